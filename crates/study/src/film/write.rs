//! Films as they are written, on the way.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::{ALIGNMENT, Array, Header, Kind, MAGIC};
use crate::export::Snapshot;
use crate::store::StoreError;

/// Writes a film frame by frame.
pub struct FilmWriter {
    path: PathBuf,
    file: BufWriter<File>,
    header: Header,
}

impl FilmWriter {
    /// Begins a film of the particles of `first`, which is not written yet.
    ///
    /// # Errors
    /// The disk's.
    pub fn begin(path: &Path, first: &Snapshot, scene: &str) -> Result<Self, StoreError> {
        let header = Header::of(first, scene);
        let begin = || -> io::Result<BufWriter<File>> {
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder)?;
            }
            let mut file = BufWriter::new(File::create(path)?);
            let mut text = serde_json::to_vec(&header)?;
            let before = MAGIC.len() + size_of::<u64>();
            text.resize((before + text.len()).next_multiple_of(ALIGNMENT) - before, b' ');
            file.write_all(MAGIC)?;
            file.write_all(&(text.len() as u64).to_le_bytes())?;
            file.write_all(&text)?;
            write_arrays(&mut file, &header, &header.constants, first)?;
            Ok(file)
        };
        let file = begin().map_err(|source| StoreError::Io { path: path.into(), source })?;
        Ok(FilmWriter { path: path.into(), file, header })
    }

    /// Adds a frame of the same particles.
    ///
    /// # Errors
    /// The disk's.
    pub fn add(&mut self, snapshot: &Snapshot) -> Result<(), StoreError> {
        let mut write = || -> io::Result<()> {
            self.file.write_all(&snapshot.time.to_le_bytes())?;
            write_arrays(&mut self.file, &self.header, &self.header.fields, snapshot)?;
            self.file.flush()
        };
        write().map_err(|source| StoreError::Io { path: self.path.clone(), source })
    }
}

fn write_arrays(
    file: &mut impl Write,
    header: &Header,
    arrays: &[Array],
    snapshot: &Snapshot,
) -> io::Result<()> {
    for array in arrays {
        for p in 0..header.particles {
            for c in 0..array.components.len() {
                let value = header.value(snapshot, array, p, c);
                match array.kind {
                    Kind::U32 => file.write_all(&(value as u32).to_le_bytes())?,
                    Kind::F32 => file.write_all(&(value as f32).to_le_bytes())?,
                    Kind::F64 => file.write_all(&value.to_le_bytes())?,
                }
            }
        }
    }
    Ok(())
}
