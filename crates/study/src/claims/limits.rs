//! The numbers of the rule, each chosen in the study's plan before the runs.

/// Fewest complete blocks for a verdict.
pub const MINIMUM_BLOCKS: usize = 12;
/// Largest share of blocks that may be lost.
pub const LOST_SHARE: f64 = 0.10;
/// Largest share of a case's particles that may be clamped before the case counts as lost.
pub const CLAMP_SHARE: f64 = 0.001;
/// Largest share of an arm's cases that may be unsettled.
pub const UNSETTLED_SHARE: f64 = 0.20;
/// Damage D = 1 - M1/M below which a case counts as unbroken.
pub const BROKEN_DAMAGE: f64 = 0.01;
/// Share of unbroken cases above which an arm shows nothing.
pub const UNBROKEN_SHARE: f64 = 0.75;
/// Largest ratio of two arms' mean damping integrals.
pub const DAMPING_RATIO: f64 = 1.05;
/// Family-wise error rate of the intervals; also the level of one-sided bounds and of the checks' intervals.
pub const ERROR_RATE: f64 = 0.05;
/// Smallest ratio of N_eff of interest.
pub const SMALLEST_RATIO: f64 = 1.25;
/// Fewest complete blocks of a measurement check.
pub const CHECK_BLOCKS: usize = 8;

/// Smallest effect of interest on A = ln N_eff: delta = ln 1.25.
pub fn smallest_effect() -> f64 {
    libm::log(SMALLEST_RATIO)
}
