//! Claims from cases: endpoints at equal counts, the checks that re-measure stored frames, the gates.

mod calibration;
mod gates;
mod remeasure;
mod start;
mod stretched;
mod variations;

use std::collections::{BTreeMap, BTreeSet};

use crate::claims::{
    ArmValue, Assessment, CaseStatus, Check, Claim, Conditions, DensityNoise, DensityNoiseAssessment,
    Observations, Primary, Resampling, assess_family, density_noise,
};
use crate::metrics::Thinning;
use crate::record::Outcome;
use crate::results::{Archive, CaseResult};
use crate::spec::scene::PlacementSpec;
use crate::spec::study::MeasureSpec;

pub use gates::Gates;
pub use stretched::{Stretched, stretched_arms};

use calibration::Calibrator;
use gates::gates;
use remeasure::{Remeasured, Yardstick, remeasure};
pub use variations::{Kind, Variation};

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
    /// h_max [m], by which lengths are measured.
    pub largest_spacing: f64,
    /// What the calibration by stretch found, in words.
    pub calibration: String,
    /// What the rule says of it.
    pub assessment: Assessment,
    /// The same contrast measured otherwise, run otherwise, and under other conditions.
    pub variations: Vec<Variation>,
}

/// A path of the control `density-noise` with what it says.
#[derive(Clone, Debug)]
pub struct JudgedNoise {
    /// Its arms.
    pub arms: DensityNoise,
    /// What the endpoint was measured by.
    pub primary: Primary,
    /// What the rule says of it.
    pub assessment: DensityNoiseAssessment,
}

/// All that is judged of a study.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// Claims and controls.
    pub judged: Vec<Judged>,
    /// The paths of `density-noise`.
    pub noise: Vec<JudgedNoise>,
    /// What decides whether anything can be judged.
    pub gates: Gates,
}

/// Judges the claims and the controls of a study, each a family of its own. A claim with an arm that the profile leaves out
/// is left out, but still a member of its family: what was run does not make the family smaller.
///
/// # Errors
/// Frames that cannot be read.
pub fn judge(archive: &Archive, results: &[CaseResult]) -> anyhow::Result<Judgement> {
    let spec = &archive.study.spec;
    let gates = gates(archive, results);
    let mut calibrator = Calibrator::new(archive);
    let run = archive.study.arms();
    let mut judged = Vec::new();
    for (family, claims) in [("claim", &spec.claim), ("control", &spec.control)] {
        let mut members = Vec::new();
        for claim in claims {
            let measure = measure_of(archive, claim.largest_spacing);
            members.push(Member::observe(archive, results, &claim.arms(), measure, &gates, &mut calibrator)?);
        }
        let observed: Vec<_> =
            claims.iter().cloned().zip(members.iter().map(|member| member.observations.clone())).collect();
        let assessments = assess_family(&observed, Resampling::standard(RESAMPLING_SEED))?;
        for ((claim, member), assessment) in claims.iter().zip(members).zip(assessments) {
            if claim.arms().iter().all(|arm| run.contains(arm)) {
                judged.push(Judged {
                    family,
                    claim: claim.clone(),
                    primary: member.yardstick.primary,
                    largest_spacing: member.yardstick.measure.largest_spacing,
                    variations: variations::variations(archive, results, claim, &member)?,
                    calibration: member.calibration,
                    assessment,
                });
            }
        }
    }
    let mut noise = Vec::new();
    for arms in &spec.density_noise {
        let names = arms.names();
        if names.iter().all(|arm| run.contains(arm)) {
            let measure = measure_of(archive, None);
            let member = Member::observe(archive, results, &names, measure, &gates, &mut calibrator)?;
            let assessment = density_noise(arms, &member.observations)?;
            noise.push(JudgedNoise { arms: arms.clone(), primary: member.yardstick.primary, assessment });
        }
    }
    Ok(Judgement { judged, noise, gates })
}

/// The study's, with another h_max where a claim has one.
fn measure_of(archive: &Archive, largest_spacing: Option<f64>) -> MeasureSpec {
    let measure = archive.study.measure.clone();
    MeasureSpec { largest_spacing: largest_spacing.unwrap_or(measure.largest_spacing), ..measure }
}

/// What was observed of a contrast's arms.
struct Member {
    observations: Observations,
    /// By rulers that the rule does not ask for.
    others: BTreeMap<&'static str, Vec<ArmValue>>,
    yardstick: Yardstick,
    /// What the calibration by stretch found, in words.
    calibration: String,
}

