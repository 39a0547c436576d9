//! A run in the small: the same scene on a coarser grid with as many particles to a cell, whose course tells how many steps the scene will take
//! and what becomes of it.

use std::path::Path;
use std::time::{Duration, Instant};

use serde::Serialize;
use snowlab_solver::{Real, Simulation};

use super::Advice;
use crate::pace::STEP_IN_APPLICATIONS;
use crate::record::RunRecord;
use crate::run::{Observer, run_scene};
use crate::spec::{SceneSpec, SpecError};

/// Particles of the coarsest rehearsal, at the least (chosen: a disc of so many has four cells across its radius at four to a cell, and still
/// breaks).
const FEWEST: f64 = 200.0;
/// A rehearsal may take so much of the run's own time, and so long in any case (chosen: a look before a run of an hour takes two minutes at most,
/// one before a short run is soon over).
const AFFORDABLE: (f64, f64) = (0.03, 3.0);
/// Steps whose pace is taken for that at the start (chosen: as many as the watchdog lets pass between its looks).
const FIRST_STEPS: u64 = 50;
/// Steps in which snow yields take longer than the first ones, within this range (measured: 1.0 to 1.3 in the arms of studies/placement.toml);
/// what lies beyond it is other work on the machine.
const SLOWING: (f64, f64) = (1.0, 1.5);
/// Steps after which a rehearsal is given up (chosen: some seconds of a few hundred particles).
const MOST_STEPS: u64 = 200_000;
/// Where hardening shortens steps it does so the more, the finer the grid: steps go with h to the power -(1 + this) (measured: 0.06 to 0.6, mean
/// 0.2, between 2 h and h in the arms of studies/placement.toml). Waves alone give -1.
const HARDENING_GROWTH: f64 = 0.2;
/// Steps over those of the first one's length, above which hardening is taken to shorten them (chosen: elastic runs have 1.0 to 1.2).
const HARDENED: f64 = 1.3;

/// One run in the small.
#[derive(Clone, Debug, Serialize)]
pub struct Rehearsal {
    /// Its spacing over the scene's.
    pub coarser: usize,
    /// Steps taken.
    pub steps: u64,
    /// Steps and applications of an implicit step's operator: what time goes with.
    pub work: u64,
    /// Steps over what they would be if all were as long as the first.
    pub hardening: f64,
    /// Time per step over that of its first steps.
    pub slowing: f64,
    /// How it ended, in words.
    pub outcome: String,
    /// Why, where it stopped.
    pub stopped: Option<String>,
    /// Whether that was for the number of its steps.
    pub given_up: bool,
    /// Lost to plastic flow [J].
    pub plastic_loss: f64,
    /// Numbers of the obstacles that nothing touched.
    pub untouched: Vec<usize>,
    /// Times the watchdog went back.
    pub watchdog_restores: u64,
    /// Steps tried and refused.
    pub rejected_steps: u64,
    /// End [s].
    pub end_time: f64,
}

/// Runs the scene on coarser grids, the coarsest first, each twice as fine as the one before while that is affordable; none for particles of a
/// file, nor on grids on which the scene cannot be built, such as one that has no row of nodes at a mirror. `seconds` predicts the time of the
/// run [s] from a rehearsal.
pub fn rehearse(
    spec: &SceneSpec,
    folder: &Path,
    particles: usize,
    seconds: impl Fn(&Rehearsal) -> f64,
) -> Vec<Rehearsal> {
    let share = |coarser: usize| (coarser as f64).powi(-(spec.dimension as i32));
    let coarsest =
        (1..).map(|k| 1 << k).take_while(|&coarser| particles as f64 * share(coarser) >= FEWEST).last();
    let (mut coarser, mut rehearsals) = (coarsest.unwrap_or(2), Vec::new());
    while let Some(scene) = coarsened(spec, coarser).filter(|_| coarser > 1) {
        let small = run(&scene, folder, coarser).ok();
        coarser /= 2;
        let Some(small) = small else { continue };
        let whole = seconds(&small);
        rehearsals.push(small);
        let next = whole * share(coarser) / coarser as f64;
        if next > (AFFORDABLE.0 * whole).max(AFFORDABLE.1) {
            break;
        }
    }
    rehearsals
}

fn run(spec: &SceneSpec, folder: &Path, coarser: usize) -> Result<Rehearsal, SpecError> {
    let mut pace = Pace::begin();
    let record = match spec.dimension {
        3 => run_scene::<3>(spec, folder, 1, &mut pace)?.record,
        _ => run_scene::<2>(spec, folder, 1, &mut pace)?.record,
    };
    let facts = super::facts(spec, folder)?;
    let last = record.history.last();
    let untouched = |impulses: &Vec<Vec<f64>>| {
        let is_nothing = |impulse: &Vec<f64>| impulse.iter().all(|component| *component == 0.0);
        impulses.iter().enumerate().filter(|(_, impulse)| is_nothing(impulse)).map(|(k, _)| k).collect()
    };
    Ok(Rehearsal {
        coarser,
        steps: record.steps,
        work: work(&record),
        hardening: record.steps as f64 * facts.first_step / record.end_time,
        slowing: pace.slowing(),
        outcome: record.outcome.in_words(),
        stopped: record.outcome.message().map(str::to_string),
        given_up: record.steps >= MOST_STEPS,
        plastic_loss: last.map_or(0.0, |row| row.plastic_loss),
        untouched: last.map_or(Vec::new(), |row| untouched(&row.impulses)),
        watchdog_restores: record.watchdog_restores,
        rejected_steps: record.rejected_steps,
        end_time: record.end_time,
    })
}

