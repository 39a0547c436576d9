//! Particles that are not alike: factors on their weights or stiffness.

use snowlab_solver::geometry::Vector;

use crate::error::SamplerError;
use crate::gaussian_field::PlaneWaves;
use crate::region::Region;
use crate::rng::{self, Purpose, Streams};

/// How factors vary over the particles of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heterogeneity {
    /// Each particle for itself: Gamma of mean 1, the law of the areas that independent points would have to themselves.
    Independent {
        /// Standard deviation over the mean.
        spread: f64,
    },
    /// Neighbours alike: log-normal of mean 1, from a Gaussian random field.
    Correlated {
        /// Standard deviation over the mean.
        spread: f64,
        /// Correlation length of the Gaussian field [m].
        correlation_length: f64,
    },
    /// A shell that differs from the inside (S13, section 5: snowballs harder outside), where the factor is 1.
    Shell {
        /// Factor in the shell.
        factor: f64,
        /// Thickness of the shell [m].
        thickness: f64,
    },
}

impl Heterogeneity {
    /// A factor for each of `positions` [m] in `region`. Those of noise have a mean of exactly 1, to round-off, so that
    /// nothing but their spread is added; independent factors of fewer particles are the first of more, but for that.
    ///
    /// # Errors
    /// [`SamplerError::OutOfRange`]: a spread outside 0 to 3, a length or factor that is not positive.
    pub fn factors<const D: usize>(
        &self,
        region: &Region<D>,
        positions: &[Vector<f64, D>],
        streams: &Streams,
    ) -> Result<Vec<f64>, SamplerError> {
        self.validate()?;
        let mut stream = streams.stream(Purpose::Noise);
        Ok(match *self {
            Self::Independent { spread } => {
                of_mean_one(positions.iter().map(|_| rng::unit_mean_gamma(&mut stream, spread)).collect())
            }
            Self::Correlated { spread, correlation_length } => {
                let field = PlaneWaves::<D>::draw(correlation_length, &mut stream);
                // A log-normal of this sigma has the standard deviation `spread` over its mean.
                let sigma = libm::log1p(spread * spread).sqrt();
                of_mean_one(positions.iter().map(|x| libm::exp(sigma * field.value(x))).collect())
            }
            Self::Shell { factor, thickness } => {
                positions.iter().map(|x| if region.depth(x) < thickness { factor } else { 1.0 }).collect()
            }
        })
    }

    fn validate(&self) -> Result<(), SamplerError> {
        let refused = |name, value: f64, allowed| Err(SamplerError::OutOfRange { name, value, allowed });
        let positive = |name, value: f64| {
            if value > 0.0 && value.is_finite() { Ok(()) } else { refused(name, value, "above 0") }
        };
        // Chosen: beyond 3 one particle in twenty carries half of the body.
        let spread_within = |spread: f64| {
            if (0.0..=3.0).contains(&spread) {
                Ok(())
            } else {
                refused("spread of the heterogeneity", spread, "0 to 3")
            }
        };
        match *self {
            Self::Independent { spread } => spread_within(spread),
            Self::Correlated { spread, correlation_length } => {
                spread_within(spread)?;
                positive("correlation length of the heterogeneity [m]", correlation_length)
            }
            Self::Shell { factor, thickness } => {
                positive("factor of the shell", factor)?;
                positive("thickness of the shell [m]", thickness)
            }
        }
    }
}

/// The factors over their mean.
fn of_mean_one(factors: Vec<f64>) -> Vec<f64> {
    let mean = factors.iter().sum::<f64>() / factors.len().max(1) as f64;
    factors.into_iter().map(|factor| factor / mean).collect()
}
