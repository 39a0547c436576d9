//! How much memory a case takes, before it is run.

use std::f64::consts::PI;
use std::path::Path;

use crate::assemble::region;
use crate::meshes;
use crate::spec::SceneSpec;
use crate::spec::scene::{MeshSpec, PrecisionName, RegionSpec, TransferName};

/// Of the program itself, its tables and threads [bytes] (chosen: a case of two particles peaks at 18 MB, and heaps have gaps).
const PROGRAM: f64 = 2.5e7;
/// Copies of the particles in the engine's chunks: two that are sorted into each other, the watchdog's snapshot and its next one, and a checkpoint's.
const COPIES: f64 = 5.0;
/// Copies of the particles as a plain state: as they were placed, and as they are looked at.
const PLAIN_COPIES: f64 = 2.0;
/// Beside its bonds, what measuring a particle takes [bytes] (chosen: 290 of 820 are not bonds at 300 thousand in 3D).
const MEASURED: f64 = 300.0;
/// Of a triangle of a mesh, while it is read and welded [bytes] (measured: 458 of STL as text, 188 to 235 of the others, at 640 thousand).
const TRIANGLE: f64 = 460.0;
/// Nodes of the grid's blocks over cells that hold particles (chosen: a body of ten blocks across has a block more on each side).
const MARGIN: f64 = 1.7;
/// Fields over the nodes that an implicit step holds: 8 of MINRES, and of its system v^n, the forces, the right side, the held and known parts, masses and
/// weights, and two copies on the way.
const FIELDS_OF_SOLVE: f64 = 17.0;
/// Nodes of a block, and lanes of a chunk of particles.
const BLOCK: f64 = 64.0;
const CHUNK: f64 = 16.0;
/// Particles to a cell where nothing tells (chosen: what studies have).
const USUAL_PER_CELL: f64 = 4.0;

/// Bytes that a case of `scene` takes at its peak, the program included, where its fragments are measured by `h_max` [m], or by its own spacing; `None` where
/// a file has its particles. Within a factor of 1.5 ([docs/performance.md](../../../docs/performance.md)).
pub fn of_case(scene: &SceneSpec, folder: &Path, h_max: Option<f64>) -> Option<f64> {
    let particles = particles(scene)?;
    let numerics = &scene.numerics;
    let (d, number) = (scene.dimension as f64, bytes_of_number(scene));
    let per_cell = per_cell(scene, folder, particles).unwrap_or(USUAL_PER_CELL);

    // Half a chunk of each block is padding.
    let padding = 1.0 + 0.5 * CHUNK / (per_cell * BLOCK);
    let fields = fields(scene);
    let particle = COPIES * padding * (fields * number + 8.0) + PLAIN_COPIES * fields * number;
    // Mass and momentum, motion, and where forces are kept apart those and the change of velocity, four channels each.
    let joined = numerics.transfer != TransferName::Flip && !numerics.energy_budget && !numerics.watchdog;
    let arrays = if joined { 2.0 } else { 1.0 + d };
    let (tangents, fields_of_solve) = match numerics.integrator {
        Some(_) => (2.0 * d * d + 1.5 * d * (d - 1.0), FIELDS_OF_SOLVE),
        None => (0.0, 0.0),
    };
    let particle = particle + padding * tangents * number;
    let nodes = MARGIN * (arrays + fields_of_solve) * 4.0 * number / per_cell;
    // Pairs within 2 h_max, four bytes each (metrics/bond_graph.rs): a disc's area or a ball's volume of particles, each pair once.
    let wider = h_max.map_or(1.0, |h_max| libm::pow(h_max / numerics.spacing, d));
    let bonds = 4.0 * 0.5 * wider * per_cell * if scene.dimension == 2 { 4.0 * PI } else { 32.0 / 3.0 * PI };
    // As they are kept, and as the bytes that a checkpoint or the results have of them.
    let frames = 2.0 * frames(scene) * 4.0 * (d + 1.0);
    // A case is measured when its engine is gone.
    Some(
        PROGRAM
            + TRIANGLE * triangles(scene, folder)
            + particles * ((particle + nodes).max(bonds + MEASURED) + frames),
    )
}

/// [`of_case`] of a run whose frames are written as text: two copies of the state wait to be written, and a frame's text.
pub fn of_simulation(scene: &SceneSpec, folder: &Path) -> Option<f64> {
    // chosen: the longest that a number of 17 digits is written.
    let digits = 21.0;
    // A text grows by doubling.
    Some(
        of_case(scene, folder, None)?
            + particles(scene)? * fields(scene) * (2.0 * bytes_of_number(scene) + 2.0 * digits),
    )
}

/// Bytes of a case's row in the tables with its record, and of a row of `frames` with its ledgers (measured: 27 kB a case of four frames, of ten thousand).
const ROW: f64 = 2e4;
const FRAME_ROW: f64 = 3e3;

/// Bytes that writing the tables of cases takes, from the frames of each ([`frames`]).
pub fn of_tables(frames: impl Iterator<Item = f64>) -> f64 {
    PROGRAM + frames.map(|frames| ROW + FRAME_ROW * frames).sum::<f64>()
}

/// Frames of a case, at most.
pub fn frames(scene: &SceneSpec) -> f64 {
    scene.output.end / scene.output.frame_interval + 2.0
}

/// How many there will be; `None` where a file has them.
fn particles(scene: &SceneSpec) -> Option<f64> {
    let counts: Option<Vec<usize>> = scene.body.iter().map(|body| body.placement.count()).collect();
    Some(counts?.into_iter().sum::<usize>() as f64)
}

