//! The placements of the arms compared under uniaxial stretch: what the calibration figure shows.

use super::start::Start;
use crate::metrics::calibration::STRETCH_RANGE;
use crate::metrics::{MetricError, stretch_curve};
use crate::results::{Archive, CaseResult};
use crate::store::StoreError;

/// Stretches at which a curve is known (chosen: 13 % apart from 1 to 20).
const STRETCHES: usize = 25;
/// Blocks of an arm that are measured (chosen: placements of one kind are alike to some percent).
const MOST_BLOCKS: usize = 3;
/// Particles that are linked for one figure, all arms, blocks and stretches together, where more than one block of an arm
/// is measured (chosen: about 4 s on one core).
const MOST_LINKED: usize = 16_000_000;

/// An arm's placement under stretch.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretched {
    /// The arm.
    pub arm: String,
    /// (stretch, M1/M) of the first blocks.
    pub blocks: Vec<Vec<(f64, f64)>>,
}

/// The arms that claims and controls compare, in the order of the results, each thinned to the least number of particles
/// of any of them, which comes with it.
///
/// # Errors
/// Frames that cannot be read. A case that cannot be measured is passed over.
pub fn stretched_arms(
    archive: &Archive,
    results: &[CaseResult],
) -> Result<(usize, Vec<Stretched>), StoreError> {
    let spec = &archive.study.spec;
    let compared: Vec<&str> = spec.claim.iter().chain(&spec.control).flat_map(|claim| claim.arms()).collect();
    let cases: Vec<&CaseResult> =
        results.iter().filter(|r| compared.contains(&r.case.arm.as_str()) && r.record.was_built()).collect();
    let count = super::equal_count(&cases);
    let mut arms: Vec<(&str, Vec<&CaseResult>)> = Vec::new();
    for case in cases {
        match arms.last_mut() {
            Some((arm, own)) if *arm == case.case.arm => own.push(case),
            _ => arms.push((&case.case.arm, vec![case])),
        }
    }
    let blocks = (MOST_LINKED / (count * arms.len() * STRETCHES).max(1)).clamp(1, MOST_BLOCKS);
    let mut stretched = Vec::new();
    for (arm, cases) in arms {
        let mut curves = Vec::new();
        for case in cases.into_iter().take(blocks) {
            curves.extend(match case.case.scene.dimension {
                3 => curve::<3>(archive, case, count)?.ok(),
                _ => curve::<2>(archive, case, count)?.ok(),
            });
        }
        stretched.push(Stretched { arm: arm.into(), blocks: curves });
    }
    Ok((count, stretched))
}

type Curve = Vec<(f64, f64)>;

fn curve<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
    count: usize,
) -> Result<Result<Curve, MetricError>, StoreError> {
    let [least, greatest] = STRETCH_RANGE;
    let share = |k: usize| k as f64 / (STRETCHES - 1) as f64;
    let stretches: Vec<f64> = (0..STRETCHES)
        .map(|k| (least * libm::pow(greatest / least, share(k))).clamp(least, greatest))
        .collect();
    let start = Start::<D>::read(archive, result, &archive.study.measure)?;
    Ok(start
        .thinned(result, count)
        .and_then(|(points, masses)| stretch_curve(&points, &masses, start.link, 0, &stretches)))
}
