//! Where the naive step gets its polar and singular value decompositions from.

use nalgebra::{Matrix2, Matrix3};
use snowlab_solver::Real;
use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::math::{clamp_stretches, polar_rotation};

/// For matrices of positive determinant.
pub trait Decomposition {
    /// R of F = R S.
    fn rotation<T: Real, const D: usize>(f: &Matrix<T, D>) -> Matrix<T, D>;
    /// F with its stretches clamped, and by what factor that has lowered its determinant.
    fn clamp<T: Real, const D: usize>(f: &Matrix<T, D>, least: T, greatest: T) -> (Matrix<T, D>, T);
}

/// nalgebra's singular value decomposition, as people use it.
#[derive(Clone, Copy, Debug)]
pub struct General;

/// The solver's own functions.
#[derive(Clone, Copy, Debug)]
pub struct Own;

impl Decomposition for General {
    #[inline(always)]
    fn rotation<T: Real, const D: usize>(f: &Matrix<T, D>) -> Matrix<T, D> {
        let (u, _, v_t) = decompose(f);
        u * v_t
    }

    #[inline(always)]
    fn clamp<T: Real, const D: usize>(f: &Matrix<T, D>, least: T, greatest: T) -> (Matrix<T, D>, T) {
        let (u, stretches, v_t) = decompose(f);
        let clamped = stretches.map(|s| s.max(least).min(greatest));
        let ratio = (0..D).fold(T::one(), |ratio, k| ratio * stretches[k] / clamped[k]);
        (u * Matrix::from_diagonal(&clamped) * v_t, ratio)
    }
}

impl Decomposition for Own {
    #[inline(always)]
    fn rotation<T: Real, const D: usize>(f: &Matrix<T, D>) -> Matrix<T, D> {
        polar_rotation(f)
    }

    #[inline(always)]
    fn clamp<T: Real, const D: usize>(f: &Matrix<T, D>, least: T, greatest: T) -> (Matrix<T, D>, T) {
        let flow = clamp_stretches(f, least, greatest);
        let ratio = (0..D).fold(T::one(), |ratio, k| ratio * flow.stretches[k] / flow.clamped[k]);
        (flow.matrix, ratio)
    }
}

/// U, the stretches and V^T. nalgebra decomposes matrices of a known size: `D` is matched here, which costs nothing when compiled.
#[inline(always)]
fn decompose<T: Real, const D: usize>(f: &Matrix<T, D>) -> (Matrix<T, D>, Vector<T, D>, Matrix<T, D>) {
    if D == 2 {
        let svd = Matrix2::from_fn(|i, j| f[(i, j)]).svd(true, true);
        let (u, v_t) = (svd.u.expect("asked for"), svd.v_t.expect("asked for"));
        (
            Matrix::from_fn(|i, j| u[(i, j)]),
            Vector::from_fn(|k, _| svd.singular_values[k]),
            Matrix::from_fn(|i, j| v_t[(i, j)]),
        )
    } else {
        let svd = Matrix3::from_fn(|i, j| f[(i, j)]).svd(true, true);
        let (u, v_t) = (svd.u.expect("asked for"), svd.v_t.expect("asked for"));
        (
            Matrix::from_fn(|i, j| u[(i, j)]),
            Vector::from_fn(|k, _| svd.singular_values[k]),
            Matrix::from_fn(|i, j| v_t[(i, j)]),
        )
    }
}
