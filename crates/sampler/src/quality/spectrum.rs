//! The radial spectrum of a weighted set of points.

use snowlab_solver::geometry::Vector;

use super::grid_spread::check_weights;
use crate::directions::even_directions;
use crate::error::{SamplerError, require};

/// Directions that are averaged over, none of them opposite to another, since `S(-k) = S(k)`. Chosen: the scatter of a
/// value is then about a quarter in 2D and a sixth in 3D.
const fn directions(dimension: usize) -> usize {
    if dimension == 2 { 15 } else { 32 }
}

/// `S(k) = |sum_p w_p exp(i k . x_p)|^2 / sum_p w_p^2` at every wave number [rad/m], averaged over evenly spread
/// directions: 1 for independent points and weights, near 0 where a set is even (Illian et al. 2008, chapter 4).
/// Wave lengths should be well below the size of the region, whose own shape shows at smaller wave numbers.
///
/// # Errors
/// [`SamplerError::TooFewSamples`] without points, [`SamplerError::OutOfRange`] for a wave number that is not finite,
/// [`SamplerError::CountOutOfRange`] if the weights are not as many as positions.
pub fn radial_spectrum<const D: usize>(
    positions: &[Vector<f64, D>],
    weights: Option<&[f64]>,
    wave_numbers: &[f64],
) -> Result<Vec<f64>, SamplerError> {
    check_weights(positions, weights)?;
    if positions.is_empty() {
        return Err(SamplerError::TooFewSamples { measure: "spectrum", needed: "a point", found: 0 });
    }
    let weight = |point: usize| weights.map_or(1.0, |weights| weights[point]);
    let power: f64 = (0..positions.len()).map(|point| weight(point) * weight(point)).sum();
    let directions = even_directions::<D>(directions(D));
    wave_numbers
        .iter()
        .map(|&wave_number| {
            require(wave_number.abs() <= 1e9, "wave number [rad/m]", wave_number, "-1e9 to 1e9")?;
            let sum: f64 = directions
                .iter()
                .map(|direction| {
                    let (mut real, mut imaginary) = (0.0, 0.0);
                    for (point, position) in positions.iter().enumerate() {
                        let phase = wave_number * direction.dot(position);
                        real += weight(point) * libm::cos(phase);
                        imaginary += weight(point) * libm::sin(phase);
                    }
                    real * real + imaginary * imaginary
                })
                .sum();
            Ok(sum / (directions.len() as f64 * power))
        })
        .collect()
}
