//! A scene file: bodies, obstacles, numerics, output.

use serde::{Deserialize, Serialize};

/// A scene. Lengths in metres, times in seconds, SI throughout; in 2D mass and energy are per metre of depth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// 2 or 3.
    #[serde(default = "defaults::dimension")]
    pub dimension: usize,
    /// Seed of all random streams; in a study the number of the block.
    #[serde(default = "defaults::seed")]
    pub seed: u64,
    /// Acceleration of gravity [m/s^2]; zero when left out.
    #[serde(default)]
    pub gravity: Vec<f64>,
    /// Grid, kernel, transfer, time step.
    pub numerics: NumericsSpec,
    /// Bodies of material.
    pub body: Vec<BodySpec>,
    /// Obstacles.
    #[serde(default)]
    pub collider: Vec<ColliderSpec>,
    /// When frames are kept and when the run ends.
    pub output: OutputSpec,
}

/// Numerical choices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NumericsSpec {
    /// Grid spacing h [m].
    pub spacing: f64,
    /// B-spline.
    #[serde(default)]
    pub kernel: KernelName,
    /// Transfer between particles and grid.
    #[serde(default)]
    pub transfer: TransferName,
    /// FLIP share a of a step of the reference length.
    #[serde(default = "defaults::flip_share")]
    pub flip_share: f64,
    /// Length of the step `flip_share` is meant for [s].
    #[serde(default = "defaults::flip_reference_step")]
    pub flip_reference_step: f64,
    /// Whether the share is the same for every step, however long (S13).
    #[serde(default)]
    pub flip_per_step: bool,
    /// Which velocity moves particles.
    #[serde(default)]
    pub advection: AdvectionName,
    /// How rest volumes are found.
    #[serde(default)]
    pub rest_volume: RestVolumeName,
    /// Floating point type of the run.
    #[serde(default)]
    pub precision: PrecisionName,
    /// A fixed time step [s] instead of the adaptive one.
    #[serde(default)]
    pub fixed_step: Option<f64>,
    /// C_wave; half the stability limit when left out.
    #[serde(default)]
    pub wave_courant: Option<f64>,
    /// C_adv.
    #[serde(default = "defaults::advective_courant")]
    pub advective_courant: f64,
    /// Longest time step [s].
    #[serde(default = "defaults::greatest_step")]
    pub greatest_step: f64,
    /// Whether the energy watchdog is on.
    #[serde(default = "defaults::yes")]
    pub watchdog: bool,
    /// The run stops after so many steps.
    #[serde(default = "defaults::max_steps")]
    pub max_steps: u64,
}

/// One body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodySpec {
    /// Its shape; left out where particles come from a file.
    #[serde(default)]
    pub region: Option<RegionSpec>,
    /// How particles are placed.
    pub placement: PlacementSpec,
    /// Voids, none when left out.
    #[serde(default)]
    pub voids: Option<VoidSpec>,
    /// Material.
    #[serde(default)]
    pub material: MaterialSpec,
    /// Velocity [m/s]; zero when left out.
    #[serde(default)]
    pub velocity: Vec<f64>,
    /// Spin about the body's centre [rad/s]; one number in 2D, three in 3D, none when left out.
    #[serde(default)]
    pub spin: Vec<f64>,
    /// The body is shifted by a random vector, uniform in [0, phase_shift) on each axis [m], from the stream of
    /// the grid phase.
    #[serde(default)]
    pub phase_shift: f64,
    /// Factor on the Lame parameters of all its particles.
    #[serde(default = "defaults::one")]
    pub stiffness_scale: f64,
}

/// A shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RegionSpec {
    /// A disc or ball.
    Ball {
        /// Centre [m].
        centre: Vec<f64>,
        /// Radius [m].
        radius: f64,
    },
    /// A rectangle or cuboid.
    Box {
        /// Centre [m].
        centre: Vec<f64>,
        /// Half the edge lengths [m].
        half_extent: Vec<f64>,
        /// Turned by so much in the plane of the first two axes [degrees].
        #[serde(default)]
        angle: f64,
    },
    /// An ellipse or ellipsoid.
    Ellipsoid {
        /// Centre [m].
        centre: Vec<f64>,
        /// Semi-axes [m].
        semi_axes: Vec<f64>,
        /// Turned by so much in the plane of the first two axes [degrees].
        #[serde(default)]
        angle: f64,
    },
    /// Points in any of the parts.
    Union {
        /// The parts.
        parts: Vec<RegionSpec>,
    },
    /// Points in `solid` but not in `removed`.
    Difference {
        /// What there is at first.
        solid: Box<RegionSpec>,
        /// What is taken away.
        removed: Box<RegionSpec>,
    },
}

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
        #[serde(default = "defaults::lattice_angle")]
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
        #[serde(default = "defaults::lattice_angle")]
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

