//! Scenes at the ends of every range, put together at random: each ends `ok`, `ok-with-clamps` or stopped with a reason and a remedy, with
//! numbers in its tables and frames, or is refused in words that help. No panic, no hang.
//!
//! `SNOWLAB_EXTREME_SCENES` says how many scenes of each dimension are tried (by default a few seconds' worth):
//!
//! ```text
//! SNOWLAB_EXTREME_SCENES=20000 cargo test --release --locked -p snowlab-study --test robustness extremes -- --nocapture
//! ```

mod numerics;
mod scene;
mod study;

use std::collections::BTreeMap;
use std::path::Path;

use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngSeed, TestCaseError, TestRunner};
use snowlab_study::frames::Frames;
use snowlab_study::measure::measure;
use snowlab_study::record::{Outcome, RunRecord};
use snowlab_study::results::CaseResult;
use snowlab_study::run::{Unobserved, run_scene};
use snowlab_study::spec::study::MeasureSpec;
use snowlab_study::spec::{self, SceneSpec};
use snowlab_study::sweep::Case;
use snowlab_study::table::Cell;
use snowlab_study::tables::case_row;

use super::hostile::hold_refusal;
use super::hostile::watch::Watch;
use scene::{MOST_STEPS, scenes};

/// Scenes of each dimension where the environment does not say (chosen: some five seconds each).
const USUAL_SCENES: u32 = 400;
/// What says how many.
const VARIABLE: &str = "SNOWLAB_EXTREME_SCENES";
/// Scenes tried at most to make a fault simpler (chosen: some seconds).
const MOST_SHRUNK: u32 = 300;
/// Every reason that a run may stop for.
const REASONS: [&str; 6] =
    ["step-rejected", "energy-rise", "too-many-steps", "steps-too-short", "overflow", "no-contact"];
/// The watchdog looks at least every so many steps.
const CHECK_INTERVAL: u64 = 50;
/// A step is halved at most so often in a row; the watchdog goes back as often at most.
const MOST_HALVINGS: u64 = 13;

#[test]
fn scenes_in_2d_end_well_or_tell_why_not() {
    hold_scenes::<2>();
}

#[test]
fn scenes_in_3d_end_well_or_tell_why_not() {
    hold_scenes::<3>();
}

fn hold_scenes<const D: usize>() {
    let cases =
        std::env::var(VARIABLE).map_or(USUAL_SCENES, |text| text.parse().expect("a number of scenes"));
    let config = Config {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(D as u64),
        max_shrink_iters: MOST_SHRUNK,
        ..Config::default()
    };
    let mut ends: BTreeMap<String, u32> = BTreeMap::new();
    let tally = std::cell::RefCell::new(&mut ends);
    let scenes = scenes::<D>().prop_map(|scene| scene.to_string());
    let held = TestRunner::new(config).run(&scenes, |text| {
        let _watch = Watch::over(text.clone());
        let end = hold_scene::<D>(&text).map_err(TestCaseError::fail)?;
        *tally.borrow_mut().entry(end).or_default() += 1;
        Ok(())
    });
    println!("{D}D: {ends:?}");
    held.unwrap_or_else(|fault| panic!("{fault}"));
    // Each kind of end must come up, or nothing is tested.
    let all: u32 = ends.values().sum();
    for kind in ["ok", "ok-with-clamps", "stopped(step-rejected)", "stopped(too-many-steps)", "refused"] {
        assert!(ends.contains_key(kind), "no scene of {all} ended {kind}: {ends:?}");
    }
}

/// Runs a scene; how it ended.
fn hold_scene<const D: usize>(text: &str) -> Result<String, String> {
    let scene: SceneSpec =
        spec::parse(text).map_err(|error| format!("the scene is not read: {error}\n{text}"))?;
    match run_scene::<D>(&scene, Path::new("/nowhere"), 1, &mut Unobserved) {
        Ok(run) => {
            hold_frames(&run.frames)?;
            hold_record(&scene, &run.record)?;
            let end = run.record.outcome.in_words();
            hold_row(scene, &run.frames, run.record)?;
            Ok(end)
        }
        Err(error) => {
            hold_refusal(&error.to_string(), text);
            Ok("refused".into())
        }
    }
}

fn hold_frames<const D: usize>(frames: &Frames<D>) -> Result<(), String> {
    for frame in &frames.frames {
        // Frames are in f32, in which J_P may be infinite: material torn without end.
        let finite = frame.positions.iter().flatten().all(|x| x.is_finite())
            && frame.plastic_ratios.iter().all(|ratio| *ratio >= 0.0);
        hold(finite, || format!("a frame at t = {} s has what is no number", frame.time))?;
    }
    hold(!frames.frames.is_empty(), || "there is no frame".into())
}

fn hold_record(scene: &SceneSpec, record: &RunRecord) -> Result<(), String> {
    if let Outcome::Stopped { reason, message } = &record.outcome {
        hold(REASONS.contains(&reason.as_str()), || format!("stopped for {reason}"))?;
        let remedies = ["`numerics.", "`max_iterations`", "`hardening`", "check ", "look for "];
        hold(remedies.iter().any(|remedy| message.contains(remedy)), || format!("no remedy: {message}"))?;
        hold(!message.contains("NaN"), || message.clone())?;
    }
    hold(record.steps <= scene.numerics.max_steps.min(MOST_STEPS), || format!("{} steps", record.steps))?;
    // Steps that the watchdog takes back, as many as lie between its checks, may have been halved too.
    let tried = (record.steps + CHECK_INTERVAL) * (record.watchdog_restores + 1);
    hold(record.watchdog_restores <= MOST_HALVINGS, || format!("{} restores", record.watchdog_restores))?;
    hold(record.rejected_steps <= tried * MOST_HALVINGS, || format!("{} refused", record.rejected_steps))
}

/// The case's row has numbers alone; what is not there is empty.
fn hold_row<const D: usize>(scene: SceneSpec, frames: &Frames<D>, record: RunRecord) -> Result<(), String> {
    let spec = MeasureSpec {
        largest_spacing: scene.numerics.spacing,
        link_ratio: 2.0,
        min_mass_share: 0.002,
        bodies: scene.body.len(),
        settle_window: 1.0,
    };
    let measured = match record.outcome {
        Outcome::Stopped { .. } => None,
        _ => Some(measure(&spec, &scene, frames, &record)),
    };
    let (metrics, unmeasured) = match measured {
        Some(Ok(metrics)) => (Some(metrics), None),
        Some(Err(error)) => (None, Some(error)),
        None => (None, None),
    };
    let case = Case { arm: "random".into(), block: scene.seed, axes: Vec::new(), scene };
    let row = case_row(&CaseResult { case, key: String::new(), record, metrics, unmeasured, manifest: None });
    for (definition, cell) in row.entries() {
        // Without voids there is no narrowest one.
        let number = !matches!(cell, Cell::Number(number) if !number.is_finite());
        hold(number || definition.name == "least_void_width", || {
            format!("`{}` is {cell:?}", definition.name)
        })?;
    }
    Ok(())
}

fn hold(holds: bool, fault: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(fault()) }
}
