//! Meshes in a scene.

use std::path::Path;

use snowlab_sampler::PlacedMesh;
use snowlab_solver::Matrix;

use crate::meshes::{self, MeshError};
use crate::spec::SpecError;
use crate::spec::scene::{MeshSpec, UpName};

use super::vector::{vector, vector_or_zero};

/// The mesh that a region's words describe; its path is relative to `folder`.
pub(super) fn mesh(spec: &MeshSpec, key: &str, folder: &Path) -> Result<PlacedMesh, SpecError> {
    let place = format!("`{key}.path`");
    let mesh = match meshes::read(&folder.join(&spec.path)) {
        Ok(mesh) => mesh,
        Err(error @ MeshError::Io { .. }) => {
            return Err(SpecError::Particles { place, message: error.to_string() });
        }
        Err(error) => return Err(SpecError::value(place, error.to_string())),
    };
    let angles = vector_or_zero::<3>(&spec.rotation, &format!("{key}.rotation"))?.map(f64::to_radians);
    // About the first axis, then the second, then the third.
    let turns = [(1, 2), (2, 0), (0, 1)].into_iter().zip(&angles);
    let orientation = turns.fold(upright(spec.up), |before, (axes, angle)| turn(axes, *angle) * before);
    let centre =
        spec.centre.as_ref().map(|centre| vector::<3>(centre, &format!("{key}.centre"))).transpose()?;
    PlacedMesh::new(mesh, spec.scale, orientation, centre)
        .map_err(|error| SpecError::value(format!("`{key}`"), error.to_string()))
}

/// Takes the file's axes to the scene's.
fn upright(up: UpName) -> Matrix<f64, 3> {
    match up {
        UpName::Z => Matrix::<f64, 3>::identity(),
        UpName::Y => Matrix::<f64, 3>::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0),
    }
}

/// Rotation by `angle` [rad] from one axis to another.
fn turn((from, to): (usize, usize), angle: f64) -> Matrix<f64, 3> {
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let mut matrix = Matrix::<f64, 3>::identity();
    (matrix[(from, from)], matrix[(from, to)]) = (cosine, -sine);
    (matrix[(to, from)], matrix[(to, to)]) = (sine, cosine);
    matrix
}
