use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde::Serialize;

use super::blocks::Blocks;
use super::checks::fixed_weights;
use super::claim::{Claim, ClaimError};
use super::evidence::{Evidence, Resampling, differences};
use super::limits::CHECK_BLOCKS;
use super::observations::{ArmValue, Check, Observations};
use super::rules::{Case, judge};
use super::verdict::Verdict;
use crate::statistics::{Interval, ReplicatePlan, holm_adjusted, mean, replicate_plan};

/// A claim judged: the verdict, the numbers it rests on, and the reason in words. `Display` is one line of a
/// report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Assessment {
    /// Id of the claim.
    pub claim: String,
    /// What the rule says.
    pub verdict: Verdict,
    /// Effect, intervals, bounds and p values from the complete blocks, whatever the verdict.
    pub evidence: Evidence,
    /// Blocks dropped because a case in them was lost.
    pub lost_blocks: usize,
    /// Blocks dropped because a case in them has not been run.
    pub incomplete_blocks: usize,
    /// The effect as measured otherwise, where a block has every arm.
    pub checks: Vec<CheckReading>,
    /// How many blocks a study to come needs to see such an effect, with these blocks as its pilot; `None` for a range.
    pub replicates: Option<ReplicatePlan>,
    /// The reason, with its numbers.
    pub explanation: String,
}

/// The effect by one of the checks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CheckReading {
    /// Which.
    pub check: Check,
    /// Complete blocks.
    pub blocks: usize,
    /// Mean of d; for a range, that of the two arms that were extreme in the primary measurement.
    pub effect: f64,
}

/// Judges one claim as a member of a family of `family_size` (at least 1).
///
/// # Errors
/// [`ClaimError`] if the contrast means nothing, a case appears twice, or a case that is not lost lacks a finite
/// number.
///
/// # Panics
/// If `family_size` is 0.
pub fn assess(
    claim: &Claim,
    observations: &Observations,
    family_size: usize,
    resampling: Resampling,
) -> Result<Assessment, ClaimError> {
    assert!(family_size > 0, "assess: a family has at least one member");
    claim.validate()?;
    let blocks = Blocks::of(&claim.id, &claim.arms(), &observations.rows)?;
    let evidence = Evidence::measure(&claim.contrast, &blocks.values(), family_size, resampling);
    let checks = complete_checks(claim, &observations.checks)?;
    let readings = readings(claim, &blocks.values(), &checks);
    let checks = checks.into_iter().filter(|(_, values)| values.len() >= CHECK_BLOCKS).collect();
    let conditions = observations.conditions;
    let replicates =
        claim.contrast.weights().and_then(|weights| replicate_plan(&differences(&weights, &blocks.values())));
    let case = Case { claim, conditions, blocks, evidence, checks, family_size, resampling };
    let verdict = judge(&case);
    Ok(Assessment {
        claim: claim.id.clone(),
        explanation: verdict.explanation(),
        verdict,
        lost_blocks: case.blocks.lost.len(),
        incomplete_blocks: case.blocks.incomplete,
        checks: readings,
        replicates,
        evidence: case.evidence,
    })
}

/// Judges a family of claims: its size m is the number of different ids, and claims with the same id are paths
/// of one member. Holm's adjustment is over the members, each with the largest p value of its paths; a member
/// without one counts as p = 1.
///
/// # Errors
/// As [`assess`], for the first claim concerned.
pub fn assess_family(
    members: &[(Claim, Observations)],
    resampling: Resampling,
) -> Result<Vec<Assessment>, ClaimError> {
    let size = members.iter().map(|(claim, _)| &claim.id).collect::<BTreeSet<_>>().len();
    let mut assessments: Vec<Assessment> = members
        .iter()
        .map(|(claim, observations)| assess(claim, observations, size, resampling))
        .collect::<Result<_, _>>()?;
    adjust_by_holm(&mut assessments);
    Ok(assessments)
}

/// Values of the complete blocks of each check.
fn complete_checks(
    claim: &Claim,
    checks: &BTreeMap<Check, Vec<ArmValue>>,
) -> Result<BTreeMap<Check, Vec<Vec<f64>>>, ClaimError> {
    let values = |rows| Blocks::of(&claim.id, &claim.arms(), rows).map(|blocks| blocks.values());
    checks.iter().map(|(check, rows)| Ok((*check, values(rows)?))).collect()
}

fn readings(
    claim: &Claim,
    primary: &[Vec<f64>],
    checks: &BTreeMap<Check, Vec<Vec<f64>>>,
) -> Vec<CheckReading> {
    let weights = fixed_weights(&claim.contrast, primary);
    let reading = |(check, values): (&Check, &Vec<Vec<f64>>)| {
        let effect = mean(&differences(&weights, values))?;
        Some(CheckReading { check: *check, blocks: values.len(), effect })
    };
    checks.iter().filter_map(reading).collect()
}

impl fmt::Display for CheckReading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:.3} (n = {})", self.check, self.effect, self.blocks)
    }
}

fn adjust_by_holm(assessments: &mut [Assessment]) {
    let mut largest: BTreeMap<String, f64> = BTreeMap::new();
    for assessment in assessments.iter() {
        let p = largest.entry(assessment.claim.clone()).or_insert(0.0);
        *p = p.max(assessment.evidence.p_value.unwrap_or(1.0));
    }
    let adjusted = holm_adjusted(&largest.values().copied().collect::<Vec<_>>());
    let by_claim: BTreeMap<&String, f64> = largest.keys().zip(adjusted).collect();
    for assessment in assessments.iter_mut() {
        let p = by_claim[&assessment.claim];
        assessment.evidence.p_holm = assessment.evidence.p_value.map(|_| p);
    }
}

impl fmt::Display for Assessment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let e = &self.evidence;
        let number = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.3}"));
        let pair = |interval: Option<Interval>| {
            interval.map_or("-".into(), |i| format!("[{:.3}, {:.3}]", i.lower, i.upper))
        };
        let percent = 100.0 * e.confidence;
        write!(f, "{}: {}; n = {}, d = {}", self.claim, self.verdict, e.blocks, number(e.effect))?;
        write!(f, ", {percent:.1} % t {}, BCa {}", pair(e.interval_t), pair(e.interval_bca))?;
        write!(f, ", U t {}, BCa {}", number(e.upper_t), number(e.upper_bca))?;
        let p = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.2e}"));
        write!(f, ", p = {}, Holm {}, Cliff's delta {}", p(e.p_value), p(e.p_holm), number(e.cliffs_delta))?;
        write!(f, " ({})", self.explanation)
    }
}
