//! Results on disk. A case has a folder named by its key; a file is whole or not there.
//!
//! ```text
//! <out>/<study>/cases/<key>/case.json      what was asked
//!                           frames.bin     frames
//!                           run.json       how it went: written last, so that it marks a finished run
//!                           metrics-<k>.json   fragments, by the key of the measurement
//!                           clock.json     how long it took, and where
//! ```

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

use crate::frames::{Frames, FramesError};
use crate::spec::SceneSpec;
use crate::spec::study::MeasureSpec;

/// Changes whenever the same scene gives other numbers: it is part of every case's key.
pub const SOLVER_VERSION: u32 = 2;
/// Changes whenever the same frames give other metrics.
pub const METRIC_VERSION: u32 = 2;

/// A result that cannot be written or read.
#[derive(Debug, Error)]
pub enum StoreError {
    /// The disk said no.
    #[error("{}: {source}; check space and permissions, then run the same command again: finished cases are kept", path.display())]
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
    /// Frames.
    #[error(transparent)]
    Frames(#[from] FramesError),
}

/// The folder of a study's results.
#[derive(Clone, Debug)]
pub struct Store {
    root: PathBuf,
}

/// The folder of one case.
#[derive(Clone, Debug)]
pub struct CaseFolder {
    path: PathBuf,
}

impl Store {
    /// The results of the study `name` below `out`.
    pub fn new(out: &Path, name: &str) -> Self {
        Store { root: out.join(name) }
    }

    /// The study's folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The folder of a case.
    pub fn case(&self, key: &str) -> CaseFolder {
        CaseFolder { path: self.root.join("cases").join(key) }
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
    /// [`StoreError::Frames`].
    pub fn read_frames<const D: usize>(&self) -> Result<Frames<D>, StoreError> {
        Ok(Frames::read(&self.path.join("frames.bin"))?)
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
        match std::fs::read(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(StoreError::Io { path, source }),
            Ok(bytes) => serde_json::from_slice(&bytes)
                .map(Some)
                .map_err(|error| StoreError::Damaged { path, reason: error.to_string() }),
        }
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
