//! Points as PLY (Turk 1994): the element `vertex`, with its numbers in any order and of any type, ascii or binary.
//! Other elements and lists are passed over, and must be there as the header says.

use std::io::{self, BufRead, Read, Write};
use std::path::Path;

use super::columns::{Columns, Table};
use super::lines::{Lines, shown};
use super::ply_header::{self, Element, Encoding, Header, Kind, Scalar};
use super::{PointCloud, PointsError, format_error};

const VERTEX: &str = "vertex";

/// Reads all points.
pub fn read(path: &Path, source: impl BufRead) -> Result<Table, PointsError> {
    let mut lines = Lines::new(path, source);
    let header = ply_header::read(&mut lines)?;
    let columns = columns_of(&header).map_err(|message| format_error(path, 0, message))?;
    let mut table = Table::new(columns);
    for element in &header.elements {
        for row in 0..element.count {
            let values = match header.encoding {
                Encoding::Ascii => ascii_row(&mut lines, element, row)?,
                encoding => binary_row(&mut lines, element, row, encoding)?,
            };
            if element.name == VERTEX {
                let line = if header.encoding == Encoding::Ascii { lines.line } else { 0 };
                table.push(line, |column| Ok(values[column])).map_err(|message| {
                    format_error(path, line, format!("{}: {message}", place(element, row)))
                })?;
            }
        }
    }
    expect_end(&mut lines, header.encoding)?;
    Ok(table)
}

/// Where the vertex has its coordinates.
fn columns_of(header: &Header) -> Result<Columns, String> {
    let mut vertices = header.elements.iter().filter(|element| element.name == VERTEX);
    let vertex = match (vertices.next(), vertices.next()) {
        (Some(vertex), None) => vertex,
        (None, _) => return Err("the header has no `element vertex`; points are read from it".into()),
        _ => return Err("the header has `element vertex` twice; join them".into()),
    };
    // A list keeps its place among the columns under a name that none of ours has.
    let names: Vec<&str> = vertex
        .properties
        .iter()
        .map(|property| if matches!(property.kind, Kind::Number(_)) { &property.name } else { "(list)" })
        .collect();
    Columns::named(&names).map_err(|message| format!("in `element vertex`: {message}"))
}

/// The numbers of the next line, 0 in place of each list.
fn ascii_row(lines: &mut Lines, element: &Element, row: u64) -> Result<Vec<f64>, PointsError> {
    match lines.next_line()? {
        None => Err(lines.error(too_short(element, row))),
        Some(text) => parse_row(text, element)
            .map_err(|message| lines.error(format!("{}: {message}", place(element, row)))),
    }
}

fn parse_row(text: &str, element: &Element) -> Result<Vec<f64>, String> {
    let mut words = text.split_ascii_whitespace();
    let mut values = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        let name = shown(&property.name);
        let mut word =
            || words.next().ok_or_else(|| format!("the line ends before {name}; give every property"));
        let first = word()?;
        match property.kind {
            Kind::Number(_) => values.push(
                first.parse().map_err(|_| format!("{name} is {}; a number is expected", shown(first)))?,
            ),
            Kind::List { .. } => {
                let count: u64 = first.parse().map_err(|_| {
                    format!("list {name} counts {} items; a whole number from 0 is expected", shown(first))
                })?;
                for _ in 0..count {
                    word()?;
                }
                values.push(0.0);
            }
        }
    }
    match words.next() {
        Some(word) => Err(format!("{} follows the last property; leave it out or name it", shown(word))),
        None => Ok(values),
    }
}

/// The numbers of the next row of binary data, 0 in place of each list.
fn binary_row(
    lines: &mut Lines,
    element: &Element,
    row: u64,
    encoding: Encoding,
) -> Result<Vec<f64>, PointsError> {
    let mut values = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        let read = match property.kind {
            Kind::Number(scalar) => number(&mut lines.rest, scalar, encoding),
            Kind::List { count, item } => match number(&mut lines.rest, count, encoding) {
                Ok(count) if count < 0.0 => {
                    let (place, name) = (place(element, row), shown(&property.name));
                    let message =
                        format!("{place}: list {name} counts {count} items; 0 or more are expected");
                    return Err(lines.error_in_data(message));
                }
                // At most 2^32 items of at most 8 bytes.
                Ok(count) => skip(&mut lines.rest, count as u64 * item.size() as u64).map(|()| 0.0),
                Err(error) => Err(error),
            },
        };
        match read {
            Ok(value) => values.push(value),
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return Err(lines.error_in_data(too_short(element, row)));
            }
            Err(error) => return Err(lines.io(error)),
        }
    }
    Ok(values)
}

fn number(source: &mut impl Read, scalar: Scalar, encoding: Encoding) -> io::Result<f64> {
    let mut bytes = [0; 8];
    let own = &mut bytes[..scalar.size()];
    source.read_exact(own)?;
    if encoding == Encoding::BigEndian {
        own.reverse();
    }
    Ok(scalar.decode(bytes))
}

fn skip(source: &mut impl Read, bytes: u64) -> io::Result<()> {
    let skipped = io::copy(&mut source.take(bytes), &mut io::sink())?;
    if skipped == bytes { Ok(()) } else { Err(io::ErrorKind::UnexpectedEof.into()) }
}

/// Refuses data behind the last element: the header then belongs to other data. White space may follow.
fn expect_end(lines: &mut Lines, encoding: Encoding) -> Result<(), PointsError> {
    const MESSAGE: &str =
        "data follow the last row that the header promises; correct its counts and properties";
    if encoding == Encoding::Ascii {
        return if lines.next_line()?.is_none() { Ok(()) } else { Err(lines.error(MESSAGE)) };
    }
    loop {
        let bytes = match lines.rest.fill_buf() {
            Ok(bytes) => bytes,
            Err(error) => return Err(lines.io(error)),
        };
        match (bytes.len(), bytes.trim_ascii().is_empty()) {
            (0, _) => return Ok(()),
            (count, true) => lines.rest.consume(count),
            (_, false) => return Err(lines.error_in_data(MESSAGE)),
        }
    }
}

fn place(element: &Element, row: u64) -> String {
    if element.name == VERTEX {
        format!("vertex {row} (from 0)")
    } else {
        format!("element {}, row {row} (from 0)", shown(&element.name))
    }
}

fn too_short(element: &Element, row: u64) -> String {
    let (place, count) = (place(element, row), element.count);
    format!(
        "{place}: the file ends here, but its header promises {count} rows; write it again or correct the count"
    )
}

/// Writes binary little-endian doubles; in 2D z = 0 and vz = 0.
pub fn write<const D: usize>(file: &mut dyn Write, cloud: &PointCloud<D>) -> io::Result<()> {
    let points = cloud.positions.len();
    write!(file, "ply\nformat binary_little_endian 1.0\nelement {VERTEX} {points}\n")?;
    for name in cloud.names(3) {
        writeln!(file, "property double {name}")?;
    }
    writeln!(file, "end_header")?;
    for point in 0..points {
        for number in cloud.numbers(point, 3) {
            file.write_all(&number.to_le_bytes())?;
        }
    }
    Ok(())
}
