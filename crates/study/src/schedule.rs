//! Cases side by side, those that take longest first: one thread each, or more where there are fewer cases than cores.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use snowlab_solver::{Real, Simulation};

use crate::attempt::Attempt;
use crate::case_run::{CaseEnd, Job};
use crate::keeper::Limits;
use crate::manifest::{MANIFEST, Program};
use crate::plan::{State, Status};
use crate::results::Archive;
use crate::run::Observer;
use crate::store::{Hold, Lock, RUN, StoreError, sweep};

/// Hears how the work goes. Called from several threads.
pub trait Progress: Sync {
    /// So much of the whole work is done, in [0, 1], `cases` of them whole.
    fn advanced(&self, share: f64, cases: usize);
    /// Case number `index` could not be put away and goes on.
    fn not_put_away(&self, index: usize, error: &StoreError);
    /// An attempt at case number `index` has ended.
    fn ended(&self, index: usize, result: Result<&CaseEnd, &StoreError>);
}

/// A case to be run.
#[derive(Clone, Debug)]
pub struct Task {
    /// What there was of it when it was chosen.
    pub status: Status,
    /// Its work, in any unit.
    pub work: f64,
}

/// How cases are run.
#[derive(Clone, Debug)]
pub struct Orders {
    /// Cases at a time, at most.
    pub side_by_side: usize,
    /// Threads of each.
    pub threads: usize,
    /// Whether no other case begins once one has failed or stopped.
    pub fail_fast: bool,
    /// What a case may take.
    pub limits: Limits,
    /// The program, for the manifests.
    pub program: Program,
}

/// Between two looks at cases that other runners are at (chosen: short beside a case, long beside a look).
const BUSY_WAIT: Duration = Duration::from_millis(100);

/// What came of it.
#[derive(Debug, Default)]
pub struct Account {
    /// Cases run to their end.
    pub finished: usize,
    /// Cases that another runner has run meanwhile, and damaged ones that could be mended without a run.
    pub elsewhere: usize,
    /// Cases that failed for no fault of their own.
    pub failed: Vec<usize>,
    /// Cases that were put away because the program was asked to stop.
    pub interrupted: usize,
    /// Cases whose results could not be stored.
    pub unstored: Vec<(usize, StoreError)>,
    /// Cases that were not begun.
    pub left: usize,
}

/// Runs cases. One that stops does not keep the others from running, unless the orders say so; a disk that says no does, for nothing could be kept.
pub fn run_cases(
    archive: &Archive,
    mut tasks: Vec<Task>,
    orders: &Orders,
    progress: &impl Progress,
) -> Account {
    let count = tasks.len();
    tasks.sort_by(|a, b| b.work.total_cmp(&a.work).then(a.status.index.cmp(&b.status.index)));
    let total: f64 = tasks.iter().map(|task| task.work).sum();
    let shop = Shop {
        archive,
        orders,
        progress,
        // One case a task, taken in order: the long ones first, so that the last to end are short.
        queue: Mutex::new(tasks.into()),
        tally: Mutex::new(Tally { total: total.max(f64::MIN_POSITIVE), done: 0.0, cases: 0 }),
        account: Mutex::default(),
        closed: AtomicBool::new(false),
    };
    let workers = orders.side_by_side.min(count).max(1);
    // Threads of their own, for a thread of a pool that waits for a step may begin another case.
    std::thread::scope(|scope| {
        for worker in (0..workers).map(|_| scope.spawn(|| shop.work())).collect::<Vec<_>>() {
            worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        }
    });
    let mut account = shop.account.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    account.left = shop.queue.into_inner().map_or(0, |queue| queue.len());
    account.failed.sort_unstable();
    account.unstored.sort_by_key(|(index, _)| *index);
    account
}

/// What the workers share.
struct Shop<'a, P: Progress> {
    archive: &'a Archive<'a>,
    orders: &'a Orders,
    progress: &'a P,
    queue: Mutex<VecDeque<Task>>,
    tally: Mutex<Tally>,
    account: Mutex<Account>,
    /// Whether no other case is to begin.
    closed: AtomicBool,
}

