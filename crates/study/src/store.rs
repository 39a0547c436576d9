//! Results on disk. A case has a folder named by its key; a file is whole or not there.
//!
//! ```text
//! <out>/<study>/cases/<key>/case.json      what was asked
//!                           frames.bin     frames
//!                           run.json       how it went: written last, so that it marks a finished run
//!                           panic.json     how it went, where the program panicked: such a case is run again
//!                           metrics-<k>.json   fragments, by the key of the measurement
//!                           clock.json     how long it took, and where
//! <out>/<study>/             tables, figures and report of the study run without a profile
//! <out>/<study>/<profile>/   those of a profile, which shares the cases with all others
//! ```

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

use crate::frames::Frames;
use crate::record::RunRecord;
use crate::spec::SceneSpec;
use crate::spec::study::{DEFAULT_PROFILE, MeasureSpec};

/// Changes whenever the same scene gives other numbers: it is part of every case's key.
pub const SOLVER_VERSION: u32 = 4;
/// Changes whenever the same frames give other metrics.
pub const METRIC_VERSION: u32 = 2;

/// The record of a case in which the program panicked. It does not mark a finished run.
pub const PANIC: &str = "panic.json";

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
    #[error("{}: {reason}; delete the case's folder and run the study again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// Names of folders of a study, which no profile can have.
pub const FOLDERS: [&str; 2] = ["cases", "figures"];

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

    /// The folder of a case.
    pub fn case(&self, key: &str) -> CaseFolder {
        CaseFolder { path: self.cases.join(key) }
    }
}

/// The key of a case: what decides its numbers, and nothing else.
///
/// `inputs` are the contents of particle files that the scene names.
pub fn case_key(scene: &SceneSpec, inputs: &[Vec<u8>]) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(format!("snowlab case, solver version {SOLVER_VERSION}\n").as_bytes());
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

impl CaseFolder {
    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the run is finished.
    pub fn is_finished(&self) -> bool {
        self.path.join("run.json").is_file()
    }

    /// Whether it has the record of a finished run or of a panic.
    pub fn has_record(&self) -> bool {
        self.is_finished() || self.path.join(PANIC).is_file()
    }

    /// The record of the finished run, or else of the panic; `None` where there is neither.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn read_record(&self) -> Result<Option<RunRecord>, StoreError> {
        Ok(match self.read_json("run.json")? {
            Some(record) => Some(record),
            None => self.read_json(PANIC)?,
        })
    }

    /// Removes the record of an earlier panic, if there is one.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn forget_panic(&self) -> Result<(), StoreError> {
        let path = self.path.join(PANIC);
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                Err(StoreError::Io { path, source })
            }
            _ => Ok(()),
        }
    }

    /// Writes frames.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write_frames<const D: usize>(&self, frames: &Frames<D>) -> Result<(), StoreError> {
        write_whole(&self.path.join("frames.bin"), &frames.to_bytes())
    }

    /// Reads frames.
    ///
    /// # Errors
    /// [`StoreError`] where they are missing, cannot be read or are not what was written.
    pub fn read_frames<const D: usize>(&self) -> Result<Frames<D>, StoreError> {
        let path = self.path.join("frames.bin");
        let bytes = read_whole(&path)?.ok_or("it is missing".to_string());
        bytes
            .and_then(|bytes| Frames::from_bytes(&bytes))
            .map_err(|reason| StoreError::Damaged { path, reason })
    }

    /// Writes a value as JSON.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), StoreError> {
        let mut bytes = serde_json::to_vec_pretty(value).expect("results are plain data");
        bytes.push(b'\n');
        write_whole(&self.path.join(name), &bytes)
    }

    /// Reads a value written as JSON; `None` where the file is not there.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn read_json<V: DeserializeOwned>(&self, name: &str) -> Result<Option<V>, StoreError> {
        let path = self.path.join(name);
        let value = read_whole(&path)?.map(|bytes| serde_json::from_slice(&bytes)).transpose();
        value.map_err(|error| StoreError::Damaged { path, reason: error.to_string() })
    }
}

/// The bytes of a file; `None` where it is not there.
fn read_whole(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(StoreError::Io { path: path.into(), source }),
    }
}

/// Writes a file beside its place, flushes it to the disk and moves it there: whoever looks sees the whole file or none.
///
/// # Errors
/// [`StoreError::Io`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let write = || -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        // Readable as any file the user makes: the umask takes from 0666 what it forbids.
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o666);
        let mut file = tempfile::Builder::new().permissions(mode).tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        std::fs::File::open(folder)?.sync_all()
    };
    write().map_err(|source| StoreError::Io { path: path.into(), source })
}
