//! Measures of a placement: spacing, spread of particles per cell and of the grid density, pair correlation,
//! spectrum.

mod grid_spread;
mod pair_correlation;
mod spacing;
mod spectrum;

pub use grid_spread::{MeasuringGrid, grid_density_spread, particles_per_cell_spread};
pub use pair_correlation::{PairCorrelation, pair_correlation};
pub use spacing::nearest_neighbour_spacing;
pub use spectrum::radial_spectrum;

use crate::error::SamplerError;

/// Mean and spread of a set of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Arithmetic mean, in the unit of the samples.
    pub mean: f64,
    /// Standard deviation over the mean (divisor: the number of samples).
    pub relative_spread: f64,
    /// Least sample.
    pub least: f64,
    /// Greatest sample.
    pub greatest: f64,
    /// Number of samples.
    pub samples: usize,
}

impl Spread {
    /// # Errors
    /// [`SamplerError::TooFewSamples`] if there is no sample.
    fn of(samples: &[f64], measure: &'static str, needed: &'static str) -> Result<Self, SamplerError> {
        if samples.is_empty() {
            return Err(SamplerError::TooFewSamples { measure, needed, found: 0 });
        }
        let number = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / number;
        let variance = samples.iter().map(|sample| (sample - mean) * (sample - mean)).sum::<f64>() / number;
        Ok(Self {
            mean,
            relative_spread: variance.sqrt() / mean,
            least: samples.iter().copied().fold(f64::INFINITY, f64::min),
            greatest: samples.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            samples: samples.len(),
        })
    }
}
