//! What cannot be compared.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Input that cannot be compared.
#[derive(Debug, Error)]
pub enum CompareError {
    /// A file or folder that cannot be read.
    #[error("{}: cannot be read; give two folders of tables or two CSV files", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Not what was expected at this place.
    #[error("{}: {message}", path.display())]
    Place {
        /// The file or folder.
        path: PathBuf,
        /// What it is, and what to do.
        message: String,
    },
    /// Not a table, or one whose rows cannot be told apart.
    #[error("{}: line {line}: {message}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong, and what to do.
        message: String,
    },
    /// An option names a column that it cannot name.
    #[error("`{option}` names the column `{column}`; {message}")]
    Name {
        /// The option.
        option: &'static str,
        /// The column.
        column: String,
        /// What is allowed.
        message: String,
    },
    /// Columns that tell rows apart, given for several tables at once.
    #[error(
        "`--key` names the columns that tell the rows of two files apart; of a folder's tables they are known: leave it out, or give two files"
    )]
    KeyOfFolders,
}

impl CompareError {
    /// Not a table that can be compared, because of a line.
    pub(super) fn format(path: &Path, line: u64, message: impl Into<String>) -> Self {
        CompareError::Format { path: path.into(), line, message: message.into() }
    }

    /// Not what was expected.
    pub(super) fn place(path: &Path, message: impl Into<String>) -> Self {
        CompareError::Place { path: path.into(), message: message.into() }
    }
}
