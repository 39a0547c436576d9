use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::Interval;
use super::descriptive::{between_order_statistics, mean};
use super::distributions::{normal_cdf, normal_quantile};

/// Relative difference below which two resampled values count as tied (round-off of the same value).
const TIE: f64 = 1e-12;

/// The bias-corrected, accelerated (BCa) bootstrap of a statistic over blocks (Efron 1987, JASA 82, 171;
/// Efron & Tibshirani 1993, An Introduction to the Bootstrap, eqs. 14.9-14.15). Blocks are resampled whole, so
/// that whatever is paired within a block stays paired.
#[derive(Clone, Debug)]
pub struct Bootstrap {
    estimate: f64,
    bias_correction: f64,
    acceleration: f64,
    sorted: Vec<f64>,
}

impl Bootstrap {
    /// Draws `resamples` resamples of `blocks` blocks from ChaCha8 seeded by `seed`. The `statistic` maps a list
    /// of block indices (each below `blocks`, repeats allowed) to a finite value. `None` for fewer than two
    /// blocks or no resamples.
    pub fn over_blocks(
        blocks: usize,
        resamples: usize,
        seed: u64,
        statistic: impl Fn(&[usize]) -> f64,
    ) -> Option<Self> {
        if blocks < 2 || resamples == 0 {
            return None;
        }
        let all: Vec<usize> = (0..blocks).collect();
        let estimate = statistic(&all);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut chosen = all.clone();
        let mut sorted: Vec<f64> = (0..resamples)
            .map(|_| {
                chosen.fill_with(|| rng.random_range(0..blocks as u32) as usize);
                statistic(&chosen)
            })
            .collect();
        sorted.sort_by(f64::total_cmp);
        Some(Self {
            estimate,
            bias_correction: bias_correction(estimate, &sorted),
            acceleration: jackknife_acceleration(&all, statistic),
            sorted,
        })
    }

    /// The bootstrap of the mean of one value per block.
    pub fn of_mean(values: &[f64], resamples: usize, seed: u64) -> Option<Self> {
        Self::over_blocks(values.len(), resamples, seed, |blocks| {
            blocks.iter().map(|&block| values[block]).sum::<f64>() / blocks.len() as f64
        })
    }

    /// The statistic of the blocks as they are.
    pub fn estimate(&self) -> f64 {
        self.estimate
    }

    /// Two-sided BCa interval at `confidence` in (0, 1). Where all resamples agree it is that one value.
    pub fn interval(&self, confidence: f64) -> Interval {
        let tail = 0.5 - 0.5 * confidence;
        Interval { lower: self.limit(tail), upper: self.limit(1.0 - tail) }
    }

    /// One-sided lower BCa bound at `confidence` in (0, 1).
    pub fn lower_bound(&self, confidence: f64) -> f64 {
        self.limit(1.0 - confidence)
    }

    /// One-sided upper BCa bound at `confidence` in (0, 1).
    pub fn upper_bound(&self, confidence: f64) -> f64 {
        self.limit(confidence)
    }

    /// The BCa limit of nominal level `level`: the quantile of the resampled values at
    /// Phi(z0 + (z0 + z)/(1 - a (z0 + z))), eq. 14.10, read at plotting position k/(B + 1).
    fn limit(&self, level: f64) -> f64 {
        let shifted = self.bias_correction + normal_quantile(level);
        let stretch = 1.0 - self.acceleration * shifted;
        let corrected = if stretch > 0.0 {
            normal_cdf(self.bias_correction + shifted / stretch)
        } else {
            // Beyond the pole of the transformation the limit is the extreme of the resampled values.
            f64::from(shifted > 0.0)
        };
        between_order_statistics(&self.sorted, corrected * (self.sorted.len() + 1) as f64 - 1.0)
    }
}

/// z0, eq. 14.14: the normal quantile of the share of resampled values below the estimate, ties counted half.
/// A share of 0 or 1 is moved in by half a resample, so that z0 stays finite.
fn bias_correction(estimate: f64, sorted: &[f64]) -> f64 {
    let tolerance = TIE * estimate.abs();
    let below = sorted.partition_point(|&value| value < estimate - tolerance);
    let not_above = sorted.partition_point(|&value| value <= estimate + tolerance);
    let count = sorted.len() as f64;
    let share = 0.5 * (below + not_above) as f64 / count;
    normal_quantile(share.clamp(0.5 / count, 1.0 - 0.5 / count))
}

/// The acceleration a, eq. 14.15, from the statistic with one block left out at a time; 0 where leaving a block
/// out changes nothing.
fn jackknife_acceleration(all: &[usize], statistic: impl Fn(&[usize]) -> f64) -> f64 {
    let left_out: Vec<f64> = all
        .iter()
        .map(|&out| {
            let kept: Vec<usize> = all.iter().copied().filter(|&block| block != out).collect();
            statistic(&kept)
        })
        .collect();
    let centre = mean(&left_out).unwrap_or_default();
    let deviations = || left_out.iter().map(|value| centre - value);
    let squares: f64 = deviations().map(|d| d * d).sum();
    let cubes: f64 = deviations().map(|d| d * d * d).sum();
    if squares > 0.0 { cubes / (6.0 * squares * squares.sqrt()) } else { 0.0 }
}
