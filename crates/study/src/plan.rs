//! What there is of each case, what would be run and why.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;
use serde::Serialize;

use crate::attempt::Attempt;
use crate::checkpoint::CheckpointFile;
use crate::manifest::{CaseManifest, MANIFEST};
use crate::record::{Outcome, RunRecord, in_full};
use crate::results::Archive;
use crate::store::{Asked, CASE, CaseFolder, FAILURE, StoreError};

/// What there is of a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "state")]
pub enum State {
    /// It ran to its end.
    Finished,
    /// It came to a stop of its own, which the same case always would.
    Stopped {
        /// Short reason.
        reason: String,
        /// In full.
        message: String,
    },
    /// It failed for no fault of its own.
    Failed {
        /// Short reason.
        reason: String,
        /// In full.
        message: String,
    },
    /// Somebody is at work on it.
    Running {
        /// Who, where known.
        attempt: Option<Attempt>,
    },
    /// Its runner was killed.
    Killed {
        /// Who.
        attempt: Attempt,
    },
    /// It was put away.
    Interrupted,
    /// A file of it is not what was written.
    Damaged {
        /// Which, and in which way.
        message: String,
    },
    /// The disk does not say what there is.
    Unreadable {
        /// Which file, and why.
        message: String,
    },
    /// It was run by a solver of another version.
    Stale {
        /// Version.
        version: u32,
    },
    /// Nothing.
    New,
}

/// A case and what there is of it.
#[derive(Clone, Debug, Serialize)]
pub struct Status {
    /// Number in the study.
    pub index: usize,
    /// What there is.
    #[serde(flatten)]
    pub state: State,
    /// The share of the run that a checkpoint has.
    pub checkpoint: Option<f64>,
    /// Steps times particles of a finished run.
    pub particle_steps: Option<u64>,
    /// Who ran it, where it is finished.
    #[serde(skip)]
    pub manifest: Option<CaseManifest>,
}

/// How much is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// The records.
    Records,
    /// Every file, with its checksum.
    Everything,
}

impl State {
    /// Of a case with a file that cannot be used.
    fn of(error: &StoreError) -> Self {
        match error {
            StoreError::Io { .. } => State::Unreadable { message: in_full(error) },
            _ => State::Damaged { message: error.to_string() },
        }
    }

    /// One word.
    pub fn name(&self) -> &'static str {
        match self {
            State::Finished => "finished",
            State::Stopped { .. } => "stopped",
            State::Failed { .. } => "failed",
            State::Running { .. } => "running",
            State::Killed { .. } => "killed",
            State::Interrupted => "interrupted",
            State::Damaged { .. } => "damaged",
            State::Unreadable { .. } => "unreadable",
            State::Stale { .. } => "stale",
            State::New => "new",
        }
    }

    /// All words, in the order of a list.
    pub const NAMES: [&'static str; 10] = [
        "finished",
        "stopped",
        "failed",
        "running",
        "killed",
        "interrupted",
        "damaged",
        "unreadable",
        "stale",
        "new",
    ];

    /// Whether `run` leaves it as it is.
    pub fn is_done(&self) -> bool {
        matches!(self, State::Finished | State::Stopped { .. })
    }

    /// Whether `run --failed` takes it.
    pub fn has_failed(&self) -> bool {
        matches!(
            self,
            State::Stopped { .. }
                | State::Failed { .. }
                | State::Killed { .. }
                | State::Damaged { .. }
                | State::Unreadable { .. }
        )
    }

    /// Why it would be run, or what came of it.
    pub fn why(&self) -> String {
        match self {
            State::Finished => String::new(),
            State::Stopped { reason, message } | State::Failed { reason, message } => {
                format!("{reason}: {message}")
            }
            State::Running { attempt: Some(Attempt { host, process, began, .. }) } => {
                format!("process {process} on {host} since {began}")
            }
            State::Running { attempt: None } => "somebody is at work on it".into(),
            State::Killed { attempt: Attempt { number, host, process, began, .. } } => format!(
                "process {process} on {host}, begun {began}, was killed on the way (attempt {number}); if memory was short, \
                 `--jobs 1` takes less"
            ),
            State::Interrupted => "it was put away on the way".into(),
            State::Damaged { message } | State::Unreadable { message } => message.clone(),
            State::Stale { version } => format!("it was run by version {version} of the solver"),
            State::New => "it has not been run".into(),
        }
    }
}

