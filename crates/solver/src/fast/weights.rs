//! The kernels with the nodes of an axis as lanes.

use super::lanes::Lanes;
use crate::kernel::{Cubic, Kernel, Quadratic};
use crate::real::Real;

/// A kernel on lanes.
pub(super) trait LaneKernel: Kernel {
    /// [`Kernel::weights`]: the first node, and weights and slopes of four nodes. They differ from the definition's by round-off.
    fn weight_lanes<T: Real, V: Lanes<T>>(x: T) -> (i32, V, V);
}

#[inline(always)]
fn constants<T: Real, V: Lanes<T>>([a, b, c, d]: [f64; 4]) -> V {
    V::load(&[T::of(a), T::of(b), T::of(c), T::of(d)])
}

impl LaneKernel for Cubic {
    /// With x = l, r, l, r, where r is the distance to the second node and l = 1 - r that to the third: x^3 / 6 at the outer nodes,
    /// x^3 / 2 - x^2 + 2/3 at the inner ones.
    #[inline(always)]
    fn weight_lanes<T: Real, V: Lanes<T>>(x: T) -> (i32, V, V) {
        const SIXTH: f64 = 1.0 / 6.0;
        let cell = x.floor_index();
        let r = x - T::of_index(cell);
        let l = T::one() - r;
        let x = V::of([l, r, l, r]);
        let xx = x.times(x);
        let cubes = constants::<T, V>([SIXTH, 0.5, 0.5, SIXTH]).times(xx).times(x);
        let squares = constants::<T, V>([0.0, -1.0, -1.0, 0.0]).times(xx);
        let weights = cubes.plus(squares).plus(constants([0.0, 2.0 / 3.0, 2.0 / 3.0, 0.0]));
        let slopes = constants::<T, V>([-0.5, 1.5, -1.5, 0.5])
            .times(xx)
            .plus(constants::<T, V>([0.0, -2.0, 2.0, 0.0]).times(x));
        (cell - 1, weights, slopes)
    }
}

impl LaneKernel for Quadratic {
    /// With x = 1/2 - q, q, 1/2 + q, where q is the offset from the node in the middle: x^2 / 2 at the outer nodes, 3/4 - x^2 in the middle.
    #[inline(always)]
    fn weight_lanes<T: Real, V: Lanes<T>>(x: T) -> (i32, V, V) {
        let half = T::of(0.5);
        let nearest = (x + half).floor_index();
        let q = x - T::of_index(nearest);
        let x = V::of([half - q, q, half + q, T::zero()]);
        let squares = constants::<T, V>([0.5, -1.0, 0.5, 0.0]).times(x).times(x);
        let weights = squares.plus(constants([0.0, 0.75, 0.0, 0.0]));
        (nearest - 1, weights, constants::<T, V>([-1.0, -2.0, 1.0, 0.0]).times(x))
    }
}
