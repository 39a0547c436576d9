//! B-spline kernels in one dimension (S13 section 4 for the cubic; Steffen, Kirby & Berzins 2008 for both).
//!
//! With q = (x_p - x_i) / h:
//!
//! ```text
//! cubic       N = |q|^3/2 - q^2 + 2/3    |q| < 1        quadratic   N = 3/4 - q^2          |q| < 1/2
//!                 (2 - |q|)^3 / 6         1 <= |q| < 2                   (3/2 - |q|)^2 / 2  1/2 <= |q| < 3/2
//! ```

use crate::real::Real;

/// The most nodes a kernel reaches on one axis.
pub const MAX_SUPPORT: usize = 4;

/// Which kernel a scene uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KernelKind {
    /// Four nodes on each axis; S13's choice.
    Cubic,
    /// Three nodes on each axis.
    Quadratic,
}

impl KernelKind {
    /// D^-1 h^2 of the kernel, see [`Kernel::INVERSE_INERTIA`].
    pub fn inverse_inertia(self) -> f64 {
        match self {
            KernelKind::Cubic => Cubic::INVERSE_INERTIA,
            KernelKind::Quadratic => Quadratic::INVERSE_INERTIA,
        }
    }

    /// The bound on the grid's frequency, see [`Kernel::GRADIENT_BOUND`].
    pub fn gradient_bound(self) -> f64 {
        match self {
            KernelKind::Cubic => Cubic::GRADIENT_BOUND,
            KernelKind::Quadratic => Quadratic::GRADIENT_BOUND,
        }
    }
}

/// A kernel as a type, so that loops over its nodes have a length known to the compiler.
pub trait Kernel: Copy + Default + Send + Sync + 'static {
    /// Nodes reached on each axis.
    const SUPPORT: usize;
    /// D^-1 h^2, where D = sum_i w_ip (x_i - x_p)(x_i - x_p)^T (Jiang et al. 2015, section 5.2).
    const INVERSE_INERTIA: f64;
    /// The largest sum_i N'(q_i)^2 / N(q_i) over all positions of a particle between nodes; it bounds the frequency
    /// of the grid (docs/stability.md).
    const GRADIENT_BOUND: f64;

    /// The first of the `SUPPORT` nodes reached from `x` (in units of h), with the weights and their derivatives
    /// with respect to x / h. Entries past `SUPPORT` are zero.
    fn weights<T: Real>(x: T) -> (i32, [T; MAX_SUPPORT], [T; MAX_SUPPORT]);

    /// The first of the nodes reached from `x` (in units of h).
    fn first_node<T: Real>(x: T) -> i32;
}

/// The cubic B-spline.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cubic;

/// The quadratic B-spline.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quadratic;

impl Kernel for Cubic {
    const SUPPORT: usize = 4;
    const INVERSE_INERTIA: f64 = 3.0;
    const GRADIENT_BOUND: f64 = 3.137;

    #[inline(always)]
    fn weights<T: Real>(x: T) -> (i32, [T; MAX_SUPPORT], [T; MAX_SUPPORT]) {
        let cell = x.floor_index();
        let r = x - T::of_index(cell);
        let l = T::one() - r;
        let (half, sixth, two_thirds, three_halves, two) =
            (T::of(0.5), T::of(1.0 / 6.0), T::of(2.0 / 3.0), T::of(1.5), T::of(2.0));
        let (rr, ll) = (r * r, l * l);
        // Distances to the four nodes: 1 + r, r, 1 - r, 2 - r.
        let weights = [
            sixth * ll * l,
            half * rr * r - rr + two_thirds,
            half * ll * l - ll + two_thirds,
            sixth * rr * r,
        ];
        let slopes = [-half * ll, three_halves * rr - two * r, two * l - three_halves * ll, half * rr];
        (cell - 1, weights, slopes)
    }

    #[inline(always)]
    fn first_node<T: Real>(x: T) -> i32 {
        x.floor_index() - 1
    }
}

impl Kernel for Quadratic {
    const SUPPORT: usize = 3;
    const INVERSE_INERTIA: f64 = 4.0;
    const GRADIENT_BOUND: f64 = 6.0;

    #[inline(always)]
    fn weights<T: Real>(x: T) -> (i32, [T; MAX_SUPPORT], [T; MAX_SUPPORT]) {
        let half = T::of(0.5);
        let nearest = (x + half).floor_index();
        let q = x - T::of_index(nearest);
        let (below, above) = (half - q, half + q);
        let weights = [half * below * below, T::of(0.75) - q * q, half * above * above, T::zero()];
        let slopes = [-below, -(q + q), above, T::zero()];
        (nearest - 1, weights, slopes)
    }

    #[inline(always)]
    fn first_node<T: Real>(x: T) -> i32 {
        (x + T::of(0.5)).floor_index() - 1
    }
}