/// What there is of all cases, in their order.
pub fn statuses(archive: &Archive, look: Look) -> Vec<Status> {
    let strangers = Strangers::of(archive);
    let status = |index| status(archive, index, look, Some(&strangers));
    (0..archive.study.cases.len()).into_par_iter().map(status).collect()
}

/// What there is of the cases of the given numbers, in their order. No other folder is looked at, so that a case of another version is a new one.
pub fn statuses_of(archive: &Archive, numbers: &[usize], look: Look) -> Vec<Status> {
    numbers.par_iter().map(|&index| status(archive, index, look, None)).collect()
}

fn status(archive: &Archive, index: usize, look: Look, strangers: Option<&Strangers>) -> Status {
    let folder = archive.case_folder(index);
    let checkpoint = CheckpointFile::new(folder.path(), archive.key(index)).share();
    let record = folder.read_run();
    let particle_steps = record.as_ref().ok().and_then(Option::as_ref).map(|record| record.particle_steps);
    let state = match record {
        Err(error) => State::of(&error),
        Ok(Some(record)) => match damage(archive, index, &record, look) {
            Err(error) => State::of(&error),
            Ok(()) => match record.outcome {
                Outcome::Stopped { reason, message } => State::Stopped { reason, message },
                Outcome::Ok | Outcome::OkWithClamps => State::Finished,
            },
        },
        Ok(None) => unfinished(archive, index, &folder, checkpoint, strangers),
    };
    let manifest = match state.is_done() {
        true => folder.read_json(MANIFEST).ok().flatten(),
        false => None,
    };
    Status { index, state, checkpoint, particle_steps, manifest }
}

/// Looks for files of a finished run that are not what was written.
fn damage(archive: &Archive, index: usize, record: &RunRecord, look: Look) -> Result<(), StoreError> {
    let folder = archive.case_folder(index);
    if look == Look::Records {
        return Ok(());
    }
    if record.was_built() {
        folder.check_frames()?;
        archive.check_metrics(index)?;
    }
    folder.read_json::<CaseManifest>(MANIFEST)?;
    folder.read_json::<Asked>(CASE).map(|_| ())
}

fn unfinished(
    archive: &Archive,
    index: usize,
    folder: &CaseFolder,
    checkpoint: Option<f64>,
    strangers: Option<&Strangers>,
) -> State {
    if !folder.path().is_dir() {
        let version = strangers.and_then(|strangers| strangers.version_of(archive, index));
        return version.map_or(State::New, |version| State::Stale { version });
    }
    let attempt = Attempt::not_ended(folder);
    if Attempt::is_running(folder) {
        return State::Running { attempt };
    }
    match folder.read_json::<RunRecord>(FAILURE) {
        Err(error) => return State::of(&error),
        Ok(Some(RunRecord { outcome: Outcome::Stopped { reason, message }, .. })) => {
            return State::Failed { reason, message };
        }
        Ok(_) => {}
    }
    match (attempt, checkpoint) {
        (Some(attempt), _) => State::Killed { attempt },
        (None, Some(_)) => State::Interrupted,
        (None, None) => State::New,
    }
}

/// Folders of cases that are none of the study as it is: of other profiles, of a study that has changed, of another version of the solver.
struct Strangers {
    /// Version by key of the scene.
    versions: HashMap<String, u32>,
}

impl Strangers {
    fn of(archive: &Archive) -> Self {
        let known: HashSet<&str> = (0..archive.study.cases.len()).map(|index| archive.key(index)).collect();
        let names = folders_of(archive);
        let strange = names.par_iter().filter(|name| !known.contains(name.as_str()));
        let asked =
            strange.filter_map(|name| archive.store.case(name).read_json::<Asked>(CASE).ok().flatten());
        Strangers { versions: asked.map(|asked| (asked.scene_key, asked.solver_version)).collect() }
    }

    fn version_of(&self, archive: &Archive, index: usize) -> Option<u32> {
        if self.versions.is_empty() {
            return None;
        }
        self.versions.get(&archive.scene_key(index).ok()?).copied()
    }
}

/// Names of all case folders of the study.
pub fn folders_of(archive: &Archive) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(archive.store.cases()) else { return Vec::new() };
    let mut names: Vec<String> =
        entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.sort_unstable();
    names
}
