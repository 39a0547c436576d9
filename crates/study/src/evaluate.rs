//! Claims from cases: endpoints at equal counts, the checks that re-measure stored frames, the gates.

use std::collections::BTreeMap;

use crate::claims::{
    ArmValue, Assessment, CaseStatus, Check, Claim, Conditions, Observations, Resampling, assess_family,
};
use crate::frames::{Frame, Frames};
use crate::measure::{Ruler, earlier_frame};
use crate::metrics::{
    MetricError, Thinning, breaking_stretch, friends_of_friends, mean_over_subsets, stretches_agree, thinning,
};
use crate::record::Outcome;
use crate::results::{Archive, CaseError, CaseResult};
use crate::spec::scene::PlacementSpec;
use crate::tables::usable;

/// Seed of resampling: fixed, so that tables are the same bytes (chosen: PS17's year).
const RESAMPLING_SEED: u64 = 2017;

/// What decides whether the claims of a study can be judged at all, with the words for it.
#[derive(Clone, Debug)]
pub struct Gates {
    /// The conditions.
    pub conditions: Conditions,
    /// One line on each.
    pub words: Vec<String>,
}

/// A claim with its verdict.
#[derive(Clone, Debug)]
pub struct Judged {
    /// `claim` or `control`: the family it belongs to.
    pub family: &'static str,
    /// The claim.
    pub claim: Claim,
    /// What the rule says of it.
    pub assessment: Assessment,
}

/// Judges the claims and the controls of a study, each a family of its own. A claim with an arm that the profile leaves out
/// is left out.
///
/// # Errors
/// Frames that cannot be read.
pub fn assess_claims(archive: &Archive, results: &[CaseResult]) -> anyhow::Result<(Vec<Judged>, Gates)> {
    let spec = &archive.study.spec;
    let gates = gates(archive, results)?;
    let mut judged = Vec::new();
    for (family, claims) in [("claim", &spec.claim), ("control", &spec.control)] {
        let mut members = Vec::new();
        for claim in claims {
            if claim.arms().iter().all(|arm| results.iter().any(|r| r.case.arm == *arm)) {
                members.push((claim.clone(), observations(archive, results, claim, gates.conditions)?));
            }
        }
        let assessments = assess_family(&members, Resampling::standard(RESAMPLING_SEED))?;
        let claims = members.into_iter().map(|(claim, _)| claim);
        judged.extend(claims.zip(assessments).map(|(claim, assessment)| Judged {
            family,
            claim,
            assessment,
        }));
    }
    Ok((judged, gates))
}

fn observations(
    archive: &Archive,
    results: &[CaseResult],
    claim: &Claim,
    conditions: Conditions,
) -> Result<Observations, CaseError> {
    let mut rows = Vec::new();
    let mut checks: BTreeMap<Check, Vec<ArmValue>> = BTreeMap::new();
    for (_, block) in by_block(results, &claim.arms()) {
        let count = block.iter().map(|r| r.record.made.particles).min().unwrap_or(0);
        for result in block {
            let measured = match result.case.scene.dimension {
                3 => remeasure::<3>(archive, result, count)?,
                _ => remeasure::<2>(archive, result, count)?,
            };
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
    Ok(Observations { rows, conditions, checks })
}

fn by_block<'a>(results: &'a [CaseResult], arms: &[&str]) -> BTreeMap<u64, Vec<&'a CaseResult>> {
    let mut blocks: BTreeMap<u64, Vec<&CaseResult>> = BTreeMap::new();
    for result in results.iter().filter(|r| arms.contains(&r.case.arm.as_str())) {
        blocks.entry(result.case.block).or_default().push(result);
    }
    blocks
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

/// One case at the count N* of its block.
struct Remeasured {
    primary: f64,
    /// Whether the thinned particles read as the intended bodies at t = 0.
    whole: bool,
    checks: [(Check, f64); 5],
}

fn remeasure<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
    count: usize,
) -> Result<Option<Remeasured>, CaseError> {
    let Some(metrics) = &result.metrics else { return Ok(None) };
    let frames: Frames<D> = archive.store.case(&result.key).read_frames()?;
    let spec = &archive.study.measure;
    let ruler = Ruler::new(spec, &result.case.scene, &result.record);
    let thinning = thinning_of(result);
    let at = |frame: Option<&Frame<D>>, link: f64| -> Result<f64, MetricError> {
        let points = frame.map_or(Vec::new(), Frame::points);
        let ids: Vec<usize> = (0..points.len()).collect();
        mean_over_subsets(thinning, count, &ids, &points, &frames.masses, |points, masses| {
            Ok(friends_of_friends(points, masses, link)?.log_effective_number())
        })
    };
    let (first, last) = (frames.frames.first(), frames.frames.last());
    let measured = (|| -> Result<Remeasured, MetricError> {
        Ok(Remeasured {
            primary: at(last, ruler.link)?,
            whole: whole_at_start(&ruler, first, &frames.masses, thinning, count, spec.bodies)?,
            checks: [
                (Check::NoThinning, metrics.end.ln_neff),
                (Check::LongLink, at(last, 3.0 * ruler.spacing)?),
                (Check::FloodFill, metrics.ln_neff_flood),
                (Check::BondGraph, metrics.ln_neff_bonds),
                (Check::EarlierTime, at(earlier_frame(&frames, spec, &result.record), ruler.link)?),
            ],
        })
    })();
    Ok(measured.ok())
}

