//! A Gaussian random field as a sum of random plane waves.

use std::f64::consts::PI;

use rand_chacha::ChaCha8Rng;
use snowlab_solver::geometry::Vector;

use crate::raster::Raster;
use crate::rng;

/// Waves in the sum. Chosen: the excess kurtosis of the field is -1.5/256, far below what a level cut can show.
const WAVES: usize = 256;

/// A random field of mean 0, variance 1 and covariance `exp(-r^2 / (2 l^2))`, defined everywhere:
/// `sqrt(2/n) sum_j cos(k_j . x + phase_j)` with wave vectors of independent normal components of standard deviation
/// `1/l` (the randomisation method: Shinozuka 1971; Kraichnan 1970). Asymptotically Gaussian in the number of waves.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneWaves<const D: usize> {
    waves: Vec<(Vector<f64, D>, f64)>,
}

impl<const D: usize> PlaneWaves<D> {
    /// Draws a field of `correlation_length` `l` [m], above 0.
    pub fn draw(correlation_length: f64, rng: &mut ChaCha8Rng) -> Self {
        let waves = (0..WAVES)
            .map(|_| (rng::normal_vector::<D>(rng) / correlation_length, 2.0 * PI * rng::uniform(rng)))
            .collect();
        Self { waves }
    }

    /// The value at `point` [m].
    pub fn value(&self, point: &Vector<f64, D>) -> f64 {
        let sum: f64 = self.waves.iter().map(|(wave, phase)| libm::cos(wave.dot(point) + phase)).sum();
        sum * (2.0 / WAVES as f64).sqrt()
    }

    /// The values at the centres of all cells of `raster`, measured from `origin` [m]. A plane wave is a product over
    /// the axes, so each costs two products a cell and no cosine.
    pub(crate) fn on_raster(&self, raster: &Raster<D>, origin: &Vector<f64, D>) -> Vec<f64> {
        let along: Vec<Vec<Vec<(f64, f64)>>> = (0..D)
            .map(|axis| {
                self.waves.iter().map(|(wave, _)| axis_factors(raster, origin, axis, wave[axis])).collect()
            })
            .collect();
        let (cosines, sines): (Vec<Vec<f64>>, Vec<Vec<f64>>) =
            along[0].iter().map(|factors| factors.iter().copied().unzip()).unzip();
        let amplitude = (2.0 / WAVES as f64).sqrt();
        let mut values = vec![0.0; raster.len()];
        for (row, line) in values.chunks_exact_mut(raster.shape[0]).enumerate() {
            for (number, (_, phase)) in self.waves.iter().enumerate() {
                let mut factor = (amplitude * libm::cos(*phase), amplitude * libm::sin(*phase));
                let mut rest = row;
                for axis in 1..D {
                    let (cosine, sine) = along[axis][number][rest % raster.shape[axis]];
                    rest /= raster.shape[axis];
                    factor = (factor.0 * cosine - factor.1 * sine, factor.0 * sine + factor.1 * cosine);
                }
                for (value, (cosine, sine)) in line.iter_mut().zip(cosines[number].iter().zip(&sines[number]))
                {
                    *value += factor.0 * cosine - factor.1 * sine;
                }
            }
        }
        values
    }
}

/// Cosine and sine of `wave_number * (x - origin)` at the cells along `axis`.
fn axis_factors<const D: usize>(
    raster: &Raster<D>,
    origin: &Vector<f64, D>,
    axis: usize,
    wave_number: f64,
) -> Vec<(f64, f64)> {
    (0..raster.shape[axis])
        .map(|step| {
            let angle = wave_number * (raster.first[axis] + step as f64 * raster.cell - origin[axis]);
            (libm::cos(angle), libm::sin(angle))
        })
        .collect()
}
