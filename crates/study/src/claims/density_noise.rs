//! The control `density-noise`: does noise on a lattice reproduce what random placement does?

use std::fmt;

use serde::{Deserialize, Serialize};

use super::blocks::Blocks;
use super::claim::ClaimError;
use super::evidence::differences;
use super::limits::ERROR_RATE;
use super::observations::Observations;
use super::rules::{enough_blocks, fit_to_judge};
use super::verdict::Verdict;
use crate::statistics::{FiellerSet, ratio_of_means};

/// The ratios q that count as "noise on a lattice does what random placement does" (the study's plan).
const REPRODUCED: std::ops::RangeInclusive<f64> = 0.5..=1.5;

/// Arms of one path of the control `density-noise`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DensityNoise {
    /// Lattice with noise on its particles.
    pub noisy: String,
    /// The plain lattice.
    pub lattice: String,
    /// Random placement.
    pub random: String,
}

impl DensityNoise {
    /// Its arms.
    pub fn names(&self) -> [&str; 3] {
        [&self.noisy, &self.lattice, &self.random]
    }
}

/// What the control says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum DensityNoiseVerdict {
    /// Rule 1 or 2 ended it.
    NotJudged(Verdict),
    /// The set of q lies within [0.5, 1.5].
    Supported,
    /// The upper end of q is below 0.5.
    Refuted,
    /// Neither.
    Inconclusive,
}

impl fmt::Display for DensityNoiseVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotJudged(verdict) => write!(f, "{verdict}"),
            Self::Supported => f.write_str("supported"),
            Self::Refuted => f.write_str("refuted (q < 0.5)"),
            Self::Inconclusive => f.write_str("inconclusive (not resolved)"),
        }
    }
}

/// The control judged.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DensityNoiseAssessment {
    /// What it says.
    pub verdict: DensityNoiseVerdict,
    /// Complete blocks.
    pub blocks: usize,
    /// q = (A_noisy - A_lattice)/(A_random - A_lattice), of the means; `None` if undefined.
    pub ratio: Option<f64>,
    /// Fieller's 95 % set of q.
    pub set: Option<FiellerSet>,
}

/// Does noise on a lattice reproduce what random placement does? Rules 1 and 2 apply (blocks with a lost case
/// are dropped); then q's 95 % Fieller set decides.
///
/// # Errors
/// [`ClaimError`] if a case appears twice or one that is not lost lacks a finite number.
pub fn density_noise(
    arms: &DensityNoise,
    observations: &Observations,
) -> Result<DensityNoiseAssessment, ClaimError> {
    let names = arms.names();
    let blocks = Blocks::of("density-noise", &names, &observations.rows)?;
    let values = blocks.values();
    let by_noise = differences(&[1.0, -1.0, 0.0], &values);
    let by_random = differences(&[0.0, -1.0, 1.0], &values);
    let q = ratio_of_means(&by_noise, &by_random, 1.0 - ERROR_RATE);
    let fit = enough_blocks(&blocks).and_then(|()| fit_to_judge(&names, &blocks, observations.conditions));
    let verdict = match fit {
        Err(verdict) => DensityNoiseVerdict::NotJudged(verdict),
        Ok(()) => verdict_of(q.map(|(_, set)| set)),
    };
    Ok(DensityNoiseAssessment {
        verdict,
        blocks: values.len(),
        ratio: q.map(|(ratio, _)| ratio),
        set: q.map(|(_, set)| set),
    })
}

fn verdict_of(set: Option<FiellerSet>) -> DensityNoiseVerdict {
    match set {
        Some(FiellerSet::Bounded(q)) if REPRODUCED.contains(&q.lower) && REPRODUCED.contains(&q.upper) => {
            DensityNoiseVerdict::Supported
        }
        Some(FiellerSet::Bounded(q)) if q.upper < *REPRODUCED.start() => DensityNoiseVerdict::Refuted,
        _ => DensityNoiseVerdict::Inconclusive,
    }
}
