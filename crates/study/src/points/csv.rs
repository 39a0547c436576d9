//! Points as comma-separated values (RFC 4180), also with semicolons, tabs or spaces between them.
//!
//! The separator is the first of comma, semicolon, tab, space that the first line has. Where every field of that line
//! is a number there is no header, and the columns are x y or x y z. Blank lines and lines that begin with `#` are
//! passed over.

use std::io::{self, BufRead, Read, Write};
use std::path::Path;

use ::csv::{ErrorKind, ReaderBuilder, StringRecord, Trim};

use super::columns::{Columns, Table};
use super::lines::{LONGEST_LINE, Lines, shown};
use super::{PointCloud, PointsError, format_error};

/// Reads all points.
pub fn read(path: &Path, source: impl BufRead) -> Result<Table, PointsError> {
    let Some(text) = Text::begin(path, source)? else {
        let message = "the file is empty; give it a header such as x,y,z and one point per line";
        return Err(format_error(path, 0, message));
    };
    let separator = text.separator;
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .delimiter(separator as u8)
        .from_reader(text);
    let mut record = StringRecord::new();
    let mut table: Option<Table> = None;
    let mut width = 0;
    while reader.read_record(&mut record).map_err(|error| of_csv(path, error))? {
        let line = reader.get_ref().first_line;
        let refused = |message| format_error(path, line, message);
        match &mut table {
            Some(table) => add(table, &record, line, width).map_err(refused)?,
            None => {
                width = record.len();
                let (columns, headless) = columns_of(&record, separator).map_err(refused)?;
                let table = table.insert(Table::new(columns));
                if headless {
                    add(table, &record, line, width).map_err(refused)?;
                }
            }
        }
        reader.get_mut().begin_record();
    }
    table.ok_or_else(|| format_error(path, 0, "there is no header and no point"))
}

/// The columns that the first record names, and whether it is a point instead and names none.
fn columns_of(first: &StringRecord, separator: char) -> Result<(Columns, bool), String> {
    if first.iter().all(|field| field.parse::<f64>().is_ok()) {
        return Ok((Columns::in_order(first.len())?, true));
    }
    let columns = Columns::named(&first.iter().collect::<Vec<_>>()).map_err(|message| {
        format!(
            "in the header, separated by {separator:?}: {message}; \
             a first line of numbers alone counts as no header"
        )
    })?;
    Ok((columns, false))
}

fn add(table: &mut Table, record: &StringRecord, line: u64, width: usize) -> Result<(), String> {
    if record.len() != width {
        return Err(format!(
            "{} field(s), but the first line has {width}; give every line the same columns",
            record.len()
        ));
    }
    table.push(line, |column| {
        let field = &record[column];
        field.parse().map_err(|_| {
            let place = column + 1;
            format!("field {place} is {}; a number such as 0.25 or 1e-3 is expected", shown(field))
        })
    })
}

/// Our own error where it came through the reader, else the reader's.
fn of_csv(path: &Path, error: ::csv::Error) -> PointsError {
    match error.into_kind() {
        ErrorKind::Io(error) => match error.downcast::<PointsError>() {
            Ok(error) => error,
            Err(reason) => PointsError::Io { path: path.into(), reason },
        },
        kind => format_error(path, 0, format!("not CSV: {kind:?}")),
    }
}

/// The text of a file, handed to the CSV reader a line at a time, so that the line of a record is known and a quote
/// left open cannot swallow the file.
struct Text<'a> {
    lines: Lines<'a>,
    separator: char,
    /// The line on hand, and how much of it has been handed on.
    line: String,
    sent: usize,
    /// The line the record began at, and its bytes so far.
    first_line: u64,
    record_bytes: usize,
}

impl<'a> Text<'a> {
    /// `None` where the file has no line to read.
    fn begin(path: &Path, source: impl BufRead + 'a) -> Result<Option<Self>, PointsError> {
        let (lines, line) = (Lines::new(path, source), String::new());
        let mut text = Self { lines, separator: ',', line, sent: 0, first_line: 0, record_bytes: 0 };
        if !text.next_line()? {
            return Ok(None);
        }
        text.separator = [',', ';', '\t'].into_iter().find(|&s| text.line.contains(s)).unwrap_or(' ');
        text.separate();
        Ok(Some(text))
    }

    fn begin_record(&mut self) {
        self.record_bytes = 0;
    }

    fn next_line(&mut self) -> Result<bool, PointsError> {
        self.line.clear();
        self.sent = 0;
        loop {
            match self.lines.next_line()? {
                Some(text) if text.starts_with('#') => {}
                Some(text) => break self.line.push_str(text),
                None => return Ok(false),
            }
        }
        if self.record_bytes == 0 {
            self.first_line = self.lines.line;
        }
        self.record_bytes += self.line.len();
        if self.record_bytes > LONGEST_LINE {
            let line = self.first_line;
            let message = format!("a quote (\") is opened in line {line} and not closed; close it");
            return Err(self.lines.error(message));
        }
        self.line.push('\n');
        self.separate();
        Ok(true)
    }

    /// Leaves one space between columns that are set apart by any number of them.
    fn separate(&mut self) {
        if self.separator == ' ' {
            self.line = self.line.split_ascii_whitespace().collect::<Vec<_>>().join(" ") + "\n";
        }
    }
}

impl Read for Text<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.sent == self.line.len() && !self.next_line().map_err(io::Error::other)? {
            return Ok(0);
        }
        let count = buffer.len().min(self.line.len() - self.sent);
        buffer[..count].copy_from_slice(&self.line.as_bytes()[self.sent..][..count]);
        self.sent += count;
        Ok(count)
    }
}

/// Writes a header and a line per point, each number with the fewest digits that bring back its bits.
pub fn write<const D: usize>(file: &mut dyn Write, cloud: &PointCloud<D>) -> io::Result<()> {
    writeln!(file, "{}", cloud.names(D).join(","))?;
    for point in 0..cloud.positions.len() {
        for (column, number) in cloud.numbers(point, D).into_iter().enumerate() {
            let separator = if column == 0 { "" } else { "," };
            write!(file, "{separator}{number:?}")?;
        }
        writeln!(file)?;
    }
    Ok(())
}
