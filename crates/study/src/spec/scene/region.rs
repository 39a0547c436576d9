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
    /// What a closed surface of triangles encloses; 3D only.
    Mesh(MeshSpec),
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

impl RegionSpec {
    /// The meshes it is made of, in their order.
    pub fn meshes(&self) -> Vec<&MeshSpec> {
        match self {
            RegionSpec::Ball(_) | RegionSpec::Box(_) | RegionSpec::Ellipsoid { .. } => Vec::new(),
            RegionSpec::Mesh(mesh) => vec![mesh],
            RegionSpec::Union { parts } => parts.iter().flat_map(RegionSpec::meshes).collect(),
            RegionSpec::Difference { solid, removed } => [solid.meshes(), removed.meshes()].concat(),
        }
    }

    /// [`RegionSpec::meshes`], to be changed.
    pub fn meshes_mut(&mut self) -> Vec<&mut MeshSpec> {
        match self {
            RegionSpec::Ball(_) | RegionSpec::Box(_) | RegionSpec::Ellipsoid { .. } => Vec::new(),
            RegionSpec::Mesh(mesh) => vec![mesh],
            RegionSpec::Union { parts } => parts.iter_mut().flat_map(RegionSpec::meshes_mut).collect(),
            RegionSpec::Difference { solid, removed } => {
                solid.meshes_mut().into_iter().chain(removed.meshes_mut()).collect()
            }
        }
    }
}

/// A closed surface of triangles in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshSpec {
    /// OBJ, STL or PLY; relative to the scene file.
    pub path: String,
    /// Metres in one unit of the file.
    #[serde(default = "metre")]
    pub scale: f64,
    /// The file's axis that becomes the scene's third.
    #[serde(default)]
    pub up: UpName,
    /// Turned about the scene's first axis, then the second, then the third [degrees]; not at all when left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rotation: Vec<f64>,
    /// Where the middle of the box about it goes [m]; the file's origin stays the scene's when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<Vec<f64>>,
}

/// `scale` where it is left out.
fn metre() -> f64 {
    1.0
}

/// Which way is up in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UpName {
    /// As in the scene.
    #[default]
    Z,
    /// The file's y becomes the scene's z, its z the scene's -y.
    Y,
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
