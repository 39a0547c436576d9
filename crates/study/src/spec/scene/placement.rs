//! Where the particles of a body are.

use serde::{Deserialize, Serialize};

/// How particles are placed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PlacementSpec {
    /// Independent uniform points.
    Random(CountSpec),
    /// One uniform point in every cell of a lattice.
    Jittered(LatticeSpec),
    /// The sites of a lattice.
    Lattice(LatticeSpec),
    /// Random points that keep their distance.
    PoissonDisk(CountSpec),
    /// Points from a CSV or PLY file with columns x, y[, z], and what else it has of a frame of `simulate`.
    File {
        /// The file; relative to the scene file.
        path: String,
        /// Area [m^2] or volume [m^3] that the points fill, where the file has no rest volumes.
        filled_volume: Option<f64>,
    },
}

impl PlacementSpec {
    /// Number of particles; `None` where a file has it.
    pub fn count(&self) -> Option<usize> {
        match self {
            PlacementSpec::Random(CountSpec { count, .. })
            | PlacementSpec::PoissonDisk(CountSpec { count, .. })
            | PlacementSpec::Jittered(LatticeSpec { count, .. })
            | PlacementSpec::Lattice(LatticeSpec { count, .. }) => Some(*count),
            PlacementSpec::File { .. } => None,
        }
    }

    /// [`PlacementSpec::count`], to be changed.
    pub fn count_mut(&mut self) -> Option<&mut usize> {
        match self {
            PlacementSpec::Random(CountSpec { count, .. })
            | PlacementSpec::PoissonDisk(CountSpec { count, .. })
            | PlacementSpec::Jittered(LatticeSpec { count, .. })
            | PlacementSpec::Lattice(LatticeSpec { count, .. }) => Some(count),
            PlacementSpec::File { .. } => None,
        }
    }
}

/// How many particles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CountSpec {
    /// Number of particles.
    pub count: usize,
    /// What `count` refers to.
    #[serde(default)]
    pub count_of: CountOf,
}

/// How many particles, on a lattice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatticeSpec {
    /// Number of particles.
    pub count: usize,
    /// What `count` refers to.
    #[serde(default)]
    pub count_of: CountOf,
    /// Angle of the lattice [degrees].
    #[serde(default = "lattice_angle")]
    pub angle: f64,
}

/// What a particle count refers to in a body with voids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CountOf {
    /// The body as it is: the same count in less space.
    #[default]
    Body,
    /// The body without its voids: round(count x (1 - porosity)) particles, so that mass per particle and particles per
    /// cell are those of the solid body.
    Solid,
}

/// `angle` where it is left out [degrees].
fn lattice_angle() -> f64 {
    snowlab_sampler::LATTICE_ANGLE.to_degrees()
}
