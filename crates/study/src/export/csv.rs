//! CSV in full precision: id, position [m], velocity [m/s], mass [kg or kg/m], volume at rest [m^3 or m^2], J_P, and the elastic deformation gradient
//! row by row; what is not known is left out. [`crate::points`] reads it.

use std::io::{self, Write};

use super::{Snapshot, Values};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Particles in the order of their ids; digits that read back to the same numbers.
pub fn write(file: &mut dyn Write, snapshot: &Snapshot) -> io::Result<()> {
    let axes = &AXES[..snapshot.dimension];
    let fields: Vec<_> = snapshot
        .fields()
        .into_iter()
        .filter(|field| !["id", "stress", "fragment"].contains(&field.name))
        .collect();
    let mut names = vec!["id".to_string()];
    names.extend(axes.iter().map(ToString::to_string));
    for field in &fields {
        match field.values {
            Values::Labels(_) | Values::Scalars(_) => names.push(field.name.into()),
            Values::Vectors(_) => names.extend(axes.iter().map(|axis| format!("v{axis}"))),
            Values::Matrices(_) => {
                names.extend(axes.iter().flat_map(|i| axes.iter().map(move |j| format!("f{i}{j}"))));
            }
        }
    }
    writeln!(file, "{}", names.join(","))?;
    let d = snapshot.dimension;
    for (p, id) in snapshot.ids.iter().enumerate() {
        write!(file, "{id}")?;
        snapshot.positions[p][..d].iter().try_for_each(|x| write!(file, ",{x:?}"))?;
        for field in &fields {
            let components = 0..field.values.components();
            let of_the_dimension = |k: &usize| match field.values {
                Values::Vectors(_) => *k < d,
                Values::Matrices(_) => k / 3 < d && k % 3 < d,
                _ => true,
            };
            components
                .filter(of_the_dimension)
                .try_for_each(|k| write!(file, ",{:?}", field.values.get(p, k)))?;
        }
        writeln!(file)?;
    }
    Ok(())
}

/// As [`write`], a text.
pub fn text(snapshot: &Snapshot) -> String {
    let mut bytes = Vec::new();
    write(&mut bytes, snapshot).expect("memory takes all");
    String::from_utf8(bytes).expect("numbers are ASCII")
}
