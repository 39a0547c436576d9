//! How long steps take, by taking a few.

use std::path::Path;
use std::time::{Duration, Instant};

use serde::Serialize;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{Real, Simulation};

use crate::assemble::{Assembly, Made, assemble};
use crate::export::{Snapshot, csv_text};
use crate::spec::scene::PrecisionName;
use crate::spec::{SceneSpec, SpecError};
use crate::statistics::median;

/// Steps taken at a time (chosen: as many as the watchdog lets pass between its looks, so that each turn pays for one).
const TURN: u64 = 50;
/// An implicit step without its solve, in applications of its operator (docs/integrators.md: an application is 0.5 to 1.0 of an explicit step).
pub const STEP_IN_APPLICATIONS: u64 = 2;
/// Turns at the least, once each (chosen: a median of fewer is no median).
const TURNS: usize = 3;

/// A scene that takes steps on demand, of whatever dimension and precision.
pub trait Stepper {
    /// Takes so many steps; the time that has been simulated by them [s] and how often an implicit step's operator was applied.
    ///
    /// # Errors
    /// Why the run stopped.
    fn take(&mut self, steps: u64) -> Result<(f64, u64), String>;

    /// The particles as they are, as they are written.
    fn frame(&self) -> String;
}

impl<T: Real, const D: usize> Stepper for Simulation<T, D> {
    fn take(&mut self, steps: u64) -> Result<(f64, u64), String> {
        let (time, applied) = (self.time(), self.ledger().iterations);
        for _ in 0..steps {
            self.advance_one(f64::MAX).map_err(|error| error.to_string())?;
        }
        Ok((self.time() - time, self.ledger().iterations - applied))
    }

    fn frame(&self) -> String {
        let scene = self.scene();
        csv_text(&Snapshot::of_state(self.state(), &scene.materials, scene.spacing.as_f64()))
    }
}

/// A scene at its start.
pub struct Started {
    /// The run.
    pub run: Box<dyn Stepper>,
    /// What was built.
    pub made: Made,
    /// Length of its first step [s].
    pub first_step: f64,
}

/// The scene at its start, on so many threads. Its files are relative to `folder`.
///
/// # Errors
/// A scene that cannot be built.
pub fn start(spec: &SceneSpec, folder: &Path, threads: usize) -> Result<Started, SpecError> {
    match (spec.dimension, spec.numerics.precision) {
        (3, PrecisionName::F32) => build::<f32, 3>(spec, folder, threads),
        (3, PrecisionName::F64) => build::<f64, 3>(spec, folder, threads),
        (_, PrecisionName::F32) => build::<f32, 2>(spec, folder, threads),
        (_, PrecisionName::F64) => build::<f64, 2>(spec, folder, threads),
    }
}

fn build<T: Real, const D: usize>(
    spec: &SceneSpec,
    folder: &Path,
    threads: usize,
) -> Result<Started, SpecError> {
    let Assembly { scene, state, made } = assemble::<T, D>(spec, folder)?;
    let first_step = step_length(&scene, &state);
    let run = Simulation::with_threads(scene, state, threads)
        .map_err(|error| SpecError::value("scene", error.to_string()))?;
    Ok(Started { run: Box::new(run), made, first_step })
}

/// The pace of a scene at its start.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Pace {
    /// Wall time of a step [s].
    pub step: f64,
    /// Applications of an implicit step's operator in a step; 0 in explicit ones.
    pub applications: f64,
}

impl Pace {
    /// Wall time of a unit of work [s]: of an explicit step, or of an application of an implicit step's operator.
    pub fn unit(&self) -> f64 {
        if self.applications > 0.0 {
            self.step / (self.applications + STEP_IN_APPLICATIONS as f64)
        } else {
            self.step
        }
    }
}

/// Takes steps of `scene` for about so long.
///
/// # Errors
/// Why the run stopped.
pub fn pace(scene: &mut dyn Stepper, budget: Duration) -> Result<Pace, String> {
    // The first step makes the engine's memory.
    scene.take(1)?;
    let (began, mut steps, mut applied) = (Instant::now(), 0, 0);
    while steps == 0 || began.elapsed() < budget {
        applied += scene.take(1)?.1;
        steps += 1;
    }
    Ok(Pace {
        step: began.elapsed().as_secs_f64() / steps as f64,
        applications: applied as f64 / steps as f64,
    })
}

/// Wall time of a simulated second of `varied` over that of `base`, both taking steps by turns for about `budget`, and for three turns in any
/// case: the median over the turns, which other work on the machine disturbs less than either time.
///
/// # Errors
/// Why one of them stopped.
pub fn ratio(base: &mut dyn Stepper, varied: &mut dyn Stepper, budget: Duration) -> Result<f64, String> {
    base.take(1)?;
    varied.take(1)?;
    let (began, mut ratios) = (Instant::now(), Vec::new());
    while ratios.len() < TURNS || began.elapsed() < budget {
        ratios.push(turn(varied)? / turn(base)?);
    }
    Ok(median(&ratios).expect("there were turns"))
}

/// Wall time of a simulated second.
fn turn(scene: &mut dyn Stepper) -> Result<f64, String> {
    let began = Instant::now();
    let (simulated, _) = scene.take(TURN)?;
    Ok(began.elapsed().as_secs_f64() / simulated)
}
