//! Wavefront OBJ, by tobj, which is shown the lines of vertices and faces alone, and of these the positions.

use std::io::{self, BufRead, Read};

use snowlab_solver::geometry::Vector;
use tobj::{LoadError, LoadOptions};

use super::{Fault, Soup, said};

pub fn read(bytes: &[u8]) -> Result<Soup, Fault> {
    let options = LoadOptions { triangulate: true, single_index: true, ..LoadOptions::default() };
    let mut lines = Positions { rest: bytes, line: 0, shown: Vec::new(), used: 0 };
    let (models, _) = tobj::load_obj_buf(&mut lines, &options, |_| Err(LoadError::OpenFileFailed))
        .map_err(|error| fault(error, lines.line))?;
    let mut soup = Soup::default();
    for mesh in models.into_iter().map(|model| model.mesh) {
        let before = soup.vertices.len() as u32;
        soup.vertices.extend(mesh.positions.chunks_exact(3).map(Vector::<f64, 3>::from_column_slice));
        let corners = mesh.indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|corner| corner + before));
        soup.triangles.extend(corners);
    }
    Ok(soup)
}

fn fault(error: LoadError, line: u64) -> Fault {
    let message = match error {
        LoadError::PositionParseError | LoadError::ScalingByZeroError => {
            "`v` is followed by three numbers, or four of which the last is not 0"
        }
        LoadError::FaceParseError => "`f` is followed by numbers of vertices, from 1 or from -1 backwards",
        // Told at the end of the file.
        LoadError::FaceVertexOutOfBounds | LoadError::InvalidPolygon => {
            return String::from("a face `f` has no vertex, or one that is not there; write the mesh again")
                .into();
        }
        other => return format!("is no OBJ: {}; write the mesh again", said(other)).into(),
    };
    Fault { line: Some(line), message: message.into() }
}

/// The lines that begin with `v` or `f`, with positions and numbers of positions alone, one at a time.
struct Positions<'a> {
    rest: &'a [u8],
    /// Number of the line that is shown, from 1.
    line: u64,
    shown: Vec<u8>,
    used: usize,
}

impl Positions<'_> {
    /// Turns to the next line that counts; at the end there is nothing to show.
    fn advance(&mut self) {
        self.shown.clear();
        self.used = 0;
        while !self.rest.is_empty() && self.shown.is_empty() {
            let length = self.rest.iter().position(|b| *b == b'\n').unwrap_or(self.rest.len() - 1) + 1;
            let (line, rest) = self.rest.split_at(length);
            (self.rest, self.line) = (rest, self.line + 1);
            if let [b'v' | b'f', b' ' | b'\t', ..] = line.trim_ascii_start() {
                self.shown = positions(&String::from_utf8_lossy(line)).into_bytes();
            }
        }
    }
}

/// A line of a vertex without its colour, or of a face without textures and normals.
fn positions(line: &str) -> String {
    let words = line.split_whitespace().map(|word| word.split('/').next().unwrap_or_default());
    let words: Vec<&str> = words.collect();
    // A fourth number alone is a weight.
    let count = if words[0] == "v" && words.len() != 5 { words.len().min(4) } else { words.len() };
    words[..count].join(" ") + "\n"
}

impl Read for Positions<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(buffer)?;
        self.consume(read);
        Ok(read)
    }
}

impl BufRead for Positions<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.used == self.shown.len() {
            self.advance();
        }
        Ok(&self.shown[self.used..])
    }

    fn consume(&mut self, amount: usize) {
        self.used += amount;
    }
}
