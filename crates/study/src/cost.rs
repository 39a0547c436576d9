//! What a case will take: particle-steps from earlier results of the same case or arm, and time from cases run on this machine, or from a short
//! trial of each arm.

use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

use serde::Serialize;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{Real, Simulation};

use crate::assemble::{Assembly, assemble, time_unit};
use crate::attempt::host;
use crate::plan::Status;
use crate::results::Archive;
use crate::spec::scene::{EndFrom, PrecisionName, TimeUnit};
use crate::spec::{SceneSpec, SpecError};
use crate::statistics::median;
use crate::sweep::Case;

/// Where a prediction comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The same case has been run before.
    Case,
    /// Others of its arm have.
    Arm,
    /// Nothing like it has: its first step's length.
    FirstStep,
}

/// What a case will take.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// Steps times particles.
    pub particle_steps: f64,
    /// Wall time on one thread [s].
    pub seconds: f64,
    /// Where the steps come from.
    pub basis: Basis,
}

/// A trial of an arm goes on for so long (chosen: some hundred steps of the studies' scenes).
const TRIAL: Duration = Duration::from_millis(300);
/// A case over a trial of it, per particle-step: a trial sees the flight, not the impact, where plastic flow costs more, and neither placing nor
/// measuring (measured: the arms of `studies/placement.toml` have 1.0 to 1.3).
const CASE_OVER_TRIAL: f64 = 1.15;
/// Time per particle-step where there is no trial [ns] (chosen: what one thread takes in 2D).
const USUAL: f64 = 40.0;
/// A run that ends some time after its first contact, over that time (chosen: flights of the studies are a quarter of it).
const WITH_FLIGHT: f64 = 1.25;

/// Particle-steps of earlier results.
#[derive(Debug, Default)]
struct Known {
    by_key: HashMap<String, f64>,
    by_arm: BTreeMap<String, Vec<f64>>,
    /// ns per particle-step on this machine.
    speed_by_arm: BTreeMap<String, Vec<f64>>,
}

/// What each case of the study will take, in the order of the study. With `trials` arms that nothing is known of are tried for a moment.
pub fn costs(archive: &Archive, statuses: &[Status], trials: bool) -> Vec<Cost> {
    let known = Known::of(archive, statuses);
    let all: Vec<f64> = known.speed_by_arm.values().flatten().copied().collect();
    let usual = median(&all);
    let mut tried: BTreeMap<&str, Option<Trial>> = BTreeMap::new();
    let cases = &archive.study.cases;
    let cost = |status: &Status| {
        let case = &cases[status.index];
        let steps = known.steps_of(archive.key(status.index), case);
        let speed = known.speed_by_arm.get(&case.arm).and_then(|speeds| median(speeds)).or(usual);
        let needed = trials && !status.state.is_done() && (steps.is_none() || speed.is_none());
        let trial = match needed {
            true => *tried.entry(&case.arm).or_insert_with(|| try_out(&case.scene, archive).ok()),
            false => None,
        };
        let (particle_steps, basis) = steps.unwrap_or_else(|| {
            let steps = trial.map_or_else(|| rough_steps(&case.scene), |trial| trial.particle_steps);
            (steps, Basis::FirstStep)
        });
        let speed = speed.or(trial.map(|trial| trial.nanoseconds * CASE_OVER_TRIAL)).unwrap_or(USUAL);
        let rest = 1.0 - status.checkpoint.unwrap_or(0.0);
        Cost { particle_steps, seconds: 1e-9 * speed * particle_steps * rest, basis }
    };
    statuses.iter().map(cost).collect()
}

/// Wall time [s] of the cases of the given numbers, so many side by side, each on as many threads as are left for it.
pub fn wall_time(costs: &[Cost], numbers: &[usize], side_by_side: usize) -> f64 {
    let mut seconds: Vec<f64> = numbers.iter().map(|&index| costs[index].seconds).collect();
    seconds.sort_by(|a, b| b.total_cmp(a));
    let mut workers = vec![0.0_f64; side_by_side.max(1)];
    for case in seconds {
        let first = workers.iter_mut().min_by(|a, b| a.total_cmp(b)).expect("there is a worker");
        *first += case;
    }
    workers.into_iter().fold(0.0, f64::max)
}

