//! How many blocks a confirmatory study needs, from a pilot that ran its contrast: to be fixed before that study runs.

use serde::Serialize;

use super::distributions::chi_square_quantile;
use super::standard_deviation;

/// Normal quantile at 0.995: two-sided 1 - 0.05/5, the family of five claims.
const Z_FAMILY: f64 = 2.576;
/// Normal quantile at 0.80: the power of 80 % the plan asks for.
const Z_POWER: f64 = 0.842;
/// The ratio of N_eff the plan is to detect. Chosen: a change a reader of the pictures would see.
const TARGET_RATIO: f64 = 1.5;
/// Blocks added for the t quantile's excess over the normal one (chosen: two, the study's formula).
const ALLOWANCE: usize = 2;
/// Fewest and most blocks of a confirmatory run (chosen in the study: the cost of a night's run).
const BLOCKS: std::ops::RangeInclusive<usize> = 24..=48;
/// Confidence of the upper limit of the pilot's standard deviation.
const PILOT_CONFIDENCE: f64 = 0.80;

/// Upper `confidence` limit of a normal sample's standard deviation: s sqrt((n-1)/chi2_{1-confidence, n-1})
/// (Hahn & Meeker 1991, Statistical Intervals, sec. 4.4). `None` for fewer than two values.
pub fn standard_deviation_upper_limit(values: &[f64], confidence: f64) -> Option<f64> {
    let spread = standard_deviation(values)?;
    let freedom = (values.len() - 1) as f64;
    Some(spread * (freedom / chi_square_quantile(1.0 - confidence, freedom)).sqrt())
}

/// How many blocks the confirmatory run gets, fixed before it starts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReplicatePlan {
    /// Standard deviation of the pilot's paired differences.
    pub pilot_deviation: f64,
    /// Its upper 80 % limit, s_u.
    pub deviation_limit: f64,
    /// Blocks by the formula, before the clamp.
    pub wanted: usize,
    /// Blocks to run: `wanted` held within 24 to 48.
    pub blocks: usize,
    /// The ratio of N_eff that `blocks` blocks detect with 80 % power: exp((2.576 + 0.842) s_u/sqrt(n - 2)).
    pub detectable_ratio: f64,
}

/// Number of blocks n = ceil((2.576 + 0.842)^2 s_u^2/(ln 1.5)^2) + 2 from the paired differences of a pilot, at
/// least 24 and at most 48: the normal-theory sample size of a paired comparison (Cohen 1988, Statistical
/// Power Analysis, sec. 2.4). `None` for fewer than two differences.
pub fn replicate_plan(pilot_differences: &[f64]) -> Option<ReplicatePlan> {
    let deviation_limit = standard_deviation_upper_limit(pilot_differences, PILOT_CONFIDENCE)?;
    let reach = (Z_FAMILY + Z_POWER) * deviation_limit;
    let wanted = (reach / libm::log(TARGET_RATIO)).powi(2).ceil() as usize + ALLOWANCE;
    let blocks = wanted.clamp(*BLOCKS.start(), *BLOCKS.end());
    Some(ReplicatePlan {
        pilot_deviation: standard_deviation(pilot_differences)?,
        deviation_limit,
        wanted,
        blocks,
        detectable_ratio: libm::exp(reach / ((blocks - ALLOWANCE) as f64).sqrt()),
    })
}
