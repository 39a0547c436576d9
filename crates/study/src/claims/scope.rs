//! Rule 7: the same contrast under other conditions, in 3D, or measured otherwise.

use std::fmt;

use serde::Serialize;

use super::blocks::Blocks;
use super::checks::fixed_weights;
use super::claim::{Claim, ClaimError};
use super::evidence::differences;
use super::limits::{CHECK_BLOCKS, ERROR_RATE};
use super::observations::ArmValue;
use super::rules::difference_finding;
use super::verdict::Finding;
use crate::statistics::{Interval, mean, t_interval, t_upper_bound};

/// Which way the effect points under other conditions (rule 7) or in 3D, against the primary runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Direction {
    /// The 95 % interval lies on the side of 0 of the primary effect.
    Same,
    /// The 95 % interval lies on the other side.
    Opposite,
    /// It contains 0, or there are fewer than 8 complete blocks.
    Undetermined,
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Same => "same",
            Self::Opposite => "opposite",
            Self::Undetermined => "undetermined",
        })
    }
}

/// The effect under other conditions. It never changes a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScopeReading {
    /// Which way it points.
    pub direction: Direction,
    /// Complete blocks.
    pub blocks: usize,
    /// Mean of d.
    pub effect: Option<f64>,
    /// Its 95 % t interval.
    pub interval: Option<Interval>,
    /// What rules 3 and 4 would say of it by itself, at 95 %; `None` where they leave it open or there are fewer than 8 complete blocks.
    pub finding: Option<Finding>,
}

/// Rule 7: the effect of `claim` in the rows of a scope condition, read against the `primary` rows. For a range
/// it is the difference of the two arms that were extreme in the primary rows.
///
/// # Errors
/// As [`assess`](super::assess).
pub fn direction(
    claim: &Claim,
    primary: &[ArmValue],
    scope: &[ArmValue],
) -> Result<ScopeReading, ClaimError> {
    claim.validate()?;
    let values = |rows| Blocks::of(&claim.id, &claim.arms(), rows).map(|blocks| blocks.values());
    let (primary, scope) = (values(primary)?, values(scope)?);
    let weights = fixed_weights(&claim.contrast, &primary);
    let expected = mean(&differences(&weights, &primary)).unwrap_or_default();
    let found = differences(&weights, &scope);
    let interval = t_interval(&found, 1.0 - ERROR_RATE);
    let sign = match interval {
        Some(interval) if found.len() >= CHECK_BLOCKS && interval.lies_above(0.0) => 1.0,
        Some(interval) if found.len() >= CHECK_BLOCKS && interval.lies_below(0.0) => -1.0,
        _ => 0.0,
    };
    let agreement = sign * expected;
    let direction = if agreement > 0.0 {
        Direction::Same
    } else if agreement < 0.0 {
        Direction::Opposite
    } else {
        Direction::Undetermined
    };
    let effect = mean(&found);
    let finding = difference_finding(effect, interval, t_upper_bound(&found, 1.0 - ERROR_RATE))
        .filter(|_| found.len() >= CHECK_BLOCKS);
    Ok(ScopeReading { direction, blocks: found.len(), effect, interval, finding })
}
