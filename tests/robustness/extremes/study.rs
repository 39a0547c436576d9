//! The arms of studies/extremes.toml: how each ends.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use snowlab_study::record::Outcome;
use snowlab_study::run::{Unobserved, run_scene};
use snowlab_study::spec::{SceneSpec, parse};
use snowlab_study::sweep::Study;

/// Arms that do not end `ok`, with words of the reason.
const ENDS: &[(&str, &str, &[&str])] = &[
    ("bounded", "ok-with-clamps", &[]),
    ("young-1e9", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    ("young-1e12", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    ("poisson-limit", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    ("speed-0.001", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    ("gravity-1e6", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    ("spin-1e6", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    (
        "mass-1e-12-stiff",
        "stopped(too-many-steps)",
        &["the fastest wave takes", "raise `numerics.max_steps`"],
    ),
    ("press", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    ("press-sticky", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    ("boxes-meet", "stopped(too-many-steps)", &["the fastest wave takes", "raise `numerics.max_steps`"]),
    (
        "trapezoidal-1e9",
        "stopped(too-many-steps)",
        &["halved the step 12 times", "raise `numerics.max_steps`"],
    ),
    (
        "step-0.9",
        "stopped(energy-rise)",
        &["energy rose", "the stability limit there is", "make `numerics.fixed_step` shorter"],
    ),
    (
        "step-1.1",
        "stopped(energy-rise)",
        &["energy rose", "the stability limit there is", "make `numerics.fixed_step` shorter"],
    ),
    (
        "step-2",
        "stopped(step-rejected)",
        &["cells in one step", "the stability limit there is", "make `numerics.fixed_step` shorter"],
    ),
    (
        "step-10",
        "stopped(step-rejected)",
        &["cells in one step", "the stability limit there is", "make `numerics.fixed_step` shorter"],
    ),
    (
        "step-1000",
        "stopped(step-rejected)",
        &["cells in one step", "the stability limit there is", "make `numerics.fixed_step` shorter"],
    ),
    (
        "step-2-unwatched",
        "stopped(step-rejected)",
        &["inside out", "the stability limit there is", "make `numerics.fixed_step` shorter"],
    ),
    (
        "step-10-implicit",
        "stopped(step-rejected)",
        &["cells in one step", "make `numerics.fixed_step` shorter"],
    ),
    ("solve-given-up", "stopped(step-rejected)", &["residual", "raise `max_iterations` or `tolerance`"]),
    ("none", "stopped(not-built)", &["has no point; a body has one or more"]),
    ("missed", "stopped(no-contact)", &["nothing touched an obstacle", "check positions and velocities"]),
    (
        "overlapping",
        "stopped(no-contact)",
        &["nothing touched an obstacle", "check positions and velocities"],
    ),
];

#[test]
fn every_arm_of_the_study_ends_as_it_is_known_to() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../studies/extremes.toml");
    let text = std::fs::read_to_string(&path).expect("the study is there");
    let study =
        Study::expand(parse(&text).expect("the study is accepted"), Some("smoke")).expect("the profile");
    let folder = path.parent().expect("a folder");
    let faults: Vec<String> = study
        .cases
        .par_iter()
        .filter_map(|case| {
            let outcome = outcome(&case.scene, folder);
            let (_, end, says) =
                ENDS.iter().copied().find(|(arm, ..)| *arm == case.arm).unwrap_or((&case.arm, "ok", &[]));
            let message = match &outcome {
                Outcome::Stopped { message, .. } => message.as_str(),
                _ => "",
            };
            let as_known = outcome.in_words() == end && says.iter().all(|words| message.contains(words));
            (!as_known)
                .then(|| format!("{}: {} ({message}), not {end} ({says:?})", case.arm, outcome.in_words()))
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let known = |arm: &str| study.cases.iter().any(|case| case.arm == arm);
    assert!(ENDS.iter().all(|(arm, ..)| known(arm)), "every arm of the table is run");
}

fn outcome(scene: &SceneSpec, folder: &Path) -> Outcome {
    let built = match scene.dimension {
        3 => run_scene::<3>(scene, folder, 1, &mut Unobserved).map(|run| run.record),
        _ => run_scene::<2>(scene, folder, 1, &mut Unobserved).map(|run| run.record),
    };
    built.map_or_else(|error| Outcome::not_built(error.to_string()), |record| record.outcome)
}
