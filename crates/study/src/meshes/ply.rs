//! PLY (Turk 1994), text and binary, by ply-rs-bw: `x`, `y`, `z` of the element `vertex`, and the corners of the element
//! `face`.

use std::io::BufRead;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult};
use snowlab_solver::geometry::Vector;

use super::{Fault, Soup, said};

/// A row of any element: what is wanted of it.
#[derive(Default)]
struct Row {
    position: [Option<f64>; 3],
    corners: Option<Vec<u32>>,
}

impl PropertyAccess for Row {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        match name {
            "x" => self.position[0] = number(&value),
            "y" => self.position[1] = number(&value),
            "z" => self.position[2] = number(&value),
            "vertex_indices" | "vertex_index" => self.corners = value.to_u32_list(),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

fn number(value: &Property) -> Option<f64> {
    match *value {
        Property::Char(value) => Some(value.into()),
        Property::UChar(value) => Some(value.into()),
        Property::Short(value) => Some(value.into()),
        Property::UShort(value) => Some(value.into()),
        Property::Int(value) => Some(value.into()),
        Property::UInt(value) => Some(value.into()),
        Property::Float(value) => Some(value.into()),
        Property::Double(value) => Some(value),
        _ => None,
    }
}

pub fn read(bytes: &[u8]) -> Result<Soup, Fault> {
    let parser = Parser::<Row>::new();
    let mut source = Reader::new(bytes);
    let header = parser.read_header(&mut source).map_err(refused)?;
    let mut soup = Soup::default();
    for element in header.elements.values() {
        check_rows(element, source.get_ref().len())?;
        let rows = parser.read_payload_for_element(&mut source, element, &header).map_err(refused)?;
        match element.name.as_str() {
            "vertex" => soup.vertices = rows.iter().enumerate().map(position).collect::<Result<_, _>>()?,
            "face" => {
                rows.iter().enumerate().try_for_each(|(number, row)| add_face(&mut soup, number, row))?
            }
            _ => {}
        }
    }
    let rest = source.get_mut().fill_buf().unwrap_or_default();
    if !rest.trim_ascii().is_empty() {
        return Err(
            String::from("data follow the last row that the header promises; write the mesh again").into()
        );
    }
    Ok(soup)
}

/// Refuses counts that the file has no room for: a row takes a byte at the least.
fn check_rows(element: &ElementDef, bytes: usize) -> Result<(), Fault> {
    let (name, count) = (said(&element.name), element.count);
    if count > bytes {
        return Err(
            format!("element {name} has {count} rows by the header, but {bytes} bytes are left").into()
        );
    }
    if count > 0 && element.properties.is_empty() {
        return Err(format!("element {name} has {count} rows but no property; give it one").into());
    }
    Ok(())
}

fn refused(error: ParseError) -> Fault {
    format!("is no PLY: {}; write the mesh again", said(error)).into()
}

fn position((number, row): (usize, &Row)) -> Result<Vector<f64, 3>, Fault> {
    match row.position {
        [Some(x), Some(y), Some(z)] => Ok(Vector::<f64, 3>::new(x, y, z)),
        _ => Err(format!("vertex {number} (from 0) has no numbers `x`, `y` and `z`").into()),
    }
}

fn add_face(soup: &mut Soup, number: usize, row: &Row) -> Result<(), Fault> {
    let corners = row.corners.as_ref().ok_or_else(|| {
        format!("face {number} (from 0) has no list `vertex_indices` of whole numbers from 0")
    })?;
    soup.add_polygon(corners);
    Ok(())
}
