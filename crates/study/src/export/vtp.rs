//! VTK polygonal data (VTK File Formats, "XML File Formats"): appended raw blocks, each a u64 count of bytes and the bytes; offsets count from the byte
//! after `_`. Every particle is a vertex cell, without which ParaView shows nothing. `frames.pvd` names the files of a series with their times.

use std::io::{self, Write};

use super::{Snapshot, Values};

/// A block of the appended data.
struct Block {
    /// The element that stands for it, without its offset.
    tag: String,
    bytes: Vec<u8>,
}

impl Block {
    fn new(kind: &str, name: &str, components: usize, bytes: Vec<u8>) -> Self {
        let tag = format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\""
        );
        Block { tag, bytes }
    }
}

/// Writes one snapshot.
pub fn write(file: &mut dyn Write, snapshot: &Snapshot) -> io::Result<()> {
    let count = snapshot.ids.len();
    let doubles = snapshot.positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let points = vec![Block::new("Float64", "position", 3, doubles)];
    let data: Vec<Block> = snapshot
        .fields()
        .iter()
        .map(|field| match field.values {
            Values::Labels(labels) => {
                let bytes = labels.iter().flat_map(|label| (*label as i32).to_le_bytes()).collect();
                Block::new("Int32", field.name, 1, bytes)
            }
            values => {
                let components = values.components();
                let all = (0..count).flat_map(|p| (0..components).map(move |k| (p, k)));
                let bytes = all.flat_map(|(p, k)| (values.get(p, k) as f32).to_le_bytes()).collect();
                Block::new("Float32", field.name, components, bytes)
            }
        })
        .collect();
    let numbers = |from: i64| (from..from + count as i64).flat_map(i64::to_le_bytes).collect();
    let cells = vec![
        Block::new("Int64", "connectivity", 1, numbers(0)),
        Block::new("Int64", "offsets", 1, numbers(1)),
    ];

    write!(
        file,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n\
         <FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{:?}</DataArray>\n</FieldData>\n\
         <Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
        snapshot.time
    )?;
    let mut offset = 0;
    for (element, blocks) in [("PointData", &data), ("Points", &points), ("Verts", &cells)] {
        writeln!(file, "<{element}>")?;
        for block in blocks {
            writeln!(file, "{} offset=\"{offset}\"/>", block.tag)?;
            offset += size_of::<u64>() + block.bytes.len();
        }
        writeln!(file, "</{element}>")?;
    }
    write!(file, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_")?;
    for block in data.iter().chain(&points).chain(&cells) {
        file.write_all(&(block.bytes.len() as u64).to_le_bytes())?;
        file.write_all(&block.bytes)?;
    }
    write!(file, "\n</AppendedData>\n</VTKFile>\n")
}

/// Writes the series of files (ParaView's PVD): names and times [s].
pub fn write_series(file: &mut dyn Write, series: &[(String, f64)]) -> io::Result<()> {
    writeln!(
        file,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>"
    )?;
    for (name, time) in series {
        writeln!(file, "<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{name}\"/>")?;
    }
    writeln!(file, "</Collection>\n</VTKFile>")
}
