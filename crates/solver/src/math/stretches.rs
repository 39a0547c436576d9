//! Bounds on the stretches, the (signed) singular values: whether a matrix keeps them, and what it becomes where it is made to.

use super::{SignedSvd, determinant, norm_squared, signed_svd};
use crate::geometry::{Matrix, Vector};
use crate::real::Real;

/// F = U diag(s) V^T with its stretches s and, in their place, the nearest ones within bounds.
#[derive(Clone, Copy, Debug)]
pub struct ClampedStretches<T: Real, const D: usize> {
    /// U diag(`clamped`) V^T.
    pub matrix: Matrix<T, D>,
    /// The stretches of F, in descending order; only the last may be negative.
    pub stretches: Vector<T, D>,
    /// The nearest values within the bounds.
    pub clamped: Vector<T, D>,
}

/// Whether every stretch of `f` lies in `[least, greatest]`.
///
/// In 2D in closed form. In 3D by the bound |s^2 - 1| <= |F^T F - I|, and by the stretches themselves where the bound does not
/// decide.
#[inline]
pub fn stretches_within<T: Real, const D: usize>(f: &Matrix<T, D>, least: T, greatest: T) -> bool {
    match D {
        2 => Planar::of(f).stretches().iter().all(|s| *s >= least && *s <= greatest),
        3 => {
            let one = T::one();
            let room = (one - least * least).min(greatest * greatest - one);
            let strain = f.transpose() * f - Matrix::<T, D>::identity();
            let upright = determinant(f) > T::zero();
            if upright && room > T::zero() && norm_squared(&strain) <= room * room {
                return true;
            }
            signed_svd(f).stretches.iter().all(|s| *s >= least && *s <= greatest)
        }
        _ => unreachable!("D is 2 or 3"),
    }
}

/// `f` with its stretches clamped to `[least, greatest]`, for any finite `f`.
#[inline]
pub fn clamp_stretches<T: Real, const D: usize>(
    f: &Matrix<T, D>,
    least: T,
    greatest: T,
) -> ClampedStretches<T, D> {
    if D == 2 {
        let parts = Planar::of(f);
        // Upright, and no square has vanished or overflown.
        if parts.sum > parts.difference && parts.sum.is_finite() {
            return parts.clamped(least, greatest);
        }
    }
    let svd = signed_svd(f);
    let clamped = svd.stretches.map(|s| s.max(least).min(greatest));
    ClampedStretches {
        matrix: SignedSvd { stretches: clamped, ..svd }.recompose(),
        stretches: svd.stretches,
        clamped,
    }
}

/// Twice a 2 by 2 matrix as a turned and a mirrored part, [[a, -b], [b, a]] + [[c, d], [d, -c]]. Their lengths |(a, b)| and |(c, d)|
/// are the sum and the difference of the stretches, their directions the difference and the sum of the angles of U and V: the
/// stretches change by scaling the parts, without a decomposition.
struct Planar<T> {
    turned: (T, T),
    mirrored: (T, T),
    sum: T,
    difference: T,
}

impl<T: Real> Planar<T> {
    #[inline]
    fn of<const D: usize>(f: &Matrix<T, D>) -> Self {
        let turned = (f[(0, 0)] + f[(1, 1)], f[(1, 0)] - f[(0, 1)]);
        let mirrored = (f[(0, 0)] - f[(1, 1)], f[(1, 0)] + f[(0, 1)]);
        let length = |(x, y): (T, T)| (x * x + y * y).sqrt();
        Planar { turned, mirrored, sum: length(turned), difference: length(mirrored) }
    }

    #[inline]
    fn stretches(&self) -> [T; 2] {
        let half = T::of(0.5);
        [(self.sum + self.difference) * half, (self.sum - self.difference) * half]
    }

    /// For a matrix with a positive determinant.
    #[inline]
    fn clamped<const D: usize>(&self, least: T, greatest: T) -> ClampedStretches<T, D> {
        let s = self.stretches();
        let c = s.map(|s| s.max(least).min(greatest));
        let half = T::of(0.5);
        let turned = (c[0] + c[1]) / self.sum * half;
        // Equal stretches stay equal, and have no mirrored part.
        let apart = self.difference > T::zero();
        let mirrored = if apart { (c[0] - c[1]) / self.difference * half } else { T::zero() };
        let (a, b) = (self.turned.0 * turned, self.turned.1 * turned);
        let (x, y) = (self.mirrored.0 * mirrored, self.mirrored.1 * mirrored);
        let mut matrix = Matrix::<T, D>::zeros();
        (matrix[(0, 0)], matrix[(0, 1)], matrix[(1, 0)], matrix[(1, 1)]) = (a + x, y - b, y + b, a - x);
        ClampedStretches {
            matrix,
            stretches: Vector::from_fn(|i, _| s[i]),
            clamped: Vector::from_fn(|i, _| c[i]),
        }
    }
}
