//! Who is at work on a case: a mark in its folder while it runs, which is left where the runner was killed, and the case's log.

use std::fs::OpenOptions;
use std::io::Write;
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use crate::checkpoint::CheckpointFile;
use crate::store::{CaseFolder, FAILURE, Lock, StoreError};

/// Name of the mark.
pub const MARK: &str = "attempt.json";
/// Name of the log.
pub const LOG: &str = "log.txt";

/// Somebody at work on a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attempt {
    /// Number of the attempt, from 1.
    pub number: u32,
    /// Host.
    pub host: String,
    /// Process.
    pub process: u32,
    /// When it began, UTC.
    pub began: String,
}

impl Attempt {
    /// Marks a case as begun by this process. The mark of one who was killed before tells the number.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn begin(folder: &CaseFolder) -> Result<Self, StoreError> {
        let before = Self::left(folder);
        let attempt = Attempt {
            number: before.as_ref().map_or(1, |before| before.number.saturating_add(1)),
            host: host(),
            process: std::process::id(),
            began: now(),
        };
        folder.write_json(MARK, &attempt)?;
        if let Some(Attempt { host, process, began, .. }) = before {
            log(folder, &format!("process {process} on {host}, begun {began}, was killed on the way"));
        }
        Ok(attempt)
    }

    /// Removes the mark.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn end(folder: &CaseFolder) -> Result<(), StoreError> {
        folder.remove(MARK)
    }

    /// Removes what is of use only until a case is finished. A runner that was killed just then has left it.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn clear(folder: &CaseFolder) -> Result<(), StoreError> {
        [CheckpointFile::NAME, FAILURE, MARK].iter().try_for_each(|name| folder.remove(name))
    }

    /// The mark in a case's folder. One that cannot be read says nothing.
    pub fn left(folder: &CaseFolder) -> Option<Self> {
        folder.read_json(MARK).ok().flatten()
    }

    /// Whether somebody is at work on the case now.
    pub fn is_running(folder: &CaseFolder) -> bool {
        Lock::is_held(&folder.lock())
    }
}

/// Adds a line to a case's log. A log that cannot be written keeps nothing from running.
pub fn log(folder: &CaseFolder, line: &str) {
    let file = OpenOptions::new().create(true).append(true).open(folder.path().join(LOG));
    let _ = file.and_then(|mut file| file.write_all(format!("{} {line}\n", now()).as_bytes()));
}

/// The time, UTC, to the second.
pub fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}

/// The host's name.
pub fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    name.trim().to_string()
}
