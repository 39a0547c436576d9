//! Vectors, boxes and signed distances, for `D` = 2 or 3.

use nalgebra::{SMatrix, SVector};

/// A column vector of `D` components.
pub type Vector<T, const D: usize> = SVector<T, D>;
/// A `D` by `D` matrix.
pub type Matrix<T, const D: usize> = SMatrix<T, D, D>;

/// An axis-aligned box, `min <= max` on every axis [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb<const D: usize> {
    /// The corner of least coordinates [m].
    pub min: Vector<f64, D>,
    /// The corner of greatest coordinates [m].
    pub max: Vector<f64, D>,
}
