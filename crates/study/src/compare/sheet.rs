//! A CSV file as text: columns, rows, and the lines they stand in.

use std::io;
use std::path::{Path, PathBuf};

use ::csv::{ErrorKind, ReaderBuilder, StringRecord};

use super::CompareError;
use crate::points::lines::shown;

/// A table that has been read, all entries as text.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Where it came from.
    pub path: PathBuf,
    /// Names of the columns; none where a table without rows was written.
    pub columns: Vec<String>,
    /// Rows, each with an entry for every column.
    pub rows: Vec<StringRecord>,
}

impl Sheet {
    /// Reads a file.
    ///
    /// # Errors
    /// [`CompareError::Io`], and what [`Sheet::parse`] refuses.
    pub fn read(path: &Path) -> Result<Self, CompareError> {
        let failed = |source: io::Error| CompareError::Io { path: path.into(), source };
        if !std::fs::metadata(path).map_err(failed)?.is_file() {
            return Err(CompareError::place(
                path,
                "is neither a file nor a folder of tables; give a CSV file",
            ));
        }
        Self::parse(path, &std::fs::read(path).map_err(failed)?)
    }

    /// Takes the bytes of a file for a table. `path` is what messages call it.
    ///
    /// # Errors
    /// [`CompareError::Format`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, CompareError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if bytes.is_empty() {
            let message = "the file is empty; a table has at least the names of its columns: write it again";
            return Err(CompareError::format(path, 1, message));
        }
        let mut reader = ReaderBuilder::new().from_reader(bytes);
        let header = reader.headers().map_err(|error| refused(path, error))?.clone();
        let columns: Vec<String> = header.iter().map(Into::into).collect();
        for (index, column) in columns.iter().enumerate() {
            if columns[..index].contains(column) {
                let message = format!("the column {} stands twice; rename one", shown(column));
                return Err(CompareError::format(path, 1, message));
            }
        }
        let rows = reader.into_records().collect::<Result<Vec<_>, _>>().map_err(|e| refused(path, e))?;
        // A quote that is not closed swallows all that follows it: the last row, then, is where it stands.
        if bytes.iter().filter(|&&byte| byte == b'"').count() % 2 == 1 {
            let line = rows.last().map_or(1, line_of);
            let message =
                "from this row on a quote is left open; close it, and write a quote inside a field twice";
            return Err(CompareError::format(path, line, message));
        }
        Ok(Sheet { path: path.into(), columns, rows })
    }

    /// The number of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// The line a row begins in, from 1.
    pub fn line(&self, row: usize) -> u64 {
        line_of(&self.rows[row])
    }
}

fn line_of(record: &StringRecord) -> u64 {
    record.position().map_or(1, ::csv::Position::line)
}

fn refused(path: &Path, error: ::csv::Error) -> CompareError {
    let line = error.position().map_or(1, ::csv::Position::line);
    let message = match error.into_kind() {
        ErrorKind::UnequalLengths { expected_len, len, .. } => format!(
            "{len} field(s), but the first line names {expected_len} columns; give every row as many, separated by commas"
        ),
        ErrorKind::Utf8 { err, .. } => {
            format!("field {} is not UTF-8; save the file as UTF-8 text", err.field() + 1)
        }
        other => format!("not CSV: {other:?}"),
    };
    CompareError::format(path, line, message)
}
