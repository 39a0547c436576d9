//! A scene file: bodies, obstacles, numerics, output.

mod body;
mod collider;
mod heterogeneity;
mod material;
mod numerics;
mod output;
mod placement;
mod region;
mod voids;

pub use body::BodySpec;
pub use collider::{ColliderSpec, ContactName, SolidSpec};
pub use heterogeneity::{HeterogeneitySpec, Property};
pub use material::MaterialSpec;
pub use numerics::{
    AdvectionName, EngineName, IntegratorSpec, KernelName, MethodName, NumericsSpec, PrecisionName,
    RestVolumeName, SemiImplicitSpec, TransferName, TrapezoidalSpec,
};
pub use output::{EndFrom, OutputSpec, TimeUnit};
pub use placement::{CountOf, CountSpec, LatticeSpec, PlacementSpec};
pub use region::{BallSpec, BoxSpec, MeshSpec, RegionSpec, UpName};
pub use voids::{InclusionSpec, VoidSpec};

use serde::{Deserialize, Serialize};

/// A scene. Lengths in metres, times in seconds, SI throughout; in 2D mass and energy are per metre of depth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// 2 or 3.
    #[serde(default = "plane")]
    pub dimension: usize,
    /// Seed of all random streams; in a study the number of the block.
    #[serde(default = "first_seed")]
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

impl SceneSpec {
    /// The scene on a grid of this spacing [m], with so many times as many particles of each body and the voids it has: lengths that are left out follow
    /// the spacing it had. `None` where particles come from a file.
    pub fn on_grid(&self, spacing: f64, factor: f64) -> Option<SceneSpec> {
        let mut scene = self.clone();
        scene.numerics.spacing = spacing;
        for body in &mut scene.body {
            let count = body.placement.count_mut()?;
            *count = ((*count as f64 * factor).round() as usize).max(1);
            match &mut body.voids {
                Some(VoidSpec::Circles(field) | VoidSpec::Ellipses(field)) => {
                    field.judged_at.get_or_insert(self.numerics.spacing);
                }
                Some(VoidSpec::GaussianField { judged_at, .. }) => {
                    judged_at.get_or_insert(self.numerics.spacing);
                }
                None => {}
            }
        }
        Some(scene)
    }
}

/// `dimension` where it is left out.
fn plane() -> usize {
    2
}

/// `seed` where it is left out.
fn first_seed() -> u64 {
    1
}
