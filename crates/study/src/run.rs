//! One case, from its scene to frames and record.

use std::path::Path;

use snowlab_solver::timestep::step_length;
use snowlab_solver::{Real, Scene, Simulation, SimulationError, State};

use crate::assemble::{Assembly, assemble, time_unit};
use crate::frames::{Frame, Frames};
use crate::keeper::{Keeper, Pause, Unkept, Wish};
use crate::record::{HistoryRow, Outcome, RunRecord};
use crate::spec::scene::{EndFrom, OutputSpec, PrecisionName};
use crate::spec::{SceneSpec, SpecError};
use crate::store::StoreError;

/// A scene that waits for a contact stops after so many time units without one (chosen: three times the flight of any
/// scene of the studies).
const LONGEST_FLIGHT: f64 = 20.0;

/// A run of more steps is refused before it begins (chosen: steps of a single particle take days).
const MOST_STEPS: f64 = 1e11;
/// So many steps apart it is asked how many are left (chosen: the question costs a copy of the state).
const STALL_INTERVAL: u64 = 1024;

/// What a run gives.
#[derive(Clone, Debug)]
pub struct Run<const D: usize> {
    /// Its frames; the first is the start, the last the end.
    pub frames: Frames<D>,
    /// How it went.
    pub record: RunRecord,
}

/// How a run ended.
#[derive(Debug)]
pub enum Ended<const D: usize> {
    /// It has come to its end.
    Run(Box<Run<D>>),
    /// It was put away on the way.
    Paused(Pause),
    /// It had to stop on the way and could not be put away: what it did since the checkpoint before is lost.
    Lost(StoreError),
}

/// Something that wants to know how far a run is, and may see each frame's state.
pub trait Observer {
    /// Called after every step with the share of the run that is done, in [0, 1].
    fn progress(&mut self, share: f64, steps: u64);

    /// Called at every frame that is kept, in the order of time; none is taken back.
    fn frame<T: Real, const D: usize>(&mut self, simulation: &Simulation<T, D>);

    /// Called where the run could not be put away and goes on.
    fn not_put_away(&mut self, _error: &StoreError) {}
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn progress(&mut self, _share: f64, _steps: u64) {}
    fn frame<T: Real, const D: usize>(&mut self, _simulation: &Simulation<T, D>) {}
}

/// Runs `spec` in the precision it asks for, on so many threads, whose number shows in no result. Paths in it are relative to `folder`. A run
/// that stops is a record, not an error.
///
/// # Errors
/// A scene that cannot be built.
pub fn run_scene<const D: usize>(
    spec: &SceneSpec,
    folder: &Path,
    threads: usize,
    observer: &mut impl Observer,
) -> Result<Run<D>, SpecError> {
    match run_kept::<D>(spec, folder, threads, observer, &mut Unkept)? {
        Ended::Run(run) => Ok(*run),
        Ended::Paused(_) | Ended::Lost(_) => unreachable!("a run that is kept nowhere is not put away"),
    }
}

/// As [`run_scene`]. The run goes on where `keeper` has it from, and is put away when `keeper` wishes; neither shows in its bytes.
///
/// # Errors
/// A scene that cannot be built.
pub fn run_kept<const D: usize>(
    spec: &SceneSpec,
    folder: &Path,
    threads: usize,
    observer: &mut impl Observer,
    keeper: &mut impl Keeper,
) -> Result<Ended<D>, SpecError> {
    match spec.numerics.precision {
        PrecisionName::F64 => run::<f64, D>(spec, folder, threads, observer, keeper),
        PrecisionName::F32 => run::<f32, D>(spec, folder, threads, observer, keeper),
    }
}

fn run<T: Real, const D: usize>(
    spec: &SceneSpec,
    folder: &Path,
    threads: usize,
    observer: &mut impl Observer,
    keeper: &mut impl Keeper,
) -> Result<Ended<D>, SpecError> {
    let Assembly { scene, state, made } = assemble::<T, D>(spec, folder)?;
    let unit = time_unit(&spec.output, made.crossing_time)?;
    let clock = FrameClock::new(&spec.output, unit);
    let (mut simulation, mut kept) = match taken_up(&scene, &state, threads, keeper) {
        Some(resumed) => resumed,
        None => begun(scene, state, threads, &clock)?,
    };
    let outcome = loop {
        if let Some(ended) = put_away(&simulation, &clock, &kept, keeper, observer) {
            return Ok(ended);
        }
        match advance(&mut simulation, &clock, &mut kept, observer) {
            Ok(None) => {}
            Ok(Some(outcome)) => break outcome,
            Err(error) => {
                kept.keep_last(&simulation, observer);
                break Outcome::stopped(&error, &simulation);
            }
        }
    };
    let record = RunRecord::of(&simulation, made, unit, kept.history, outcome);
    Ok(Ended::Run(Box::new(Run { frames: kept.frames, record })))
}

