//! What a user writes: scene and study files in TOML. Every key is documented in `docs/input.md`.

pub mod override_path;
pub mod scene;
pub mod study;

pub use scene::SceneSpec;
pub use study::StudySpec;

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use thiserror::Error;

/// A file that cannot be used as it is.
#[derive(Debug, Error)]
pub enum SpecError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({source}); check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not TOML, or a key is unknown, missing or of the wrong kind.
    #[error("{}: {message}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// The parser's words, with line and column.
        message: String,
    },
    /// A value that means nothing.
    #[error("{place}: {message}")]
    Value {
        /// File or case, and key.
        place: String,
        /// What is wrong, what is allowed, what to do.
        message: String,
    },
}

impl SpecError {
    /// A value at `place` that means nothing.
    pub fn value(place: impl Into<String>, message: impl Into<String>) -> Self {
        SpecError::Value { place: place.into(), message: message.into() }
    }
}

/// Files longer than this are refused unread (chosen: a thousand times the largest study of the project).
const MOST_BYTES: u64 = 16 << 20;

/// Reads and parses a TOML file; its text comes with it.
///
/// # Errors
/// [`SpecError`], naming file, line and key.
pub fn read<S: DeserializeOwned>(path: &Path) -> Result<(S, String), SpecError> {
    let failed = |source| SpecError::Read { path: path.into(), source };
    let bytes = std::fs::metadata(path).map_err(failed)?.len();
    if bytes > MOST_BYTES {
        let message = format!("has {bytes} bytes; a scene or study has at most {MOST_BYTES}");
        return Err(SpecError::value(path.display().to_string(), message));
    }
    let text = std::fs::read_to_string(path).map_err(failed)?;
    let spec = toml::from_str(&text)
        .map_err(|error| SpecError::Parse { path: path.into(), message: error.to_string() })?;
    Ok((spec, text))
}
