//! The rotation R of the polar decomposition F = R S, with det R = +1 for every F, inverted and singular included.

use super::{cofactor, determinant, norm_squared, signed_svd};
use crate::geometry::Matrix;
use crate::real::Real;

/// Newton's iteration doubles its correct digits each time; from stretches between 1/10 and 10 it needs 7 or fewer
/// (chosen: twice that, then the SVD decides).
const NEWTON_STEPS: usize = 14;
/// Newton's iteration starts where det F is above this share of |F|^3 (chosen: 3^-1.5 = 0.19 is the most there is; from 0.05 on the
/// greatest stretch is below 8 times the least, and the inverse by cofactors keeps all but a digit).
const REGULAR_SHARE: f64 = 0.05;

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
    let (cos, sin) = direction(x, y);
    let mut r = Matrix::<T, D>::zeros();
    r[(0, 0)] = cos;
    r[(0, 1)] = -sin;
    r[(1, 0)] = sin;
    r[(1, 1)] = cos;
    r
}

/// The unit vector along (x, y), (1, 0) for 0, also where the squares overflow or vanish.
#[inline]
fn direction<T: Real>(x: T, y: T) -> (T, T) {
    let squared = x * x + y * y;
    if squared > T::of(T::LEAST_SQUARE) && squared < T::of(1.0 / T::LEAST_SQUARE) {
        let length = squared.sqrt();
        return (x / length, y / length);
    }
    let size = x.abs().max(y.abs());
    if size == T::zero() {
        return (T::one(), T::zero());
    }
    let (x, y) = (x / size, y / size);
    let length = (x * x + y * y).sqrt();
    (x / length, y / length)
}

/// By Newton's iteration X <- (X + X^-T) / 2 (Higham 1986) where F is regular and not inverted, else by the SVD.
fn spatial<T: Real, const D: usize>(f: &Matrix<T, D>) -> Matrix<T, D> {
    let half = T::of(0.5);
    let size = norm_squared(f);
    let regular = determinant(f) > T::of(REGULAR_SHARE) * size * size.sqrt();
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
