//! What a case will take: particle-steps from earlier results of the same case, of its arm at its point of the sweep, or of its arm at others, and time
//! from such cases run on this machine, or both from a short trial.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::assemble::{region, time_unit};
use crate::attempt::host;
use crate::pace::{Started, pace, start};
use crate::plan::Status;
use crate::results::Archive;
use crate::spec::scene::{EndFrom, RegionSpec, TimeUnit};
use crate::spec::{SceneSpec, SpecError};
use crate::statistics::median;
use crate::sweep::Case;

/// Where a prediction comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The same case has been run before.
    Case,
    /// Others of its arm, at its point of the sweep, have.
    Arm,
    /// Others of its arm have, at other points of the sweep.
    Sweep,
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

/// How much is looked at to tell what cases will take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// What is known of the cases that are asked about: only ratios of what it gives mean something.
    Own,
    /// The study's table as well.
    Table,
    /// Where nothing is known of an arm at a point of the sweep it is tried for a moment.
    Trials,
}

/// A trial goes on for so long (chosen: some hundred steps of the studies' scenes).
const TRIAL: Duration = Duration::from_millis(300);
/// All trials together; what is then left is scaled from them (chosen: a user waits so long).
const TRIALS: Duration = Duration::from_secs(10);
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
    by_place: BTreeMap<String, Vec<f64>>,
    /// Over the rough ones.
    over_rough_by_arm: BTreeMap<String, Vec<f64>>,
    /// ns per particle-step on this machine.
    speed_by_place: BTreeMap<String, Vec<f64>>,
    speed_by_arm: BTreeMap<String, Vec<f64>>,
}

/// What each of the cases will take that `statuses` are of, in their order.
pub fn costs(archive: &Archive, statuses: &[Status], effort: Effort) -> Vec<Cost> {
    let known = Known::of(archive, statuses, effort);
    let all: Vec<f64> = known.speed_by_arm.values().flatten().copied().collect();
    let usual = median(&all).unwrap_or(USUAL);
    let mut trials = Trials { archive, time: Duration::ZERO, found: BTreeMap::new(), over_rough: Vec::new() };
    let cost = |status: &Status| {
        let case = &archive.study.cases[status.index];
        let place = place_of(case);
        let steps = known.steps_of(archive.key(status.index), &place, case, archive.folder);
        let speeds = known.speed_by_place.get(&place).or_else(|| known.speed_by_arm.get(&case.arm));
        let speed = speeds.and_then(|speeds| median(speeds));
        let is_needed = !status.state.is_done() && (steps.is_none() || speed.is_none());
        let trial = if effort == Effort::Trials && is_needed { trials.of(case, place) } else { None };
        let (particle_steps, basis) = steps.unwrap_or_else(|| {
            let steps =
                trial.map_or_else(|| rough_steps(&case.scene, archive.folder), |trial| trial.particle_steps);
            (steps, Basis::FirstStep)
        });
        let speed = speed.or(trial.map(|trial| trial.nanoseconds * CASE_OVER_TRIAL)).unwrap_or(usual);
        let rest = 1.0 - status.checkpoint.unwrap_or(0.0);
        Cost { particle_steps, seconds: 1e-9 * speed * particle_steps * rest, basis }
    };
    statuses.iter().map(cost).collect()
}

/// Wall time [s] of cases, so many side by side on so many threads each.
pub fn wall_time<'a>(costs: impl Iterator<Item = &'a Cost>, side_by_side: usize, threads: usize) -> f64 {
    let mut seconds: Vec<f64> = costs.map(|cost| cost.seconds / threads.max(1) as f64).collect();
    seconds.sort_by(|a, b| b.total_cmp(a));
    let mut workers = vec![0.0_f64; side_by_side.max(1)];
    for case in seconds {
        let first = workers.iter_mut().min_by(|a, b| a.total_cmp(b)).expect("there is a worker");
        *first += case;
    }
    workers.into_iter().fold(0.0, f64::max)
}

