//! The mechanical rule, in reading order. Each rule either lets the claim pass on to the next or returns, as an
//! `Err`, the verdict it ends with.

use std::collections::BTreeMap;

use super::blocks::Blocks;
use super::checks::{Doubt, doubt_of_refutation, doubt_of_support};
use super::claim::{Claim, Contrast};
use super::evidence::{Evidence, Resampling, leaning};
use super::limits::{
    BROKEN_DAMAGE, DAMPING_RATIO, LOST_SHARE, MINIMUM_BLOCKS, UNBROKEN_SHARE, UNSETTLED_SHARE,
    smallest_effect,
};
use super::observations::{ArmValue, Calibration, Check, Conditions, NoiseFloor, OperatingPoint};
use super::verdict::{Finding, FloorCause, MetricFault, NotRun, Reason, Refutation, Verdict};
use crate::statistics::{Interval, mean};

/// What the rules look at.
pub(super) struct Case<'a> {
    pub claim: &'a Claim,
    pub conditions: Conditions,
    pub blocks: Blocks<'a>,
    pub evidence: Evidence,
    /// Values of the complete blocks of each check that has enough of them.
    pub checks: BTreeMap<Check, Vec<Vec<f64>>>,
    pub family_size: usize,
    pub resampling: Resampling,
}

/// The verdict of rules 1 to 6.
pub(super) fn judge(case: &Case) -> Verdict {
    enough_blocks(&case.blocks)
        .and_then(|()| fit_to_judge(&case.claim.arms(), &case.blocks, case.conditions))
        .and_then(|()| effect_against_delta(&case.claim.contrast, &case.evidence))
        .and_then(|finding| holds_with_lost_cases(finding, case))
        .and_then(|finding| withstands_remeasurement(finding, case))
        .map_or_else(|verdict| verdict, Verdict::from)
}

/// Rule 1: at least 12 complete blocks, at most 10 % of the blocks lost.
pub(super) fn enough_blocks(blocks: &Blocks) -> Result<(), Verdict> {
    let (complete, lost) = (blocks.complete.len(), blocks.lost.len());
    let run = complete + lost;
    if complete < MINIMUM_BLOCKS {
        return Err(Verdict::NotRun(NotRun::TooFewBlocks { complete }));
    }
    if lost as f64 > LOST_SHARE * run as f64 {
        return Err(Verdict::NotRun(NotRun::TooManyLost { lost, run }));
    }
    Ok(())
}

/// Rule 2: the floor, the plateau, the metric and the damping, in this order.
pub(super) fn fit_to_judge(arms: &[&str], blocks: &Blocks, conditions: Conditions) -> Result<(), Verdict> {
    something_breaks(blocks, conditions)
        .and_then(|()| fragments_have_settled(arms, blocks))
        .and_then(|()| metric_is_sound(conditions))
        .and_then(|()| damping_is_alike(blocks))
        .map_err(Verdict::Inconclusive)
}

fn something_breaks(blocks: &Blocks, conditions: Conditions) -> Result<(), Reason> {
    match conditions.operating_point {
        OperatingPoint::Found => {}
        OperatingPoint::NotFound => return Err(Reason::Floor(FloorCause::NoOperatingPoint)),
        OperatingPoint::NoPilot => return Err(Reason::NoPilot),
    }
    let unbroken = per_arm(blocks, |case| f64::from(case.damage < BROKEN_DAMAGE));
    let share = unbroken.into_iter().fold(1.0, f64::min);
    if share > UNBROKEN_SHARE { Err(Reason::Floor(FloorCause::Unbroken { share })) } else { Ok(()) }
}

fn fragments_have_settled(arms: &[&str], blocks: &Blocks) -> Result<(), Reason> {
    let unsettled = per_arm(blocks, |case| f64::from(!case.settled));
    match arms.iter().zip(unsettled).find(|(_, share)| *share > UNSETTLED_SHARE) {
        Some((arm, share)) => Err(Reason::NoPlateau { arm: (*arm).into(), share }),
        None => Ok(()),
    }
}

fn metric_is_sound(conditions: Conditions) -> Result<(), Reason> {
    match (conditions.calibration, conditions.noise_floor) {
        (Calibration::NotMeasured, _) => Err(Reason::Metric(MetricFault::NotCalibrated)),
        (_, NoiseFloor::Broken) => Err(Reason::Metric(MetricFault::NoiseFloor)),
        (_, NoiseFloor::NotRun) => Err(Reason::Metric(MetricFault::NoiseFloorNotRun)),
        (Calibration::Agrees | Calibration::FloodFill, NoiseFloor::Holds) => Ok(()),
    }
}