/// A void field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum VoidSpec {
    /// Irregular circles (spheres).
    Circles(InclusionSpec),
    /// Irregular ellipses (ellipsoids) of the same centres and areas.
    Ellipses(InclusionSpec),
    /// A level cut of a Gaussian random field.
    GaussianField {
        /// Share of the body that is void.
        #[serde(default = "defaults::porosity")]
        porosity: f64,
        /// Correlation length [m].
        correlation_length: f64,
        /// Grid spacing that voids and bridges are judged by [m]; the scene's when left out.
        #[serde(default)]
        judged_at: Option<f64>,
    },
}

/// Parameters of circles and ellipses. Lengths left out follow from the spacing they are judged by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InclusionSpec {
    /// Share of the body that is void.
    #[serde(default = "defaults::porosity")]
    pub porosity: f64,
    /// Mean radius [m]; 3 h when left out.
    #[serde(default)]
    pub mean_radius: Option<f64>,
    /// Standard deviation of the radius over its mean.
    #[serde(default = "defaults::radius_spread")]
    pub radius_spread: f64,
    /// RMS of the outline's relative perturbation.
    #[serde(default = "defaults::irregularity")]
    pub irregularity: f64,
    /// Long over short axis of the ellipses; circles of the same seed leave room for it.
    #[serde(default = "defaults::aspect")]
    pub aspect: f64,
    /// Angle of the long axes [degrees]; random when left out.
    #[serde(default)]
    pub angle: Option<f64>,
    /// Least solid between voids, and between voids and surface [m]; 2 h when left out.
    #[serde(default)]
    pub gap: Option<f64>,
    /// Grid spacing that voids and bridges are judged by [m]; the scene's when left out.
    #[serde(default)]
    pub judged_at: Option<f64>,
}

/// A material. The defaults are S13's table 2 as handed on by public codes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum MaterialSpec {
    /// Snow.
    Snow {
        /// Density at rest [kg/m^D].
        #[serde(default = "defaults::density")]
        density: f64,
        /// Young's modulus E [Pa].
        #[serde(default = "defaults::young")]
        young: f64,
        /// Poisson's ratio nu.
        #[serde(default = "defaults::poisson")]
        poisson: f64,
        /// theta_c.
        #[serde(default = "defaults::critical_compression")]
        critical_compression: f64,
        /// theta_s.
        #[serde(default = "defaults::critical_stretch")]
        critical_stretch: f64,
        /// xi.
        #[serde(default = "defaults::hardening")]
        hardening: f64,
        /// Bounds on J_P; a run in which one takes effect is marked. None when left out.
        #[serde(default)]
        plastic_ratio_bounds: Option<[f64; 2]>,
    },
    /// The same elastic law without a yield surface.
    Elastic {
        /// Density at rest [kg/m^D].
        #[serde(default = "defaults::density")]
        density: f64,
        /// Young's modulus E [Pa].
        #[serde(default = "defaults::young")]
        young: f64,
        /// Poisson's ratio nu.
        #[serde(default = "defaults::poisson")]
        poisson: f64,
    },
}

impl Default for MaterialSpec {
    fn default() -> Self {
        MaterialSpec::Snow {
            density: defaults::density(),
            young: defaults::young(),
            poisson: defaults::poisson(),
            critical_compression: defaults::critical_compression(),
            critical_stretch: defaults::critical_stretch(),
            hardening: defaults::hardening(),
            plastic_ratio_bounds: None,
        }
    }
}

impl MaterialSpec {
    /// Density at rest [kg/m^D].
    pub fn density(&self) -> f64 {
        match self {
            MaterialSpec::Snow { density, .. } | MaterialSpec::Elastic { density, .. } => *density,
        }
    }
}

