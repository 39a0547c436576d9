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
