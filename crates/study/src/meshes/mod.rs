//! Solids from files of triangles: OBJ, STL and PLY, read by crates of their own (tobj, stl_io, ply-rs-bw), welded and
//! closed.
//!
//! Polygons become fans of triangles about their first corner. Vertices nearer to each other than [`WELD`] of the mesh's
//! longest side are one, for STL shares none and others split them along seams; triangles that this leaves without an
//! area go. Normals, colours, textures and names are passed over. What remains must close ([`Mesh::new`]).

mod obj;
mod ply;
mod stl;
mod weld;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use snowlab_sampler::Mesh;
use snowlab_solver::geometry::Vector;
use thiserror::Error;

pub use weld::WELD;

/// Longest file taken [bytes] (chosen: two million triangles as text, the most a mesh may have).
const MOST_BYTES: u64 = 1 << 29;
/// Meshes that are kept at hand, by what their files hold (chosen: the bodies of a scene).
const KEPT: usize = 4;

/// A mesh that cannot be used.
#[derive(Debug, Error)]
pub enum MeshError {
    /// The file cannot be read.
    #[error("{}: {reason}; check the path and its permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: std::io::Error,
    },
    /// It holds no mesh, or none that closes.
    #[error("{}{}: {message}", path.display(), line.map_or(String::new(), |line| format!(", line {line}")))]
    Format {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1, where one is at fault.
        line: Option<u64>,
        /// What is wrong, what is allowed and what to do.
        message: String,
    },
}

/// What is wrong, and on which line.
struct Fault {
    line: Option<u64>,
    message: String,
}

impl From<String> for Fault {
    fn from(message: String) -> Self {
        Fault { line: None, message }
    }
}

/// Triangles as a file has them.
#[derive(Debug, Default)]
struct Soup {
    vertices: Vec<Vector<f64, 3>>,
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    /// Adds a polygon as a fan about its first corner.
    fn add_polygon(&mut self, corners: &[u32]) {
        if let [first, rest @ ..] = corners {
            self.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        }
    }
}

/// The mesh of an OBJ, STL or PLY file, told apart by its ending, in the file's own units. Files of the same content are
/// understood once.
///
/// # Errors
/// [`MeshError`], naming the file.
pub fn read(path: &Path) -> Result<Arc<Mesh>, MeshError> {
    /// What was understood last, first.
    static KNOWN: Mutex<Vec<(blake3::Hash, Arc<Mesh>)>> = Mutex::new(Vec::new());
    let format = Format::of(path)?;
    let bytes = read_bytes(path)?;
    let mut hasher = blake3::Hasher::new();
    hasher.update(&[format as u8]).update(&bytes);
    let content = hasher.finalize();
    // Entries are whole whenever a thread may have panicked.
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let place = known.iter().position(|(other, _)| *other == content);
    let entry = match place {
        Some(place) => known.remove(place),
        None => (content, Arc::new(understand(path, format, bytes)?)),
    };
    let mesh = Arc::clone(&entry.1);
    known.insert(0, entry);
    known.truncate(KEPT);
    Ok(mesh)
}

/// What [`read`] makes of a file that holds `bytes`; `path` tells its format, and errors name it.
///
/// # Errors
/// [`MeshError::Format`].
pub fn read_from(path: &Path, bytes: Vec<u8>) -> Result<Mesh, MeshError> {
    understand(path, Format::of(path)?, bytes)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, MeshError> {
    let failed = |reason| MeshError::Io { path: path.into(), reason };
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MOST_BYTES {
        let message = format!("has more than {MOST_BYTES} bytes; use a coarser mesh");
        return Err(MeshError::Format { path: path.into(), line: None, message });
    }
    Ok(bytes)
}

fn understand(path: &Path, format: Format, bytes: Vec<u8>) -> Result<Mesh, MeshError> {
    let read = match format {
        Format::Obj => obj::read(&bytes),
        Format::Stl => stl::read(bytes),
        Format::Ply => ply::read(&bytes),
    };
    let mesh = read.and_then(|soup| {
        check(&soup)?;
        let welded = weld::weld(soup);
        Mesh::new(&welded.vertices, &welded.triangles).map_err(|error| error.to_string().into())
    });
    mesh.map_err(|Fault { line, message }| MeshError::Format { path: path.into(), line, message })
}

/// Refuses what has no triangles, no numbers, or corners that are not there.
fn check(Soup { vertices, triangles }: &Soup) -> Result<(), Fault> {
    if triangles.is_empty() {
        return Err(
            String::from("has no faces; a mesh encloses a volume with triangles or other polygons").into()
        );
    }
    let finite = |vertex: &Vector<f64, 3>| vertex.iter().all(|coordinate| coordinate.is_finite());
    if let Some(number) = vertices.iter().position(|vertex| !finite(vertex)) {
        let Vector { data, .. } = vertices[number];
        let [[x, y, z]] = data.0;
        return Err(format!("vertex {number} (from 0) is at {x} {y} {z}; finite numbers are expected").into());
    }
    let count = vertices.len();
    match triangles.iter().flatten().find(|corner| **corner as usize >= count) {
        Some(corner) => {
            Err(format!("a face has vertex {corner} (from 0), but there are {count}; write the mesh again")
                .into())
        }
        None => Ok(()),
    }
}

/// A format, told by the ending of a file's name.
#[derive(Clone, Copy)]
enum Format {
    Obj,
    Stl,
    Ply,
}

impl Format {
    fn of(path: &Path) -> Result<Self, MeshError> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        let found = match ending.as_str() {
            "obj" => return Ok(Self::Obj),
            "stl" => return Ok(Self::Stl),
            "ply" => return Ok(Self::Ply),
            "" => "a name without ending".into(),
            other => format!("`.{other}`"),
        };
        let message = format!("{found} is not a format of meshes; use .obj, .stl or .ply");
        Err(MeshError::Format { path: path.into(), line: None, message })
    }
}

/// What a reader of somebody else's says, as it may stand in a message: one short line without control characters.
fn said(text: impl ToString) -> String {
    const LONGEST: usize = 100;
    let text = text.to_string().replace(['`', '"'], "'");
    let line: String = text.lines().next().unwrap_or_default().chars().take(LONGEST).collect();
    format!("`{}`", line.escape_debug())
}
