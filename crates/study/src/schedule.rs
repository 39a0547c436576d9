//! Cases side by side, the longest first: one thread each, or more where there are fewer cases than cores.

use std::sync::Mutex;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use snowlab_solver::{Real, Simulation};

use crate::results::Archive;
use crate::run::Observer;
use crate::spec::scene::TimeUnit;
use crate::store::StoreError;
use crate::sweep::Case;

/// Hears how the work goes. Called from several threads.
pub trait Progress: Sync {
    /// So much of the whole work is done, in [0, 1], `cases` of them whole.
    fn advanced(&self, share: f64, cases: usize);
    /// A case has ended.
    fn finished(&self, case: &Case, result: Result<(), &StoreError>);
}

/// Wall time of a run, and where: kept apart from results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Wall time [s].
    pub wall_seconds: f64,
    /// Host.
    pub host: String,
    /// Peak memory of the process so far [bytes].
    pub peak_memory: u64,
    /// Cases run side by side.
    pub jobs: usize,
}

/// How cases share the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Jobs {
    /// Threads in all.
    pub cores: usize,
    /// Cases at a time, at most; each has its share of the cores.
    pub side_by_side: usize,
}

/// Runs the cases of the given numbers. A case that stops does not keep the others from running.
///
/// # Errors
/// The cases that could not be stored, with their numbers.
pub fn run_cases(
    archive: &Archive,
    numbers: &[usize],
    jobs: Jobs,
    progress: &impl Progress,
) -> Result<(), Vec<(usize, StoreError)>> {
    let cases = &archive.study.cases;
    let side_by_side = jobs.side_by_side.min(numbers.len()).max(1);
    // A thread for each of many cases keeps all cores busy; few cases share the cores.
    let threads = (jobs.cores / side_by_side).max(1);
    let mut order: Vec<usize> = numbers.to_vec();
    order.sort_by(|&a, &b| predicted_work(&cases[b]).total_cmp(&predicted_work(&cases[a])).then(a.cmp(&b)));
    let total: f64 = order.iter().map(|&index| predicted_work(&cases[index])).sum();
    let tally = Mutex::new(Tally { total, done: 0.0, cases: 0 });
    let run = |&index: &usize| -> Option<(usize, StoreError)> {
        let started = Instant::now();
        let mut watcher =
            Watcher { tally: &tally, progress, work: predicted_work(&cases[index]), reported: 0.0 };
        let result = archive.run(index, threads, &mut watcher).and_then(|()| {
            let clock = Clock::read(started.elapsed().as_secs_f64(), side_by_side);
            archive.case_folder(index).write_json("clock.json", &clock)
        });
        watcher.end();
        progress.finished(&cases[index], result.as_ref().map(|_| ()));
        result.err().map(|error| (index, error))
    };
    // One case a task, taken in order: the long ones first, so that the last to end are short. Threads of their own, for a thread of a pool
    // that waits for a step may begin another case.
    let queue = Mutex::new(order.iter());
    let work = || {
        let mut failed = Vec::new();
        while let Some(index) = { queue.lock().expect("no panic holds the queue").next() } {
            failed.extend(run(index));
        }
        failed
    };
    let mut failures: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..side_by_side).map(|_| scope.spawn(work)).collect();
        let ends = workers.into_iter().map(std::thread::ScopedJoinHandle::join);
        ends.flat_map(|end| end.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    failures.sort_by_key(|(index, _)| *index);
    if failures.is_empty() { Ok(()) } else { Err(failures) }
}

/// Expected work of a case, in units that only compare cases of one study: particles times time over spacing, which
/// steps go with.
fn predicted_work(case: &Case) -> f64 {
    let scene = &case.scene;
    let count: usize = scene
        .body
        .iter()
        // A file's length is not known before it is read.
        .map(|body| body.placement.count().unwrap_or(10_000))
        .sum();
    let speed = scene.body[0].velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
    let duration = match scene.output.time_unit {
        TimeUnit::Crossing => scene.output.end / speed.max(1e-3),
        TimeUnit::Second => scene.output.end,
    };
    count as f64 * duration / scene.numerics.spacing
}

struct Tally {
    total: f64,
    done: f64,
    cases: usize,
}

/// Adds up the progress of one case.
struct Watcher<'a, P: Progress> {
    tally: &'a Mutex<Tally>,
    progress: &'a P,
    work: f64,
    reported: f64,
}

impl<P: Progress> Watcher<'_, P> {
    fn report(&mut self, share: f64, ended: bool) {
        let (done, cases) = {
            let mut tally = self.tally.lock().expect("no panic holds the tally");
            tally.done += (share - self.reported) * self.work;
            tally.cases += usize::from(ended);
            (tally.done / tally.total, tally.cases)
        };
        self.reported = share;
        self.progress.advanced(done, cases);
    }

    fn end(&mut self) {
        self.report(1.0, true);
    }
}

impl<P: Progress> Observer for Watcher<'_, P> {
    fn progress(&mut self, share: f64, _steps: u64) {
        // chosen: a hundred reports a case.
        if share - self.reported > 0.01 && share < 1.0 {
            self.report(share, false);
        }
    }
    fn frame<T: Real, const D: usize>(&mut self, _simulation: &Simulation<T, D>) {}
}

impl Clock {
    fn read(wall_seconds: f64, jobs: usize) -> Self {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = kilobytes.and_then(|rest| rest.trim().trim_end_matches(" kB").parse::<u64>().ok());
        let host = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        Clock {
            wall_seconds,
            host: host.trim().to_string(),
            peak_memory: kilobytes.unwrap_or(0) * 1024,
            jobs,
        }
    }
}
