//! Vectors, boxes and the solid shapes of colliders, for `D` = 2 or 3.

use nalgebra::{SMatrix, SVector};

use crate::real::Real;

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

/// A solid whose signed distance is known in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<T: Real, const D: usize> {
    /// All points with (x - point) . normal <= 0.
    HalfSpace {
        /// A point of the plane [m].
        point: Vector<T, D>,
        /// Unit normal, out of the solid.
        normal: Vector<T, D>,
    },
    /// A disc in 2D, a sphere in 3D.
    Ball {
        /// Centre [m].
        centre: Vector<T, D>,
        /// Radius [m].
        radius: T,
    },
    /// A box, its axes the columns of `orientation`.
    Box {
        /// Centre [m].
        centre: Vector<T, D>,
        /// Half the edge lengths [m].
        half_extent: Vector<T, D>,
        /// Proper rotation from the box's axes to the world's.
        orientation: Matrix<T, D>,
    },
}

/// Distance to a surface and the direction away from it.
#[derive(Clone, Copy, Debug)]
pub struct Surface<T: Real, const D: usize> {
    /// Signed distance phi [m], negative inside the solid.
    pub distance: T,
    /// Unit vector grad phi.
    pub normal: Vector<T, D>,
}

impl<T: Real, const D: usize> Shape<T, D> {
    /// A quick answer for most points: whether `x` [m] lies outside a ball round the whole solid. `false` decides nothing.
    #[inline]
    pub(crate) fn is_far_from(&self, x: &Vector<T, D>) -> bool {
        match self {
            Shape::Box { centre, half_extent, .. } => {
                (x - centre).norm_squared() > half_extent.norm_squared()
            }
            Shape::HalfSpace { .. } | Shape::Ball { .. } => false,
        }
    }

    /// Signed distance and normal at `x` [m].
    #[inline]
    pub fn surface(&self, x: &Vector<T, D>) -> Surface<T, D> {
        match self {
            Shape::HalfSpace { point, normal } => {
                Surface { distance: (x - point).dot(normal), normal: *normal }
            }
            Shape::Ball { centre, radius } => {
                let arm = x - centre;
                let length = arm.norm();
                let normal = if length > T::zero() { arm / length } else { unit(0) };
                Surface { distance: length - *radius, normal }
            }
            Shape::Box { centre, half_extent, orientation } => {
                let surface = box_surface(&(orientation.transpose() * (x - centre)), half_extent);
                Surface { normal: orientation * surface.normal, ..surface }
            }
        }
    }
}

/// Signed distance to an axis-aligned box about the origin (Quilez, "distance functions"; exact inside and outside).
fn box_surface<T: Real, const D: usize>(x: &Vector<T, D>, half_extent: &Vector<T, D>) -> Surface<T, D> {
    let beyond = Vector::<T, D>::from_fn(|k, _| x[k].abs() - half_extent[k]);
    let outwards = Vector::<T, D>::from_fn(|k, _| if x[k] < T::zero() { -T::one() } else { T::one() });
    let nearest = (0..D).fold(0, |best, k| if beyond[k] > beyond[best] { k } else { best });
    if beyond[nearest] <= T::zero() {
        return Surface { distance: beyond[nearest], normal: unit::<T, D>(nearest) * outwards[nearest] };
    }
    let outside = Vector::<T, D>::from_fn(|k, _| beyond[k].max(T::zero()));
    let distance = outside.norm();
    Surface { distance, normal: outside.component_mul(&outwards) / distance }
}

/// The unit vector along `axis`.
pub fn unit<T: Real, const D: usize>(axis: usize) -> Vector<T, D> {
    Vector::from_fn(|k, _| if k == axis { T::one() } else { T::zero() })
}

/// Whether every component is 0.
#[inline]
pub fn is_zero<T: Real, const D: usize>(v: &Vector<T, D>) -> bool {
    v.iter().all(|c| *c == T::zero())
}
