//! Particles for other programs: one file a frame and format, and what a program needs to see them as a series.
//!
//! | format | for | columns |
//! |---|---|---|
//! | `csv` | everyone; a body can be made of it again | id, position, velocity, mass, volume, J_P, F_E |
//! | `ply` | Blender, Houdini, MeshLab | position, velocity, mass, J_P, id, fragment |
//! | `vtp` | ParaView, with `frames.pvd` as the series | all |
//! | `xyz` | OVITO, ASE: extended XYZ | position, velocity, mass, J_P, id, fragment |
//! | `vol` | Mitsuba 3 | density on the grid over that at rest |
//! | `vdb` | Houdini, Blender: OpenVDB | the same |
//! | `parquet` | pandas, polars, duckdb | all |
//!
//! Lengths are metres, as everywhere.

mod csv;
mod density;
#[cfg(feature = "parquet")]
mod parquet;
mod ply;
mod snapshot;
mod vdb;
mod vol;
mod vtp;
mod xyz;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;

use crate::store::{StoreError, write_whole_with};

pub use csv::text as csv_text;
pub use density::{Density, DensityError};
pub use snapshot::{Field, Snapshot, Values};

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Text, in full precision; a body can be made of it again
    Csv,
    /// Binary PLY for Blender, Houdini and MeshLab
    Ply,
    /// VTK polygonal data for ParaView, with frames.pvd as the series
    Vtp,
    /// Extended XYZ for OVITO and ASE
    Xyz,
    /// Density on the grid for Mitsuba 3, in 3D
    Vol,
    /// Density on the grid as OpenVDB for Houdini and Blender, in 3D
    Vdb,
    /// Columns for pandas, polars and duckdb
    #[cfg(feature = "parquet")]
    Parquet,
}

/// Frames that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The disk.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A grid that cannot be made of the particles.
    #[error("{}: {reason}", path.display())]
    Density {
        /// The file that was to be.
        path: PathBuf,
        /// Why not.
        reason: DensityError,
    },
}

impl Format {
    /// The ending of its files.
    pub fn ending(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Ply => "ply",
            Format::Vtp => "vtp",
            Format::Xyz => "xyz",
            Format::Vol => "vol",
            Format::Vdb => "vdb",
            #[cfg(feature = "parquet")]
            Format::Parquet => "parquet",
        }
    }

    /// Whether it has a column for fragments.
    pub fn tells_fragments(self) -> bool {
        !matches!(self, Format::Csv | Format::Vol | Format::Vdb)
    }

    /// Whether it is a density on a grid.
    pub fn is_grid(self) -> bool {
        matches!(self, Format::Vol | Format::Vdb)
    }

    /// Writes a density as Mitsuba's grid volume; the first and last of its nodes.
    ///
    /// # Errors
    /// The disk's; a box of too many nodes.
    pub fn write_density(path: &Path, density: &Density) -> Result<[[i32; 3]; 2], ExportError> {
        let bounds = density.bounds(vol::MARGIN);
        let bounds = bounds.map_err(|reason| ExportError::Density { path: path.into(), reason })?;
        let bounds = bounds.unwrap_or_default();
        write_whole_with(path, |file| vol::write(file, density, bounds))?;
        Ok(bounds)
    }

    /// Writes a snapshot as `path`, whole or not at all. Grids have cells of side `cell` [m].
    ///
    /// # Errors
    /// The disk's; a grid that cannot be made.
    pub fn write(self, path: &Path, snapshot: &Snapshot, cell: Option<f64>) -> Result<(), ExportError> {
        let whole = |write: &dyn Fn(&mut dyn Write) -> io::Result<()>| {
            write_whole_with(path, |file| write(file)).map_err(ExportError::from)
        };
        let density = || {
            Density::of(snapshot, cell).map_err(|reason| ExportError::Density { path: path.into(), reason })
        };
        match self {
            Format::Csv => whole(&|file| csv::write(file, snapshot)),
            Format::Ply => whole(&|file| ply::write(file, snapshot)),
            Format::Vtp => whole(&|file| vtp::write(file, snapshot)),
            Format::Xyz => whole(&|file| xyz::write(file, snapshot)),
            Format::Vol => density().and_then(|grid| Self::write_density(path, &grid).map(|_| ())),
            Format::Vdb => density().and_then(|grid| whole(&|file| vdb::write(file, &grid))),
            #[cfg(feature = "parquet")]
            Format::Parquet => whole(&|file| parquet::write(file, snapshot)),
        }
    }
}

/// Writes frame after frame into a folder.
#[derive(Debug)]
pub struct Exporter {
    folder: PathBuf,
    formats: Vec<Format>,
    cell: Option<f64>,
    /// Name and time [s] of each frame as VTP.
    series: Vec<(String, f64)>,
}

/// The series of frames for ParaView.
pub const SERIES: &str = "frames.pvd";

/// The name of a frame's file.
pub fn frame_name(number: usize, ending: &str) -> String {
    format!("frame-{number:05}.{ending}")
}

/// Whether a file's name is one that [`frame_name`] gives.
pub fn is_frame_name(name: &str) -> bool {
    let number = name
        .strip_prefix("frame-")
        .and_then(|rest| rest.split_once('.'))
        .filter(|(_, ending)| Format::value_variants().iter().any(|format| format.ending() == *ending));
    number.is_some_and(|(n, _)| n.len() >= 5 && n.bytes().all(|b| b.is_ascii_digit()))
}

impl Exporter {
    /// Into `folder`, in these formats; grids have cells of side `cell` [m], or of the scene's grid.
    pub fn new(folder: &Path, formats: &[Format], cell: Option<f64>) -> Self {
        Exporter { folder: folder.into(), formats: formats.to_vec(), cell, series: Vec::new() }
    }

    /// Whether any format has a column for fragments.
    pub fn tells_fragments(&self) -> bool {
        self.formats.iter().any(|format| format.tells_fragments())
    }

    /// Writes frame number `number`.
    ///
    /// # Errors
    /// As [`Format::write`].
    pub fn add(&mut self, number: usize, snapshot: &Snapshot) -> Result<(), ExportError> {
        for format in &self.formats {
            let name = frame_name(number, format.ending());
            format.write(&self.folder.join(&name), snapshot, self.cell)?;
            if *format == Format::Vtp {
                self.series.push((name, snapshot.time));
            }
        }
        Ok(())
    }

    /// Writes what makes a series of the frames.
    ///
    /// # Errors
    /// The disk's.
    pub fn end(self) -> Result<(), ExportError> {
        if self.series.is_empty() {
            return Ok(());
        }
        write_whole_with(&self.folder.join(SERIES), |file| vtp::write_series(file, &self.series))?;
        Ok(())
    }
}
