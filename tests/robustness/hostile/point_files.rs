//! Files of points that are made up, most of them nearly right.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bytes;
use super::telling::{NUMBERS_IN_TEXT, one_of};
use crate::points::{varied_ascii, varied_binary};

/// Columns that are taken, others, and some that look like them.
const COLUMNS: [&str; 29] = [
    "x", "y", "z", "vx", "vy", "vz", "mass", "volume", "jp", "fxx", "fxy", "fxz", "fyx", "fyy", "fyz", "fzx",
    "fzy", "fzz", "X", "Mass", "id", "radius", "x ", "", "\"x\"", "x;y", "#", "0.5", "é",
];
const LINE_ENDS: [&str; 4] = ["\n", "\r\n", "\n\n", "\r"];
const TYPES: [&str; 12] = [
    "char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8", "uint32", "float64", "real",
];
/// Counts of a header that promises more than there is, or is none.
const COUNTS: [&str; 10] = [
    "1000000000",
    "4294967296",
    "18446744073709551615",
    "18446744073709551616",
    "-1",
    "1e3",
    "nan",
    "0",
    "1",
    "2",
];

/// A CSV: made up, or a valid one with some bytes changed, or both.
pub fn csv(random: &mut ChaCha8Rng) -> Vec<u8> {
    const VALID: [&str; 4] = [
        "id,y,x,z,vx,vy,vz,mass\n0,1.5,2,0,1,2,3,1\n1,-1e-3,2.25,3,1,2,3,0.5\n",
        "\"name\";\"x\";\"y\"\r\n\"a;b\";1;2\r\n# no\r\nc;3;-4.5\r\n",
        "0.5 0.25\n-1 2e3\n",
        "x,y,vx,vy,mass,volume,jp,fxx,fxy,fyx,fyy\n0,0,1,1,2,0.5,1,1,0,0,1\n1,0,1,1,2,0.5,0.9,1,0.1,0,1\n",
    ];
    let others: Vec<&[u8]> = VALID.iter().map(|text| text.as_bytes()).collect();
    let way = random.random_range(0..4);
    let file = if way < 2 { made_up_csv(random) } else { one_of(&others, random).to_vec() };
    if way == 0 { file } else { bytes::mutated(&file, &others, random) }
}

fn made_up_csv(random: &mut ChaCha8Rng) -> Vec<u8> {
    let separator = one_of(&[",", ";", "\t", " ", ", ", "|"], random);
    let end = one_of(&LINE_ENDS, random);
    let columns = columns(random);
    let mut text = one_of(&["", "", "", "\u{feff}", "# note\n", "\n"], random).to_string();
    if random.random_range(0..5) > 0 {
        text += &columns.join(separator);
        text += end;
    }
    for _ in 0..random.random_range(0..6) {
        let width = columns.len() + [0, 0, 0, 0, 0, 0, 0, 1][random.random_range(0..8)];
        let fields: Vec<String> = (0..width).map(|_| field(random)).collect();
        text += &fields.join(separator);
        text += end;
    }
    text.into_bytes()
}

/// Coordinates first, mostly, and whatever else.
fn columns(random: &mut ChaCha8Rng) -> Vec<&'static str> {
    let usual: &[&str] = match random.random_range(0..8) {
        0 => &[],
        1..=3 => &COLUMNS[..3],
        4 => &COLUMNS[..9],
        5 => &COLUMNS[..18],
        _ => &COLUMNS[..2],
    };
    let more = if random.random() { random.random_range(0..4) } else { 0 };
    usual.iter().copied().chain((0..more).map(|_| one_of(&COLUMNS, random))).collect()
}

fn field(random: &mut ChaCha8Rng) -> String {
    match random.random_range(0..60) {
        0 => one_of(&NUMBERS_IN_TEXT, random).to_string(),
        1 => one_of(&["", "up", "\"", "\"1\"", "\"1\n2\"", "1 2", "\u{7}", "#"], random).to_string(),
        _ => format!("{}", f64::from(random.random_range(1..100)) / 8.0),
    }
}

