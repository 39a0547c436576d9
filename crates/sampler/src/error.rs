//! What can go wrong, with the numbers.

use crate::drawn_voids::Rejections;

/// Why a region, a void field or a placement was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SamplerError {
    /// A parameter lies outside its range.
    #[error("{name} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// What the parameter is called, with its unit.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The values allowed.
        allowed: &'static str,
    },
    /// A count lies outside its range.
    #[error("{name} is {value}; allowed: {least} to {most}")]
    CountOutOfRange {
        /// What is counted.
        name: &'static str,
        /// The count given.
        value: usize,
        /// The least count allowed.
        least: usize,
        /// The greatest count allowed.
        most: usize,
    },
    /// The columns of an orientation are not orthonormal.
    #[error(
        "the orientation of a {shape} is not orthonormal: |Q^T Q - 1| is {defect}, at most 1e-9 is allowed"
    )]
    Orientation {
        /// The primitive that carries the orientation.
        shape: &'static str,
        /// Largest entry of `|Q^T Q - 1|`.
        defect: f64,
    },
    /// A triangle of a mesh has a corner that is not there.
    #[error(
        "triangle {triangle} (from 0) has vertex {vertex}, but there are {vertices} (from 0); write the mesh again"
    )]
    NoSuchVertex {
        /// Number of the triangle.
        triangle: usize,
        /// Number of the vertex.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// The triangles of a mesh do not close.
    #[error(
        "the mesh does not close: {}, the first near {} of the mesh; in Blender's edit mode use Mesh > Clean Up > \
         Merge by Distance, Mesh > Clean Up > Fill Holes, Mesh > Normals > Recalculate Outside", of_edges(*open, *crowded, *turned), place(at)
    )]
    OpenMesh {
        /// Edges of a single triangle.
        open: usize,
        /// Edges of three triangles or more that do not pass them as often in one direction as in the other.
        crowded: usize,
        /// Edges of two triangles that pass them in the same direction.
        turned: usize,
        /// Middle of the first such edge, in the mesh's own units.
        at: [f64; 3],
    },
    /// The triangles of a mesh enclose nothing.
    #[error("the mesh encloses no volume; give it a thickness (in Blender: the Solidify modifier)")]
    FlatMesh,
    /// A part of a mesh faces the other way.
    #[error(
        "{share:.3} of the mesh's volume is enclosed inside out, as near {} of the mesh; in Blender's edit mode use \
         Mesh > Normals > Recalculate Outside",
        place(at)
    )]
    MeshInsideOut {
        /// Volume enclosed the wrong way round over that of the whole mesh.
        share: f64,
        /// A point in it, in the mesh's own units.
        at: [f64; 3],
    },
    /// A mesh in two dimensions.
    #[error("a mesh encloses a volume in 3D and no area in 2D; use another region or a scene in 3D")]
    MeshInPlane,
    /// A union without parts.
    #[error("a union of no regions is empty; give it at least one part")]
    EmptyUnion,
    /// Regions nested too deeply.
    #[error("regions are nested {depth} deep or deeper; at most {most} levels are allowed")]
    NestedTooDeep {
        /// The depth reached.
        depth: usize,
        /// The depth allowed.
        most: usize,
    },
    /// No volume is left to fill.
    #[error(
        "the region is empty: {filled} m^D are filled of a bounding box of {bounds} m^D, \
         at least 1/{least_share} is needed; enlarge the region or remove less from it"
    )]
    EmptyRegion {
        /// Volume filled [m^D].
        filled: f64,
        /// Volume of the bounding box [m^D].
        bounds: f64,
        /// Reciprocal of the least share allowed.
        least_share: f64,
    },
    /// A raster would have too many cells.
    #[error(
        "a raster of {cell} m over the region has {cells} cells, at most {most} are allowed; use larger cells"
    )]
    RasterTooFine {
        /// Side of a cell [m].
        cell: f64,
        /// Number of cells.
        cells: f64,
        /// Number of cells allowed.
        most: f64,
    },
    /// A sampler did not reach the count.
    #[error(
        "{sampler} placed {placed} of {wanted} particles in {tries} tries; use `random` or another count"
    )]
    CannotPlace {
        /// The sampler's name.
        sampler: &'static str,
        /// Particles placed.
        placed: usize,
        /// Particles asked for.
        wanted: usize,
        /// Tries spent.
        tries: usize,
    },
    /// Nothing to measure.
    #[error("{measure} needs {needed}; {found} found")]
    TooFewSamples {
        /// The measure.
        measure: &'static str,
        /// What it needs.
        needed: &'static str,
        /// How many there are.
        found: usize,
    },
    /// No draw of a void field was accepted.
    #[error(
        "no void field of porosity {porosity} accepted in {draws} draws: {rejections}; \
         use fewer, larger or rounder voids, a smaller gap or a lower porosity"
    )]
    FieldRejected {
        /// The porosity asked for.
        porosity: f64,
        /// Draws made.
        draws: usize,
        /// Draws by the reason of their rejection.
        rejections: Rejections,
    },
}

/// Refuses `value` unless it is finite and `in_range`.
pub(crate) fn require(
    in_range: bool,
    name: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), SamplerError> {
    if value.is_finite() && in_range {
        Ok(())
    } else {
        Err(SamplerError::OutOfRange { name, value, allowed })
    }
}

/// The edges that keep a mesh open, by what is wrong with them.
fn of_edges(open: usize, crowded: usize, turned: usize) -> String {
    let kinds = [
        (open, "of one triangle alone (holes)"),
        (crowded, "of more than two"),
        (turned, "of two that face opposite ways"),
    ];
    let found = kinds.iter().filter(|(count, _)| *count > 0);
    let told =
        found.map(|(count, what)| format!("{count} {} {what}", if *count == 1 { "edge" } else { "edges" }));
    told.collect::<Vec<_>>().join(", ")
}

/// A point to six digits.
fn place(point: &[f64; 3]) -> String {
    let [x, y, z] = point.map(|c| format!("{c:.5e}").parse().unwrap_or(c));
    format!("[{x:?}, {y:?}, {z:?}]")
}
