//! Extended XYZ, as OVITO and ASE read it: a line with the number of particles, one that names the columns, one line a particle. Not periodic.

use std::io::{self, Write};

use super::{Snapshot, Values};

/// Writes one snapshot.
pub fn write(file: &mut dyn Write, snapshot: &Snapshot) -> io::Result<()> {
    let fields: Vec<_> =
        snapshot.fields().into_iter().filter(|field| !matches!(field.values, Values::Matrices(_))).collect();
    let column = |name: &str, values: &Values| match values {
        Values::Labels(_) => format!(":{name}:I:1"),
        // OVITO's and ASE's name for velocities.
        Values::Vectors(_) => ":velo:R:3".into(),
        _ => format!(":{name}:R:1"),
    };
    let columns: String = fields.iter().map(|field| column(field.name, &field.values)).collect();
    writeln!(file, "{}", snapshot.ids.len())?;
    writeln!(file, "Properties=species:S:1:pos:R:3{columns} Time={:?} pbc=\"F F F\"", snapshot.time)?;
    for (p, [x, y, z]) in snapshot.positions.iter().enumerate() {
        // A species is asked for; particles of snow have none.
        write!(file, "X {x:?} {y:?} {z:?}")?;
        for field in &fields {
            match field.values {
                Values::Labels(labels) => write!(file, " {}", labels[p])?,
                values => {
                    (0..values.components()).try_for_each(|k| write!(file, " {:?}", values.get(p, k)))?;
                }
            }
        }
        writeln!(file)?;
    }
    Ok(())
}
