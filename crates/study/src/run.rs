//! One case, from its scene to frames and record.

use std::path::Path;

use snowlab_solver::timestep::step_length;
use snowlab_solver::{Real, Simulation};

use crate::assemble::{Assembly, assemble, time_unit};
use crate::frames::{Frame, Frames};
use crate::record::{HistoryRow, Outcome, RunRecord};
use crate::spec::scene::{EndFrom, PrecisionName};
use crate::spec::{SceneSpec, SpecError};

/// A scene that waits for a contact stops after so many time units without one (chosen: three times the flight of any
/// scene of the studies).
const LONGEST_FLIGHT: f64 = 20.0;

/// A run of more steps is refused before it begins (chosen: steps of a single particle take days).
const MOST_STEPS: f64 = 1e11;

/// What a run gives.
#[derive(Clone, Debug)]
pub struct Run<const D: usize> {
    /// Its frames; the first is the start, the last the end.
    pub frames: Frames<D>,
    /// How it went.
    pub record: RunRecord,
}

/// Something that wants to know how far a run is, and may see each frame's state.
pub trait Observer {
    /// Called after every step with the share of the run that is done, in [0, 1].
    fn progress(&mut self, share: f64, steps: u64);

    /// Called at every frame.
    fn frame<T: Real, const D: usize>(&mut self, simulation: &Simulation<T, D>);
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn progress(&mut self, _share: f64, _steps: u64) {}
    fn frame<T: Real, const D: usize>(&mut self, _simulation: &Simulation<T, D>) {}
}

/// Runs `spec` in the precision it asks for. Paths in it are relative to `folder`. A run that stops is a record, not an error.
///
/// # Errors
/// A scene that cannot be built.
pub fn run_scene<const D: usize>(
    spec: &SceneSpec,
    folder: &Path,
    observer: &mut impl Observer,
) -> Result<Run<D>, SpecError> {
    match spec.numerics.precision {
        PrecisionName::F64 => run::<f64, D>(spec, folder, observer),
        PrecisionName::F32 => run::<f32, D>(spec, folder, observer),
    }
}

fn run<T: Real, const D: usize>(
    spec: &SceneSpec,
    folder: &Path,
    observer: &mut impl Observer,
) -> Result<Run<D>, SpecError> {
    let Assembly { scene, state, made } = assemble::<T, D>(spec, folder)?;
    let unit = time_unit(&spec.output, made.crossing_time)?;
    let mut clock = FrameClock::new(spec, unit);
    let mut frames = Frames::new(&state);
    let mut simulation =
        Simulation::new(scene, state).map_err(|error| SpecError::value("scene", error.to_string()))?;
    check_steps(step_length(simulation.scene(), simulation.state()), clock.end)?;
    let mut history = Vec::new();
    let outcome = loop {
        if clock.is_frame(simulation.state().time) {
            frames.frames.push(Frame::of(simulation.state()));
            history.push(HistoryRow::of(&simulation));
            observer.frame(&simulation);
        }
        if simulation.state().time >= clock.end {
            break if clock.missed_contact() { no_contact(&clock) } else { Outcome::Ok };
        }
        if let Err(error) = simulation.advance_one(clock.next_frame()) {
            frames.frames.push(Frame::of(simulation.state()));
            history.push(HistoryRow::of(&simulation));
            break Outcome::stopped(&error);
        }
        clock.notice_contact(simulation.state().first_contact);
        observer.progress(simulation.state().time / clock.end, simulation.state().steps);
    };
    let record = RunRecord::of(&simulation, made, unit, history, outcome);
    Ok(Run { frames, record })
}

/// Refuses a run that no machine would end.
fn check_steps(first: f64, end: f64) -> Result<(), SpecError> {
    let steps = end / first;
    // Written so that a step that is no number is refused as well.
    if steps <= MOST_STEPS {
        return Ok(());
    }
    let message = format!(
        "takes {steps:.1e} steps of {first:.1e} s, the first one's length; allowed: {MOST_STEPS:e}; check spacing, \
         velocity, stiffness and density"
    );
    Err(SpecError::value("`output.end`", message))
}

fn no_contact(clock: &FrameClock) -> Outcome {
    Outcome::Stopped {
        reason: "no-contact".into(),
        message: format!(
            "nothing touched an obstacle within {:.3e} s; check positions and velocities",
            clock.end
        ),
    }
}

/// When frames are due: at multiples of the interval from the start, and once something has touched an obstacle, from
/// then on at multiples of the interval from that moment, so that frames of different arms are alike in phase.
#[derive(Clone, Debug)]
struct FrameClock {
    interval: f64,
    duration: f64,
    waits_for_contact: bool,
    anchor: f64,
    next: u64,
    end: f64,
}

impl FrameClock {
    fn new(spec: &SceneSpec, unit: f64) -> Self {
        let output = &spec.output;
        let (interval, duration) = (output.frame_interval * unit, output.end * unit);
        let waits_for_contact = output.end_from == EndFrom::Contact;
        let end = if waits_for_contact { LONGEST_FLIGHT * unit.max(duration) } else { duration };
        FrameClock { interval, duration, waits_for_contact, anchor: 0.0, next: 0, end }
    }

    /// Time of frame `index` since the anchor; the last frame is the end.
    fn due(&self, index: u64) -> f64 {
        let time = self.anchor + index as f64 * self.interval;
        // A multiple of the interval that misses the end by round-off is the end.
        if time > self.end - 1e-6 * self.interval { self.end } else { time }
    }

    fn is_frame(&mut self, time: f64) -> bool {
        let due = time >= self.due(self.next);
        if due {
            self.next += 1;
        }
        due
    }

    fn next_frame(&self) -> f64 {
        self.due(self.next)
    }

    fn notice_contact(&mut self, contact: Option<f64>) {
        if let (true, Some(time)) = (self.waits_for_contact, contact) {
            self.waits_for_contact = false;
            self.anchor = time;
            self.end = time + self.duration;
            self.next = 1;
        }
    }

    fn missed_contact(&self) -> bool {
        self.waits_for_contact
    }
}
