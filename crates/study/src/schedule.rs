//! Cases side by side, those that take longest first: one thread each, or more where there are fewer cases than cores.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use snowlab_solver::{Real, Simulation};

use crate::attempt::Attempt;
use crate::case_run::{CaseEnd, Job};
use crate::keeper::Limits;
use crate::manifest::Program;
use crate::results::Archive;
use crate::run::Observer;
use crate::store::{Hold, Lock, StoreError};

/// Hears how the work goes. Called from several threads.
pub trait Progress: Sync {
    /// So much of the whole work is done, in [0, 1], `cases` of them whole.
    fn advanced(&self, share: f64, cases: usize);
    /// Case number `index` could not be put away and goes on.
    fn not_put_away(&self, index: usize, error: &StoreError);
    /// An attempt at case number `index` has ended.
    fn ended(&self, index: usize, result: Result<&CaseEnd, &StoreError>);
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
    /// Cases that another runner has run meanwhile.
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

/// Runs the cases of the given numbers, the work of each as `work` tells, in any unit. A case that stops does not keep the others from running,
/// unless the orders say so; a disk that says no does, for nothing could be kept.
pub fn run_cases(
    archive: &Archive,
    numbers: &[usize],
    work: &[f64],
    orders: &Orders,
    progress: &impl Progress,
) -> Account {
    let mut order: Vec<usize> = numbers.to_vec();
    order.sort_by(|&a, &b| work[b].total_cmp(&work[a]).then(a.cmp(&b)));
    let total: f64 = order.iter().map(|&index| work[index]).sum();
    let shop = Shop {
        archive,
        orders,
        progress,
        work,
        // One case a task, taken in order: the long ones first, so that the last to end are short.
        queue: Mutex::new(order.into()),
        tally: Mutex::new(Tally { total: total.max(f64::MIN_POSITIVE), done: 0.0, cases: 0 }),
        account: Mutex::default(),
        closed: AtomicBool::new(false),
    };
    let workers = orders.side_by_side.min(numbers.len()).max(1);
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
    work: &'a [f64],
    queue: Mutex<VecDeque<usize>>,
    tally: Mutex<Tally>,
    account: Mutex<Account>,
    /// Whether no other case is to begin.
    closed: AtomicBool,
}

impl<P: Progress> Shop<'_, P> {
    fn work(&self) {
        while let Some(index) = self.next() {
            match Lock::take(&self.archive.case_folder(index).lock(), Hold::Alone) {
                // Another runner has run it meanwhile, and may have been killed before it had cleared up.
                Ok(Some(_lock)) if self.archive.is_done(index) => {
                    match Attempt::clear(&self.archive.case_folder(index)) {
                        Ok(()) => self.account(|account| account.elsewhere += 1),
                        Err(error) => self.unstored(index, error),
                    }
                    self.watcher(index).end();
                }
                Ok(Some(_lock)) => self.run(index),
                Ok(None) => {
                    // Another runner is at it: later it will have been run, or its runner killed.
                    self.queue.lock().expect("no panic holds the queue").push_back(index);
                    std::thread::sleep(BUSY_WAIT);
                }
                Err(error) => self.unstored(index, error),
            }
        }
    }

    fn next(&self) -> Option<usize> {
        let stop = self.orders.limits.stop.load(Ordering::Relaxed) || self.closed.load(Ordering::Relaxed);
        if stop { None } else { self.queue.lock().expect("no panic holds the queue").pop_front() }
    }

    fn run(&self, index: usize) {
        let Orders { side_by_side, threads, ref limits, ref program, .. } = *self.orders;
        let mut watcher = self.watcher(index);
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
        self.account(|account| account.unstored.push((index, error)));
        self.closed.store(true, Ordering::Relaxed);
    }

    fn account(&self, change: impl FnOnce(&mut Account)) {
        change(&mut self.account.lock().expect("no panic holds the account"));
    }

    fn watcher(&self, index: usize) -> Watcher<'_, P> {
        Watcher { index, tally: &self.tally, progress: self.progress, work: self.work[index], reported: 0.0 }
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
