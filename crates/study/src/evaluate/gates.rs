//! What decides whether the claims of a study can be judged at all.

use crate::claims::{NoiseFloor, OperatingPoint};
use crate::results::{Archive, CaseResult};

/// What the pilot and the noise floor say, with the words for it.
#[derive(Clone, Debug)]
pub struct Gates {
    /// The pilot.
    pub operating_point: OperatingPoint,
    /// Arms that nothing can break.
    pub noise_floor: NoiseFloor,
    /// One line on each.
    pub words: Vec<String>,
}

pub(super) fn gates(archive: &Archive, results: &[CaseResult]) -> Gates {
    let spec = &archive.study.spec;
    let (operating_point, pilot) = match &spec.pilot {
        Some(pilot) if pilot.operating_point_found => {
            (OperatingPoint::Found, format!("found by the pilot ({})", pilot.source))
        }
        Some(pilot) => (OperatingPoint::NotFound, format!("the pilot found none ({})", pilot.source)),
        None => (OperatingPoint::NoPilot, "the study names no pilot".into()),
    };
    let (noise_floor, floor) = noise_floor(&spec.noise_floor, results);
    let words = vec![format!("operating point: {pilot}"), format!("noise floor: {floor}")];
    Gates { operating_point, noise_floor, words }
}

/// Arms that must stay in one piece (an elastic ball, a ball at rest) must read as one piece in every block.
fn noise_floor(arms: &[String], results: &[CaseResult]) -> (NoiseFloor, String) {
    let cases: Vec<&CaseResult> = results.iter().filter(|r| arms.contains(&r.case.arm)).collect();
    let broken: Vec<&&CaseResult> = cases
        .iter()
        .filter(|r| !r.metrics.as_ref().is_some_and(|m| m.gate_valid && m.end.fragments == 1))
        .collect();
    match (arms, cases.len(), broken.first()) {
        ([], ..) => (NoiseFloor::NotRun, "the study names no arm that nothing can break".into()),
        (_, 0, _) => (NoiseFloor::NotRun, format!("{} not run", arms.join(", "))),
        (_, count, None) => {
            (NoiseFloor::Holds, format!("all {count} cases of {} read as one piece", arms.join(", ")))
        }
        (_, count, Some(first)) => {
            let (arm, block) = (&first.case.arm, first.case.block);
            let broken = broken.len();
            let words =
                format!("{broken} of {count} cases do not read as one piece, first {arm} block {block}");
            (NoiseFloor::Broken, words)
        }
    }
}
