//! Who is at work on a case: a mark in its folder until it is finished, which tells who has ended from who was killed, and the case's log.

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

/// What is of use only until a case is finished.
pub const PASSING: [&str; 3] = [CheckpointFile::NAME, FAILURE, MARK];

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
    /// When it ended without the case being finished, UTC; `None` while it goes on, and where it was killed.
    #[serde(default)]
    pub ended: Option<String>,
}

impl Attempt {
    /// Marks a case as begun by this process, and takes the failure of an attempt before out of the way. The mark of that one tells the number.
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
            ended: None,
        };
        folder.write_json(MARK, &attempt)?;
        folder.remove(FAILURE)?;
        if let Some(Attempt { host, process, began, ended: None, .. }) = before {
            log(folder, &format!("process {process} on {host}, begun {began}, was killed on the way"));
        }
        Ok(attempt)
    }

    /// Marks it as ended, not killed; where that cannot be written the mark goes.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn end(self, folder: &CaseFolder) -> Result<(), StoreError> {
        let ended = Attempt { ended: Some(now()), ..self };
        folder.write_json(MARK, &ended).or_else(|_| folder.remove(MARK))
    }

    /// Removes what is of use only until a case is finished. A runner that was killed just then has left it.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn clear(folder: &CaseFolder) -> Result<(), StoreError> {
        PASSING.iter().try_for_each(|name| folder.remove(name))
    }

    /// Whether there is any of that.
    pub fn has_left(folder: &CaseFolder) -> bool {
        PASSING.iter().any(|name| folder.path().join(name).exists())
    }

    /// The mark of the latest attempt in a case's folder. One that cannot be read says nothing.
    fn left(folder: &CaseFolder) -> Option<Self> {
        folder.read_json(MARK).ok().flatten()
    }

    /// The latest attempt, where it has not ended: it goes on, or was killed.
    pub fn not_ended(folder: &CaseFolder) -> Option<Self> {
        Self::left(folder).filter(|attempt| attempt.ended.is_none())
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
