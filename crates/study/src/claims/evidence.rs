use serde::Serialize;

use super::claim::Contrast;
use super::limits::ERROR_RATE;
use crate::statistics::{
    Bootstrap, Interval, cliffs_delta, mean, range_of_means, range_permutation_p, sign_flip_p,
    standard_deviation, t_interval, t_upper_bound,
};

/// Seed and sizes of the resampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Resampling {
    /// Seed of the ChaCha8 streams.
    pub seed: u64,
    /// Bootstrap resamples.
    pub resamples: usize,
    /// Sign patterns drawn where they are not enumerated.
    pub sign_flips: usize,
    /// Permutations of the arms within blocks.
    pub permutations: usize,
}

impl Resampling {
    /// The study's sizes: 10,000 resamples and permutations, 100,000 sign patterns.
    pub const fn standard(seed: u64) -> Self {
        Self { seed, resamples: 10_000, sign_flips: 100_000, permutations: 10_000 }
    }
}

/// The numbers a verdict rests on, from the complete blocks. All effects are on A = ln N_eff. `None` where too
/// few blocks leave a number undefined, and where a range of means has no studentised counterpart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evidence {
    /// Number n of complete blocks.
    pub blocks: usize,
    /// Mean of d; for a range, the range of the arm means.
    pub effect: Option<f64>,
    /// Standard deviation of d over blocks.
    pub standard_deviation: Option<f64>,
    /// Confidence 1 - 0.05/m of the two intervals.
    pub confidence: f64,
    /// I: studentised interval of the mean of d.
    pub interval_t: Option<Interval>,
    /// I: BCa interval over blocks.
    pub interval_bca: Option<Interval>,
    /// U: one-sided 95 % upper bound, studentised.
    pub upper_t: Option<f64>,
    /// U: one-sided 95 % upper bound, BCa.
    pub upper_bca: Option<f64>,
    /// p value: sign flips within blocks; for a range, permutation of the arms within blocks.
    pub p_value: Option<f64>,
    /// That p value adjusted by Holm over the family, once the family is known.
    pub p_holm: Option<f64>,
    /// Cliff's delta of the extreme arms: the largest against the smallest weight or, for a range, mean.
    pub cliffs_delta: Option<f64>,
}

impl Evidence {
    /// Measures `contrast` on `rows` (one row per block, one value per arm) in a family of `family_size` claims.
    pub(super) fn measure(
        contrast: &Contrast,
        rows: &[Vec<f64>],
        family_size: usize,
        resampling: Resampling,
    ) -> Self {
        let confidence = 1.0 - ERROR_RATE / family_size as f64;
        let mut evidence = match contrast.weights() {
            Some(weights) => of_differences(&differences(&weights, rows), confidence, resampling),
            None => of_range(rows, confidence, resampling),
        };
        evidence.cliffs_delta = extreme_arms(&leaning(contrast, rows))
            .and_then(|(high, low)| cliffs_delta(&column(rows, high), &column(rows, low)));
        evidence
    }
}

/// d_b = sum over arms of weight x A, one per block.
pub(super) fn differences(weights: &[f64], rows: &[Vec<f64>]) -> Vec<f64> {
    rows.iter().map(|row| weights.iter().zip(row).map(|(weight, value)| weight * value).sum()).collect()
}

/// Which way each arm pulls the effect: the weight of a linear contrast; for a range, the arm's mean less the
/// mean of all arms. Empty for a range without blocks.
pub(super) fn leaning(contrast: &Contrast, rows: &[Vec<f64>]) -> Vec<f64> {
    contrast.weights().unwrap_or_else(|| {
        let arms = rows.first().map_or(0, Vec::len);
        let means: Vec<f64> = (0..arms).filter_map(|arm| mean(&column(rows, arm))).collect();
        let centre = mean(&means).unwrap_or_default();
        means.iter().map(|value| value - centre).collect()
    })
}

/// Indices of the arms of largest and smallest leaning, the first of equals; `None` without arms.
pub(super) fn extreme_arms(leaning: &[f64]) -> Option<(usize, usize)> {
    let indices = || 0..leaning.len();
    let low = indices().min_by(|&a, &b| leaning[a].total_cmp(&leaning[b]))?;
    let high = indices().min_by(|&a, &b| leaning[b].total_cmp(&leaning[a]))?;
    Some((high, low))
}

fn column(rows: &[Vec<f64>], arm: usize) -> Vec<f64> {
    rows.iter().map(|row| row[arm]).collect()
}

fn of_differences(differences: &[f64], confidence: f64, resampling: Resampling) -> Evidence {
    let bootstrap = Bootstrap::of_mean(differences, resampling.resamples, resampling.seed);
    Evidence {
        blocks: differences.len(),
        effect: mean(differences),
        standard_deviation: standard_deviation(differences),
        confidence,
        interval_t: t_interval(differences, confidence),
        interval_bca: bootstrap.as_ref().map(|b| b.interval(confidence)),
        upper_t: t_upper_bound(differences, 1.0 - ERROR_RATE),
        upper_bca: bootstrap.as_ref().map(|b| b.upper_bound(1.0 - ERROR_RATE)),
        p_value: sign_flip_p(differences, resampling.sign_flips, resampling.seed),
        p_holm: None,
        cliffs_delta: None,
    }
}

fn of_range(rows: &[Vec<f64>], confidence: f64, resampling: Resampling) -> Evidence {
    let range_of = |blocks: &[usize]| {
        let chosen: Vec<&[f64]> = blocks.iter().map(|&block| rows[block].as_slice()).collect();
        range_of_means(&chosen).unwrap_or_default()
    };
    let bootstrap = Bootstrap::over_blocks(rows.len(), resampling.resamples, resampling.seed, range_of);
    Evidence {
        blocks: rows.len(),
        effect: range_of_means(rows),
        standard_deviation: None,
        confidence,
        interval_t: None,
        interval_bca: bootstrap.as_ref().map(|b| b.interval(confidence)),
        upper_t: None,
        upper_bca: bootstrap.as_ref().map(|b| b.upper_bound(1.0 - ERROR_RATE)),
        p_value: range_permutation_p(rows, resampling.permutations, resampling.seed),
        p_holm: None,
        cliffs_delta: None,
    }
}