/// The prefix for random placement, whose first N points are a placement of N points; random subsets else.
fn thinning_of(result: &CaseResult) -> Thinning {
    match result.case.scene.body[0].placement {
        PlacementSpec::Random { .. } => Thinning::Prefix,
        _ => Thinning::RandomSubsets { seed: result.case.block },
    }
}

fn whole_at_start<const D: usize>(
    ruler: &Ruler,
    start: Option<&Frame<D>>,
    masses: &[f64],
    thinning: Thinning,
    count: usize,
    bodies: usize,
) -> Result<bool, MetricError> {
    let points = start.map_or(Vec::new(), Frame::points);
    let ids: Vec<usize> = (0..points.len()).collect();
    for subset in thinning.subsets(&ids, count)? {
        let (points, masses) = thinning::thinned(&points, masses, &subset)?;
        let gate = crate::metrics::Gate::judge(&ruler.fragments(&points, &masses)?, ruler.least_mass, bodies);
        if !gate.is_valid() {
            return Ok(false);
        }
    }
    Ok(true)
}

fn gates(archive: &Archive, results: &[CaseResult]) -> Result<Gates, CaseError> {
    let spec = &archive.study.spec;
    let mut words = Vec::new();
    let operating_point_found = spec.pilot.as_ref().is_some_and(|pilot| pilot.operating_point_found);
    words.push(match &spec.pilot {
        Some(pilot) if operating_point_found => {
            format!("operating point: found by the pilot ({})", pilot.source)
        }
        Some(pilot) => format!("operating point: the pilot found none ({})", pilot.source),
        None => "operating point: no pilot was made".into(),
    });
    let noise_floor_holds = noise_floor(&spec.noise_floor, results, &mut words);
    let calibration_agrees = calibration(archive, results, &mut words)?;
    Ok(Gates {
        conditions: Conditions { operating_point_found, calibration_agrees, noise_floor_holds },
        words,
    })
}

/// Arms that must stay in one piece (an elastic ball, a ball at rest) must read as one piece in every block.
fn noise_floor(arms: &[String], results: &[CaseResult], words: &mut Vec<String>) -> bool {
    let cases: Vec<&CaseResult> = results.iter().filter(|r| arms.contains(&r.case.arm)).collect();
    let broken: Vec<&&CaseResult> = cases
        .iter()
        .filter(|r| !r.metrics.as_ref().is_some_and(|m| m.gate_valid && m.end.fragments == 1))
        .collect();
    words.push(match (cases.is_empty(), broken.first()) {
        (true, _) => "noise floor: not run in this profile".into(),
        (_, None) => {
            format!("noise floor: all {} cases of {} read as one piece", cases.len(), arms.join(", "))
        }
        (_, Some(first)) => {
            format!(
                "noise floor: {} of {} cases do not read as one piece, first {} block {}",
                broken.len(),
                cases.len(),
                first.case.arm,
                first.case.block
            )
        }
    });
    !cases.is_empty() && broken.is_empty()
}

/// Under uniform stretch, arms at equal counts must seem to fall apart at the same stretch within 15 %: asked of the first
/// block of every claim's arms.
fn calibration(
    archive: &Archive,
    results: &[CaseResult],
    words: &mut Vec<String>,
) -> Result<bool, CaseError> {
    let mut agrees = true;
    for claim in &archive.study.spec.claim {
        let Some((_, block)) = by_block(results, &claim.arms()).into_iter().next() else { continue };
        let count = block.iter().map(|r| r.record.made.particles).min().unwrap_or(0);
        let mut stretches = Vec::new();
        for result in &block {
            stretches.push(match result.case.scene.dimension {
                3 => apparent_break::<3>(archive, result, count)?,
                _ => apparent_break::<2>(archive, result, count)?,
            });
        }
        let holds = stretches_agree(&stretches);
        agrees &= holds;
        let list: Vec<String> = block
            .iter()
            .zip(&stretches)
            .map(|(r, s)| format!("{} {}", r.case.arm, s.map_or("over 20".into(), |s| format!("{s:.2}"))))
            .collect();
        let word = if holds { "agrees" } else { "does not agree" };
        words.push(format!(
            "calibration by stretch of `{}` at {count} particles {word}: {}",
            claim.id,
            list.join(", ")
        ));
    }
    Ok(agrees)
}

fn apparent_break<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
    count: usize,
) -> Result<Option<f64>, CaseError> {
    let frames: Frames<D> = archive.store.case(&result.key).read_frames()?;
    let ruler = Ruler::new(&archive.study.measure, &result.case.scene, &result.record);
    let points = frames.frames.first().map_or(Vec::new(), Frame::points);
    let ids: Vec<usize> = (0..points.len()).collect();
    let stretch = (|| -> Result<Option<f64>, MetricError> {
        let subsets = thinning_of(result).subsets(&ids, count)?;
        let (points, masses) = thinning::thinned(&points, &frames.masses, &subsets[0])?;
        breaking_stretch(&points, &masses, ruler.link, 0)
    })();
    Ok(stretch.unwrap_or(None))
}
