//! Where one particle meets the grid: its nodes, weights and weight gradients, row by row.
//!
//! The weight of a node is a product over the axes, so sums over the `SUPPORT^D` nodes are done by rows along the last
//! axis: what belongs to the other axes is multiplied in once a row.

use crate::geometry::Vector;
use crate::kernel::{Kernel, MAX_SUPPORT};
use crate::real::Real;

/// Weights of one particle on each axis.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<T: Real, const D: usize> {
    /// The node of least index on each axis.
    pub first: [i32; D],
    /// w on each axis.
    pub weight: [[T; MAX_SUPPORT]; D],
    /// Derivative of w with respect to the particle's coordinate [1/m]; for MLS its replacement D^-1 w (x_i - x_p).
    pub slope: [[T; MAX_SUPPORT]; D],
    /// w (x_i - x_p) [m].
    pub moment: [[T; MAX_SUPPORT]; D],
}

/// What the axes but the last contribute to one row of nodes.
#[derive(Clone, Copy, Debug)]
pub struct Row<T: Real, const D: usize> {
    /// Offset of the row on the axes but the last (the last entry is 0).
    pub offset: [usize; D],
    /// Product of the weights.
    pub weight: T,
    /// For axis k but the last: the product with axis k's weight replaced by its slope. Last entry: `weight`.
    pub gradient: Vector<T, D>,
    /// For axis k but the last: the product with axis k's weight replaced by its moment. Last entry: `weight`.
    pub moment: Vector<T, D>,
}

impl<T: Real, const D: usize> Stencil<T, D> {
    /// Weights, gradients and moments of `K` at `x` [m], on a grid with nodes at the multiples of `spacing`. `MOVING_LEAST_SQUARES`
    /// takes the gradients of Hu et al. 2018 instead of the kernel's own.
    #[inline(always)]
    pub fn at<K: Kernel, const MOVING_LEAST_SQUARES: bool>(
        x: &Vector<T, D>,
        spacing: T,
        per_spacing: T,
    ) -> Self {
        Self::with::<K, true, MOVING_LEAST_SQUARES>(x, spacing, per_spacing)
    }

    /// As [`Stencil::at`]; without `MOMENTS` they stay zero, for a transfer that does not read them.
    #[inline(always)]
    pub(crate) fn with<K: Kernel, const MOMENTS: bool, const MOVING_LEAST_SQUARES: bool>(
        x: &Vector<T, D>,
        spacing: T,
        per_spacing: T,
    ) -> Self {
        let mut s = Stencil {
            first: [0; D],
            weight: [[T::zero(); MAX_SUPPORT]; D],
            slope: [[T::zero(); MAX_SUPPORT]; D],
            moment: [[T::zero(); MAX_SUPPORT]; D],
        };
        let inverse_inertia = T::of(K::INVERSE_INERTIA) * per_spacing * per_spacing;
        for axis in 0..D {
            let scaled = x[axis] * per_spacing;
            let (first, weight, slope) = K::weights(scaled);
            s.first[axis] = first;
            s.weight[axis] = weight;
            for k in 0..K::SUPPORT {
                if MOMENTS {
                    let arm = (T::of_index(first + k as i32) - scaled) * spacing;
                    s.moment[axis][k] = weight[k] * arm;
                }
                s.slope[axis][k] = if MOVING_LEAST_SQUARES {
                    inverse_inertia * s.moment[axis][k]
                } else {
                    slope[k] * per_spacing
                };
            }
        }
        s
    }

    /// The number of rows, `SUPPORT^(D-1)`.
    #[inline(always)]
    pub const fn rows<K: Kernel>() -> usize {
        if D == 3 { K::SUPPORT * K::SUPPORT } else { K::SUPPORT }
    }

    /// Row number `index`, in ascending order of the first axis, then the second.
    #[inline(always)]
    pub fn row<K: Kernel>(&self, index: usize) -> Row<T, D> {
        let mut offset = [0; D];
        if D == 3 {
            offset[0] = index / K::SUPPORT;
            offset[1] = index % K::SUPPORT;
        } else {
            offset[0] = index;
        }
        let mut weight = T::one();
        for k in 0..D - 1 {
            weight *= self.weight[k][offset[k]];
        }
        let mut gradient = Vector::<T, D>::repeat(weight);
        let mut moment = Vector::<T, D>::repeat(weight);
        for k in 0..D - 1 {
            let mut others = T::one();
            for l in 0..D - 1 {
                if l != k {
                    others *= self.weight[l][offset[l]];
                }
            }
            gradient[k] = others * self.slope[k][offset[k]];
            moment[k] = others * self.moment[k][offset[k]];
        }
        Row { offset, weight, gradient, moment }
    }

    /// Every node with its weight, in storage order: the plain definition, for what is not worth a row kernel.
    pub fn nodes<K: Kernel>(&self) -> impl Iterator<Item = ([i32; D], T)> + '_ {
        (0..K::SUPPORT.pow(D as u32)).map(|index| {
            let (mut rest, mut node, mut weight) = (index, self.first, T::one());
            for axis in (0..D).rev() {
                let k = rest % K::SUPPORT;
                rest /= K::SUPPORT;
                node[axis] += k as i32;
                weight *= self.weight[axis][k];
            }
            (node, weight)
        })
    }

    /// w, grad w and w (x_i - x_p) of the node at `offset` from the first.
    pub fn node(&self, offset: [usize; D]) -> (T, Vector<T, D>, Vector<T, D>) {
        let product = |replaced: usize, by: &[[T; MAX_SUPPORT]; D]| {
            (0..D).fold(T::one(), |w, k| {
                w * if k == replaced { by[k][offset[k]] } else { self.weight[k][offset[k]] }
            })
        };
        (
            product(D, &self.weight),
            Vector::from_fn(|k, _| product(k, &self.slope)),
            Vector::from_fn(|k, _| product(k, &self.moment)),
        )
    }
}
