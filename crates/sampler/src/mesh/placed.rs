//! A mesh in a scene: scaled, turned and shifted.

use std::sync::Arc;

use snowlab_solver::geometry::{Aabb, Matrix, Vector};

use crate::error::{SamplerError, require};

use super::tree::hull;
use super::{Mesh, Point};

/// A mesh whose point x lies at `shift + scale Q x` [m].
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedMesh {
    mesh: Arc<Mesh>,
    scale: f64,
    orientation: Matrix<f64, 3>,
    shift: Point,
    bounds: Aabb<3>,
}

impl PlacedMesh {
    /// Puts `mesh` into a scene: `scale` [m per unit of the mesh], its own axes as the orthonormal columns of
    /// `orientation`, and the middle of the box about it at `centre` [m]; without one its origin stays the scene's.
    ///
    /// # Errors
    /// [`SamplerError::OutOfRange`] for a scale that is not positive or a place beyond 1e6 m,
    /// [`SamplerError::Orientation`].
    pub fn new(
        mesh: Arc<Mesh>,
        scale: f64,
        orientation: Matrix<f64, 3>,
        centre: Option<Point>,
    ) -> Result<Self, SamplerError> {
        require(scale > 0.0 && scale <= 1e6, "scale of a mesh [m]", scale, "above 0, at most 1e6")?;
        crate::region::orthonormal("mesh", &orientation)?;
        let corners = mesh.tree.triangles().iter().flat_map(|triangle| triangle.0);
        let (min, max) = hull(corners.map(|corner| orientation * corner * scale));
        let shift = centre.map_or(Point::zeros(), |centre| centre - (min + max) * 0.5);
        let bounds = Aabb { min: min + shift, max: max + shift };
        for &coordinate in bounds.min.iter().chain(&bounds.max) {
            require(
                coordinate.abs() <= 1e6,
                "a coordinate of a mesh in the scene [m]",
                coordinate,
                "-1e6 to 1e6",
            )?;
        }
        Ok(Self { mesh, scale, orientation, shift, bounds })
    }

    /// Whether it holds the first three coordinates of `point` [m].
    pub(crate) fn contains<const D: usize>(&self, point: &Vector<f64, D>) -> bool {
        self.mesh.contains(&self.local(point))
    }

    /// Distance to the surface [m], negative outside. Where parts overlap, surface within others counts too.
    pub(crate) fn depth<const D: usize>(&self, point: &Vector<f64, D>) -> f64 {
        let local = self.local(point);
        let distance = self.scale * self.mesh.distance(&local);
        if self.mesh.contains(&local) { distance } else { -distance }
    }

    fn local<const D: usize>(&self, point: &Vector<f64, D>) -> Point {
        let point = Point::from_fn(|axis, _| point.get(axis).copied().unwrap_or(0.0));
        self.orientation.tr_mul(&(point - self.shift)) / self.scale
    }

    /// The mesh as it is in its own units.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The smallest box about it along the scene's axes [m].
    pub fn bounds(&self) -> Aabb<3> {
        self.bounds
    }

    /// Volume [m^3].
    pub fn volume(&self) -> f64 {
        self.mesh.volume() * self.scale.powi(3)
    }
}
