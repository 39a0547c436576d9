//! One case, run in its folder: from the mark of who begins to the record of how it ended.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::attempt::{Attempt, log, now};
use crate::checkpoint::CheckpointFile;
use crate::keeper::{CaseKeeper, Limits, Pause};
use crate::manifest::{CaseManifest, MANIFEST, Program, peak_memory};
use crate::measure::measure;
use crate::record::{Outcome, RunRecord, in_full};
use crate::results::{Archive, metrics_file};
use crate::run::{Ended, Observer, run_kept};
use crate::spec::SpecError;
use crate::store::{CASE, FAILURE, StoreError};

/// How a case is to be run.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// Threads.
    pub threads: usize,
    /// Cases at the same time.
    pub side_by_side: usize,
    /// What it may take.
    pub limits: &'a Limits,
    /// The program that runs it.
    pub program: &'a Program,
}

impl<'a> Job<'a> {
    /// On one thread, alone.
    pub fn alone(limits: &'a Limits, program: &'a Program) -> Self {
        Job { threads: 1, side_by_side: 1, limits, program }
    }
}

/// How an attempt at a case ended.
#[derive(Clone, Debug, PartialEq)]
pub enum CaseEnd {
    /// With a record of the whole run.
    Finished,
    /// For no fault of its own; it will be tried again.
    Failed(Outcome),
    /// Put away, because the program was asked to stop.
    Interrupted,
}

impl CaseEnd {
    fn paused(pause: Pause, limits: &Limits) -> Self {
        match pause {
            Pause::Interrupted => CaseEnd::Interrupted,
            Pause::TimeLimit => {
                let most = humantime::format_duration(limits.time.unwrap_or_default());
                CaseEnd::Failed(Outcome::failed(
                    "time-limit",
                    format!(
                        "it has run for {most}; it is put away: run it again with a longer `--time-limit`"
                    ),
                ))
            }
            Pause::StepLimit => {
                let most = limits.steps.unwrap_or_default();
                CaseEnd::Failed(Outcome::failed(
                    "step-limit",
                    format!(
                        "it has taken {most} steps; it is put away: run it again with a greater `--step-limit`"
                    ),
                ))
            }
        }
    }

    /// In the words of a log.
    pub fn in_words(&self) -> String {
        match self {
            CaseEnd::Finished => "finished".into(),
            CaseEnd::Failed(Outcome::Stopped { reason, message }) => format!("failed ({reason}): {message}"),
            CaseEnd::Failed(_) => "failed".into(),
            CaseEnd::Interrupted => "interrupted: it goes on where it was the next time".into(),
        }
    }
}

impl Archive<'_> {
    /// Runs case number `index` and stores what it gives: frames first, the record last. A case that cannot be built leaves a record that says so.
    /// One that fails for no fault of its own, by a panic, a limit or a particle file that is not what its key was made of, leaves one too, but still
    /// counts as missing.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn run(&self, index: usize, job: &Job, observer: &mut impl Observer) -> Result<CaseEnd, StoreError> {
        let folder = self.case_folder(index);
        let attempt = Attempt::begin(&folder)?;
        log(&folder, &format!("begins: {} on {} thread(s)", self.describe(index), job.threads));
        let end = self.attempt(index, job, &attempt, observer);
        match &end {
            Ok(CaseEnd::Finished) => {}
            Ok(_) => attempt.end(&folder)?,
            Err(error) => {
                log(&folder, &format!("ends: {}", in_full(error)));
                // The first error is the one to tell.
                let _ = attempt.end(&folder);
            }
        }
        end
    }

    /// What is done between the marks.
    fn attempt(
        &self,
        index: usize,
        job: &Job,
        attempt: &Attempt,
        observer: &mut impl Observer,
    ) -> Result<CaseEnd, StoreError> {
        let folder = self.case_folder(index);
        // What a panic leaves half done is the observer's count of steps and files that no record vouches for.
        let ended = catch_unwind(AssertUnwindSafe(|| match self.study.cases[index].scene.dimension {
            3 => self.run_in::<3>(index, job, attempt, observer),
            _ => self.run_in::<2>(index, job, attempt, observer),
        }));
        let end = match ended {
            Ok(end) => end?,
            Err(panic) => {
                // Where it came from may be the fault: the next attempt begins anew.
                folder.remove(CheckpointFile::NAME)?;
                CaseEnd::Failed(Outcome::failed("panic", words_of(panic.as_ref())))
            }
        };
        log(&folder, &end.in_words());
        match &end {
            CaseEnd::Finished => Attempt::clear(&folder)?,
            CaseEnd::Failed(outcome) => {
                folder.write_json(FAILURE, &RunRecord::without_particles(outcome.clone()))?;
            }
            CaseEnd::Interrupted => {}
        }
        Ok(end)
    }

    fn run_in<const D: usize>(
        &self,
        index: usize,
        job: &Job,
        attempt: &Attempt,
        observer: &mut impl Observer,
    ) -> Result<CaseEnd, StoreError> {
        let scene = &self.study.cases[index].scene;
        let folder = self.case_folder(index);
        if let Some(message) = self.changed_input(index) {
            return Ok(CaseEnd::Failed(Outcome::failed("input", message)));
        }
        folder.write_json(CASE, &self.asked(index))?;
        let mut keeper = CaseKeeper::new(&folder, self.key(index), job.limits);
        let ended = run_kept::<D>(scene, self.folder, job.threads, observer, &mut keeper);
        if let Some(message) = self.changed_input(index) {
            // What was put away may have begun with the other file.
            folder.remove(CheckpointFile::NAME)?;
            return Ok(CaseEnd::Failed(Outcome::failed("input", message)));
        }
        let record = match ended {
            Ok(Ended::Paused(pause)) => return Ok(CaseEnd::paused(pause, job.limits)),
            Ok(Ended::Lost(error)) => return Err(error),
            Ok(Ended::Run(run)) => {
                folder.write_frames(&run.frames)?;
                if let Ok(metrics) = measure(&self.study.measure, scene, &run.frames, &run.record) {
                    folder.write_json(&metrics_file(&self.study.measure), &metrics)?;
                }
                run.record
            }
            Err(error @ (SpecError::Particles { .. } | SpecError::Read { .. })) => {
                return Ok(CaseEnd::Failed(Outcome::failed("input", error.to_string())));
            }
            Err(error) => RunRecord::without_particles(Outcome::not_built(error.to_string())),
        };
        let manifest = CaseManifest {
            program: job.program.clone(),
            seed: scene.seed,
            began: attempt.began.clone(),
            ended: now(),
            wall_seconds: keeper.elapsed().as_secs_f64(),
            attempts: attempt.number,
            peak_memory: peak_memory(),
            jobs: job.side_by_side,
            threads: job.threads,
        };
        folder.write_json(MANIFEST, &manifest)?;
        folder.write_run(&record)?;
        Ok(CaseEnd::Finished)
    }
}

/// What a panic said.
fn words_of(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
    format!("the program failed: {}; please report it", text.unwrap_or("without a word"))
}
