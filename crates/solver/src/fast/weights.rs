//! The kernels on lanes: on an axis but the last for several particles at once, on the last for the four nodes of one.

use super::simd::{Lanes, ROW_NODES, Row};
use crate::kernel::{Cubic, Kernel, Quadratic};
use crate::real::Real;

/// Where particles lie on an axis.
pub(super) struct Place<V> {
    /// One more than the first node of the stencil, a whole number.
    pub node: V,
    /// The distance beyond that node, in [0, 1) (cubic) or [-1/2, 1/2) (quadratic).
    pub beyond: V,
}

/// Weights and slopes d/dx of the nodes of an axis, in units of the spacing.
#[derive(Clone, Copy)]
pub(super) struct Spline<V> {
    pub weight: V,
    pub slope: V,
}

/// A kernel on lanes, see [`Kernel::weights`]; weights next to 0 keep their relative precision.
pub(crate) trait LaneKernel: Kernel {
    /// `x` in units of the spacing.
    fn place<T: Real, V: Lanes<T>>(x: V) -> Place<V>;
    /// Node by node.
    fn splines<T: Real, V: Lanes<T>>(beyond: V) -> [Spline<V>; ROW_NODES];
    /// The four nodes side by side; `beyond` in all places.
    fn row<T: Real, R: Row<T>>(beyond: R) -> Spline<R>;
}

impl LaneKernel for Cubic {
    #[inline(always)]
    fn place<T: Real, V: Lanes<T>>(x: V) -> Place<V> {
        let node = x.floor();
        Place { node, beyond: x - node }
    }

    /// With x the distance r to the second node or l = 1 - r to the third: x^3 / 6 at the outer nodes, x^3 / 2 - x^2 + 2/3 at the inner.
    #[inline(always)]
    fn splines<T: Real, V: Lanes<T>>(r: V) -> [Spline<V>; ROW_NODES] {
        let l = V::splat(T::one()) - r;
        let (rr, ll) = (r * r, l * l);
        let (sixth, half, two_thirds) =
            (V::splat(T::of(1.0 / 6.0)), V::splat(T::of(0.5)), V::splat(T::of(2.0 / 3.0)));
        let (three_halves, two) = (V::splat(T::of(1.5)), V::splat(T::of(2.0)));
        let one = V::splat(T::one());
        [
            Spline { weight: sixth * l * ll, slope: -(half * ll) },
            Spline {
                weight: rr.mul_add(half.mul_add(r, -one), two_thirds),
                slope: r * three_halves.mul_add(r, -two),
            },
            Spline {
                weight: ll.mul_add(half.mul_add(l, -one), two_thirds),
                slope: l * three_halves.neg_mul_add(l, two),
            },
            Spline { weight: sixth * r * rr, slope: half * rr },
        ]
    }

    #[inline(always)]
    fn row<T: Real, R: Row<T>>(r: R) -> Spline<R> {
        let x = r.mul_add(by_node([-1.0, 1.0, -1.0, 1.0]), by_node([1.0, 0.0, 1.0, 0.0]));
        let inner =
            by_node::<T, R>([1.0 / 6.0, 0.5, 0.5, 1.0 / 6.0]).mul_add(x, by_node([0.0, -1.0, -1.0, 0.0]));
        Spline {
            weight: (x * x).mul_add(inner, by_node([0.0, 2.0 / 3.0, 2.0 / 3.0, 0.0])),
            slope: x * x.mul_add(by_node([-0.5, 1.5, -1.5, 0.5]), by_node([0.0, -2.0, 2.0, 0.0])),
        }
    }
}

impl LaneKernel for Quadratic {
    #[inline(always)]
    fn place<T: Real, V: Lanes<T>>(x: V) -> Place<V> {
        let node = (x + V::splat(T::of(0.5))).floor();
        Place { node, beyond: x - node }
    }

    /// With x = 1/2 - q, q, 1/2 + q, where q is the distance beyond the node in the middle: x^2 / 2 at the outer nodes, 3/4 - x^2.
    #[inline(always)]
    fn splines<T: Real, V: Lanes<T>>(q: V) -> [Spline<V>; ROW_NODES] {
        let half = V::splat(T::of(0.5));
        let (below, above) = (half - q, half + q);
        let nothing = V::splat(T::zero());
        [
            Spline { weight: half * below * below, slope: -below },
            Spline { weight: q.neg_mul_add(q, V::splat(T::of(0.75))), slope: -(q + q) },
            Spline { weight: half * above * above, slope: above },
            Spline { weight: nothing, slope: nothing },
        ]
    }

    #[inline(always)]
    fn row<T: Real, R: Row<T>>(q: R) -> Spline<R> {
        let x = q.mul_add(by_node([-1.0, 1.0, 1.0, 0.0]), by_node([0.5, 0.0, 0.5, 0.0]));
        Spline {
            weight: (by_node::<T, R>([0.5, -1.0, 0.5, 0.0]) * x).mul_add(x, by_node([0.0, 0.75, 0.0, 0.0])),
            slope: x * by_node([-1.0, -2.0, 1.0, 0.0]),
        }
    }
}

#[inline(always)]
fn by_node<T: Real, R: Row<T>>([a, b, c, d]: [f64; ROW_NODES]) -> R {
    R::by_node([T::of(a), T::of(b), T::of(c), T::of(d)])
}

/// The distances of the nodes from the particle, side by side, in units of the spacing.
#[inline(always)]
pub(super) fn arms<T: Real, R: Row<T>>(beyond: R) -> R {
    beyond.mul_add(R::splat(-T::one()), by_node([-1.0, 0.0, 1.0, 2.0]))
}
