//! When a run is put away on the way, when it has to stop, and where it goes on from.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde::Serialize;
use snowlab_solver::Real;

use crate::attempt::log;
use crate::checkpoint::{CheckpointFile, Put, Taken};
use crate::record::{HistoryRow, in_full};
use crate::store::{CaseFolder, StoreError};

/// Why a run stopped before its end, for no fault of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pause {
    /// Somebody asked the program to stop.
    Interrupted,
    /// It has had the time that it may take.
    TimeLimit,
    /// It has taken the steps that it may take.
    StepLimit,
}

/// What a run should do before its next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Take it.
    GoOn,
    /// Be put away as soon as that can be, and go on.
    Checkpoint,
    /// Be put away as soon as that can be, and stop.
    Stop(Pause),
}

/// Keeps a run.
pub trait Keeper {
    /// The run as it was put away last; `None` where it begins.
    fn take<T: Real, const D: usize>(&mut self) -> Option<Taken<T, D>>;
    /// What was taken cannot be gone on with.
    fn refuse(&mut self, reason: &str);
    /// Asked before every step.
    fn wish(&mut self, steps: u64) -> Wish;
    /// Puts the run away, `share` of which is done.
    ///
    /// # Errors
    /// [`StoreError`], where it could not: what was put away before stays.
    fn put(
        &mut self,
        share: f64,
        frames: Vec<u8>,
        history: &[HistoryRow],
        simulation: impl Serialize,
    ) -> Result<(), StoreError>;
}

/// A run that is kept nowhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unkept;

impl Keeper for Unkept {
    fn take<T: Real, const D: usize>(&mut self) -> Option<Taken<T, D>> {
        None
    }
    fn refuse(&mut self, _reason: &str) {}
    fn wish(&mut self, _steps: u64) -> Wish {
        Wish::GoOn
    }
    fn put(
        &mut self,
        _share: f64,
        _frames: Vec<u8>,
        _history: &[HistoryRow],
        _simulation: impl Serialize,
    ) -> Result<(), StoreError> {
        Ok(())
    }
}

/// What a case may take, and how often it is put away.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Time between checkpoints.
    pub checkpoint_interval: Duration,
    /// Wall time of a case, all attempts together.
    pub time: Option<Duration>,
    /// Steps of a case.
    pub steps: Option<u64>,
    /// Set when the program should stop.
    pub stop: Arc<AtomicBool>,
}

/// Time between checkpoints (chosen: writing one takes a second at most for the cases of the studies).
pub const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(60);

/// Writing checkpoints takes at most this share of the time (chosen: not to be noticed).
const SHARE: f64 = 0.02;

impl Default for Limits {
    fn default() -> Self {
        Limits { checkpoint_interval: CHECKPOINT_INTERVAL, time: None, steps: None, stop: Arc::default() }
    }
}

/// Keeps a case in its folder.
#[derive(Debug)]
pub struct CaseKeeper<'a> {
    folder: &'a CaseFolder,
    file: CheckpointFile,
    limits: &'a Limits,
    began: Instant,
    /// Wall time of attempts before.
    before: Duration,
    due: Instant,
    asked: u64,
    wished: Wish,
}

/// The clock is looked at every so many steps (chosen: a step takes microseconds at least, looking at the clock a fraction of one).
const STEPS_A_LOOK: u64 = 8;

impl<'a> CaseKeeper<'a> {
    /// Of the case `key` in its folder.
    pub fn new(folder: &'a CaseFolder, key: &str, limits: &'a Limits) -> Self {
        let now = Instant::now();
        let file = CheckpointFile::new(folder.path(), key);
        let due = now + limits.checkpoint_interval;
        CaseKeeper {
            folder,
            file,
            limits,
            began: now,
            before: Duration::ZERO,
            due,
            asked: 0,
            wished: Wish::GoOn,
        }
    }

    /// Wall time of the case so far, with what attempts before have kept.
    pub fn elapsed(&self) -> Duration {
        self.before + self.began.elapsed()
    }
}

impl Keeper for CaseKeeper<'_> {
    fn take<T: Real, const D: usize>(&mut self) -> Option<Taken<T, D>> {
        match self.file.read::<Taken<T, D>>() {
            Ok(taken) => {
                let taken = taken?;
                self.before = Duration::try_from_secs_f64(taken.seconds).unwrap_or_default();
                let share = self.file.share().unwrap_or_default();
                log(self.folder, &format!("goes on at {:.1} % of the run", 100.0 * share));
                Some(taken)
            }
            Err(error) => {
                self.refuse(&error.to_string());
                None
            }
        }
    }

    fn refuse(&mut self, reason: &str) {
        self.before = Duration::ZERO;
        log(self.folder, &format!("begins anew, the checkpoint cannot be used: {reason}"));
    }

    fn wish(&mut self, steps: u64) -> Wish {
        if self.limits.stop.load(Ordering::Relaxed) {
            return Wish::Stop(Pause::Interrupted);
        }
        if self.limits.steps.is_some_and(|most| steps >= most) {
            return Wish::Stop(Pause::StepLimit);
        }
        // What is wished holds until it can be done.
        if self.asked.is_multiple_of(STEPS_A_LOOK) && self.wished == Wish::GoOn {
            if self.limits.time.is_some_and(|most| self.elapsed() >= most) {
                self.wished = Wish::Stop(Pause::TimeLimit);
            } else if Instant::now() >= self.due {
                self.wished = Wish::Checkpoint;
            }
        }
        self.asked += 1;
        self.wished
    }

    fn put(
        &mut self,
        share: f64,
        frames: Vec<u8>,
        history: &[HistoryRow],
        simulation: impl Serialize,
    ) -> Result<(), StoreError> {
        let began = Instant::now();
        let seconds = self.elapsed().as_secs_f64();
        let written = self.file.write(share, &Put { frames, history, seconds, simulation });
        let line = match &written {
            Ok(()) => format!("put away at {:.1} % of the run", 100.0 * share),
            Err(error) => format!("cannot be put away: {}", in_full(error)),
        };
        log(self.folder, &line);
        let rest = began.elapsed().div_f64(SHARE).max(self.limits.checkpoint_interval);
        self.due = Instant::now() + rest;
        self.wished = Wish::GoOn;
        written
    }
}
