//! The rotation R of the polar decomposition F = R S, with det R = +1 for every F, inverted and singular included.

use super::{cofactor, determinant, norm_squared, signed_svd};
use crate::geometry::Matrix;
use crate::real::Real;

/// Newton's iteration doubles its correct digits each time; from stretches between 1/10 and 10 it needs 7 or fewer
/// (chosen: twice that, then the SVD decides).
const NEWTON_STEPS: usize = 14;

/// The proper rotation nearest to `f` (for det f < 0: nearest among the rotations, S then has a negative eigenvalue).
/// Where it is not unique, one of the nearest; the identity for f = 0.
#[inline]
pub fn polar_rotation<T: Real, const D: usize>(f: &Matrix<T, D>) -> Matrix<T, D> {
    match D {
        2 => planar(f),
        3 => spatial(f),
        _ => unreachable!("D is 2 or 3"),
    }
}

/// By the angle of (F00 + F11, F10 - F01); no trigonometric function is needed.
#[inline]
fn planar<T: Real, const D: usize>(f: &Matrix<T, D>) -> Matrix<T, D> {
    let (x, y) = (f[(0, 0)] + f[(1, 1)], f[(1, 0)] - f[(0, 1)]);
    let length = (x * x + y * y).sqrt();
    let (cos, sin) = if length > T::zero() { (x / length, y / length) } else { (T::one(), T::zero()) };
    let mut r = Matrix::<T, D>::zeros();
    r[(0, 0)] = cos;
    r[(0, 1)] = -sin;
    r[(1, 0)] = sin;
    r[(1, 1)] = cos;
    r
}

/// By Newton's iteration X <- (X + X^-T) / 2 (Higham 1986) where F is regular and not inverted, else by the SVD.
fn spatial<T: Real, const D: usize>(f: &Matrix<T, D>) -> Matrix<T, D> {
    let half = T::of(0.5);
    let size = norm_squared(f);
    // Well away from singular: det / |F|^3 is at most 3^-1.5, and 1e-3 of |F|^3 leaves stretches within 1 : 200.
    let regular = determinant(f) > T::of(1e-3) * size * size.sqrt();
    if regular {
        let mut x = *f;
        for _ in 0..NEWTON_STEPS {
            let next = (x + cofactor(&x) / determinant(&x)) * half;
            let change = norm_squared(&(next - x));
            x = next;
            // Quadratic convergence: a change of sqrt(eps) leaves an error of eps.
            if change <= T::default_epsilon() {
                return (x + cofactor(&x) / determinant(&x)) * half;
            }
        }
    }
    let svd = signed_svd(f);
    svd.u * svd.v.transpose()
}
