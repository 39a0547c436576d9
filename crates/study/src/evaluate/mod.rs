//! Claims from cases: endpoints at equal counts, the checks that re-measure stored frames, the gates.

mod calibration;
mod gates;
mod remeasure;
mod start;
mod stretched;

use std::collections::BTreeMap;

use crate::claims::{
    ArmValue, Assessment, Calibration, CaseStatus, Check, Claim, Conditions, Observations, Primary,
    Resampling, assess_family,
};
use crate::metrics::Thinning;
use crate::record::Outcome;
use crate::results::{Archive, CaseError, CaseResult};
use crate::spec::scene::PlacementSpec;
use crate::tables::usable;

pub use gates::Gates;
pub use stretched::{Stretched, stretched_arms};

use calibration::Calibrator;
use gates::gates;
use remeasure::remeasure;

/// Seed of resampling: fixed, so that tables are the same bytes (chosen: PS17's year).
const RESAMPLING_SEED: u64 = 2017;

/// A claim with its verdict.
#[derive(Clone, Debug)]
pub struct Judged {
    /// `claim` or `control`: the family it belongs to.
    pub family: &'static str,
    /// The claim.
    pub claim: Claim,
    /// What its endpoint was measured by.
    pub primary: Primary,
    /// What the calibration by stretch found, in words.
    pub calibration: String,
    /// What the rule says of it.
    pub assessment: Assessment,
}

/// Judges the claims and the controls of a study, each a family of its own. A claim with an arm that the profile leaves out
/// is left out, but still a member of its family: what was run does not make the family smaller.
///
/// # Errors
/// Frames that cannot be read.
pub fn assess_claims(archive: &Archive, results: &[CaseResult]) -> anyhow::Result<(Vec<Judged>, Gates)> {
    let spec = &archive.study.spec;
    let gates = gates(archive, results);
    let mut calibrator = Calibrator::new(archive);
    let mut judged = Vec::new();
    for (family, claims) in [("claim", &spec.claim), ("control", &spec.control)] {
        let (mut members, mut words) = (Vec::new(), Vec::new());
        for claim in claims {
            let (calibration, found) = calibrator.calibrate(&blocks_of(results, claim))?;
            words.push((calibration.primary(), found));
            members.push((claim.clone(), observations(archive, results, claim, &gates, calibration)?));
        }
        let assessments = assess_family(&members, Resampling::standard(RESAMPLING_SEED))?;
        let all = members.into_iter().zip(words).zip(assessments);
        judged.extend(all.map(|(((claim, _), (primary, calibration)), assessment)| Judged {
            family,
            claim,
            primary,
            calibration,
            assessment,
        }));
    }
    let run = archive.study.arms();
    judged.retain(|judged| judged.claim.arms().iter().all(|arm| run.contains(arm)));
    Ok((judged, gates))
}

fn observations(
    archive: &Archive,
    results: &[CaseResult],
    claim: &Claim,
    gates: &Gates,
    calibration: Calibration,
) -> Result<Observations, CaseError> {
    let mut rows = Vec::new();
    let mut checks: BTreeMap<Check, Vec<ArmValue>> = BTreeMap::new();
    let blocks = blocks_of(results, claim);
    for block in blocks.values() {
        let count = equal_count(block);
        for result in block {
            let measured = remeasure(archive, result, count, calibration.primary())?;
            rows.push(arm_value(
                result,
                measured.as_ref().map(|m| m.primary),
                measured.as_ref().is_none_or(|m| m.whole),
            ));
            for (check, value) in measured.iter().flat_map(|m| m.checks) {
                checks.entry(check).or_default().push(arm_value(result, Some(value), true));
            }
        }
    }
    // Arms that run one of the claim's arms again speak for it in the check.
    for result in results {
        let Some(check) = archive.study.spec.check_of(&result.case.arm) else { continue };
        let Some(block) = blocks.get(&result.case.block) else { continue };
        if claim.arms().contains(&check.of.as_str()) {
            let measured = remeasure(archive, result, equal_count(block), calibration.primary())?;
            let whole = measured.as_ref().is_none_or(|m| m.whole);
            let value = arm_value(result, measured.map(|m| m.primary), whole);
            checks.entry(check.by.into()).or_default().push(ArmValue { arm: check.of.clone(), ..value });
        }
    }
    let conditions =
        Conditions { operating_point: gates.operating_point, calibration, noise_floor: gates.noise_floor };
    Ok(Observations { rows, conditions, checks })
}

/// The cases of a claim's arms, block by block.
type BlocksOf<'a> = BTreeMap<u64, Vec<&'a CaseResult>>;

fn blocks_of<'a>(results: &'a [CaseResult], claim: &Claim) -> BlocksOf<'a> {
    let arms = claim.arms();
    let mut blocks = BlocksOf::new();
    for result in results.iter().filter(|r| arms.contains(&r.case.arm.as_str())) {
        blocks.entry(result.case.block).or_default().push(result);
    }
    blocks
}

/// N*: the least number of particles among the cases of a block that were built.
fn equal_count(block: &[&CaseResult]) -> usize {
    block.iter().filter(|r| r.record.was_built()).map(|r| r.record.made.particles).min().unwrap_or(0)
}

/// The prefix for random placement, whose first N points are a placement of N points; random subsets else.
fn thinning_of(result: &CaseResult) -> Thinning {
    match result.case.scene.body[0].placement {
        PlacementSpec::Random { .. } => Thinning::Prefix,
        _ => Thinning::RandomSubsets { seed: result.case.block },
    }
}

fn arm_value(result: &CaseResult, value: Option<f64>, whole: bool) -> ArmValue {
    ArmValue {
        block: result.case.block,
        arm: result.case.arm.clone(),
        value: value.unwrap_or(f64::NAN),
        status: match &result.record.outcome {
            Outcome::Stopped { .. } => CaseStatus::Stopped,
            _ if !usable(result) || !whole || value.is_none() => CaseStatus::MetricInvalid,
            Outcome::Ok => CaseStatus::Ok,
            Outcome::OkWithClamps => CaseStatus::OkWithClamps { clamp_share: result.record.clamp_share() },
        },
        settled: result.metrics.as_ref().is_some_and(|m| m.settled),
        damage: result.metrics.as_ref().map_or(f64::NAN, |m| m.end.damage),
        damping: result.record.damping,
    }
}