impl Known {
    fn of(archive: &Archive, statuses: &[Status], effort: Effort) -> Self {
        let mut known = Known::default();
        if effort != Effort::Own {
            known.read_table(archive);
        }
        let here = host();
        for Status { index, state, particle_steps, manifest, .. } in statuses {
            let Some(steps) = particle_steps.filter(|&steps| steps > 0 && state.is_done()) else { continue };
            let (key, case) = (archive.key(*index), &archive.study.cases[*index]);
            known.learn(key, case, steps as f64, archive.folder);
            if let Some(manifest) = manifest.as_ref().filter(|m| m.program.host == here && m.threads == 1) {
                let speed = 1e9 * manifest.wall_seconds / steps as f64;
                known.speed_by_place.entry(place_of(case)).or_default().push(speed);
                known.speed_by_arm.entry(case.arm.clone()).or_default().push(speed);
            }
        }
        known
    }

    /// The rows of the study's table of cases, such as come with a checkout.
    fn read_table(&mut self, archive: &Archive) {
        let Ok(mut reader) = csv::Reader::from_path(archive.store.root().join("cases.csv")) else { return };
        let cases: HashMap<&str, &Case> =
            archive.study.cases.iter().enumerate().map(|(i, case)| (archive.key(i), case)).collect();
        let rows = reader.deserialize::<HashMap<String, String>>();
        for row in rows.map_while(Result::ok) {
            let Some(key) = row.get("key") else { return };
            let steps = row.get("particle_steps").and_then(|text| text.parse::<f64>().ok());
            if let (Some(case), Some(steps)) = (cases.get(key.as_str()), steps.filter(|steps| *steps > 0.0)) {
                self.learn(key, case, steps, archive.folder);
            }
        }
    }

    fn learn(&mut self, key: &str, case: &Case, steps: f64, folder: &Path) {
        if self.by_key.insert(key.into(), steps).is_none() {
            self.by_place.entry(place_of(case)).or_default().push(steps);
            let over_rough = steps / rough_steps(&case.scene, folder);
            self.over_rough_by_arm.entry(case.arm.clone()).or_default().push(over_rough);
        }
    }

    fn steps_of(&self, key: &str, place: &str, case: &Case, folder: &Path) -> Option<(f64, Basis)> {
        if let Some(steps) = self.by_key.get(key) {
            return Some((*steps, Basis::Case));
        }
        if let Some(others) = self.by_place.get(place) {
            return Some((others.iter().sum::<f64>() / others.len() as f64, Basis::Arm));
        }
        let over_rough = median(self.over_rough_by_arm.get(&case.arm)?)?;
        Some((over_rough * rough_steps(&case.scene, folder), Basis::Sweep))
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

/// Trials, one for each arm and point of the sweep while there is time.
struct Trials<'a> {
    archive: &'a Archive<'a>,
    time: Duration,
    found: BTreeMap<String, Option<Trial>>,
    /// Of each its time [ns] and its particle-steps over the rough ones.
    over_rough: Vec<(f64, f64)>,
}

impl Trials<'_> {
    fn of(&mut self, case: &Case, place: String) -> Option<Trial> {
        if let Some(found) = self.found.get(&place) {
            return *found;
        }
        if self.time >= TRIALS {
            return self.scaled(rough_steps(&case.scene, self.archive.folder));
        }
        let began = Instant::now();
        let trial = try_out(&case.scene, self.archive).ok();
        self.time += began.elapsed();
        self.over_rough.extend(
            trial.map(|t| (t.nanoseconds, t.particle_steps / rough_steps(&case.scene, self.archive.folder))),
        );
        self.found.insert(place, trial);
        trial
    }

    /// What a trial of a case of so many rough particle-steps might find, by those that were made.
    fn scaled(&self, rough: f64) -> Option<Trial> {
        let (nanoseconds, ratios): (Vec<f64>, Vec<f64>) = self.over_rough.iter().copied().unzip();
        Some(Trial { nanoseconds: median(&nanoseconds)?, particle_steps: median(&ratios)? * rough })
    }
}

