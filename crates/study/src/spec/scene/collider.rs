//! An obstacle.

use serde::{Deserialize, Serialize};

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

/// What touching an obstacle does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactName {
    /// Material may leave.
    #[default]
    Separate,
    /// Material stays on the surface.
    Slip,
    /// Material sticks.
    Sticky,
    /// The surface is a plane of symmetry.
    Mirror,
}
