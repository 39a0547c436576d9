//! Mitsuba's grid volume (Mitsuba 3 documentation, plugin `gridvolume`): `VOL`, u8 version 3, i32 kind 1 (single precision), i32 x 3 size, i32 channels,
//! f32 x 6 box, then the values with x running fastest, all little-endian. Values stand at the middles of the box's cells.

use std::io::{self, Write};

use super::Density;

/// Nodes without density round the others, so that interpolation ends in nothing.
pub const MARGIN: i32 = 2;

/// Writes the density over that at rest, in the box of these first and last nodes.
pub fn write(file: &mut dyn Write, density: &Density, [low, high]: [[i32; 3]; 2]) -> io::Result<()> {
    let size: [usize; 3] = std::array::from_fn(|axis| (high[axis] - low[axis]) as usize + 1);
    file.write_all(b"VOL\x03")?;
    for number in [1].into_iter().chain(size).chain([1]) {
        file.write_all(&(number as i32).to_le_bytes())?;
    }
    // A node is the middle of a cell of the box.
    let ends = [low.map(|n| f64::from(n) - 0.5), high.map(|n| f64::from(n) + 0.5)];
    for end in ends.iter().flatten() {
        file.write_all(&((end * density.cell) as f32).to_le_bytes())?;
    }
    let mut values = vec![0.0_f32; size.iter().product()];
    for (node, value) in density.values() {
        let [i, j, k]: [usize; 3] = std::array::from_fn(|axis| (node[axis] - low[axis]) as usize);
        values[(k * size[1] + j) * size[0] + i] = value as f32;
    }
    values.iter().try_for_each(|value| file.write_all(&value.to_le_bytes()))
}