/// Largest over smallest arm mean; arms without any damping at all are alike.
fn damping_is_alike(blocks: &Blocks) -> Result<(), Reason> {
    let damping = per_arm(blocks, |case| case.damping);
    let largest = damping.iter().copied().fold(0.0, f64::max);
    let smallest = damping.iter().copied().fold(f64::INFINITY, f64::min);
    if largest > DAMPING_RATIO * smallest {
        return Err(Reason::Damping { ratio: largest / smallest });
    }
    Ok(())
}

/// Mean of `quantity` over the complete blocks, one per arm.
fn per_arm(blocks: &Blocks, quantity: impl Fn(&ArmValue) -> f64) -> Vec<f64> {
    let arms = blocks.complete.first().map_or(0, Vec::len);
    let values = |arm: usize| blocks.complete.iter().map(|cases| quantity(cases[arm])).collect::<Vec<_>>();
    (0..arms).filter_map(|arm| mean(&values(arm))).collect()
}

/// Rules 3, 4 and 5; t and BCa must give the same answer.
fn effect_against_delta(contrast: &Contrast, evidence: &Evidence) -> Result<Finding, Verdict> {
    let open = |reason| Err(Verdict::Inconclusive(reason));
    if let Contrast::Range { .. } = contrast {
        return range_finding(evidence).map_or_else(|| open(Reason::Unresolved), Ok);
    }
    let by_t = difference_finding(evidence.effect, evidence.interval_t, evidence.upper_t);
    let by_bca = difference_finding(evidence.effect, evidence.interval_bca, evidence.upper_bca);
    match (by_t, by_bca) {
        (None, None) => open(Reason::Unresolved),
        (Some(Finding::Supported), Some(Finding::Supported)) => Ok(Finding::Supported),
        (Some(Finding::Refuted(one)), Some(Finding::Refuted(other))) => {
            Ok(Finding::Refuted(weaker(one, other)))
        }
        (by_t, by_bca) => open(Reason::MethodsDisagree { by_t, by_bca }),
    }
}

/// Rules 3 and 4 for one interval I and bound U: `Supported` if I lies above 0 and the mean is at least delta,
/// `Refuted` if U < delta.
pub(super) fn difference_finding(
    effect: Option<f64>,
    interval: Option<Interval>,
    upper: Option<f64>,
) -> Option<Finding> {
    let (effect, interval, delta) = (effect?, interval?, smallest_effect());
    if interval.lies_above(0.0) && effect >= delta {
        return Some(Finding::Supported);
    }
    if upper? >= delta {
        return None;
    }
    let reversed = interval.lies_below(0.0);
    Some(Finding::Refuted(if reversed { Refutation::Reversed } else { Refutation::Smaller }))
}

/// Rules 3 and 4 for a range of means: `Supported` if p < 0.05/m and I lies above delta, `Refuted` if U < delta.
fn range_finding(evidence: &Evidence) -> Option<Finding> {
    let level = 1.0 - evidence.confidence;
    if evidence.p_value? < level && evidence.interval_bca?.lies_above(smallest_effect()) {
        return Some(Finding::Supported);
    }
    (evidence.upper_bca? < smallest_effect()).then_some(Finding::Refuted(Refutation::Smaller))
}

/// Only what both call reversed is reversed.
fn weaker(one: Refutation, other: Refutation) -> Refutation {
    if one == other { one } else { Refutation::Smaller }
}

/// Rule 1, last part: the answer stands, perhaps in its weaker form, with each lost case at the value that
/// speaks most against it among those seen.
fn holds_with_lost_cases(finding: Finding, case: &Case) -> Result<Finding, Verdict> {
    if case.blocks.lost.is_empty() {
        return Ok(finding);
    }
    let contrast = &case.claim.contrast;
    let mut leaning = leaning(contrast, &case.blocks.values());
    if let Finding::Refuted(_) = finding {
        leaning.iter_mut().for_each(|weight| *weight = -*weight);
    }
    let filled = case.blocks.values_with_lost_at_worst(&leaning);
    let evidence = Evidence::measure(contrast, &filled, case.family_size, case.resampling);
    match (finding, effect_against_delta(contrast, &evidence)) {
        (Finding::Supported, Ok(Finding::Supported)) => Ok(finding),
        (Finding::Refuted(_), Ok(Finding::Refuted(refutation))) => Ok(Finding::Refuted(refutation)),
        _ => Err(Verdict::Inconclusive(Reason::LostCases { without: finding, lost: case.blocks.lost.len() })),
    }
}

/// Rule 6: the answer withstands the measurement checks.
fn withstands_remeasurement(finding: Finding, case: &Case) -> Result<Finding, Verdict> {
    let doubt = match finding {
        Finding::Supported => doubt_of_support(case),
        Finding::Refuted(_) => doubt_of_refutation(case),
    };
    match doubt {
        None => Ok(finding),
        Some(Doubt { against, missing }) => {
            Err(Verdict::Inconclusive(Reason::Measurement { primary: finding, against, missing }))
        }
    }
}
