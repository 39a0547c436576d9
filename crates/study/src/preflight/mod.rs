//! What a scene will meet, take and not need, told before it is run.
//!
//! ```text
//! scene -> assemble -> Facts -> hazards
//!                        |-> rehearse (coarser grids) -> steps, what yields, what is touched
//!                        |-> pace (a few steps) --------> time
//!                        `-> needless (by turns) -------> what could be left out, and what that saves
//! ```

mod approach;
mod facts;
mod hazards;
mod needless;
mod rehearsal;

pub use facts::{Facts, StepBound};
pub use hazards::{Advice, hazards};
pub use needless::Needless;
pub use rehearsal::Rehearsal;

use std::path::Path;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::assemble::assemble;
use crate::memory::frames;
use crate::pace::{Pace, Stepper, pace, start};
use crate::spec::{SceneSpec, SpecError};

/// All of it.
#[derive(Clone, Debug, Serialize)]
pub struct Preflight {
    /// Numbers of the scene at its start.
    pub facts: Facts,
    /// Runs of it in the small, the coarsest first.
    pub rehearsals: Vec<Rehearsal>,
    /// What the run will take; `None` where its first steps fail.
    pub predicted: Option<Predicted>,
    /// What is about to go wrong, the worst first.
    pub hazards: Vec<Advice>,
    /// What the scene does not need.
    pub needless: Vec<Needless>,
}

/// What a run will take.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Predicted {
    /// Steps.
    pub steps: f64,
    /// Wall time [s] on so many threads as were asked for: building, steps and frames.
    pub seconds: f64,
    /// Share of it that building the scene and writing frames take.
    pub around: f64,
}

/// How long is spent on the pace of the scene, and on each feature (chosen: a second of both in a scene with two features; more only where fifty
/// steps take longer).
const BUDGET: Duration = Duration::from_millis(300);

/// Looks into a scene whose files are relative to `folder`, for a run on so many threads.
///
/// # Errors
/// A scene that cannot be built.
pub fn preflight(spec: &SceneSpec, folder: &Path, threads: usize) -> Result<Preflight, SpecError> {
    let began = Instant::now();
    let facts = facts(spec, folder)?;
    let building = began.elapsed().as_secs_f64();
    let mut endless = spec.clone();
    endless.numerics.max_steps = i64::MAX as u64;
    let mut run = start(&endless, folder, threads)?.run;
    let around = building + writing(spec, run.as_ref(), threads);
    let pace = pace(run.as_mut(), BUDGET);
    drop(run);
    // Where its own first steps fail, the scene is rehearsed all the same, for what that tells.
    let step = pace.as_ref().map_or(0.0, |pace| pace.unit());
    let rehearsals = rehearsal::rehearse(spec, folder, facts.particles, |small| small.seconds(step));
    let predicted = pace.as_ref().ok().map(|pace| predict(&facts, pace, rehearsals.last(), around));
    let mut hazards = hazards(spec, &facts);
    hazards.extend(rehearsals.last().and_then(Rehearsal::hazard));
    hazards.extend(pace.err().map(|message| Advice::new("numerics", message, "see what else is said here")));
    hazards.extend(predicted.and_then(|predicted| too_many_steps(spec, &predicted)));
    let needless = match predicted {
        Some(_) => needless::needless(&endless, &facts, &rehearsals, folder, threads, BUDGET)?,
        None => Vec::new(),
    };
    Ok(Preflight { facts, rehearsals, predicted, hazards, needless })
}

/// What needs no step taken.
///
/// # Errors
/// A scene that cannot be built.
pub fn facts(spec: &SceneSpec, folder: &Path) -> Result<Facts, SpecError> {
    match spec.dimension {
        3 => Facts::of(spec, folder, &assemble::<f64, 3>(spec, folder)?),
        _ => Facts::of(spec, folder, &assemble::<f64, 2>(spec, folder)?),
    }
}

/// What writing the frames adds to the run [s]: a thread of its own writes them, which costs nothing where a core is left for it, and else its share
/// of the cores that the steps have.
fn writing(spec: &SceneSpec, run: &dyn Stepper, threads: usize) -> f64 {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if threads < cores {
        return 0.0;
    }
    let began = Instant::now();
    std::hint::black_box(run.frame());
    frames(spec) * began.elapsed().as_secs_f64() / cores as f64
}

/// By the finest rehearsal, or as if all steps were as long as the first one; `around` is what building and writing take [s].
fn predict(facts: &Facts, pace: &Pace, finest: Option<&Rehearsal>, around: f64) -> Predicted {
    let first = facts.duration / facts.first_step;
    let steps = finest.map_or(first, |small| small.scaled(small.steps));
    let running = finest.map_or(first * pace.step, |small| small.seconds(pace.unit()));
    Predicted { steps, seconds: around + running, around: around / (around + running) }
}

fn too_many_steps(spec: &SceneSpec, predicted: &Predicted) -> Option<Advice> {
    let most = spec.numerics.max_steps;
    let finding =
        format!("is {most}, and the run takes about {:.1e} steps: it stops before its end", predicted.steps);
    (predicted.steps > most as f64)
        .then(|| Advice::new("numerics.max_steps", finding, "raise it, or end the run earlier"))
}
