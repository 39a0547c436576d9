//! Rotations and evenly spread directions, one source for both dimensions.

use std::f64::consts::PI;

use snowlab_solver::geometry::{Matrix, Vector};

/// Rotation by `angle` [rad] in the plane of the first two axes, for `D` = 2 or 3.
pub fn rotation<const D: usize>(angle: f64) -> Matrix<f64, D> {
    plane_rotation(angle, 0)
}

/// The orientation of a lattice of `angle` [rad]: [`rotation`], followed in 3D by the same angle in the plane of
/// the second and third axes, so that no face of its cells is parallel to the grid.
pub fn lattice_rotation<const D: usize>(angle: f64) -> Matrix<f64, D> {
    if D == 2 { plane_rotation(angle, 0) } else { plane_rotation(angle, 1) * plane_rotation::<D>(angle, 0) }
}

/// Rotation in the plane of the axes `first` and `first + 1`.
fn plane_rotation<const D: usize>(angle: f64, first: usize) -> Matrix<f64, D> {
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let mut matrix = Matrix::<f64, D>::identity();
    matrix[(first, first)] = cosine;
    matrix[(first, first + 1)] = -sine;
    matrix[(first + 1, first)] = sine;
    matrix[(first + 1, first + 1)] = cosine;
    matrix
}

/// `count` directions of equal weight: equal angles in 2D, a Fibonacci lattice on the sphere in 3D
/// (Swinbank & Purser 2006).
pub(crate) fn even_directions<const D: usize>(count: usize) -> Vec<Vector<f64, D>> {
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    (0..count)
        .map(|index| {
            let share = (index as f64 + 0.5) / count as f64;
            let (angle, height) = if D == 2 {
                (2.0 * PI * share, 0.0)
            } else {
                (golden_angle * index as f64, 1.0 - 2.0 * share)
            };
            let ring = (1.0 - height * height).sqrt();
            let mut direction = Vector::<f64, D>::zeros();
            direction[0] = ring * libm::cos(angle);
            direction[1] = ring * libm::sin(angle);
            if D == 3 {
                direction[2] = height;
            }
            direction
        })
        .collect()
}