fn work(record: &RunRecord) -> u64 {
    match record.iterations {
        0 => record.steps,
        iterations => iterations + STEP_IN_APPLICATIONS * record.steps,
    }
}

impl Rehearsal {
    /// Wall time of the scene itself [s], a unit of whose work takes `unit` at its start [s].
    pub fn seconds(&self, unit: f64) -> f64 {
        self.scaled(self.work) * unit * self.slowing
    }

    /// What is `count` here, in the scene itself, by how steps go with the spacing.
    pub fn scaled(&self, count: u64) -> f64 {
        let growth = if self.hardening > HARDENED { HARDENING_GROWTH } else { 0.0 };
        count as f64 * libm::pow(self.coarser as f64, 1.0 + growth)
    }

    /// Given up, it says how long the run is at the least; stopped, what may stop the run.
    pub fn hazard(&self) -> Option<Advice> {
        let (coarser, reason) = (self.coarser, self.stopped.as_ref()?);
        if self.given_up {
            let finding = format!(
                "the run takes more than {:.0e} steps: its rehearsal on a grid {coarser} times as coarse was given up at t = {:.2e} s",
                self.scaled(self.steps),
                self.end_time
            );
            return Some(Advice::new(
                "output.end",
                finding,
                "end the run earlier, or soften or slow what makes the steps short",
            ));
        }
        let finding = format!("the rehearsal on a grid {coarser} times as coarse stopped: {reason}");
        Some(Advice::new(
            "numerics",
            finding,
            "see what else is said here; a run that stops has its reason in its record",
        ))
    }
}

/// The scene on a grid so many times as coarse, with as many particles to a cell and the voids it has; `None` for particles of a file. Only its
/// last frames are kept.
fn coarsened(spec: &SceneSpec, coarser: usize) -> Option<SceneSpec> {
    let wider = coarser as f64;
    let mut scene = spec.on_grid(wider * spec.numerics.spacing, wider.powi(-(spec.dimension as i32)))?;
    // Steps as long for their cells.
    scene.numerics.fixed_step = spec.numerics.fixed_step.map(|dt| dt * wider);
    scene.numerics.max_steps = MOST_STEPS;
    scene.output.frame_interval = scene.output.end;
    Some(scene)
}

/// How fast steps follow one another at first and in all.
struct Pace {
    began: Option<Instant>,
    first: Duration,
    all: Duration,
    steps: u64,
}

impl Pace {
    fn begin() -> Self {
        Pace { began: None, first: Duration::ZERO, all: Duration::ZERO, steps: 0 }
    }

    /// Time per step over that of the first ones; 1 where there are too few to tell.
    fn slowing(&self) -> f64 {
        if self.steps < 2 * FIRST_STEPS || self.first.is_zero() {
            return 1.0;
        }
        let first = self.first.as_secs_f64() / FIRST_STEPS as f64;
        ((self.all.as_secs_f64() / self.steps as f64) / first).clamp(SLOWING.0, SLOWING.1)
    }
}

impl Observer for Pace {
    fn progress(&mut self, _share: f64, steps: u64) {
        // The first step makes the engine's memory.
        let Some(began) = self.began else {
            self.began = Some(Instant::now());
            return;
        };
        (self.all, self.steps) = (began.elapsed(), steps.saturating_sub(1));
        if self.steps == FIRST_STEPS {
            self.first = self.all;
        }
    }

    fn frame<T: Real, const D: usize>(&mut self, _simulation: &Simulation<T, D>) {}
}

#[cfg(test)]
mod tests {
    use super::Rehearsal;

    fn small(hardening: f64) -> Rehearsal {
        Rehearsal {
            coarser: 4,
            steps: 100,
            work: 100,
            hardening,
            slowing: 1.0,
            outcome: "ok".into(),
            stopped: None,
            given_up: false,
            plastic_loss: 0.0,
            untouched: Vec::new(),
            watchdog_restores: 0,
            rejected_steps: 0,
            end_time: 1.0,
        }
    }

    #[test]
    fn steps_go_with_the_spacing_and_more_where_snow_hardens() {
        assert_eq!(small(1.0).scaled(100), 400.0);
        assert!((small(6.0).scaled(100) - 100.0 * 4.0_f64.powf(1.2)).abs() < 1e-9);
    }

    #[test]
    fn what_stops_a_rehearsal_is_told_of_the_run() {
        assert!(small(1.0).hazard().is_none());
        let stopped = Rehearsal { stopped: Some("a step failed".into()), ..small(1.0) };
        let told = stopped.hazard().expect("it stopped").to_string();
        assert!(told.contains("on a grid 4 times as coarse stopped: a step failed"), "{told}");
        let given_up = Rehearsal { steps: 50_000, given_up: true, end_time: 0.25, ..stopped };
        let told = given_up.hazard().expect("it stopped").to_string();
        // Four times the steps of the rehearsal, which took no account of hardening.
        assert!(told.contains("`output.end`: the run takes more than 2e5 steps"), "{told}");
        assert!(told.contains("given up at t = 2.50e-1 s"), "{told}");
    }
}
