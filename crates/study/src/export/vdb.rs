//! OpenVDB (Museth 2013; the library's `io` sources for the order of bytes): one grid `density` of the usual tree 5-4-3, a fog volume, not compressed,
//! little-endian. Only leaves in which density is are there.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

use super::Density;
use super::density::EDGE;

/// Identifies the format.
const MAGIC: i64 = 0x5644_4220;
/// Version of the format, and of the library that wrote it first.
const FILE_VERSION: u32 = 224;
const LIBRARY: [u32; 2] = [8, 1];
/// A name of the file that is the same for the same content: 36 characters in the form of a UUID.
const NAME: &str = "736e6f77-6c61-4062-8064-656e73697479";
/// No compression.
const COMPRESSION: u32 = 0;
/// Before values of which all are written.
const ALL_VALUES: u8 = 6;
/// Binary logarithms of the children along an edge of a leaf, of a node of leaves and of a node of those.
const LEAF: u32 = 3;
const LOWER: u32 = 4;
const UPPER: u32 = 5;

type Origin = [i32; 3];

/// Leaves by the nodes that hold them.
type Tree = BTreeMap<Origin, BTreeMap<Origin, BTreeSet<Origin>>>;

/// Writes the density over that at rest.
pub fn write(file: &mut dyn Write, density: &Density) -> io::Result<()> {
    let mut out = Vec::new();
    out.extend(MAGIC.to_le_bytes());
    for number in [FILE_VERSION].into_iter().chain(LIBRARY) {
        out.extend(number.to_le_bytes());
    }
    // Offsets of the grids are given.
    out.push(1);
    out.extend(NAME.bytes());
    metadata(&mut out, &[("creator", "snowlab")]);
    out.extend(1_u32.to_le_bytes());

    text(&mut out, "density");
    text(&mut out, "Tree_float_5_4_3");
    text(&mut out, "");
    // Where grid, blocks and end are: filled in below.
    let offsets = out.len();
    out.extend([0; 3 * size_of::<i64>()]);
    let grid = out.len();
    out.extend(COMPRESSION.to_le_bytes());
    metadata(&mut out, &[("class", "fog volume"), ("name", "density")]);
    transform(&mut out, density.cell);
    let tree = tree(density);
    topology(&mut out, &tree, density);
    let blocks = out.len();
    for leaf in tree.values().flat_map(BTreeMap::values).flatten() {
        let values = &density.blocks[leaf];
        out.extend(leaf_mask(values.as_slice()));
        out.push(ALL_VALUES);
        values.iter().for_each(|value| out.extend((*value as f32).to_le_bytes()));
    }
    let end = out.len();
    for (k, place) in [grid, blocks, end].into_iter().enumerate() {
        let at = offsets + k * size_of::<i64>();
        out[at..at + size_of::<i64>()].copy_from_slice(&(place as i64).to_le_bytes());
    }
    file.write_all(&out)
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.bytes());
}

fn metadata(out: &mut Vec<u8>, entries: &[(&str, &str)]) {
    out.extend((entries.len() as u32).to_le_bytes());
    for (name, value) in entries {
        text(out, name);
        text(out, "string");
        text(out, value);
    }
}

/// Nodes at the multiples of `cell`: scale, size of a voxel, and their inverses, each three times.
fn transform(out: &mut Vec<u8>, cell: f64) {
    text(out, "UniformScaleMap");
    for number in [cell, cell, 1.0 / cell, 1.0 / (cell * cell), 0.5 / cell] {
        (0..3).for_each(|_| out.extend(number.to_le_bytes()));
    }
}

/// The first voxel of the node of side 2^`bits` that a voxel lies in.
fn origin(voxel: &Origin, bits: u32) -> Origin {
    voxel.map(|n| (n >> bits) << bits)
}

fn tree(density: &Density) -> Tree {
    debug_assert_eq!(EDGE, 1 << LEAF);
    let mut tree = Tree::new();
    for leaf in density.blocks.keys() {
        let upper = tree.entry(origin(leaf, LEAF + LOWER + UPPER)).or_default();
        upper.entry(origin(leaf, LEAF + LOWER)).or_default().insert(*leaf);
    }
    tree
}

fn topology(out: &mut Vec<u8>, tree: &Tree, density: &Density) {
    // One buffer; background 0; no tiles.
    out.extend(1_i32.to_le_bytes());
    out.extend(0_f32.to_le_bytes());
    out.extend(0_u32.to_le_bytes());
    out.extend((tree.len() as u32).to_le_bytes());
    for (first, lower) in tree {
        first.iter().for_each(|n| out.extend(n.to_le_bytes()));
        node(out, lower.keys(), UPPER, LEAF + LOWER);
        for leaves in lower.values() {
            node(out, leaves.iter(), LOWER, LEAF);
            leaves.iter().for_each(|leaf| out.extend(leaf_mask(density.blocks[leaf].as_slice())));
        }
    }
}

/// A node of 2^`bits` children along an edge, each with 2^`below` voxels along its own: which it has, no tiles, and nothing in their places.
fn node<'a>(out: &mut Vec<u8>, children: impl Iterator<Item = &'a Origin>, bits: u32, below: u32) {
    let count = 1 << (3 * bits);
    let mut mask = vec![0_u8; count / 8];
    for child in children {
        let [i, j, k] = child.map(|n| ((n >> below) & ((1 << bits) - 1)) as usize);
        set(&mut mask, (((i << bits) | j) << bits) | k);
    }
    out.extend(&mask);
    out.extend(vec![0; count / 8]);
    out.push(ALL_VALUES);
    out.extend(vec![0; count * size_of::<f32>()]);
}

/// Which voxels of a leaf hold something.
fn leaf_mask(values: &[f64]) -> Vec<u8> {
    let mut mask = vec![0; values.len() / 8];
    values.iter().enumerate().filter(|(_, value)| **value > 0.0).for_each(|(n, _)| set(&mut mask, n));
    mask
}

fn set(mask: &mut [u8], bit: usize) {
    mask[bit / 8] |= 1 << (bit % 8);
}
