//! STL (3D Systems 1988), text and binary, by stl_io, whose narrow idea of both is met halfway.

use std::io::Cursor;

use snowlab_solver::geometry::Vector;

use super::{Fault, Soup, said};

/// Bytes before the number of triangles, before the first of them, and of each.
const HEADER: usize = 80;
const START: usize = 84;
const TRIANGLE: usize = 50;

pub fn read(bytes: Vec<u8>) -> Result<Soup, Fault> {
    let bytes = if is_binary(&bytes) { unnamed(bytes) } else { one_solid(&bytes)? };
    let mut source = Cursor::new(bytes);
    let facets = stl_io::create_stl_reader(&mut source).map_err(|error| refused(0, &error))?;
    let mut soup = Soup::default();
    for (number, facet) in facets.enumerate() {
        let facet = facet.map_err(|error| refused(number, &error))?;
        let first = soup.vertices.len() as u32;
        let corners = facet.vertices.iter().map(|corner| Vector::<f64, 3>::from(corner.0.map(f64::from)));
        soup.vertices.extend(corners);
        soup.triangles.push([first, first + 1, first + 2]);
    }
    Ok(soup)
}

fn refused(facet: usize, error: &std::io::Error) -> Fault {
    format!("facet {facet} (from 0) is none of an STL: {}; write the mesh again", said(error)).into()
}

/// Whether the file is as long as the number of triangles says.
fn is_binary(bytes: &[u8]) -> bool {
    let count = bytes.get(HEADER..START).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|count| bytes.len() as u64 == START as u64 + TRIANGLE as u64 * u64::from(count))
}

/// Binary files may begin with `solid` too, which the reader would take for text.
fn unnamed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes[..HEADER].fill(0);
    bytes
}

/// A text of any number of solids as one, in small letters and without normals, which may be no numbers.
fn one_solid(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let text = bytes.trim_ascii_start();
    // Text has no zero bytes.
    if !text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) || text.contains(&0) {
        let bytes = bytes.len();
        return Err(format!(
            "is no STL: text begins with `solid`, and binary data of n triangles have {START} + {TRIANGLE} n bytes, not \
             {bytes}; write the mesh again"
        )
        .into());
    }
    let (mut solids, mut ends) = (0, 0);
    let mut joined = b"solid mesh\n".to_vec();
    for line in text.split(|b| *b == b'\n').map(|line| line.trim_ascii().to_ascii_lowercase()) {
        match line.split(u8::is_ascii_whitespace).next().unwrap_or_default() {
            b"solid" => solids += 1,
            b"endsolid" => ends += 1,
            b"facet" => joined.extend(b"facet normal 0 0 0\n"),
            _ => joined.extend([&line[..], b"\n"].concat()),
        }
    }
    if solids != ends {
        return Err(
            format!("has `solid` {solids} times and `endsolid` {ends} times; write the mesh again").into()
        );
    }
    joined.extend(b"endsolid mesh\n");
    Ok(joined)
}
