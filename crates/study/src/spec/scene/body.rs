//! A body of material.

use serde::{Deserialize, Serialize};

use super::heterogeneity::HeterogeneitySpec;
use super::material::MaterialSpec;
use super::placement::PlacementSpec;
use super::region::RegionSpec;
use super::voids::VoidSpec;

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
    /// How its particles differ; they are alike when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heterogeneity: Option<HeterogeneitySpec>,
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
    #[serde(default = "unscaled")]
    pub stiffness_scale: f64,
}

/// `stiffness_scale` where it is left out.
fn unscaled() -> f64 {
    1.0
}
