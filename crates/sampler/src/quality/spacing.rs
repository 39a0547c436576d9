//! Distances to nearest neighbours.

use snowlab_solver::geometry::Vector;

use super::Spread;
use crate::error::SamplerError;
use crate::neighbours::Neighbours;

/// Doublings of the search radius. Chosen: from a millionth of the extent of the points to beyond it.
const DOUBLINGS: usize = 64;

/// Distance [m] from every point to its nearest other point. For random points of number density `n` in the plane the
/// mean is `1 / (2 sqrt(n))`, in space `0.55396 n^(-1/3)` (Chandrasekhar 1943, appendix VII).
///
/// # Errors
/// [`SamplerError::TooFewSamples`] for fewer than two points.
pub fn nearest_neighbour_spacing<const D: usize>(
    positions: &[Vector<f64, D>],
) -> Result<Spread, SamplerError> {
    if positions.len() < 2 {
        return Err(SamplerError::TooFewSamples {
            measure: "nearest-neighbour spacing",
            needed: "two points",
            found: positions.len(),
        });
    }
    let extent = positions.iter().map(|point| (point - positions[0]).norm()).fold(0.0, f64::max);
    let per_axis = libm::pow(positions.len() as f64, 1.0 / D as f64);
    let mut radius = 2.0 * (extent / per_axis).max(f64::MIN_POSITIVE);
    let mut squared = vec![f64::INFINITY; positions.len()];
    let mut open: Vec<usize> = (0..positions.len()).collect();
    for _ in 0..DOUBLINGS {
        let neighbours = Neighbours::new(positions, radius);
        for &point in &open {
            neighbours.for_each(point, |_, distance| squared[point] = squared[point].min(distance));
        }
        // Only distances within the radius are sure to be the least.
        open.retain(|&point| squared[point] > radius * radius);
        if open.is_empty() {
            break;
        }
        radius *= 2.0;
    }
    let distances: Vec<f64> = squared.into_iter().map(f64::sqrt).collect();
    Spread::of(&distances, "nearest-neighbour spacing", "two points")
}