/// A run at its beginning.
fn begun<T: Real, const D: usize>(
    scene: Scene<T, D>,
    state: State<T, D>,
    threads: usize,
    clock: &FrameClock,
) -> Result<(Simulation<T, D>, Kept<D>), SpecError> {
    let kept = Kept { frames: Frames::new(&state), history: Vec::new() };
    let simulation = Simulation::with_threads(scene, state, threads)
        .map_err(|error| SpecError::value("scene", error.to_string()))?;
    if !HistoryRow::of(&simulation).is_finite() {
        let advice = "use \"f64\", or lower densities, speeds and stiffness";
        return Err(SpecError::value(
            "`numerics.precision`",
            format!("is outgrown by the energies at the start; {advice}"),
        ));
    }
    check_steps(step_length(simulation.scene(), simulation.state()), clock.end(None))?;
    Ok((simulation, kept))
}

/// A run where `keeper` has it from; `None` where it has none that fits.
fn taken_up<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    start: &State<T, D>,
    threads: usize,
    keeper: &mut impl Keeper,
) -> Option<(Simulation<T, D>, Kept<D>)> {
    let taken = keeper.take::<T, D>()?;
    let begun = Frames::new(start);
    let resumed = || -> Result<_, String> {
        let frames = Frames::from_bytes(&taken.frames)?;
        let rows = (frames.frames.len(), taken.history.len());
        if frames.masses != begun.masses || frames.origin != begun.origin || rows.0 != rows.1 {
            return Err("its frames are of another run".into());
        }
        if taken.simulation.particles() != begun.masses.len() {
            return Err("it has another number of particles".into());
        }
        let simulation = Simulation::resume(scene.clone(), taken.simulation, threads);
        Ok((simulation.map_err(|error| error.to_string())?, Kept { frames, history: taken.history }))
    };
    resumed().map_err(|reason| keeper.refuse(&reason)).ok()
}

/// Puts the run away where `keeper` wishes so and it can be done; how it ended, if it should stop then.
fn put_away<T: Real, const D: usize>(
    simulation: &Simulation<T, D>,
    clock: &FrameClock,
    kept: &Kept<D>,
    keeper: &mut impl Keeper,
    observer: &mut impl Observer,
) -> Option<Ended<D>> {
    let wish = keeper.wish(simulation.steps());
    if wish == Wish::GoOn {
        return None;
    }
    let checkpoint = simulation.checkpoint()?;
    let share = simulation.time() / clock.end(simulation.first_contact());
    match (wish, keeper.put(share, kept.frames.to_bytes(), &kept.history, checkpoint)) {
        (Wish::Stop(pause), Ok(())) => Some(Ended::Paused(pause)),
        (Wish::Stop(_), Err(error)) => Some(Ended::Lost(error)),
        (_, Ok(())) => None,
        (_, Err(error)) => {
            observer.not_put_away(&error);
            None
        }
    }
}

/// Keeps a frame where one is due, then takes a step; an outcome where the run is at its end.
fn advance<T: Real, const D: usize>(
    simulation: &mut Simulation<T, D>,
    clock: &FrameClock,
    kept: &mut Kept<D>,
    observer: &mut impl Observer,
) -> Result<Option<Outcome>, SimulationError> {
    let (time, contact) = (simulation.time(), simulation.first_contact());
    if time >= clock.next_frame(kept.latest(), contact) {
        // Only what the watchdog has accepted is kept, and it never goes back beyond that.
        if !simulation.confirm()? {
            return Ok(None);
        }
        if !kept.keep(simulation, observer) {
            return Ok(Some(overflow(time)));
        }
    }
    if time >= clock.end(contact) {
        return Ok(Some(if clock.missed_contact(contact) { no_contact(time) } else { Outcome::Ok }));
    }
    if let Some(outcome) = stalled(simulation, clock.end(contact)) {
        kept.keep_last(simulation, observer);
        return Ok(Some(outcome));
    }
    if let Err(error) = simulation.advance_one(clock.next_frame(kept.latest(), contact)) {
        // A state that the watchdog refuses is none to stop at: the run goes on from the one it went back to.
        return if simulation.confirm()? { Err(error) } else { Ok(None) };
    }
    observer.progress(simulation.time() / clock.end(simulation.first_contact()), simulation.steps());
    Ok(None)
}