/// An obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColliderSpec {
    /// Its solid.
    pub shape: SolidSpec,
    /// What touching it does.
    #[serde(default)]
    pub contact: ContactName,
    /// Coulomb coefficient.
    #[serde(default)]
    pub friction: f64,
    /// Velocity [m/s]; zero when left out.
    #[serde(default)]
    pub velocity: Vec<f64>,
}

/// The solid of an obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SolidSpec {
    /// Everything behind a plane.
    HalfSpace {
        /// A point of the plane [m].
        point: Vec<f64>,
        /// Direction out of the solid; made a unit vector.
        normal: Vec<f64>,
    },
    /// A disc or ball.
    Ball {
        /// Centre [m].
        centre: Vec<f64>,
        /// Radius [m].
        radius: f64,
    },
    /// A rectangle or cuboid.
    Box {
        /// Centre [m].
        centre: Vec<f64>,
        /// Half the edge lengths [m].
        half_extent: Vec<f64>,
        /// Turned by so much in the plane of the first two axes [degrees].
        #[serde(default)]
        angle: f64,
    },
}

/// When frames are kept and when the run ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputSpec {
    /// What `frame_interval` and `end` count in.
    #[serde(default)]
    pub time_unit: TimeUnit,
    /// Time between frames.
    pub frame_interval: f64,
    /// End of the run.
    pub end: f64,
    /// What `end` counts from.
    #[serde(default)]
    pub end_from: EndFrom,
}

/// What times of the output count in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeUnit {
    /// Seconds.
    #[default]
    Second,
    /// R / v of the first body: half its largest extent over its speed.
    Crossing,
}

/// What the end of the run counts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EndFrom {
    /// The start.
    #[default]
    Start,
    /// The first step in which an obstacle changes a velocity.
    Contact,
}

macro_rules! names {
    ($(#[$doc:meta])* $name:ident { $first:ident $(, $other:ident)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        #[allow(missing_docs)]
        pub enum $name { #[default] $first $(, $other)* }
    };
}

names!(/** B-spline kernels. */ KernelName { Cubic, Quadratic });
names!(/** Transfers between particles and grid. */ TransferName { Flip, Apic, Mls });
names!(/** Velocities that can move particles. */ AdvectionName { Interpolated, Blended });
names!(/** Rules for rest volumes. */ RestVolumeName { Uniform, Density });
names!(/** Floating point types. */ PrecisionName { F64, F32 });
names!(/** Contacts. */ ContactName { Separate, Slip, Sticky, Mirror });

/// Defaults of keys that may be left out. Material: S13 table 2 as handed on by public codes; the FLIP rate and the
/// experiment's numbers: the study's definition (docs/experiment.md); the rest is the solver's.
mod defaults {
    use snowlab_solver::{StepLength, TimeStepControl};

    pub fn dimension() -> usize {
        2
    }
    pub fn seed() -> u64 {
        1
    }
    pub fn yes() -> bool {
        true
    }
    pub fn one() -> f64 {
        1.0
    }
    pub fn flip_share() -> f64 {
        0.95
    }
    pub fn flip_reference_step() -> f64 {
        1e-5
    }
    pub fn advective_courant() -> f64 {
        adaptive().0
    }
    pub fn greatest_step() -> f64 {
        adaptive().1
    }
    pub fn max_steps() -> u64 {
        TimeStepControl::default().max_steps
    }
    pub fn density() -> f64 {
        400.0
    }
    pub fn young() -> f64 {
        1.4e5
    }
    pub fn poisson() -> f64 {
        0.2
    }
    pub fn critical_compression() -> f64 {
        2.5e-2
    }
    pub fn critical_stretch() -> f64 {
        7.5e-3
    }
    pub fn hardening() -> f64 {
        10.0
    }
    pub fn lattice_angle() -> f64 {
        snowlab_sampler::LATTICE_ANGLE.to_degrees()
    }
    pub fn porosity() -> f64 {
        0.15
    }
    pub fn radius_spread() -> f64 {
        0.2
    }
    pub fn irregularity() -> f64 {
        0.1
    }
    pub fn aspect() -> f64 {
        2.0
    }

    fn adaptive() -> (f64, f64) {
        match TimeStepControl::default().length {
            StepLength::Adaptive { advection, greatest, .. } => (advection, greatest),
            StepLength::Fixed(dt) => (1.0, dt),
        }
    }
}
