//! Results on disk. A case has a folder named by its key; a file is whole or not there.
//!
//! ```text
//! <out>/<study>/cases/<key>/case.json      what was asked
//!                           frames.bin     frames
//!                           manifest.json  who ran it, where and for how long
//!                           run.json       how it went: written last, so that it marks a finished run
//!                           metrics-<k>.json   fragments, by the key of the measurement
//!                           log.txt        what happened when
//!                           lock           held by who runs the case
//!       until it is finished: attempt.json   who runs it, or did last: one who was killed has not ended
//!                           checkpoint.bin where it goes on
//!            where it failed for no fault of its own:
//!                           failure.json   why: such a case is run again
//! <out>/<study>/             tables, figures and report of the study run without a profile
//! <out>/<study>/<profile>/   those of a profile, which shares the cases with all others
//! <out>/<study>/lock         shared by who runs or reads, alone for who clears away
//! ```

mod lock;
mod whole;

pub use lock::{Hold, Lock};
pub use whole::{
    Hashing, is_temporary, put_whole, read_whole, remove, seal, sign, sweep, unseal, verify, write_once,
    write_whole, write_whole_with,
};

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::frames::Frames;
use crate::record::RunRecord;
use crate::spec::SceneSpec;
use crate::spec::study::{DEFAULT_PROFILE, MeasureSpec};

/// Changes whenever the same scene gives other numbers: it is part of every case's key.
pub const SOLVER_VERSION: u32 = 4;
/// Changes whenever the same frames give other metrics.
pub const METRIC_VERSION: u32 = 2;

/// The record of a finished run.
pub const RUN: &str = "run.json";
/// The record of a case that failed for no fault of its own: a panic, a limit. It does not mark a finished run.
pub const FAILURE: &str = "failure.json";
/// What was asked.
pub const CASE: &str = "case.json";
/// Frames.
pub const FRAMES: &str = "frames.bin";

/// A result that cannot be written or read.
#[derive(Debug, Error)]
pub enum StoreError {
    /// The disk said no.
    #[error("{}: cannot be written or read; check space and permissions, then run the same command again: finished cases are kept", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A result is not what was written.
    #[error("{}: {reason}; `snowlab run --repair` with the study's file makes it anew", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The same case gave two results.
    #[error(
        "{}: a second run of the case gave other bytes, kept as {}; the same case must give the same bytes: the \
         machine, the disk or the program is at fault; please report it with both files, then delete the case's folder: \
         the next run makes it anew",
        path.display(),
        second.display()
    )]
    Differs {
        /// The first, which stays.
        path: PathBuf,
        /// The second.
        second: PathBuf,
    },
}

/// Names of files and folders of a study, which no profile can have.
pub const FOLDERS: [&str; 5] = ["cases", "figures", "lock", "manifest.json", "slurm"];

/// The folders of a study's results.
#[derive(Clone, Debug)]
pub struct Store {
    root: PathBuf,
    cases: PathBuf,
}

/// The folder of one case.
#[derive(Clone, Debug)]
pub struct CaseFolder {
    path: PathBuf,
}

impl Store {
    /// The results of the study `name`, run under `profile`, below `out`.
    pub fn new(out: &Path, name: &str, profile: &str) -> Self {
        let study = out.join(name);
        let cases = study.join("cases");
        Store { root: if profile == DEFAULT_PROFILE { study } else { study.join(profile) }, cases }
    }

    /// The folder of tables, figures and report.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The folder of all cases' folders.
    pub fn cases(&self) -> &Path {
        &self.cases
    }

    /// The lock of the study.
    pub fn lock(&self) -> PathBuf {
        self.cases.with_file_name("lock")
    }

    /// The folder of a case.
    pub fn case(&self, key: &str) -> CaseFolder {
        CaseFolder { path: self.cases.join(key) }
    }
}

/// The key of a case: what decides its numbers, and nothing else.
///
/// `inputs` are the contents of the files that the scene names: particles and meshes.
pub fn case_key(scene: &SceneSpec, inputs: &[Vec<u8>]) -> String {
    key_by(&format!("snowlab case, solver version {SOLVER_VERSION}\n"), scene, inputs)
}

/// What a case is whatever the version of the solver.
pub fn scene_key(scene: &SceneSpec, inputs: &[Vec<u8>]) -> String {
    key_by("snowlab scene\n", scene, inputs)
}