/// Of all meshes together; those that cannot be read have none.
fn triangles(scene: &SceneSpec, folder: &Path) -> f64 {
    let meshes = scene.body.iter().flat_map(|body| &body.region).flat_map(RegionSpec::meshes);
    let of = |mesh: &MeshSpec| meshes::read(&folder.join(&mesh.path)).map_or(0, |mesh| mesh.triangles());
    meshes.map(of).sum::<usize>() as f64
}

/// Numbers of a particle: x, v, F, five of one component, and C where the transfer is affine.
fn fields(scene: &SceneSpec) -> f64 {
    let d = scene.dimension as f64;
    2.0 * d + d * d + 5.0 + if scene.numerics.transfer == TransferName::Flip { 0.0 } else { d * d }
}

fn bytes_of_number(scene: &SceneSpec) -> f64 {
    if scene.numerics.precision == PrecisionName::F32 { 4.0 } else { 8.0 }
}

/// Particles to a cell, from the regions' volume.
fn per_cell(scene: &SceneSpec, folder: &Path, particles: f64) -> Option<f64> {
    let volumes: Option<Vec<f64>> = match scene.dimension {
        3 => scene.body.iter().map(|body| volume::<3>(body.region.as_ref()?, folder)).collect(),
        _ => scene.body.iter().map(|body| volume::<2>(body.region.as_ref()?, folder)).collect(),
    };
    Some(particles * scene.numerics.spacing.powi(scene.dimension as i32) / volumes?.iter().sum::<f64>())
}

fn volume<const D: usize>(spec: &RegionSpec, folder: &Path) -> Option<f64> {
    let region = region::<D>(spec, "region", folder).ok()?;
    // chosen: sixteen times as coarse as for placing particles.
    region.volume(16.0 * region.volume_raster()).ok()
}

/// How many of `cases` may run side by side on so many cores, the largest of which takes `bytes`.
///
/// # Errors
/// What to do where not even one fits.
pub fn side_by_side(bytes: Option<f64>, cases: usize, cores: usize) -> Result<usize, String> {
    let wanted = cases.min(cores).max(1);
    let (Some(bytes), Some(available)) = (bytes, available()) else { return Ok(wanted) };
    let fitting = (available / bytes) as usize;
    if fitting == 0 {
        return Err(format!(
            "a case takes about {}, and {} are free; use fewer particles or frames, `precision = \"f32\"`, or another machine",
            in_words(bytes),
            in_words(available)
        ));
    }
    Ok(wanted.min(fitting))
}

/// Memory that is free for this program [bytes], where the system tells: of the machine, of the group of programs it belongs to (as a cluster's
/// jobs do), and of its own address space.
pub fn available() -> Option<f64> {
    [of_machine(), of_group(), of_address_space()].into_iter().flatten().reduce(f64::min)
}

fn of_machine() -> Option<f64> {
    kilobytes(&read("/proc/meminfo")?, "MemAvailable:")
}

/// By the limit of the second version of Linux's control groups.
fn of_group() -> Option<f64> {
    let groups = read("/proc/self/cgroup")?;
    let own = groups.lines().find_map(|line| line.strip_prefix("0::"))?.trim_start_matches('/');
    let mut folder = Path::new("/sys/fs/cgroup").join(own);
    let mut least = None;
    // A group has no more than those it lies in.
    loop {
        if let Some(free) = free_in(&folder) {
            least = Some(free.min(least.unwrap_or(f64::INFINITY)));
        }
        if folder == Path::new("/sys/fs/cgroup") || !folder.pop() {
            return least;
        }
    }
}

/// What a control group may still take [bytes], by the files in its folder; `None` where it has no limit. Pages of files that have not been used lately count
/// as used there, but go when memory is asked for.
fn free_in(group: &Path) -> Option<f64> {
    let text = |name: &str| read(group.join(name).to_str()?);
    let number = |name: &str| text(name)?.trim().parse::<f64>().ok();
    let cache = text("memory.stat").and_then(|text| {
        text.lines().find_map(|line| line.strip_prefix("inactive_file ")?.trim().parse::<f64>().ok())
    });
    let used = number("memory.current")? - cache.unwrap_or(0.0);
    Some((number("memory.max")? - used.max(0.0)).max(0.0))
}

fn of_address_space() -> Option<f64> {
    let limits = read("/proc/self/limits")?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most = line.split_whitespace().next()?.parse::<f64>().ok()?;
    Some((most - kilobytes(&read("/proc/self/status")?, "VmSize:")?).max(0.0))
}

fn read(path: &str) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

/// The number of kilobytes after `name`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<f64> {
    let number = text.lines().find_map(|line| line.strip_prefix(name))?;
    number.trim().trim_end_matches(" kB").parse::<f64>().ok().map(|kilobytes| 1024.0 * kilobytes)
}

/// `340 MB`, `2.1 GB`.
pub fn in_words(bytes: f64) -> String {
    if bytes < 1e9 { format!("{:.0} MB", bytes / 1e6) } else { format!("{:.1} GB", bytes / 1e9) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_whose_memory_is_full_of_file_pages_has_room() {
        let group = tempfile::tempdir().expect("a folder for the test");
        let write = |name: &str, text: &str| std::fs::write(group.path().join(name), text).expect("a file");
        write("memory.max", "max\n");
        write("memory.current", "4000000000\n");
        assert_eq!(free_in(group.path()), None, "no limit");
        write("memory.max", "4000000000\n");
        assert_eq!(free_in(group.path()), Some(0.0));
        write("memory.stat", "anon 500000000\nactive_file 500000000\ninactive_file 3000000000\n");
        assert_eq!(free_in(group.path()), Some(3e9));
    }
}