fn try_out(spec: &SceneSpec, archive: &Archive) -> Result<Trial, SpecError> {
    let Started { mut run, made, first_step } = start(spec, archive.folder, 1)?;
    let pace = pace(run.as_mut(), TRIAL).map_err(|error| SpecError::value("scene", error))?;
    let flight = if spec.output.end_from == EndFrom::Contact { WITH_FLIGHT } else { 1.0 };
    let duration = spec.output.end * time_unit(&spec.output, made.crossing_time)? * flight;
    // A scene without particles takes steps all the same.
    let particles = made.particles.max(1) as f64;
    Ok(Trial { nanoseconds: 1e9 * pace.step / particles, particle_steps: particles * duration / first_step })
}

/// Extents of the first body's region [m], axis by axis; `None` for a file of particles, whose are not known before it is read. Meshes are in `folder`.
pub fn extents(scene: &SceneSpec, folder: &Path) -> Option<Vec<f64>> {
    let spec = scene.body.first()?.region.as_ref()?;
    match scene.dimension {
        3 => of_region::<3>(spec, folder),
        _ => of_region::<2>(spec, folder),
    }
}

fn of_region<const D: usize>(spec: &RegionSpec, folder: &Path) -> Option<Vec<f64>> {
    let bounds = region::<D>(spec, "region", folder).ok()?.bounding_box();
    Some((bounds.max - bounds.min).as_slice().to_vec())
}

/// R of the first body [m]: half its region's largest extent.
fn radius(scene: &SceneSpec, folder: &Path) -> f64 {
    // chosen: half a metre for a file.
    extents(scene, folder).map_or(0.5, |extents| 0.5 * extents.into_iter().fold(0.0, f64::max))
}

/// Particle-steps without a trial: only their ratios mean something. Particles times time over spacing, which steps go with.
fn rough_steps(scene: &SceneSpec, folder: &Path) -> f64 {
    // chosen: a file's length is not known before it is read.
    let count: usize = scene.body.iter().map(|body| body.placement.count().unwrap_or(10_000)).sum();
    let speed = scene.body[0].velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
    let duration = match scene.output.time_unit {
        TimeUnit::Crossing => scene.output.end * radius(scene, folder) / speed.max(1e-3),
        TimeUnit::Second => scene.output.end,
    };
    // chosen: waves in snow go at 10 to 20 m/s and steps are a fraction of the time in which they cross a cell.
    const CELLS_A_SECOND: f64 = 50.0;
    count as f64 * duration * CELLS_A_SECOND / scene.numerics.spacing
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec;

    #[test]
    fn rough_steps_go_with_particles_and_with_the_time_to_cross() {
        let scene = |count: usize, radius: f64| {
            let text = format!(
                "[numerics]\nspacing = 0.05\n[[body]]\nregion = {{ kind = \"ball\", centre = [0.0, 1.0], radius = {radius} }}\n\
                 placement = {{ kind = \"random\", count = {count} }}\nvelocity = [0.0, -8.0]\n\
                 [output]\ntime_unit = \"crossing\"\nframe_interval = 0.5\nend = 1.0\n"
            );
            rough_steps(&spec::parse(&text).expect("a scene"), Path::new("."))
        };
        let one = scene(300, 0.25);
        assert_eq!([scene(600, 0.25), scene(300, 0.5)], [2.0 * one; 2]);
        // 300 particles for 0.25 m / 8 m/s.
        assert!((one - 300.0 * 0.03125 * 50.0 / 0.05).abs() < 1e-9 * one, "{one}");
    }

    #[test]
    fn cases_fill_workers_longest_first_on_their_threads() {
        let costs = [4.0, 6.0, 2.0].map(|seconds| Cost { particle_steps: 1.0, seconds, basis: Basis::Case });
        assert_eq!(
            [(1, 1), (2, 1), (2, 2), (9, 1)].map(|(n, t)| wall_time(costs.iter(), n, t)),
            [12.0, 6.0, 3.0, 6.0]
        );
    }
}
