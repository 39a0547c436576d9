//! Singular value decomposition with proper rotations: F = U diag(s) V^T, det U = det V = +1, s_0 >= s_1 >= |s_2|,
//! the last singular value negative where F is inverted (Irving, Teran & Fedkiw 2004, section 4).

use super::{cross, polar_rotation};
use crate::geometry::{Matrix, Vector};
use crate::real::Real;

/// F = `u` diag(`stretches`) `v`^T, with `u` and `v` proper rotations.
#[derive(Clone, Copy, Debug)]
pub struct SignedSvd<T: Real, const D: usize> {
    /// Left rotation, det = +1.
    pub u: Matrix<T, D>,
    /// Singular values in descending order; only the last may be negative.
    pub stretches: Vector<T, D>,
    /// Right rotation, det = +1.
    pub v: Matrix<T, D>,
}

impl<T: Real, const D: usize> SignedSvd<T, D> {
    /// `u` diag(`stretches`) `v`^T.
    #[inline]
    pub fn recompose(&self) -> Matrix<T, D> {
        let scaled = Matrix::<T, D>::from_fn(|i, j| self.u[(i, j)] * self.stretches[j]);
        scaled * self.v.transpose()
    }
}

/// The decomposition of any finite `f`: repeated, zero and negative singular values included.
#[inline]
pub fn signed_svd<T: Real, const D: usize>(f: &Matrix<T, D>) -> SignedSvd<T, D> {
    match D {
        2 => planar(f),
        3 => spatial(f),
        _ => unreachable!("D is 2 or 3"),
    }
}

/// The polar decomposition, then one Jacobi rotation that makes S diagonal.
#[inline]
fn planar<T: Real, const D: usize>(f: &Matrix<T, D>) -> SignedSvd<T, D> {
    let r = polar_rotation(f);
    let s = r.transpose() * f;
    let off = (s[(0, 1)] + s[(1, 0)]) * T::of(0.5);
    let (cos, sin, tan) = jacobi_rotation(s[(0, 0)], off, s[(1, 1)]);
    let (s0, s1) = (s[(0, 0)] - tan * off, s[(1, 1)] + tan * off);
    let mut v = Matrix::<T, D>::zeros();
    let mut stretches = Vector::<T, D>::zeros();
    // The eigenvector of s0 is (cos, -sin), that of s1 (sin, cos); in descending order, with det v = +1.
    if s0 >= s1 {
        (stretches[0], stretches[1]) = (s0, s1);
        (v[(0, 0)], v[(1, 0)], v[(0, 1)], v[(1, 1)]) = (cos, -sin, sin, cos);
    } else {
        (stretches[0], stretches[1]) = (s1, s0);
        (v[(0, 0)], v[(1, 0)], v[(0, 1)], v[(1, 1)]) = (sin, cos, -cos, sin);
    }
    SignedSvd { u: r * v, stretches, v }
}

/// Cosine, sine and tangent of the rotation that makes [[a, b], [b, c]] diagonal, by at most 45 degrees
/// (Golub & Van Loan, Matrix Computations, section 8.5.2).
#[inline]
fn jacobi_rotation<T: Real>(a: T, b: T, c: T) -> (T, T, T) {
    if b == T::zero() {
        return (T::one(), T::zero(), T::zero());
    }
    let half_cotangent = (c - a) / (b + b);
    let sign = if half_cotangent >= T::zero() { T::one() } else { -T::one() };
    let tan = sign / (half_cotangent.abs() + (T::one() + half_cotangent * half_cotangent).sqrt());
    let cos = T::one() / (T::one() + tan * tan).sqrt();
    (cos, cos * tan, tan)
}

/// One-sided Jacobi (Hestenes 1958): rotate pairs of columns of F until they are orthogonal. Small singular values
/// keep their relative precision, which a decomposition of F^T F would lose.
fn spatial<T: Real, const D: usize>(f: &Matrix<T, D>) -> SignedSvd<T, D> {
    let size = f.iter().fold(T::zero(), |m, e| m.max(e.abs()));
    if size == T::zero() {
        return SignedSvd { u: Matrix::identity(), stretches: Vector::zeros(), v: Matrix::identity() };
    }
    let mut a = *f / size;
    let mut v = Matrix::<T, D>::identity();
    orthogonalise_columns(&mut a, &mut v);
    sort_columns(&mut a, &mut v);
    let (u, stretches) = left_rotation(&a);
    SignedSvd { u, stretches: stretches * size, v }
}

fn orthogonalise_columns<T: Real, const D: usize>(a: &mut Matrix<T, D>, v: &mut Matrix<T, D>) {
    /// A 3 by 3 matrix needs 4 or 5 sweeps; convergence is quadratic (chosen: three times that).
    const SWEEPS: usize = 15;
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (x, y) = (a.column(i).into_owned(), a.column(j).into_owned());
            let (xx, xy, yy) = (x.dot(&x), x.dot(&y), y.dot(&y));
            if xy.abs() <= T::default_epsilon() * (xx * yy).sqrt() {
                continue;
            }
            rotated = true;
            let (cos, sin, _) = jacobi_rotation(xx, xy, yy);
            a.set_column(i, &(x * cos - y * sin));
            a.set_column(j, &(x * sin + y * cos));
            let (p, q) = (v.column(i).into_owned(), v.column(j).into_owned());
            v.set_column(i, &(p * cos - q * sin));
            v.set_column(j, &(p * sin + q * cos));
        }
        if !rotated {
            return;
        }
    }
}

/// Descending column lengths; each exchange also turns one column round, so that det v stays +1.
fn sort_columns<T: Real, const D: usize>(a: &mut Matrix<T, D>, v: &mut Matrix<T, D>) {
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if a.column(i).norm_squared() < a.column(j).norm_squared() {
            for m in [&mut *a, &mut *v] {
                let (x, y) = (m.column(i).into_owned(), m.column(j).into_owned());
                m.set_column(i, &y);
                m.set_column(j, &(-x));
            }
        }
    }
}

/// The proper rotation whose columns point along those of `a`, and the signed lengths.
fn left_rotation<T: Real, const D: usize>(a: &Matrix<T, D>) -> (Matrix<T, D>, Vector<T, D>) {
    let (x, y, z) = (a.column(0).into_owned(), a.column(1).into_owned(), a.column(2).into_owned());
    let s0 = x.norm();
    let u0 = x / s0;
    let y_across = y - u0 * u0.dot(&y);
    let s1 = y_across.norm();
    // Below round-off of the largest one the direction of a column says nothing: take any that is orthogonal.
    let u1 = if s1 > T::default_epsilon() * s0 * T::of(4.0) {
        y_across / s1
    } else {
        let axis = (0..3).fold(0, |least, k| if u0[k].abs() < u0[least].abs() { k } else { least });
        let mut e = Vector::<T, D>::zeros();
        e[axis] = T::one();
        let across = e - u0 * u0[axis];
        across / across.norm()
    };
    let u2 = cross(&u0, &u1);
    let mut u = Matrix::<T, D>::zeros();
    u.set_column(0, &u0);
    u.set_column(1, &u1);
    u.set_column(2, &u2);
    let mut stretches = Vector::<T, D>::zeros();
    (stretches[0], stretches[1], stretches[2]) = (s0, u1.dot(&y), u2.dot(&z));
    (u, stretches)
}
