//! Claims: each sentence of Park & Shen 2017 (PS17) as a contrast of arms in A = ln N_eff, judged by a
//! mechanical rule that was written down before the runs.
//!
//! A [`Claim`] names its arms; [`Observations`] hold what the cases of those arms gave; [`assess_family`] turns
//! both into one [`Assessment`] per claim: a [`Verdict`] and the [`Evidence`] it rests on. The rule itself reads
//! from top to bottom in `rules.rs`.

mod assess;
mod blocks;
mod checks;
mod claim;
mod density_noise;
mod evidence;
mod limits;
mod observations;
mod rules;
mod scope;
mod verdict;

pub use assess::{Assessment, CheckReading, assess, assess_family};
pub use claim::{Claim, ClaimError, Contrast, TrendArm};
pub use density_noise::{DensityNoise, DensityNoiseAssessment, DensityNoiseVerdict, density_noise};
pub use evidence::{Evidence, Resampling};
pub use limits::{
    BROKEN_DAMAGE, CHECK_BLOCKS, CLAMP_SHARE, DAMPING_RATIO, ERROR_RATE, LOST_SHARE, MINIMUM_BLOCKS,
    SMALLEST_RATIO, UNBROKEN_SHARE, UNSETTLED_SHARE, smallest_effect,
};
pub use observations::{
    ArmValue, Calibration, CaseStatus, Check, Conditions, NoiseFloor, Observations, OperatingPoint, Primary,
};
pub use scope::{Direction, ScopeReading, direction};
pub use verdict::{Finding, FloorCause, MetricFault, NotRun, Reason, Refutation, Verdict};
