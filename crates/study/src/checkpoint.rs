//! Where a long case goes on after its runner has been stopped: the run as the solver puts it away, and what was kept of it so far.
//!
//! Layout: the 16 bytes `snowlab-check-1\n`; the case's key, 20 letters; f64 little-endian share of the run that is done; then, in the postcard
//! format, frames (as in `frames.bin`), ledgers, seconds so far and the solver's [`Checkpoint`]; last the case's signature ([`crate::store::sign`]).

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use snowlab_solver::{Checkpoint, Real};

use crate::record::HistoryRow;
use crate::store::{Hashing, StoreError, read_whole, verify, write_whole_with};

const MAGIC: &[u8; 16] = b"snowlab-check-1\n";
/// Letters of a case's key.
const KEY: usize = 20;
/// Bytes before the content.
const HEAD: usize = MAGIC.len() + KEY + 8;

/// The file of a case.
#[derive(Clone, Debug)]
pub struct CheckpointFile {
    path: PathBuf,
    key: String,
}

/// What is written.
#[derive(Serialize)]
pub struct Put<'a, C: Serialize> {
    /// Frames so far, as in `frames.bin`.
    pub frames: Vec<u8>,
    /// Ledgers at each frame.
    pub history: &'a [HistoryRow],
    /// Wall time so far [s], of all attempts.
    pub seconds: f64,
    /// The run.
    pub simulation: C,
}

/// What is read.
#[derive(Deserialize)]
#[serde(bound = "")]
pub struct Taken<T: Real, const D: usize> {
    /// Frames so far, as in `frames.bin`.
    pub frames: Vec<u8>,
    /// Ledgers at each frame.
    pub history: Vec<HistoryRow>,
    /// Wall time so far [s].
    pub seconds: f64,
    /// The run.
    pub simulation: Checkpoint<T, D>,
}

impl CheckpointFile {
    /// Name of the file in a case's folder.
    pub const NAME: &str = "checkpoint.bin";

    /// That of the case `key` in its folder.
    pub fn new(folder: &Path, key: &str) -> Self {
        CheckpointFile { path: folder.join(Self::NAME), key: key.into() }
    }

    /// Writes it in place of the one before. `share` of the run is done, in [0, 1].
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write(&self, share: f64, content: &Put<impl Serialize>) -> Result<(), StoreError> {
        write_whole_with(&self.path, |file| {
            let mut file = Hashing::new(&self.key, file);
            file.write_all(MAGIC)?;
            file.write_all(self.key.as_bytes())?;
            file.write_all(&share.to_le_bytes())?;
            if let Err(error) = postcard::to_io(content, &mut file) {
                return Err(file.failure().unwrap_or_else(|| io::Error::other(error)));
            }
            file.finish()
        })
    }

    /// The share of the run that is done, from the file's head alone; `None` where there is no file of this case.
    pub fn share(&self) -> Option<f64> {
        let mut head = [0; HEAD];
        std::fs::File::open(&self.path).and_then(|mut file| file.read_exact(&mut head)).ok()?;
        let share = f64::from_le_bytes(head[HEAD - 8..].try_into().ok()?);
        self.is_own(&head).then_some(share.clamp(0.0, 1.0))
    }

    /// Reads it; `None` where there is none.
    ///
    /// # Errors
    /// [`StoreError`], in which way it is not what was written.
    pub fn read<V: DeserializeOwned>(&self) -> Result<Option<V>, StoreError> {
        let Some(bytes) = read_whole(&self.path)? else { return Ok(None) };
        let damaged = |reason: String| StoreError::Damaged { path: self.path.clone(), reason };
        self.parse(&bytes).map(Some).map_err(damaged)
    }

    /// The content of a file's bytes.
    ///
    /// # Errors
    /// In which way they are not what was written.
    pub fn parse<V: DeserializeOwned>(&self, bytes: &[u8]) -> Result<V, String> {
        let body = verify(&self.key, bytes)?;
        if body.len() < HEAD || !self.is_own(body) {
            return Err("it is not a checkpoint of this case by this version".into());
        }
        let (content, rest) = postcard::take_from_bytes(&body[HEAD..])
            .map_err(|error| format!("it is of another version ({error})"))?;
        if rest.is_empty() { Ok(content) } else { Err("it is longer than what was written".into()) }
    }

    fn is_own(&self, head: &[u8]) -> bool {
        head.starts_with(MAGIC) && &head[MAGIC.len()..MAGIC.len() + KEY] == self.key.as_bytes()
    }
}