/// A PLY: made up, or a valid one with some bytes changed, or both.
pub fn ply(random: &mut ChaCha8Rng) -> Vec<u8> {
    let valid = [varied_ascii(), varied_binary(false), varied_binary(true)];
    let others: Vec<&[u8]> = valid.iter().map(Vec::as_slice).collect();
    let way = random.random_range(0..4);
    let file = if way < 2 { made_up_ply(random) } else { one_of(&others, random).to_vec() };
    if way == 0 { file } else { bytes::mutated(&file, &others, random) }
}

/// A header of any elements, and data that fit it but for a count here and there.
fn made_up_ply(random: &mut ChaCha8Rng) -> Vec<u8> {
    let encoding = one_of(&["ascii", "binary_little_endian", "binary_big_endian"], random);
    let mut header = format!("ply\nformat {encoding} 1.0\n");
    let mut data = Vec::new();
    for k in 0..random.random_range(1..4) {
        let name =
            if k == 0 { "vertex" } else { one_of(&["face", "edge", "vertex", "é", "material"], random) };
        let rows = random.random_range(0..4);
        let said = if random.random_range(0..12) == 0 {
            one_of(&COUNTS, random).to_string()
        } else {
            format!("{rows}")
        };
        header += &format!("element {name} {said}\n");
        let properties = properties(k == 0, random);
        for property in &properties {
            header += &property.line();
        }
        for _ in 0..rows {
            properties.iter().for_each(|property| property.put(encoding, &mut data, random));
            if encoding == "ascii" {
                data.push(b'\n');
            }
        }
    }
    header += "end_header\n";
    [header.into_bytes(), data].concat()
}

struct Property {
    name: &'static str,
    kind: &'static str,
    /// What counts its items, where it is a list.
    counted_by: Option<&'static str>,
}

fn properties(of_vertex: bool, random: &mut ChaCha8Rng) -> Vec<Property> {
    let kinds = if random.random_range(0..10) == 0 { &TYPES[..] } else { &TYPES[..8] };
    let names = if of_vertex { columns(random) } else { vec!["a"; random.random_range(0..3)] };
    let mut properties = Vec::new();
    for name in names.into_iter().filter(|name| !name.is_empty()) {
        let counted_by = (random.random_range(0..12) == 0).then(|| one_of(kinds, random));
        properties.push(Property { name, kind: one_of(kinds, random), counted_by });
    }
    properties
}

impl Property {
    fn line(&self) -> String {
        match self.counted_by {
            Some(count) => format!("property list {count} {} {}\n", self.kind, self.name),
            None => format!("property {} {}\n", self.kind, self.name),
        }
    }

    /// A value, or a list that mostly has as many items as it says.
    fn put(&self, encoding: &str, data: &mut Vec<u8>, random: &mut ChaCha8Rng) {
        let mut items = 1;
        if let Some(count) = self.counted_by {
            items = random.random_range(0..4);
            let said = if random.random_range(0..12) == 0 { 127 } else { items };
            number(f64::from(said), count, encoding, data);
        }
        for _ in 0..items {
            if encoding == "ascii" && random.random_range(0..60) == 0 {
                data.extend([one_of(&NUMBERS_IN_TEXT, random).as_bytes(), b" "].concat());
            } else {
                number(f64::from(random.random_range(1..100)), self.kind, encoding, data);
            }
        }
    }
}

fn number(value: f64, kind: &str, encoding: &str, data: &mut Vec<u8>) {
    let mut bytes = match kind {
        _ if encoding == "ascii" => return data.extend(format!("{value} ").bytes()),
        "char" | "uchar" | "int8" => vec![value as u8],
        "short" | "ushort" => (value as u16).to_le_bytes().to_vec(),
        "int" | "uint" | "uint32" => (value as u32).to_le_bytes().to_vec(),
        "float" => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if encoding == "binary_big_endian" {
        bytes.reverse();
    }
    data.extend(bytes);
}
