//! Binary little-endian PLY in single precision, which is what Blender, Houdini and MeshLab keep: x y z, vx vy vz, mass, volume, jp, id, fragment. For
//! text and double precision there is `csv`.

use std::io::{self, Write};

use super::{Snapshot, Values};

/// Writes the particles as vertices.
pub fn write(file: &mut dyn Write, snapshot: &Snapshot) -> io::Result<()> {
    let fields: Vec<_> =
        snapshot.fields().into_iter().filter(|field| !matches!(field.values, Values::Matrices(_))).collect();
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\ncomment snowlab, metres, time {:?} s\nelement vertex {}\n",
        snapshot.time,
        snapshot.ids.len()
    )?;
    ["x", "y", "z"].iter().try_for_each(|name| writeln!(file, "property float {name}"))?;
    for field in &fields {
        match field.values {
            Values::Labels(_) => writeln!(file, "property int {}", field.name)?,
            Values::Vectors(_) => {
                ["vx", "vy", "vz"].iter().try_for_each(|name| writeln!(file, "property float {name}"))?;
            }
            _ => writeln!(file, "property float {}", field.name)?,
        }
    }
    writeln!(file, "end_header")?;
    for (p, position) in snapshot.positions.iter().enumerate() {
        position.iter().try_for_each(|x| file.write_all(&(*x as f32).to_le_bytes()))?;
        for field in &fields {
            match field.values {
                Values::Labels(labels) => file.write_all(&(labels[p] as i32).to_le_bytes())?,
                values => (0..values.components())
                    .try_for_each(|k| file.write_all(&(values.get(p, k) as f32).to_le_bytes()))?,
            }
        }
    }
    Ok(())
}
