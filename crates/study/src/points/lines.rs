//! Lines of text from a file that may hold anything.

use std::io::{BufRead, Read};
use std::path::{Path, PathBuf};

use super::{PointsError, format_error};

/// The longest line taken [bytes]. Chosen: a thousand times what a point needs, and little memory.
pub const LONGEST_LINE: usize = 1 << 20;
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// A text read line by line, with the number of the line, in bounded memory.
pub struct Lines<'a> {
    path: PathBuf,
    /// What has not been read yet; after a header, the data behind it.
    pub rest: Box<dyn BufRead + 'a>,
    /// The number of the last line read, from 1.
    pub line: u64,
    bytes: Vec<u8>,
}

impl<'a> Lines<'a> {
    /// The lines of `source`, which errors call `path`.
    pub fn new(path: &Path, source: impl BufRead + 'a) -> Self {
        Self { path: path.into(), rest: Box::new(source), line: 0, bytes: Vec::new() }
    }

    /// The next line that is not blank, without its end; `None` at the end of the file.
    pub fn next_line(&mut self) -> Result<Option<&str>, PointsError> {
        loop {
            self.bytes.clear();
            let longest = LONGEST_LINE as u64;
            let read = (&mut self.rest).take(longest + 1).read_until(b'\n', &mut self.bytes);
            if read.map_err(|reason| self.io(reason))? == 0 {
                return Ok(None);
            }
            self.line += 1;
            if self.bytes.len() > LONGEST_LINE {
                return Err(
                    self.error(format!("the line is longer than {longest} bytes; one point per line"))
                );
            }
            if self.line == 1 && self.bytes.starts_with(BYTE_ORDER_MARK) {
                self.bytes.drain(..BYTE_ORDER_MARK.len());
            }
            if !self.bytes.trim_ascii().is_empty() {
                break;
            }
        }
        match std::str::from_utf8(&self.bytes) {
            Ok(text) => Ok(Some(text.trim_end_matches(['\r', '\n']))),
            Err(_) => Err(self.error("this is not UTF-8 text; save the file as UTF-8 (plain ASCII will do)")),
        }
    }

    /// An error at the last line read.
    pub fn error(&self, message: impl Into<String>) -> PointsError {
        format_error(&self.path, self.line, message)
    }

    /// An error in data that has no lines.
    pub fn error_in_data(&self, message: impl Into<String>) -> PointsError {
        format_error(&self.path, 0, message)
    }

    /// A failure of the file itself.
    pub fn io(&self, reason: std::io::Error) -> PointsError {
        PointsError::Io { path: self.path.clone(), reason }
    }
}

/// Text from a file as it may stand in a message: short, and without control characters.
pub fn shown(text: &str) -> String {
    const LONGEST: usize = 40;
    let start: String = text.chars().take(LONGEST).collect();
    let more = if start.len() < text.len() { "..." } else { "" };
    format!("`{}{more}`", start.escape_debug())
}