impl Known {
    fn of(archive: &Archive, statuses: &[Status]) -> Self {
        let mut known = Known::default();
        known.read_table(archive);
        let here = host();
        for Status { index, state, particle_steps, manifest, .. } in statuses {
            let Some(steps) = particle_steps.filter(|&steps| steps > 0 && state.is_done()) else { continue };
            let (key, case) = (archive.key(*index), &archive.study.cases[*index]);
            if known.by_key.insert(key.into(), steps as f64).is_none() {
                known.by_arm.entry(place_of(case)).or_default().push(steps as f64);
            }
            if let Some(manifest) = manifest.as_ref().filter(|m| m.program.host == here && m.threads == 1) {
                let speed = 1e9 * manifest.wall_seconds / steps as f64;
                known.speed_by_arm.entry(case.arm.clone()).or_default().push(speed);
            }
        }
        known
    }

    /// The rows of the study's table of cases, such as come with a checkout.
    fn read_table(&mut self, archive: &Archive) {
        let Ok(mut reader) = csv::Reader::from_path(archive.store.root().join("cases.csv")) else { return };
        let places: HashMap<&str, String> = (0..archive.study.cases.len())
            .map(|index| (archive.key(index), place_of(&archive.study.cases[index])))
            .collect();
        let rows = reader.deserialize::<HashMap<String, String>>();
        for row in rows.map_while(Result::ok) {
            let Some(key) = row.get("key") else { return };
            let steps = row.get("particle_steps").and_then(|text| text.parse::<f64>().ok());
            if let (Some(place), Some(steps)) = (places.get(key.as_str()), steps.filter(|steps| *steps > 0.0))
            {
                self.by_key.insert(key.clone(), steps);
                self.by_arm.entry(place.clone()).or_default().push(steps);
            }
        }
    }

    fn steps_of(&self, key: &str, case: &Case) -> Option<(f64, Basis)> {
        let own = self.by_key.get(key).map(|steps| (*steps, Basis::Case));
        own.or_else(|| {
            let others = self.by_arm.get(&place_of(case))?;
            Some((others.iter().sum::<f64>() / others.len() as f64, Basis::Arm))
        })
    }
}

/// Arm and point of the sweep.
fn place_of(case: &Case) -> String {
    format!("{} {:?}", case.arm, case.axes)
}

/// What a trial of a scene found.
#[derive(Clone, Copy, Debug)]
struct Trial {
    nanoseconds: f64,
    particle_steps: f64,
}

fn try_out(scene: &SceneSpec, archive: &Archive) -> Result<Trial, SpecError> {
    match (scene.dimension, scene.numerics.precision) {
        (3, PrecisionName::F32) => try_steps::<f32, 3>(scene, archive),
        (3, PrecisionName::F64) => try_steps::<f64, 3>(scene, archive),
        (_, PrecisionName::F32) => try_steps::<f32, 2>(scene, archive),
        (_, PrecisionName::F64) => try_steps::<f64, 2>(scene, archive),
    }
}

fn try_steps<T: Real, const D: usize>(spec: &SceneSpec, archive: &Archive) -> Result<Trial, SpecError> {
    let Assembly { scene, state, made } = assemble::<T, D>(spec, archive.folder)?;
    let refused = |error: String| SpecError::value("scene", error);
    let mut run = Simulation::new(scene, state).map_err(|error| refused(error.to_string()))?;
    let first = step_length(run.scene(), run.state());
    let began = Instant::now();
    while began.elapsed() < TRIAL && made.particles > 0 {
        run.advance_one(f64::MAX).map_err(|error| refused(error.to_string()))?;
    }
    let steps = run.steps().max(1) as f64;
    let flight = if spec.output.end_from == EndFrom::Contact { WITH_FLIGHT } else { 1.0 };
    let duration = spec.output.end * time_unit(&spec.output, made.crossing_time)? * flight;
    Ok(Trial {
        nanoseconds: 1e9 * began.elapsed().as_secs_f64() / (steps * made.particles.max(1) as f64),
        particle_steps: made.particles as f64 * duration / first,
    })
}

/// Particle-steps without a trial: only their ratios mean something. Particles times time over spacing, which steps go with.
fn rough_steps(scene: &SceneSpec) -> f64 {
    // chosen: a file's length is not known before it is read.
    let count: usize = scene.body.iter().map(|body| body.placement.count().unwrap_or(10_000)).sum();
    let speed = scene.body[0].velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
    let duration = match scene.output.time_unit {
        TimeUnit::Crossing => scene.output.end / speed.max(1e-3),
        TimeUnit::Second => scene.output.end,
    };
    // chosen: waves in snow go at 10 to 20 m/s and steps are a fraction of the time in which they cross a cell.
    const CELLS_A_SECOND: f64 = 50.0;
    count as f64 * duration * CELLS_A_SECOND / scene.numerics.spacing
}
