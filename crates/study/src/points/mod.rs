//! Points in files: CSV and PLY, read and written.
//!
//! Both formats name their columns (PLY: properties of `vertex`): `x y [z]`, `vx vy [vz]`, `mass`, `volume`, `jp` and
//! `fxx fxy fyx fyy` (3D: nine, by rows); others are passed over. Velocities are taken where there is one for every
//! coordinate of the file.
//!
//! **2D or 3D.** Points are 3D where some `z` or `vz` differs from 0 or there are nine columns of F, else 2D: most programs write a `z` whether they
//! need it or not, and some refuse a PLY without one. So a file with z = 0 throughout, a file of no points and a file
//! without `z` are all 2D, and a plane at any other height is 3D. Either kind may still be asked for: a file that has a
//! `z` can always be read in 3D.
//!
//! A file is refused whole: no point that is NaN or infinite, no line that cannot be understood is passed over in
//! silence. Memory stays in proportion to the bytes the file really has, whatever its header promises.

mod columns;
mod csv;
pub(crate) mod lines;
mod ply;
mod ply_header;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use snowlab_solver::{Matrix, Vector};
use thiserror::Error;

use crate::store::put_whole;

use columns::Table;

/// Points read from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCloud<const D: usize> {
    /// Positions [m].
    pub positions: Vec<Vector<f64, D>>,
    /// Velocities [m/s], one per position, where the file has them.
    pub velocities: Option<Vec<Vector<f64, D>>>,
    /// Masses [kg] above 0, one per position, where the file has them.
    pub masses: Option<Vec<f64>>,
    /// Rest volumes [m^D] above 0, one per position, where the file has them.
    pub volumes: Option<Vec<f64>>,
    /// Plastic volume ratios J_P above 0, one per position, where the file has them.
    pub plastic_ratios: Option<Vec<f64>>,
    /// Elastic deformation gradients F_E, one per position, where the file has them.
    pub deformations: Option<Vec<Matrix<f64, D>>>,
}

/// Points whose dimension the file has decided.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyPointCloud {
    /// Every z is 0, or there is none.
    Two(PointCloud<2>),
    /// Some z differs from 0.
    Three(PointCloud<3>),
}

/// A file of points that cannot be used.
#[derive(Debug, Error)]
pub enum PointsError {
    /// It cannot be read or written.
    #[error("{}: {reason}; check the path, its permissions and the space on the disk", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: std::io::Error,
    },
    /// It is not what its name says, or the points cannot be put into a file.
    #[error("{}{}: {message}", path.display(), of_line(*line))]
    Format {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1; 0 for the file as a whole and for binary data, where the message names the vertex.
        line: u64,
        /// What is wrong, what is allowed and what to do.
        message: String,
    },
}

/// Reads a CSV or PLY file, told apart by its ending, as points in 2 or 3 dimensions.
///
/// # Errors
/// [`PointsError`], naming file and line or vertex; also a file with a z other than 0 read in 2D, and one without z
/// read in 3D.
pub fn read<const D: usize>(path: &Path) -> Result<PointCloud<D>, PointsError> {
    const { assert!(D == 2 || D == 3) };
    read_table(path)?.into_cloud().map_err(|(line, message)| format_error(path, line, message))
}

/// Reads a CSV or PLY file in the [`dimension`] it has.
///
/// # Errors
/// [`PointsError`], naming file and line or vertex.
pub fn read_any(path: &Path) -> Result<AnyPointCloud, PointsError> {
    any(path, read_table(path)?)
}

/// What [`read_any`] reads, from a source that is not a file; `path` tells its format, and errors name it.
///
/// # Errors
/// [`PointsError`], naming path and line or vertex.
pub fn read_any_from(path: &Path, source: impl BufRead) -> Result<AnyPointCloud, PointsError> {
    any(path, Format::of(path)?.read(path, source)?)
}

fn any(path: &Path, table: Table) -> Result<AnyPointCloud, PointsError> {
    let refused = |(line, message)| format_error(path, line, message);
    Ok(match table.dimension() {
        2 => AnyPointCloud::Two(table.into_cloud().map_err(refused)?),
        _ => AnyPointCloud::Three(table.into_cloud().map_err(refused)?),
    })
}

/// The number of coordinates that the points of a file have: 3 where some z or vz differs from 0, else 2. Reads the
/// whole file; [`read_any`] returns the points too.
///
/// # Errors
/// [`PointsError`].
pub fn dimension(path: &Path) -> Result<usize, PointsError> {
    Ok(read_table(path)?.dimension())
}

/// Writes positions [m] as CSV or binary PLY, told apart by the ending. See [`write_cloud`].
///
/// # Errors
/// [`PointsError`].
pub fn write<const D: usize>(path: &Path, positions: &[Vector<f64, D>]) -> Result<(), PointsError> {
    write_cloud(path, &PointCloud { positions: positions.to_vec(), ..PointCloud::default() })
}

/// Writes points with all they have, as CSV or binary PLY, told apart by the ending. The file is whole or not there, or what it was before.
///
/// CSV has as many digits as bring back the same bits, and `x,y` in 2D. PLY is binary little-endian, `double`, with
/// z = 0 (and vz = 0) in 2D, since common readers (meshio 5.3 for one) fail without `z`.
///
/// # Errors
/// [`PointsError`]: the file cannot be written, its ending is unknown, a number is not finite (it could not be read
/// back), a mass, volume or J_P is not positive, or there is not one of each quantity per position.
pub fn write_cloud<const D: usize>(path: &Path, cloud: &PointCloud<D>) -> Result<(), PointsError> {
    const { assert!(D == 2 || D == 3) };
    let form = match Format::of(path)? {
        Format::Csv => csv::write::<D>,
        Format::Ply => ply::write::<D>,
    };
    cloud.check().map_err(|message| format_error(path, 0, message))?;
    put_whole(path, |file| form(file, cloud)).map_err(|reason| PointsError::Io { path: path.into(), reason })
}

/// A format, told by the ending of a file's name.
#[derive(Clone, Copy)]
enum Format {
    Csv,
    Ply,
}

impl Format {
    fn of(path: &Path) -> Result<Self, PointsError> {
        match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default().as_str()
        {
            "csv" => Ok(Self::Csv),
            "ply" => Ok(Self::Ply),
            other => Err(unknown(path, other)),
        }
    }

    fn read(self, path: &Path, source: impl BufRead) -> Result<Table, PointsError> {
        match self {
            Self::Csv => csv::read(path, source),
            Self::Ply => ply::read(path, source),
        }
    }
}

fn read_table(path: &Path) -> Result<Table, PointsError> {
    let format = Format::of(path)?;
    let file = File::open(path).map_err(|reason| PointsError::Io { path: path.into(), reason })?;
    format.read(path, BufReader::new(file))
}

fn unknown(path: &Path, extension: &str) -> PointsError {
    let found = if extension.is_empty() { "a name without ending".into() } else { format!("`.{extension}`") };
    format_error(path, 0, format!("{found} is not a format of points; use .csv or .ply"))
}

fn format_error(path: &Path, line: u64, message: impl Into<String>) -> PointsError {
    PointsError::Format { path: path.into(), line, message: message.into() }
}

fn of_line(line: u64) -> String {
    if line == 0 { String::new() } else { format!(", line {line}") }
}