fn key_by(what: &str, scene: &SceneSpec, inputs: &[Vec<u8>]) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(what.as_bytes());
    hasher.update(&serde_json::to_vec(scene).expect("a scene is plain data"));
    for input in inputs {
        hasher.update(&(input.len() as u64).to_le_bytes());
        hasher.update(input);
    }
    short(&hasher)
}

/// The key of a measurement.
pub fn metric_key(measure: &MeasureSpec) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(format!("snowlab metrics, version {METRIC_VERSION}\n").as_bytes());
    hasher.update(&serde_json::to_vec(measure).expect("a measurement is plain data"));
    short(&hasher)
}

/// 80 bits: a collision among a million cases has a chance below 1e-12.
fn short(hasher: &blake3::Hasher) -> String {
    hasher.finalize().to_hex()[..20].to_string()
}

/// What was asked of a case, as it stands in its folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// Version of the solver that was asked.
    pub solver_version: u32,
    /// Key of the scene alone ([`scene_key`]).
    pub scene_key: String,
    /// The scene in full.
    pub scene: SceneSpec,
}

impl CaseFolder {
    /// A case's folder that is there, wherever its study is.
    pub fn at(path: &Path) -> Self {
        CaseFolder { path: path.into() }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The case's key, which the folder is named by.
    fn key(&self) -> &str {
        self.path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
    }

    /// Whether the run has left the mark of its end; its content may be damaged.
    pub fn is_finished(&self) -> bool {
        self.path.join(RUN).is_file()
    }

    /// The record of the finished run; `None` where there is none.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn read_run(&self) -> Result<Option<RunRecord>, StoreError> {
        self.read_json(RUN)
    }

    /// The lock that who runs the case holds.
    pub fn lock(&self) -> PathBuf {
        self.path.join("lock")
    }

    /// The record of the finished run, or else of the failure; `None` where there is neither.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn read_record(&self) -> Result<Option<RunRecord>, StoreError> {
        Ok(match self.read_json(RUN)? {
            Some(record) => Some(record),
            None => self.read_json(FAILURE)?,
        })
    }

    /// Removes a file that may not be there.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn remove(&self, name: &str) -> Result<(), StoreError> {
        remove(&self.path.join(name))
    }

    /// Writes frames. Those of a finished run stay and must be the same; without its record they are nobody's result and are written over.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn write_frames<const D: usize>(&self, frames: &Frames<D>) -> Result<(), StoreError> {
        let sound = |bytes: &[u8]| self.is_finished() && verify(self.key(), bytes).is_ok();
        write_once(&self.path.join(FRAMES), &sign(self.key(), frames.to_bytes()), sound)
    }

    /// Reads frames.
    ///
    /// # Errors
    /// [`StoreError`] where they are missing, cannot be read or are not what was written.
    pub fn read_frames<const D: usize>(&self) -> Result<Frames<D>, StoreError> {
        let path = self.path.join(FRAMES);
        let bytes = read_whole(&path)?.ok_or("it is missing".to_string());
        bytes
            .and_then(|bytes| Frames::from_bytes(verify(self.key(), &bytes)?))
            .map_err(|reason| StoreError::Damaged { path, reason })
    }

    /// Whether the frames are those that were written.
    ///
    /// # Errors
    /// [`StoreError`], in which way they are not.
    pub fn check_frames(&self) -> Result<(), StoreError> {
        let path = self.path.join(FRAMES);
        let bytes = read_whole(&path)?.ok_or("it is missing".to_string());
        let checked = bytes.and_then(|bytes| verify(self.key(), &bytes).map(|_| ()));
        checked.map_err(|reason| StoreError::Damaged { path, reason })
    }

    /// Writes a value as JSON under seal.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), StoreError> {
        write_whole(&self.path.join(name), &seal(self.key(), value))
    }

    /// Writes the record that marks a finished run.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn write_run(&self, record: &RunRecord) -> Result<(), StoreError> {
        let sound = |bytes: &[u8]| unseal::<RunRecord>(self.key(), bytes).is_ok();
        write_once(&self.path.join(RUN), &seal(self.key(), record), sound)
    }

    /// Reads a value written as JSON; `None` where the file is not there.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn read_json<V: DeserializeOwned>(&self, name: &str) -> Result<Option<V>, StoreError> {
        let path = self.path.join(name);
        let value = read_whole(&path)?.map(|bytes| unseal(self.key(), &bytes)).transpose();
        value.map_err(|reason| StoreError::Damaged { path, reason })
    }
}
