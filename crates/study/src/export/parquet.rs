//! Apache Parquet, a column a component, not compressed.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::{DoubleType, FloatType, Int32Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::{Snapshot, Values};

const AXES: [&str; 3] = ["x", "y", "z"];

/// A column and its values.
enum Column {
    Doubles(Vec<f64>),
    Floats(Vec<f32>),
    Labels(Vec<i32>),
}

/// Writes positions in double precision, all else in single.
pub fn write(file: &mut dyn Write, snapshot: &Snapshot) -> io::Result<()> {
    write_columns(file, columns(snapshot)).map_err(io::Error::other)
}

fn columns(snapshot: &Snapshot) -> Vec<(String, Column)> {
    let mut columns: Vec<(String, Column)> = AXES
        .iter()
        .enumerate()
        .map(|(k, axis)| {
            (axis.to_string(), Column::Doubles(snapshot.positions.iter().map(|x| x[k]).collect()))
        })
        .collect();
    for field in snapshot.fields() {
        if let Values::Labels(labels) = field.values {
            columns.push((field.name.into(), Column::Labels(labels.iter().map(|l| *l as i32).collect())));
            continue;
        }
        for k in 0..field.values.components() {
            let name = match field.values {
                Values::Vectors(_) => format!("{}_{}", field.name, AXES[k]),
                Values::Matrices(_) => format!("{}_{}{}", field.name, AXES[k / 3], AXES[k % 3]),
                _ => field.name.into(),
            };
            let values = (0..snapshot.ids.len()).map(|p| field.values.get(p, k) as f32).collect();
            columns.push((name, Column::Floats(values)));
        }
    }
    columns
}

fn write_columns(file: &mut dyn Write, columns: Vec<(String, Column)>) -> parquet::errors::Result<()> {
    let fields = columns
        .iter()
        .map(|(name, column)| {
            let kind = match column {
                Column::Doubles(_) => Physical::DOUBLE,
                Column::Floats(_) => Physical::FLOAT,
                Column::Labels(_) => Physical::INT32,
            };
            Type::primitive_type_builder(name, kind)
                .with_repetition(Repetition::REQUIRED)
                .build()
                .map(Arc::new)
        })
        .collect::<parquet::errors::Result<_>>()?;
    let schema = Type::group_type_builder("particles").with_fields(fields).build()?;
    let properties = WriterProperties::builder().set_compression(Compression::UNCOMPRESSED).build();
    // The writer wants to be sent between threads, which a borrowed file is not.
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, column) in &columns {
        let Some(mut place) = group.next_column()? else { break };
        match column {
            Column::Doubles(values) => place.typed::<DoubleType>().write_batch(values, None, None)?,
            Column::Floats(values) => place.typed::<FloatType>().write_batch(values, None, None)?,
            Column::Labels(values) => place.typed::<Int32Type>().write_batch(values, None, None)?,
        };
        place.close()?;
    }
    group.close()?;
    writer.close()?;
    file.write_all(&bytes)?;
    Ok(())
}
