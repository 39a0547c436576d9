//! What a feature of the solver costs and what it does: two arms that differ by it alone.
//!
//! Cost is the time of whole runs taken by turns, so that other work on the machine falls on both, and, where valgrind is installed, instructions
//! a particle-step, which no other work changes. The effect is that on the fragments, in standard deviations over the blocks.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::results::CaseResult;
use crate::run::{Unobserved, run_scene};
use crate::spec::study::FeatureSpec;
use crate::spec::{SceneSpec, SpecError};
use crate::statistics::{mean, median, standard_deviation, t_interval};
use crate::sweep::{Case, Study};
use crate::table::{Row, Table};
use crate::tables::{case_row, usable};

/// Instructions are counted between these steps (chosen: the first makes the engine's memory, and the impact of studies/features.toml has begun).
const COUNTED: (u64, u64) = (50, 100);
/// Metrics of `cases.csv` in which the effect is told, which move before a ball falls apart: the length of cracks, loosened mass, the horizontal extent.
const EFFECTS: [&str; 3] = ["crack", "loosened_1_3", "ln_extent"];
/// Of the effects' intervals.
const CONFIDENCE: f64 = 0.95;

/// What it takes to be with a feature over to be without.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Wall time of a run, round by round.
    pub times: Vec<f64>,
    /// Steps of a run.
    pub steps: f64,
    /// Instructions a particle-step; `None` where they were not counted.
    pub instructions: Option<f64>,
}

/// Runs the first cases of both arms by turns, `rounds` times each, on one thread.
///
/// # Errors
/// A scene that cannot be built.
pub fn cost(
    study: &Study,
    feature: &FeatureSpec,
    folder: &Path,
    rounds: usize,
    instructions: impl Fn(&SceneSpec) -> Option<f64>,
) -> Result<Cost, SpecError> {
    let first = |arm: &str| study.cases.iter().find(|case| case.arm == arm);
    let (Some(on), Some(off)) = (first(&feature.on), first(&feature.off)) else {
        let message = format!(
            "`{}` or `{}` has no case under the profile `{}`",
            feature.on, feature.off, study.profile
        );
        return Err(SpecError::value(format!("feature `{}`", feature.name), message));
    };
    let (mut times, mut steps) = (Vec::new(), 1.0);
    for _ in 0..rounds.max(1) {
        let ((with, with_steps), (without, without_steps)) = (timed(on, folder)?, timed(off, folder)?);
        times.push(with / without);
        steps = with_steps / without_steps;
    }
    let ratio = |(on, off): (f64, f64)| on / off;
    Ok(Cost { times, steps, instructions: instructions(&on.scene).zip(instructions(&off.scene)).map(ratio) })
}

/// Wall time [s] and steps of a run on one thread.
///
/// # Errors
/// A scene that cannot be built.
pub fn timed(case: &Case, folder: &Path) -> Result<(f64, f64), SpecError> {
    let began = Instant::now();
    let record = match case.scene.dimension {
        3 => run_scene::<3>(&case.scene, folder, 1, &mut Unobserved)?.record,
        _ => run_scene::<2>(&case.scene, folder, 1, &mut Unobserved)?.record,
    };
    Ok((began.elapsed().as_secs_f64(), record.steps as f64))
}

/// Instructions a particle-step of a scene as `program steps SCENE --count N --folder FOLDER` takes them, by callgrind; `None` without valgrind.
pub fn counted_instructions(program: &Path, scene: &SceneSpec, folder: &Path, particles: f64) -> Option<f64> {
    let file = tempfile::Builder::new().suffix(".toml").tempfile().ok()?;
    std::fs::write(file.path(), toml::to_string(scene).ok()?).ok()?;
    let count = |steps: u64| -> Option<f64> {
        let mut valgrind = Command::new("valgrind");
        valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program).arg("steps");
        valgrind.arg(file.path()).arg("--count").arg(steps.to_string()).arg("--folder").arg(folder);
        let told = String::from_utf8_lossy(&valgrind.output().ok()?.stderr).into_owned();
        let line = told.lines().rev().find(|line| line.contains("Collected : "))?;
        line.rsplit(' ').next()?.parse().ok()
    };
    let (first, last) = COUNTED;
    Some((count(last)? - count(first)?) / ((last - first) as f64 * particles))
}

/// Row by row what `costs` and `results` say of the study's features.
pub fn table(study: &Study, costs: &[Cost], results: &[CaseResult]) -> Table {
    let rows = study.spec.feature.iter().zip(costs).map(|(feature, cost)| row(feature, cost, results));
    Table { name: "features", rows: rows.collect() }
}

fn row(feature: &FeatureSpec, cost: &Cost, results: &[CaseResult]) -> Row {
    let mut row = Row::default();
    row.put("feature", "-", "feature of the solver", feature.name.as_str());
    row.put("on", "-", "arm that has it", feature.on.as_str());
    row.put("off", "-", "arm that does without", feature.off.as_str());
    let of_times = |fold: fn(f64, f64) -> f64| cost.times.iter().copied().reduce(fold).unwrap_or(f64::NAN);
    row.count("rounds", "runs of each arm, by turns", cost.times.len() as u64);
    row.number(
        "time",
        "-",
        "wall time of a run with it over one without, median over rounds",
        median(&cost.times).unwrap_or(f64::NAN),
    );
    row.number("time_least", "-", "least of the rounds", of_times(f64::min));
    row.number("time_greatest", "-", "greatest of the rounds", of_times(f64::max));
    row.number("steps", "-", "steps of a run with it over one without", cost.steps);
    let instructions = cost.instructions.unwrap_or(f64::NAN);
    row.number("instructions", "-", "instructions a particle-step with it over without", instructions);
    for metric in EFFECTS {
        let effect = effect(feature, metric, results);
        row.number(metric, "SD", "mean change by it over the standard deviation without", effect[0]);
        row.number(&format!("{metric}_lower"), "SD", "95 % limit of that", effect[1]);
        row.number(&format!("{metric}_upper"), "SD", "95 % limit of that", effect[2]);
    }
    row
}

/// Mean, lower and upper limit of the paired change of a metric over its standard deviation without the feature; NaN where there are too few blocks.
fn effect(feature: &FeatureSpec, metric: &str, results: &[CaseResult]) -> [f64; 3] {
    let value = |arm: &str, block: u64| {
        let result = results.iter().find(|result| result.case.arm == arm && result.case.block == block)?;
        usable(result).then(|| case_row(result).value(metric)).flatten()
    };
    let blocks =
        results.iter().filter(|result| result.case.arm == feature.off).map(|result| result.case.block);
    let pairs: Vec<(f64, f64)> =
        blocks.filter_map(|block| Some((value(&feature.on, block)?, value(&feature.off, block)?))).collect();
    let changes: Vec<f64> = pairs.iter().map(|(on, off)| on - off).collect();
    let without: Vec<f64> = pairs.iter().map(|(_, off)| *off).collect();
    let spread = standard_deviation(&without).filter(|spread| *spread > 0.0);
    match (spread, mean(&changes), t_interval(&changes, CONFIDENCE)) {
        (Some(spread), Some(mean), Some(limits)) => {
            [mean, limits.lower, limits.upper].map(|value| value / spread)
        }
        _ => [f64::NAN; 3],
    }
}
