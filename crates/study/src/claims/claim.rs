use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::statistics::mean;

/// The ratio of counts a trend's effect is expressed for: 30k against 5k particles.
const TREND_RATIO: f64 = 6.0;

/// A sentence of PS17 and the contrast that decides it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Short name, e.g. `coarse-breaks-more`. Claims with the same id are paths of one member of the family.
    pub id: String,
    /// The sentence of PS17, in our words.
    pub sentence: String,
    /// What is compared with what.
    pub contrast: Contrast,
    /// h_max of its arms [m], by which they are measured; `None`: that of the study.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_spacing: Option<f64>,
}

/// What is compared, on A = ln N_eff per block; positive where PS17 is right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Contrast {
    /// d = A(treated) - A(control).
    Paired {
        /// The arm that PS17 says breaks more.
        treated: String,
        /// The arm it is compared with.
        control: String,
    },
    /// d = -(least-squares slope of A on log2 N) x log2 6: the fall of A from 5k to 30k particles.
    Trend {
        /// Two or more arms that differ in N.
        arms: Vec<TrendArm>,
    },
    /// The range of the arm means of A.
    Range {
        /// Two or more arms along one path.
        arms: Vec<String>,
    },
    /// d = sum of weight x A(arm): factorial effects and differences of differences. Weights sum to zero.
    Weighted {
        /// Weight of each arm.
        weights: BTreeMap<String, f64>,
    },
}

/// An arm of a trend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrendArm {
    /// Name of the arm.
    pub arm: String,
    /// Its number of particles N.
    pub particles: f64,
}

/// What is wrong with a claim or with the rows it is given.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ClaimError {
    /// The contrast has too few arms or names one twice.
    #[error("claim `{claim}`: arms {arms:?}; a contrast takes two or more arms, each named once")]
    Arms {
        /// Id of the claim.
        claim: String,
        /// The arms it names.
        arms: Vec<String>,
    },
    /// A trend cannot be fitted.
    #[error(
        "claim `{claim}`: particle counts {counts:?}; a trend takes positive counts, two of them different"
    )]
    Counts {
        /// Id of the claim.
        claim: String,
        /// The counts given.
        counts: Vec<f64>,
    },
    /// Weights do not make a contrast.
    #[error(
        "claim `{claim}`: weights sum to {sum}, not 0; a contrast's weights are finite, not all 0, and cancel"
    )]
    Weights {
        /// Id of the claim.
        claim: String,
        /// Their sum.
        sum: f64,
    },
    /// A case appears twice.
    #[error("claim `{claim}`: block {block} has two rows of arm `{arm}`; give one row per case")]
    Duplicate {
        /// Id of the claim.
        claim: String,
        /// Block of the case.
        block: u64,
        /// Arm of the case.
        arm: String,
    },
    /// A case that ended well has no finite numbers.
    #[error(
        "claim `{claim}`: block {block}, arm `{arm}`: {field} = {value}; a case that is not lost has a finite one"
    )]
    NotFinite {
        /// Id of the claim.
        claim: String,
        /// Block of the case.
        block: u64,
        /// Arm of the case.
        arm: String,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
    },
}

impl Claim {
    /// Names of the arms, in the order of the contrast.
    pub fn arms(&self) -> Vec<&str> {
        match &self.contrast {
            Contrast::Paired { treated, control } => vec![treated, control],
            Contrast::Trend { arms } => arms.iter().map(|arm| arm.arm.as_str()).collect(),
            Contrast::Range { arms } => arms.iter().map(String::as_str).collect(),
            Contrast::Weighted { weights } => weights.keys().map(String::as_str).collect(),
        }
    }

    /// Refuses contrasts that mean nothing: fewer than two arms, an arm twice, equal counts, weights that do not
    /// cancel.
    ///
    /// # Errors
    /// [`ClaimError::Arms`], [`ClaimError::Counts`] or [`ClaimError::Weights`].
    pub fn validate(&self) -> Result<(), ClaimError> {
        let arms = self.arms();
        if arms.len() < 2 || arms.iter().collect::<BTreeSet<_>>().len() < arms.len() {
            let arms = arms.into_iter().map(String::from).collect();
            return Err(ClaimError::Arms { claim: self.id.clone(), arms });
        }
        match &self.contrast {
            Contrast::Trend { arms } => self.validate_counts(arms.iter().map(|arm| arm.particles).collect()),
            Contrast::Weighted { weights } => self.validate_weights(weights),
            Contrast::Paired { .. } | Contrast::Range { .. } => Ok(()),
        }
    }

    fn validate_counts(&self, counts: Vec<f64>) -> Result<(), ClaimError> {
        let positive = counts.iter().all(|count| count.is_finite() && *count > 0.0);
        if positive && counts.iter().any(|count| *count != counts[0]) {
            return Ok(());
        }
        Err(ClaimError::Counts { claim: self.id.clone(), counts })
    }

    fn validate_weights(&self, weights: &BTreeMap<String, f64>) -> Result<(), ClaimError> {
        let sum: f64 = weights.values().sum();
        let size: f64 = weights.values().map(|weight| weight.abs()).sum();
        // Round-off of weights such as 1/3 is let pass.
        if size.is_finite() && size > 0.0 && sum.abs() <= 1e-9 * size {
            return Ok(());
        }
        Err(ClaimError::Weights { claim: self.id.clone(), sum })
    }
}

impl Contrast {
    /// Weights c of the arms, in the contrast's order, with d = sum c A; `None` for a range, which is not linear.
    pub(super) fn weights(&self) -> Option<Vec<f64>> {
        match self {
            Self::Paired { .. } => Some(vec![1.0, -1.0]),
            Self::Trend { arms } => Some(trend_weights(arms)),
            Self::Weighted { weights } => Some(weights.values().copied().collect()),
            Self::Range { .. } => None,
        }
    }
}

/// -(x_i - x) / sum (x_j - x)^2 x log2 6 with x = log2 N: the least-squares slope, which is linear in A.
fn trend_weights(arms: &[TrendArm]) -> Vec<f64> {
    let logs: Vec<f64> = arms.iter().map(|arm| libm::log2(arm.particles)).collect();
    let centre = mean(&logs).unwrap_or_default();
    let spread: f64 = logs.iter().map(|x| (x - centre) * (x - centre)).sum();
    logs.iter().map(|x| -(x - centre) / spread * libm::log2(TREND_RATIO)).collect()
}