impl Member {
    fn observe(
        archive: &Archive,
        results: &[CaseResult],
        arms: &[&str],
        measure: MeasureSpec,
        gates: &Gates,
        calibrator: &mut Calibrator,
    ) -> anyhow::Result<Self> {
        let blocks = blocks_of(results, |case| arms.iter().find(|arm| **arm == case.case.arm).copied());
        let (calibration, words) = calibrator.calibrate(&blocks, &measure)?;
        let flood_side = flood_side(&blocks, measure.largest_spacing);
        let spacings: BTreeSet<u64> =
            blocks.values().flatten().map(|result| result.case.scene.numerics.spacing.to_bits()).collect();
        let yardstick = Yardstick {
            measure,
            primary: calibration.primary(),
            flood_side,
            grids_differ: spacings.len() > 1,
        };
        let (mut rows, mut checks, mut others) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
        for block in blocks.values() {
            let count = equal_count(block);
            for result in block {
                let measured = remeasure(archive, result, count, &yardstick)?;
                rows.push(primary_value(result, measured.as_ref()));
                let seen = measured.as_ref().is_some_and(|m| m.seen);
                for (check, value) in measured.iter().flat_map(|m| m.checks) {
                    put(&mut checks, check, arm_value(result, Some(value), seen));
                }
                for (name, value) in measured.iter().flat_map(|m| &m.others) {
                    put(&mut others, *name, arm_value(result, Some(*value), seen));
                }
            }
        }
        // Arms that run one of the claim's arms again speak for it in the check.
        for result in results {
            let Some(under) = archive.study.spec.under(&result.case.arm) else { continue };
            let (Some(check), Some(block)) = (under.check, blocks.get(&result.case.block)) else { continue };
            if arms.contains(&under.arm.as_str()) {
                let measured = remeasure(archive, result, equal_count(block), &yardstick)?;
                let value = primary_value(result, measured.as_ref());
                put(&mut checks, Check::from(check), ArmValue { arm: under.arm.clone(), ..value });
            }
        }
        let conditions = Conditions {
            operating_point: gates.operating_point,
            calibration,
            noise_floor: gates.noise_floor,
        };
        Ok(Member {
            observations: Observations { rows, conditions, checks },
            others,
            yardstick,
            calibration: words,
        })
    }
}

fn put<K: Ord>(map: &mut BTreeMap<K, Vec<ArmValue>>, key: K, value: ArmValue) {
    map.entry(key).or_default().push(value);
}

/// Particles to a cell of the flood fill, at the least (chosen: of the cells of a random placement 0.3 % then have less than a quarter of the rest
/// density, which is within what the gate allows as dust).
const FLOOD_PARTICLES: f64 = 8.0;

/// Cells of the flood fill [m]: h_max, or larger where the thinnest of the placements that are compared has fewer particles to a cell.
fn flood_side(blocks: &BlocksOf, spacing: f64) -> f64 {
    let thinnest = |block: &Vec<&CaseResult>| {
        let count = equal_count(block) as f64;
        let built = block.iter().filter(|result| result.record.was_built());
        let side = |result: &&CaseResult| {
            let volume = result.record.made.filled_volume * FLOOD_PARTICLES / count;
            libm::pow(volume, 1.0 / result.case.scene.dimension as f64)
        };
        built.map(side).filter(|side| side.is_finite()).fold(0.0, f64::max)
    };
    blocks.values().map(thinnest).fold(spacing, f64::max)
}

/// The cases of a contrast's arms, block by block.
type BlocksOf<'a> = BTreeMap<u64, Vec<&'a CaseResult>>;

/// The cases for which `arm` names an arm of the contrast.
fn blocks_of<'a>(results: &'a [CaseResult], arm: impl Fn(&'a CaseResult) -> Option<&str>) -> BlocksOf<'a> {
    let mut blocks = BlocksOf::new();
    for result in results.iter().filter(|result| arm(result).is_some()) {
        blocks.entry(result.case.block).or_default().push(result);
    }
    blocks
}

/// A case by the primary metric.
fn primary_value(result: &CaseResult, measured: Option<&Remeasured>) -> ArmValue {
    arm_value(result, measured.map(|m| m.primary), measured.is_some_and(|m| m.whole))
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

/// A case by some metric, which is believed or not.
fn arm_value(result: &CaseResult, value: Option<f64>, believed: bool) -> ArmValue {
    ArmValue {
        block: result.case.block,
        arm: result.case.arm.clone(),
        value: value.unwrap_or(f64::NAN),
        status: match &result.record.outcome {
            Outcome::Stopped { .. } => CaseStatus::Stopped,
            _ if !believed || value.is_none() => CaseStatus::MetricInvalid,
            Outcome::Ok => CaseStatus::Ok,
            Outcome::OkWithClamps => CaseStatus::OkWithClamps { clamp_share: result.record.clamp_share() },
        },
        settled: result.metrics.as_ref().is_some_and(|m| m.settled),
        damage: result.metrics.as_ref().map_or(f64::NAN, |m| m.end.damage),
        damping: result.record.damping,
    }
}
