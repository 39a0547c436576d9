//! The pilot: damage against speed, and the speed that its rule chooses.

use crate::figure::pilot::{Pilot, PilotArm, pilot};
use crate::results::CaseResult;
use crate::statistics::{OperatingSpeed, SpeedTrial, operating_speed};
use crate::tables::usable;

use super::{Findings, Titled, drawn};

/// Damage against the axis `speed` of a sweep.
pub(super) fn pilot_chart(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let (speeds, arms, chosen) = speed_trials(findings);
    if speeds.is_empty() {
        return Ok(None);
    }
    let columns: Vec<Vec<&[f64]>> =
        arms.iter().map(|(_, damage)| damage.iter().map(Vec::as_slice).collect()).collect();
    let shown: Vec<PilotArm> =
        arms.iter().zip(&columns).map(|((arm, _), damage)| PilotArm { arm, damage }).collect();
    let figure = Pilot {
        title: "",
        speeds: &speeds,
        arms: &shown,
        target: 0.25,
        accepted: [0.05, 0.6],
        chosen: chosen.and_then(|speed| speeds.iter().position(|s| *s == speed)),
        note: "every case a point; a short line is the median of an arm",
    };
    Ok(drawn(pilot(&figure))?.map(|drawing| Titled {
        name: "pilot".into(),
        title: "Damage against speed".into(),
        caption: "D = 1 - M1/M of every case. The study runs at the speed whose pooled median is nearest to 0.25, if it lies within [0.05, 0.6].".into(),
        alternative: "Damage of every pilot case against impact speed, by arm; the numbers are in the summary table.".into(),
        drawing,
    }))
}

/// Speeds, damages by arm and speed, and the speed that the rule chooses.
type SpeedTrials = (Vec<f64>, Vec<(String, Vec<Vec<f64>>)>, Option<f64>);

fn speed_trials(findings: Findings) -> SpeedTrials {
    let study = findings.archive.study;
    let speed_of = |r: &CaseResult| r.case.number("speed");
    let mut speeds: Vec<f64> = findings.results.iter().filter_map(speed_of).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let damages = |arm: &str, speed: f64| -> Vec<f64> {
        let cases =
            findings.results.iter().filter(|r| r.case.arm == arm && speed_of(r) == Some(speed) && usable(r));
        cases.filter_map(|r| Some(r.metrics.as_ref()?.end.damage)).collect()
    };
    let ids = study.arms();
    let arms = ids
        .iter()
        .map(|id| (study.label(id), speeds.iter().map(|&speed| damages(id, speed)).collect()))
        .collect();
    let chosen = match operating_point(findings.results, &ids) {
        Some((OperatingSpeed::Found { speed, .. }, _)) => Some(speed),
        _ => None,
    };
    (speeds, arms, chosen)
}

/// The operating point by the pilot's rule, obstacle by obstacle: arms of one obstacle share the first part of their
/// id; an obstacle is asked only where those before it, in the order of the file, have no usable speed. The obstacle comes
/// with it.
pub fn operating_point(results: &[CaseResult], arms: &[&str]) -> Option<(OperatingSpeed, String)> {
    let obstacle = |arm: &str| arm.split('-').next().unwrap_or(arm).to_string();
    let mut obstacles: Vec<String> = Vec::new();
    for arm in arms {
        if !obstacles.contains(&obstacle(arm)) {
            obstacles.push(obstacle(arm));
        }
    }
    let mut latest = None;
    for name in obstacles {
        let mut trials: Vec<SpeedTrial> = Vec::new();
        for result in results.iter().filter(|r| obstacle(&r.case.arm) == name && usable(r)) {
            let speed = result.case.number("speed");
            if let (Some(speed), Some(metrics)) = (speed, &result.metrics) {
                match trials.iter_mut().find(|trial| trial.speed == speed) {
                    Some(trial) => trial.damages.push(metrics.end.damage),
                    None => trials.push(SpeedTrial { speed, damages: vec![metrics.end.damage] }),
                }
            }
        }
        if trials.is_empty() {
            continue;
        }
        let found = operating_speed(&trials);
        let usable = matches!(found, OperatingSpeed::Found { .. });
        latest = Some((found, name));
        if usable {
            break;
        }
    }
    latest
}
