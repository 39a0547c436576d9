//! Films as they are read, frame by frame.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::{Array, Header, Kind, MAGIC, MOST_HEADER, check, entry};
use crate::export::Snapshot;

/// A film that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// The disk.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is none, or a broken one.
    #[error("{}: {message}; `snowlab simulate` writes it anew", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
}

/// A film that is read frame by frame.
#[derive(Debug)]
pub struct Film {
    path: PathBuf,
    file: BufReader<File>,
    header: Header,
    /// Where the first frame begins.
    start: u64,
    frames: usize,
    /// What has no time, as a snapshot.
    constants: Snapshot,
}

impl Film {
    /// Opens a film.
    ///
    /// # Errors
    /// [`FilmError`].
    pub fn open(path: &Path) -> Result<Self, FilmError> {
        let io = |source| FilmError::Io { path: path.into(), source };
        let wrong = |message: &str| FilmError::Format { path: path.into(), message: message.into() };
        let file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let mut file = BufReader::new(file);
        let mut magic = [0; MAGIC.len()];
        let mut bytes = [0; size_of::<u64>()];
        let begins =
            file.read_exact(&mut magic).is_ok() && magic == *MAGIC && file.read_exact(&mut bytes).is_ok();
        if !begins {
            return Err(wrong("it does not begin with `snowlab-frames-2`, as frames of this version do"));
        }
        let text_length = u64::from_le_bytes(bytes);
        if text_length > MOST_HEADER.min(length) {
            return Err(wrong("its header is longer than the file, or than any header"));
        }
        let mut text = vec![0; text_length as usize];
        file.read_exact(&mut text).map_err(io)?;
        let header: Header =
            serde_json::from_slice(&text).map_err(|error| wrong(&format!("its header: {error}")))?;
        check(&header).map_err(|message| wrong(&message))?;
        let sizes = header.bytes_of(&header.constants).zip(header.frame_bytes());
        let (constants, frame) = sizes.ok_or_else(|| wrong("its header has more numbers than any file"))?;
        let start = (MAGIC.len() + size_of::<u64>()) as u64 + text_length + constants as u64;
        let rest =
            length.checked_sub(start).ok_or_else(|| wrong("it is cut short before its first frame"))?;
        let mut film = Film {
            path: path.into(),
            file,
            start,
            frames: (rest / frame as u64) as usize,
            constants: Snapshot {
                dimension: header.dimension,
                spacing: (header.spacing > 0.0).then_some(header.spacing),
                ..Snapshot::default()
            },
            header,
        };
        let mut constants = film.constants.clone();
        let arrays = film.header.constants.clone();
        film.read_arrays(&arrays, &mut constants).map_err(io)?;
        film.constants = constants;
        Ok(film)
    }

    /// What it says of itself.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Whole frames.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Frame number `number`, which is below [`Film::frames`].
    ///
    /// # Errors
    /// The disk's.
    pub fn snapshot(&mut self, number: usize) -> Result<Snapshot, FilmError> {
        assert!(number < self.frames, "frame {number} of {}", self.frames);
        let mut read = || -> io::Result<Snapshot> {
            let frame = self.header.frame_bytes().unwrap_or(0) as u64;
            self.file.seek(SeekFrom::Start(self.start + number as u64 * frame))?;
            let mut snapshot = self.constants.clone();
            let mut time = [0; size_of::<f64>()];
            self.file.read_exact(&mut time)?;
            snapshot.time = f64::from_le_bytes(time);
            let arrays = self.header.fields.clone();
            self.read_arrays(&arrays, &mut snapshot)?;
            Ok(snapshot)
        };
        read().map_err(|source| FilmError::Io { path: self.path.clone(), source })
    }

    fn read_arrays(&mut self, arrays: &[Array], into: &mut Snapshot) -> io::Result<()> {
        for array in arrays {
            let values = self.read_numbers(array)?;
            let width = array.components.len();
            let scalars = || values.clone();
            let vectors = |origin: &[f64]| -> Vec<[f64; 3]> {
                let vector = |v: &[f64]| {
                    std::array::from_fn(|k| {
                        v.get(k).map_or(0.0, |x| x + origin.get(k).copied().unwrap_or(0.0))
                    })
                };
                values.chunks_exact(width).map(vector).collect()
            };
            let matrices = |along: f64| -> Vec<[f64; 9]> {
                values.chunks_exact(width).map(|row| matrix(&array.components, row, along)).collect()
            };
            match array.name.as_str() {
                "id" => into.ids = values.iter().map(|v| *v as u32).collect(),
                "mass" => into.masses = Some(scalars()),
                "volume" => into.volumes = Some(scalars()),
                "position" => into.positions = vectors(&self.header.origin),
                "velocity" => into.velocities = Some(vectors(&[])),
                "jp" => into.plastic_ratios = Some(scalars()),
                "deformation" => into.deformations = Some(matrices(1.0)),
                "stress" => into.stresses = Some(matrices(0.0)),
                // Of a later version of the same layout.
                _ => {}
            }
        }
        Ok(())
    }

    fn read_numbers(&mut self, array: &Array) -> io::Result<Vec<f64>> {
        let mut bytes = vec![0; array.bytes(self.header.particles).unwrap_or(0)];
        self.file.read_exact(&mut bytes)?;
        Ok(match array.kind {
            Kind::U32 => numbers(&bytes, |b| f64::from(u32::from_le_bytes(b))),
            Kind::F32 => numbers(&bytes, |b| f64::from(f32::from_le_bytes(b))),
            Kind::F64 => numbers(&bytes, f64::from_le_bytes),
        })
    }
}

fn numbers<const N: usize>(bytes: &[u8], decode: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    bytes.chunks_exact(N).map(|chunk| decode(std::array::from_fn(|k| chunk[k]))).collect()
}

/// A matrix of named entries; what is not named is mirrored, or 0, or along the depth `along`.
fn matrix(components: &[String], row: &[f64], along: f64) -> [f64; 9] {
    let mut full: [Option<f64>; 9] = [None; 9];
    for (name, value) in components.iter().zip(row) {
        if let Some(n) = entry(name) {
            full[n] = Some(*value);
        }
    }
    std::array::from_fn(|n| {
        let mirrored = full[n % 3 * 3 + n / 3];
        full[n].or(mirrored).unwrap_or(if n == 8 { along } else { 0.0 })
    })
}
