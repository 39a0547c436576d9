//! The header of a PLY file (Turk, "The PLY Polygon File Format", 1994; Stanford University).

use super::PointsError;
use super::lines::{Lines, shown};

/// How the data behind the header are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Float32,
    Float64,
}

impl Scalar {
    /// By either of its names: those of 1994 and those with their bits.
    fn named(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Self::Int8,
            "uchar" | "uint8" => Self::UInt8,
            "short" | "int16" => Self::Int16,
            "ushort" | "uint16" => Self::UInt16,
            "int" | "int32" => Self::Int32,
            "uint" | "uint32" => Self::UInt32,
            "float" | "float32" => Self::Float32,
            "double" | "float64" => Self::Float64,
            _ => {
                return Err(format!(
                    "{} is no type; allowed are char, uchar, short, ushort, int, uint, float and double",
                    shown(name)
                ));
            }
        })
    }

    fn is_whole(self) -> bool {
        !matches!(self, Self::Float32 | Self::Float64)
    }

    /// Its size [bytes].
    pub fn size(self) -> usize {
        match self {
            Self::Int8 | Self::UInt8 => 1,
            Self::Int16 | Self::UInt16 => 2,
            Self::Int32 | Self::UInt32 | Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }

    /// The number whose bytes, least significant first, are the first [`size`](Self::size) of `b`. Exact for every type.
    pub fn decode(self, b: [u8; 8]) -> f64 {
        match self {
            Self::Int8 => i8::from_le_bytes([b[0]]).into(),
            Self::UInt8 => b[0].into(),
            Self::Int16 => i16::from_le_bytes([b[0], b[1]]).into(),
            Self::UInt16 => u16::from_le_bytes([b[0], b[1]]).into(),
            Self::Int32 => i32::from_le_bytes([b[0], b[1], b[2], b[3]]).into(),
            Self::UInt32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]).into(),
            Self::Float32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]).into(),
            Self::Float64 => f64::from_le_bytes(b),
        }
    }
}

/// What one property of an element holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Number(Scalar),
    /// A count, of a whole type, and as many items.
    List {
        count: Scalar,
        item: Scalar,
    },
}

/// A named property.
#[derive(Clone, Debug)]
pub struct Property {
    pub name: String,
    pub kind: Kind,
}

/// `count` rows of the same properties.
#[derive(Clone, Debug)]
pub struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

/// What the data are.
#[derive(Clone, Debug)]
pub struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

/// Reads the header and leaves the file at the first byte of the data.
pub fn read(lines: &mut Lines) -> Result<Header, PointsError> {
    if lines.next_line()?.map(str::trim_end) != Some("ply") {
        return Err(lines.error("a PLY file begins with a line `ply`; is this another format?"));
    }
    let (mut encoding, mut elements) = (None, Vec::new());
    loop {
        let Some(text) = lines.next_line()? else {
            return Err(lines.error("the file ends in its header, before `end_header`; write it again"));
        };
        match understand(text, &mut encoding, &mut elements) {
            Ok(true) => {}
            Ok(false) => break,
            Err(message) => return Err(lines.error(message)),
        }
    }
    let Some(encoding) = encoding else {
        return Err(lines.error("the header has no `format`; add `format ascii 1.0` or what the data are"));
    };
    for element in &elements {
        if element.properties.is_empty() && element.count > 0 {
            let name = shown(&element.name);
            let message = format!("element {name} has {} rows but no property; give it one", element.count);
            return Err(lines.error(message));
        }
    }
    Ok(Header { encoding, elements })
}

/// Takes one line of the header; false at its end.
fn understand(
    text: &str,
    encoding: &mut Option<Encoding>,
    elements: &mut Vec<Element>,
) -> Result<bool, String> {
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    match words[..] {
        ["end_header"] => return Ok(false),
        ["comment" | "obj_info", ..] => {}
        ["format", name, "1.0"] => *encoding = Some(encoding_named(name)?),
        ["element", name, count] => {
            let count = count.parse().map_err(|_| {
                let (name, count) = (shown(name), shown(count));
                format!(
                    "element {name} counts {count} rows; a whole number from 0 to {} is expected",
                    u64::MAX
                )
            })?;
            elements.push(Element { name: name.into(), count, properties: Vec::new() });
        }
        ["property", "list", count, item, name] => {
            let (count, item) = (Scalar::named(count)?, Scalar::named(item)?);
            if !count.is_whole() {
                let name = shown(name);
                return Err(format!("list {name} is counted by a float; use a whole type such as uchar"));
            }
            add_property(elements, name, Kind::List { count, item })?;
        }
        ["property", kind, name] => add_property(elements, name, Kind::Number(Scalar::named(kind)?))?,
        _ => {
            return Err(format!(
                "{} is no line of a PLY header; allowed are format NAME 1.0, comment, obj_info, \
                 element NAME COUNT, property TYPE NAME, property list TYPE TYPE NAME, end_header",
                shown(text)
            ));
        }
    }
    Ok(true)
}

fn encoding_named(name: &str) -> Result<Encoding, String> {
    match name {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(format!(
            "{} is no format; allowed are ascii, binary_little_endian and binary_big_endian",
            shown(name)
        )),
    }
}

fn add_property(elements: &mut [Element], name: &str, kind: Kind) -> Result<(), String> {
    let Some(element) = elements.last_mut() else {
        return Err(format!("property {} stands before any element; name its element first", shown(name)));
    };
    element.properties.push(Property { name: name.into(), kind });
    Ok(())
}