impl<P: Progress> Shop<'_, P> {
    fn work(&self) {
        while let Some(task) = self.next() {
            let index = task.status.index;
            match Lock::take(&self.archive.case_folder(index).lock(), Hold::Alone) {
                Ok(Some(lock)) => match self.is_to_run(&task.status, &lock) {
                    Ok(true) => self.run(&task),
                    Ok(false) => {
                        self.account(|account| account.elsewhere += 1);
                        self.watcher(&task).end();
                    }
                    Err(error) => self.unstored(index, error),
                },
                Ok(None) => {
                    // Another runner is at it: later it will have been run, or its runner killed.
                    self.queue.lock().expect("no panic holds the queue").push_back(task);
                    std::thread::sleep(BUSY_WAIT);
                }
                Err(error) => self.unstored(index, error),
            }
        }
    }

    fn next(&self) -> Option<Task> {
        let stop = self.orders.limits.stop.load(Ordering::Relaxed) || self.closed.load(Ordering::Relaxed);
        if stop { None } else { self.queue.lock().expect("no panic holds the queue").pop_front() }
    }

    /// Whether a case has to be run, now that nobody else is at it: what there is of it is looked at again, for another runner may have run it since.
    /// What keeps it from running is taken out of the way.
    fn is_to_run(&self, then: &Status, lock: &Lock) -> Result<bool, StoreError> {
        let folder = self.archive.case_folder(then.index);
        if lock.is_held_here() {
            sweep(folder.path())?;
        }
        let record = match folder.read_run() {
            Err(StoreError::Damaged { .. }) => None,
            record => match record? {
                None => return Ok(true),
                record => record,
            },
        };
        let has_to = match (&record, &then.state) {
            (None, _) => true,
            // Unless the record is one that another runner has made since.
            (_, State::Stopped { .. }) => then.manifest == folder.read_json(MANIFEST).ok().flatten(),
            (Some(record), State::Damaged { .. }) => !self.archive.mend(then.index, record)?,
            _ => false,
        };
        if has_to {
            folder.remove(RUN)?
        } else {
            Attempt::clear(&folder)?
        }
        Ok(has_to)
    }

    fn run(&self, task: &Task) {
        let index = task.status.index;
        let Orders { side_by_side, threads, ref limits, ref program, .. } = *self.orders;
        let mut watcher = self.watcher(task);
        let job = Job { threads, side_by_side, limits, program };
        match self.archive.run(index, &job, &mut watcher) {
            Ok(end) => {
                watcher.end();
                self.progress.ended(index, Ok(&end));
                self.account(|account| match end {
                    CaseEnd::Finished => account.finished += 1,
                    CaseEnd::Failed(_) => account.failed.push(index),
                    CaseEnd::Interrupted => account.interrupted += 1,
                });
                let failed = match end {
                    CaseEnd::Finished => self.archive.stopped(index),
                    _ => true,
                };
                if failed && self.orders.fail_fast {
                    self.closed.store(true, Ordering::Relaxed);
                }
            }
            Err(error) => self.unstored(index, error),
        }
    }

    fn unstored(&self, index: usize, error: StoreError) {
        self.progress.ended(index, Err(&error));
        // A disk that says no does so of all cases; two results of one case are a matter of that case.
        if matches!(error, StoreError::Io { .. }) || self.orders.fail_fast {
            self.closed.store(true, Ordering::Relaxed);
        }
        self.account(|account| account.unstored.push((index, error)));
    }

    fn account(&self, change: impl FnOnce(&mut Account)) {
        change(&mut self.account.lock().expect("no panic holds the account"));
    }

    fn watcher(&self, task: &Task) -> Watcher<'_, P> {
        let Task { status: Status { index, .. }, work } = *task;
        Watcher { index, tally: &self.tally, progress: self.progress, work, reported: 0.0 }
    }
}

struct Tally {
    total: f64,
    done: f64,
    cases: usize,
}

/// Adds up the progress of one case.
struct Watcher<'a, P: Progress> {
    index: usize,
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
    fn not_put_away(&mut self, error: &StoreError) {
        self.progress.not_put_away(self.index, error);
    }
}

/// Takes away what killed runners have left of a finished case, unless somebody is at work on it.
///
/// # Errors
/// [`StoreError::Io`].
pub fn tidy(archive: &Archive, index: usize) -> Result<(), StoreError> {
    let folder = archive.case_folder(index);
    if !Attempt::has_left(&folder) {
        return Ok(());
    }
    match Lock::take(&folder.lock(), Hold::Alone)? {
        Some(_lock) if folder.is_finished() => Attempt::clear(&folder),
        _ => Ok(()),
    }
}
