//! The frames of one run in one file, as `snowlab simulate` writes them on the way: [docs/frames.md](../../../docs/frames.md) has the layout.
//!
//! Little-endian: the 16 bytes `snowlab-frames-2`; u64 length of the header; the header as JSON, padded with spaces; the constants of all particles, one
//! array after the other; then frame after frame: f64 time [s], and one array a field. Every frame has as many bytes, so that a file that has no
//! end yet, or whose run was killed, is read up to its last whole frame.

mod read;
mod source;
mod write;

use serde::{Deserialize, Serialize};

use crate::export::Snapshot;

pub use read::{Film, FilmError};
pub use source::{Source, SourceError};
pub use write::FilmWriter;

const MAGIC: &[u8; 16] = b"snowlab-frames-2";
/// The file in the folder of a run.
pub const FILM: &str = "frames.snowlab";
/// Arrays begin at multiples of so many bytes (chosen: a line of any cache).
const ALIGNMENT: usize = 64;
/// A header of more bytes is none (chosen: a scene file has at most 16 MiB).
const MOST_HEADER: u64 = 1 << 26;

/// What a file says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// 2 or 3.
    pub dimension: usize,
    /// Particles in every frame.
    pub particles: usize,
    /// Spacing of the grid [m].
    pub spacing: f64,
    /// What positions count from [m].
    pub origin: Vec<f64>,
    /// What does not change, in the order of the file.
    pub constants: Vec<Array>,
    /// What every frame has after its time, in the order of the file.
    pub fields: Vec<Array>,
    /// The scene file as it was read.
    pub scene: String,
}

/// An array of numbers, all components of a particle together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Array {
    /// What it is.
    pub name: String,
    /// Of each number.
    pub kind: Kind,
    /// Names of the components; one without a name for a scalar.
    pub components: Vec<String>,
    /// Unit.
    pub unit: String,
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Whole, 32 bits.
    U32,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

impl Kind {
    fn size(self) -> usize {
        match self {
            Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }
}

impl Array {
    fn new(name: &str, kind: Kind, components: Vec<String>, unit: &str) -> Self {
        Array { name: name.into(), kind, components, unit: unit.into() }
    }

    fn bytes(&self, particles: usize) -> Option<usize> {
        self.kind.size().checked_mul(self.components.len())?.checked_mul(particles)
    }
}

/// Entries of a matrix by rows and columns, counted in three dimensions.
const ENTRIES: [(&str, usize); 9] =
    [("xx", 0), ("xy", 1), ("xz", 2), ("yx", 3), ("yy", 4), ("yz", 5), ("zx", 6), ("zy", 7), ("zz", 8)];

impl Header {
    fn of(snapshot: &Snapshot, scene: &str) -> Self {
        let d = snapshot.dimension;
        let none = || vec![String::new()];
        let axes = || ["x", "y", "z"][..d].iter().map(ToString::to_string).collect::<Vec<_>>();
        let entries = |keep: &dyn Fn(usize, usize) -> bool| {
            let kept = ENTRIES.iter().filter(|(_, n)| keep(n / 3, n % 3));
            kept.map(|(name, _)| name.to_string()).collect::<Vec<_>>()
        };
        let all = entries(&|i, j| i < d && j < d);
        // Symmetric; in plane strain with what acts along the depth.
        let upper = entries(&|i, j| (i <= j && j < d) || (i == 2 && j == 2));
        let constants = [
            Some(Array::new("id", Kind::U32, none(), "-")),
            snapshot.masses.as_ref().map(|_| Array::new("mass", Kind::F64, none(), "kg")),
            snapshot.volumes.as_ref().map(|_| Array::new("volume", Kind::F64, none(), "m^D")),
        ];
        let fields = [
            Some(Array::new("position", Kind::F32, axes(), "m")),
            snapshot.velocities.as_ref().map(|_| Array::new("velocity", Kind::F32, axes(), "m/s")),
            snapshot.plastic_ratios.as_ref().map(|_| Array::new("jp", Kind::F32, none(), "-")),
            snapshot.deformations.as_ref().map(|_| Array::new("deformation", Kind::F32, all, "-")),
            snapshot.stresses.as_ref().map(|_| Array::new("stress", Kind::F32, upper, "Pa")),
        ];
        // Positions count from the middle of the first frame, so that single precision resolves the body wherever it is.
        let count = snapshot.positions.len().max(1) as f64;
        let origin =
            (0..d).map(|k| (snapshot.positions.iter().map(|x| x[k]).sum::<f64>() / count).round()).collect();
        Header {
            dimension: d,
            particles: snapshot.positions.len(),
            spacing: snapshot.spacing.unwrap_or(0.0),
            origin,
            constants: constants.into_iter().flatten().collect(),
            fields: fields.into_iter().flatten().collect(),
            scene: scene.into(),
        }
    }

    fn bytes_of(&self, arrays: &[Array]) -> Option<usize> {
        arrays.iter().try_fold(0, |sum: usize, array| sum.checked_add(array.bytes(self.particles)?))
    }

    /// Bytes of a frame, its time included.
    fn frame_bytes(&self) -> Option<usize> {
        self.bytes_of(&self.fields)?.checked_add(size_of::<f64>())
    }

    /// Component `c` of an array for particle `p` of a snapshot.
    fn value(&self, snapshot: &Snapshot, array: &Array, p: usize, c: usize) -> f64 {
        let matrix = |matrices: &Option<Vec<[f64; 9]>>| {
            matrices.as_ref().map_or(f64::NAN, |all| all[p][entry(&array.components[c]).unwrap_or(0)])
        };
        let scalar = |values: &Option<Vec<f64>>| values.as_ref().map_or(f64::NAN, |values| values[p]);
        match array.name.as_str() {
            "id" => f64::from(snapshot.ids[p]),
            "mass" => scalar(&snapshot.masses),
            "volume" => scalar(&snapshot.volumes),
            "position" => snapshot.positions[p][c] - self.origin[c],
            "velocity" => snapshot.velocities.as_ref().map_or(f64::NAN, |all| all[p][c]),
            "jp" => scalar(&snapshot.plastic_ratios),
            "deformation" => matrix(&snapshot.deformations),
            _ => matrix(&snapshot.stresses),
        }
    }
}

/// Which entry of a matrix by rows a component is.
fn entry(name: &str) -> Option<usize> {
    ENTRIES.iter().find(|(entry, _)| *entry == name).map(|(_, n)| *n)
}

fn check(header: &Header) -> Result<(), String> {
    let d = header.dimension;
    if !(2..=3).contains(&d) || header.origin.len() != d {
        return Err("its header has neither two nor three dimensions".into());
    }
    for array in header.constants.iter().chain(&header.fields) {
        let wanted = match array.name.as_str() {
            "position" | "velocity" => d,
            "id" | "mass" | "volume" | "jp" => 1,
            _ => array.components.len().max(1),
        };
        if array.components.len() != wanted {
            return Err(format!(
                "its `{}` has {} components, not {wanted}",
                array.name,
                array.components.len()
            ));
        }
    }
    let has = |arrays: &[Array], name: &str| arrays.iter().any(|array| array.name == name);
    if !has(&header.constants, "id") || !has(&header.fields, "position") {
        return Err("its header has no `id` or no `position`".into());
    }
    Ok(())
}
