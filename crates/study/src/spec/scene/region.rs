//! Shapes: those of bodies, and the ones that obstacles share with them.

use serde::{Deserialize, Serialize};

/// A shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RegionSpec {
    /// A disc or ball.
    Ball(BallSpec),
    /// A rectangle or cuboid.
    Box(BoxSpec),
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

/// A disc or ball.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BallSpec {
    /// Centre [m].
    pub centre: Vec<f64>,
    /// Radius [m].
    pub radius: f64,
}

/// A rectangle or cuboid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Centre [m].
    pub centre: Vec<f64>,
    /// Half the edge lengths [m].
    pub half_extent: Vec<f64>,
    /// Turned by so much in the plane of the first two axes [degrees].
    #[serde(default)]
    pub angle: f64,
}
