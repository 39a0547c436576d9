//! Fragments as the grid sees them: particles joined where their kernels reach a common node.

use super::cell_list::CellList;
use super::error::{LENGTH_RANGE, MetricError, check_masses, check_parameter, check_positions};
use super::fragments::FragmentAnalysis;
use super::union_find::UnionFind;
use snowlab_solver::KernelKind;
use snowlab_solver::geometry::Vector;

/// The fragments of `positions` [m] with `masses` [kg] where particles that share a grid node are joined: a
/// node at `origin + h k` with |x_p - x_i| < 2h on every axis, the support of the cubic B-spline, or 1.5h,
/// that of the quadratic one. `spacing` is h [m].
///
/// Cubic: particles of one grid cell share its corners, and so do particles up to two cells apart per axis.
/// Three cells apart they share a node unless the lower one lies exactly on a node, whose support then ends
/// one node short. So cells are joined instead of particles. Quadratic: the same of cells half a cell off,
/// with a node in the middle of each, that are one or two apart.
///
/// # Errors
/// Positions, masses, origin or spacing that are not finite; a spacing that is not positive; lengths that
/// differ.
pub fn kernel_graph<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    spacing: f64,
    origin: Vector<f64, D>,
    kernel: KernelKind,
) -> Result<FragmentAnalysis, MetricError> {
    check_positions(positions)?;
    check_masses(positions.len(), masses)?;
    check_positions(&[origin])?;
    check_parameter("grid spacing [m]", spacing, LENGTH_RANGE)?;
    // In units of h: half of one is exact, wherever the cells begin.
    let scaled: Vec<_> = positions.iter().map(|x| (x - origin).map(|x| x / spacing)).collect();
    let (edge, reach) = match kernel {
        KernelKind::Cubic => (0.0, 3),
        KernelKind::Quadratic => (0.5, 2),
    };
    let list = CellList::new(&scaled, 1.0, Some(Vector::from_element(edge)));
    let off_edge: Vec<OffEdge> =
        (0..list.cells()).map(|cell| OffEdge::of_points(&list.points()[list.slots(cell)], edge)).collect();
    let mut cells = UnionFind::new(list.cells());
    list.for_each_cell_pair(reach, |a, b| {
        let (here, there) = (list.coordinates(a), list.coordinates(b));
        let needed_of = |low: &[i64; D], high: &[i64; D]| {
            let far = i64::from(reach);
            (0..D).filter(|&axis| high[axis] - low[axis] == far).fold(0, |mask, axis| mask | 1 << axis)
        };
        if off_edge[a].allows(needed_of(&here, &there)) && off_edge[b].allows(needed_of(&there, &here)) {
            cells.union(a as u32, b as u32);
        }
    });
    FragmentAnalysis::of_partition(&list.components_of_particles(&mut cells), masses)
}

/// The sets of axes on which some particle of a cell lies off the cell's edge; set s is bit s, axis a is bit a of
/// s.
#[derive(Clone, Copy)]
struct OffEdge(u8);

impl OffEdge {
    fn of_points<const D: usize>(points: &[Vector<f64, D>], edge: f64) -> Self {
        Self(points.iter().fold(0, |sets, point| {
            let between = |axis: usize| (point[axis] - edge).fract() != 0.0;
            let set = (0..D).filter(|&axis| between(axis)).fold(0, |set, axis| set | 1 << axis);
            sets | 1 << set
        }))
    }

    /// Whether one particle lies off the edge on all the axes of `needed` at once.
    fn allows(self, needed: u8) -> bool {
        (0..8).any(|set: u8| self.0 >> set & 1 == 1 && set & needed == needed)
    }
}
