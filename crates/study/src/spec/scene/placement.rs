//! Where the particles of a body are.

use serde::{Deserialize, Serialize};

/// How particles are placed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PlacementSpec {
    /// Independent uniform points.
    Random {
        /// Number of particles.
        count: usize,
        /// What `count` refers to.
        #[serde(default)]
        count_of: CountOf,
    },
    /// One uniform point in every cell of a lattice.
    Jittered {
        /// Number of particles.
        count: usize,
        /// What `count` refers to.
        #[serde(default)]
        count_of: CountOf,
        /// Angle of the lattice [degrees].
        #[serde(default = "lattice_angle")]
        angle: f64,
    },
    /// The sites of a lattice.
    Lattice {
        /// Number of particles.
        count: usize,
        /// What `count` refers to.
        #[serde(default)]
        count_of: CountOf,
        /// Angle of the lattice [degrees].
        #[serde(default = "lattice_angle")]
        angle: f64,
    },
    /// Random points that keep their distance.
    PoissonDisk {
        /// Number of particles.
        count: usize,
        /// What `count` refers to.
        #[serde(default)]
        count_of: CountOf,
    },
    /// Points from a CSV or PLY file with columns x, y[, z], and vx, vy[, vz] if it has them.
    File {
        /// The file; relative to the scene file.
        path: String,
        /// Area [m^2] or volume [m^3] that the points fill.
        filled_volume: f64,
    },
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