/// What is kept of a run: a frame and a row of history for each of the same times.
struct Kept<const D: usize> {
    frames: Frames<D>,
    history: Vec<HistoryRow>,
}

impl<const D: usize> Kept<D> {
    fn latest(&self) -> Option<f64> {
        self.frames.frames.last().map(|frame| frame.time)
    }

    /// `false` where there is nothing to keep: energies have outgrown the precision.
    fn keep<T: Real>(&mut self, simulation: &Simulation<T, D>, observer: &mut impl Observer) -> bool {
        let row = HistoryRow::of(simulation);
        if !row.is_finite() {
            return false;
        }
        self.frames.frames.push(Frame::of(simulation.state()));
        self.history.push(row);
        observer.frame(simulation);
        true
    }

    /// Keeps the state that a run stopped at, unless it is a frame already.
    fn keep_last<T: Real>(&mut self, simulation: &Simulation<T, D>, observer: &mut impl Observer) {
        if self.latest().is_none_or(|latest| simulation.time() > latest) {
            self.keep(simulation, observer);
        }
    }
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

/// Stops a run that no machine would end, whose steps have become too short on the way. The state alone decides, so that a run that goes on
/// from a checkpoint stops where it would have stopped.
fn stalled<T: Real, const D: usize>(simulation: &Simulation<T, D>, end: f64) -> Option<Outcome> {
    if !simulation.steps().is_multiple_of(STALL_INTERVAL) {
        return None;
    }
    let (dt, time) = (step_length(simulation.scene(), simulation.state()), simulation.time());
    let left = (end - time) / dt;
    // Written so that a step that is no number stops, too.
    (!(left <= MOST_STEPS)).then(|| Outcome::Stopped {
        reason: "steps-too-short".into(),
        message: format!(
            "at t = {time:.6e} s: {left:.1e} steps of {dt:.1e} s are left, more than {MOST_STEPS:e}; material has become \
             too stiff or too fast: lower `hardening` or speed, or set `hardening_limit` or `plastic_ratio_bounds`"
        ),
    })
}

fn overflow(time: f64) -> Outcome {
    Outcome::Stopped {
        reason: "overflow".into(),
        message: format!(
            "at t = {time:.6e} s: energies outgrow the precision; shorten the steps, leave the watchdog on, or use `numerics.precision` = \"f64\""
        ),
    }
}

fn no_contact(time: f64) -> Outcome {
    Outcome::Stopped {
        reason: "no-contact".into(),
        message: format!("nothing touched an obstacle within {time:.3e} s; check positions and velocities"),
    }
}

/// The time up to which a run of the given output can go [s]: its end, or how long it waits for a contact from which the end counts.
/// `unit` is one of the output's time units [s].
pub fn latest_end(output: &OutputSpec, unit: f64) -> f64 {
    FrameClock::new(output, unit).end(None)
}

/// When frames are due: at multiples of the interval from the start, and once something has touched an obstacle, from
/// then on at multiples of the interval from that moment, so that frames of different arms are alike in phase. All follows
/// from the latest frame and the first contact, so that a run that goes back in time leaves nothing to put right.
#[derive(Clone, Debug)]
struct FrameClock {
    interval: f64,
    duration: f64,
    from_contact: bool,
    longest_flight: f64,
}

impl FrameClock {
    fn new(output: &OutputSpec, unit: f64) -> Self {
        let (interval, duration) = (output.frame_interval * unit, output.end * unit);
        let longest_flight = LONGEST_FLIGHT * unit.max(duration);
        FrameClock { interval, duration, from_contact: output.end_from == EndFrom::Contact, longest_flight }
    }

    /// When the run ends [s], if the first contact was at `contact`.
    fn end(&self, contact: Option<f64>) -> f64 {
        match (self.from_contact, contact) {
            (false, _) => self.duration,
            (true, Some(contact)) => contact + self.duration,
            (true, None) => self.longest_flight,
        }
    }

    /// When the frame after `latest` is due [s]; the last frame is the end.
    fn next_frame(&self, latest: Option<f64>, contact: Option<f64>) -> f64 {
        let anchor = contact.filter(|_| self.from_contact).unwrap_or(0.0);
        // A multiple of the interval that misses a frame or the end by round-off is that frame or the end.
        let index =
            latest.map_or(0.0, |time| ((time - anchor) / self.interval + 1e-6).floor().max(0.0) + 1.0);
        let (time, end) = (anchor + index * self.interval, self.end(contact));
        if time > end - 1e-6 * self.interval { end } else { time }
    }

    fn missed_contact(&self, contact: Option<f64>) -> bool {
        self.from_contact && contact.is_none()
    }
}
