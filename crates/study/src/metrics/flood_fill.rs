//! Fragments of the density field: raster cells that hold enough mass, joined through their sides.

use super::cell_list::CellList;
use super::error::{LENGTH_RANGE, MetricError, check_masses, check_parameter, check_positions};
use super::exact_sum::FixedPoint;
use super::fragments::FragmentAnalysis;
use super::union_find::UnionFind;
use snowlab_solver::geometry::Vector;

/// Share of the rest density above which a raster cell counts as material. Chosen by the study's definition.
const DENSITY_SHARE: f64 = 0.25;

/// The raster of a flood fill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloodRaster<const D: usize> {
    /// The side of a cell, h_max [m].
    pub side: f64,
    /// A corner of some cell [m].
    pub origin: Vector<f64, D>,
    /// rho0, the density at rest of the solid material [kg/m^D].
    pub rest_density: f64,
}

/// The fragments of `positions` [m] with `masses` [kg]: the particles of raster cells with density above 0.25
/// rho0 that are joined through sides (4 neighbours in 2D, 6 in 3D). A particle in a thinner cell belongs to
/// no such fragment: each one is a component of its own (dust).
///
/// # Errors
/// Positions, masses or raster that are not finite; a side or rest density that is not positive; lengths that
/// differ.
pub fn flood_fill<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    raster: FloodRaster<D>,
) -> Result<FragmentAnalysis, MetricError> {
    check_positions(positions)?;
    check_masses(positions.len(), masses)?;
    check_positions(&[raster.origin])?;
    check_parameter("side of the raster [m]", raster.side, LENGTH_RANGE)?;
    check_parameter("rest density [kg/m^D]", raster.rest_density, [f64::MIN_POSITIVE, f64::MAX])?;

    let list = CellList::new(positions, raster.side, Some(raster.origin));
    let least_mass = DENSITY_SHARE * raster.rest_density * raster.side.powi(D as i32);
    let scale = FixedPoint::for_masses(masses);
    let mass_of =
        |cell| list.order()[list.slots(cell)].iter().map(|&i| scale.encode(masses[i as usize])).sum();
    let full: Vec<bool> = (0..list.cells()).map(|cell| scale.decode(mass_of(cell)) > least_mass).collect();
    let mut cells = UnionFind::new(list.cells());
    list.for_each_cell_pair(1, |a, b| {
        if full[a] && full[b] && share_a_side(list.coordinates(a), list.coordinates(b)) {
            cells.union(a as u32, b as u32);
        }
    });
    let mut components = list.components_of_particles(&mut cells);
    for cell in (0..list.cells()).filter(|&cell| !full[cell]) {
        for &particle in &list.order()[list.slots(cell)] {
            components[particle as usize] = particle;
        }
    }
    FragmentAnalysis::of_partition(&components, masses)
}

fn share_a_side<const D: usize>(a: [i64; D], b: [i64; D]) -> bool {
    (0..D).map(|axis| (a[axis] - b[axis]).abs()).sum::<i64>() == 1
}
