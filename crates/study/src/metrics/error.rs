//! What the metrics refuse, and the checks that refuse it.

use snowlab_solver::geometry::Vector;

/// Lengths the metrics accept, and the greatest size of a coordinate [m]. Chosen: their squares neither
/// vanish nor overflow in f64.
pub const LENGTH_RANGE: [f64; 2] = [1e-100, 1e100];

/// The most particles one analysis takes. Chosen: cell numbers then fit 32 bits whatever the positions are
/// (at most 12 new cell numbers per particle and axis, see [`super::cell_list`]).
pub const MAX_PARTICLES: usize = 1 << 27;

/// A measurement that cannot be made of the input given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricError {
    /// A coordinate is NaN, infinite or beyond 1e100 m.
    #[error(
        "metrics: position of particle {index} on axis {axis} is {}; it must be finite and at most \
         1e100 m from 0: measure a frame from before the case diverged",
        number(*value)
    )]
    Position {
        /// The particle, as an index into the positions.
        index: usize,
        /// The axis, from 0.
        axis: usize,
        /// The coordinate [m].
        value: f64,
    },
    /// A mass is zero, negative, NaN or infinite.
    #[error("metrics: mass of particle {index} is {} kg; it must be finite and above 0", number(*value))]
    Mass {
        /// The particle, as an index into the masses.
        index: usize,
        /// The mass [kg].
        value: f64,
    },
    /// A value per particle or fragment is NaN or infinite.
    #[error("metrics: {quantity} number {index} is {}; it must be finite", number(*value))]
    Value {
        /// What it is.
        quantity: &'static str,
        /// Its place in the input.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Two arrays that run over the same particles differ in length.
    #[error(
        "metrics: {expected} particles but {actual} {quantity}; give one per particle, in the same order"
    )]
    Length {
        /// The array that does not fit.
        quantity: &'static str,
        /// The number of particles.
        expected: usize,
        /// The length given.
        actual: usize,
    },
    /// A parameter lies outside what is allowed.
    #[error(
        "metrics: {parameter} is {}; allowed is {} to {}",
        number(*value), number(*least), number(*greatest)
    )]
    Parameter {
        /// Its name and unit.
        parameter: &'static str,
        /// The value given.
        value: f64,
        /// The least value allowed.
        least: f64,
        /// The greatest value allowed.
        greatest: f64,
    },
    /// More particles than [`MAX_PARTICLES`].
    #[error("metrics: {count} particles; at most {greatest} are taken: measure a subset")]
    TooMany {
        /// The number given.
        count: usize,
        /// The number allowed.
        greatest: usize,
    },
}

/// A number in few characters: very large and very small ones as powers of ten.
fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-6..1e9).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// Refuses positions [m] that are not finite or beyond the greatest of [`LENGTH_RANGE`], naming the first
/// particle and axis, and more of them than [`MAX_PARTICLES`].
pub fn check_positions<const D: usize>(positions: &[Vector<f64, D>]) -> Result<(), MetricError> {
    if positions.len() > MAX_PARTICLES {
        return Err(MetricError::TooMany { count: positions.len(), greatest: MAX_PARTICLES });
    }
    for (index, position) in positions.iter().enumerate() {
        for (axis, &value) in position.iter().enumerate() {
            if value.is_nan() || value.abs() > LENGTH_RANGE[1] {
                return Err(MetricError::Position { index, axis, value });
            }
        }
    }
    Ok(())
}

/// Refuses masses [kg] that are not finite and positive, and a number of them other than `particles`.
pub fn check_masses(particles: usize, masses: &[f64]) -> Result<(), MetricError> {
    check_length("masses", particles, masses.len())?;
    match masses.iter().position(|&mass| !(mass.is_finite() && mass > 0.0)) {
        Some(index) => Err(MetricError::Mass { index, value: masses[index] }),
        None => Ok(()),
    }
}

/// Refuses an array that does not run over all the particles.
pub fn check_length(quantity: &'static str, expected: usize, actual: usize) -> Result<(), MetricError> {
    if expected == actual { Ok(()) } else { Err(MetricError::Length { quantity, expected, actual }) }
}

/// Refuses a parameter that is NaN or outside `[least, greatest]`.
pub fn check_parameter(
    parameter: &'static str,
    value: f64,
    [least, greatest]: [f64; 2],
) -> Result<(), MetricError> {
    if value >= least && value <= greatest {
        Ok(())
    } else {
        Err(MetricError::Parameter { parameter, value, least, greatest })
    }
}
