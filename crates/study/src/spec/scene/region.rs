//! The shape of a body.

use serde::{Deserialize, Serialize};

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
