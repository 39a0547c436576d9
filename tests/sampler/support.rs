//! The regions that most tests place points in.

use snowlab_sampler::Region;
use snowlab_solver::geometry::Vector;

/// A disc or ball with its centre at `x` [m] on the first axis.
pub fn ball<const D: usize>(x: f64, radius: f64) -> Region<D> {
    let mut centre = Vector::<f64, D>::zeros();
    centre[0] = x;
    Region::Ball { centre, radius }
}

/// The study's ball of 0.25 m, round the origin.
pub fn snowball<const D: usize>() -> Region<D> {
    ball(0.0, 0.25)
}
