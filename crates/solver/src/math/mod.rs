//! Small matrix algebra for `D` = 2 and 3: determinant, cofactor, rotation of the polar decomposition, singular values.
//!
//! `D` is matched here and nowhere else: the arms that do not apply vanish when a function is compiled for one `D`.

mod polar;
mod stretches;
mod svd;

pub use polar::polar_rotation;
pub use stretches::{ClampedStretches, clamp_stretches, stretches_within};
pub use svd::{SignedSvd, signed_svd};

use crate::geometry::{Matrix, Vector};
use crate::real::Real;

/// The determinant of `m`.
#[inline]
pub fn determinant<T: Real, const D: usize>(m: &Matrix<T, D>) -> T {
    match D {
        2 => m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)],
        3 => {
            m[(0, 0)] * (m[(1, 1)] * m[(2, 2)] - m[(1, 2)] * m[(2, 1)])
                - m[(0, 1)] * (m[(1, 0)] * m[(2, 2)] - m[(1, 2)] * m[(2, 0)])
                + m[(0, 2)] * (m[(1, 0)] * m[(2, 1)] - m[(1, 1)] * m[(2, 0)])
        }
        _ => unreachable!("D is 2 or 3"),
    }
}

/// The cofactor matrix, `det(m) m^-T` where `m` is regular; defined, and polynomial in the entries, for every `m`.
#[inline]
pub fn cofactor<T: Real, const D: usize>(m: &Matrix<T, D>) -> Matrix<T, D> {
    match D {
        2 => {
            let mut c = Matrix::<T, D>::zeros();
            c[(0, 0)] = m[(1, 1)];
            c[(0, 1)] = -m[(1, 0)];
            c[(1, 0)] = -m[(0, 1)];
            c[(1, 1)] = m[(0, 0)];
            c
        }
        3 => Matrix::from_fn(|i, j| {
            let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            m[(i1, j1)] * m[(i2, j2)] - m[(i1, j2)] * m[(i2, j1)]
        }),
        _ => unreachable!("D is 2 or 3"),
    }
}

/// The sum of the squares of the entries.
#[inline]
pub fn norm_squared<T: Real, const D: usize>(m: &Matrix<T, D>) -> T {
    let mut sum = T::zero();
    for entry in m.iter() {
        sum += *entry * *entry;
    }
    sum
}

/// The vector product of two vectors of three components.
#[inline]
pub(crate) fn cross<T: Real, const D: usize>(a: &Vector<T, D>, b: &Vector<T, D>) -> Vector<T, D> {
    debug_assert_eq!(D, 3);
    Vector::from_fn(|i, _| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}
