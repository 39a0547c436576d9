//! Which particles lie deep inside their body, farther than a given depth from its edge, voids included.

use super::cell_list::{CellList, side_over, squared_distance};
use super::error::{LENGTH_RANGE, MetricError, check_parameter, check_positions};
use snowlab_solver::geometry::Vector;

/// Radius of the balls that roll round the body, in depths. Chosen: random placement leaves a ball of this
/// radius empty inside a body with a chance of e^-9 at PPC 1.3 (2D, depth 2h), and a ball still enters voids
/// 2 depths wide.
const PROBE_RADIUS: f64 = 0.75;
/// Raster points per depth at which such balls are tried. Chosen: every void of radius 1.1 depths is then
/// found (half the raster's diagonal more than the ball).
const PROBES_PER_DEPTH: f64 = 3.0;

/// Marks the particles farther than `depth` [m] from the edge of their body.
///
/// The body is what balls of radius 0.75 `depth` that hold no particle cannot reach (the closing of the
/// particles by that ball; an alpha shape, Edelsbrunner & Muecke, ACM TOG 13(1), 1994). Centres of such balls
/// are tried on a raster of spacing `depth`/3, and a particle is marked where no empty ball is centred within
/// depth + radius + the raster's diagonal. The last term makes up for the centres between raster points: half
/// of it to lie inside the void, half to reach a raster point. So a marked particle is never too near the
/// edge, and only some that are deep enough are left out.
///
/// # Errors
/// Positions or a depth that are not finite; a depth that is not positive.
pub fn interior<const D: usize>(positions: &[Vector<f64, D>], depth: f64) -> Result<Vec<bool>, MetricError> {
    check_positions(positions)?;
    check_parameter("depth of the interior [m]", depth, LENGTH_RANGE)?;
    let spacing = depth / PROBES_PER_DEPTH;
    let radius = PROBE_RADIUS * depth;
    let clearance = depth + radius + spacing * (D as f64).sqrt();
    let probes = probes(positions, spacing, clearance);
    let occupied = have_near(&probes, positions, radius);
    let empty: Vec<_> = probes
        .into_iter()
        .zip(occupied)
        .filter_map(|(probe, occupied)| (!occupied).then_some(probe))
        .collect();
    let near_an_edge = have_near(positions, &empty, clearance);
    Ok(near_an_edge.into_iter().map(|near| !near).collect())
}

/// The centres of all raster cells of side `spacing` within `clearance` [m] of some particle, and some beyond.
fn probes<const D: usize>(positions: &[Vector<f64, D>], spacing: f64, clearance: f64) -> Vec<Vector<f64, D>> {
    let steps = (clearance / spacing).ceil() as i64;
    let list = CellList::new(positions, spacing, Some(Vector::zeros()));
    let mut cells: Vec<[i64; D]> = (0..list.cells())
        .map(|cell| list.points()[list.slots(cell).start])
        .map(|point| std::array::from_fn(|axis| (point[axis] / spacing).floor() as i64))
        .collect();
    // A box is widened axis by axis: D short passes in place of one of (2 steps + 1)^D.
    (0..D).for_each(|axis| cells = widened(std::mem::take(&mut cells), axis, steps));
    cells.into_iter().map(|cell| Vector::from(cell.map(|n| (n as f64 + 0.5) * spacing))).collect()
}

/// `cells` and those up to `steps` beside them along `axis`, each once.
fn widened<const D: usize>(mut cells: Vec<[i64; D]>, axis: usize, steps: i64) -> Vec<[i64; D]> {
    let row_first = |mut cell: [i64; D]| {
        cell.swap(axis, D - 1);
        cell
    };
    cells.sort_unstable_by_key(|&cell| row_first(cell));
    let mut wide: Vec<[i64; D]> = Vec::with_capacity(2 * cells.len());
    for cell in cells {
        let on_row = |n| {
            let mut moved = cell;
            moved[axis] = n;
            moved
        };
        // What the row's cell before has widened to already.
        let done =
            wide.last().filter(|last| on_row(last[axis]) == **last).map_or(i64::MIN, |last| last[axis] + 1);
        wide.extend((done.max(cell[axis] - steps)..=cell[axis] + steps).map(on_row));
    }
    wide
}

/// For each of `targets` whether one of `others` lies within `radius` [m].
fn have_near<const D: usize>(
    targets: &[Vector<f64, D>],
    others: &[Vector<f64, D>],
    radius: f64,
) -> Vec<bool> {
    let both: Vec<Vector<f64, D>> = targets.iter().chain(others).copied().collect();
    let list = CellList::new(&both, side_over(radius), None);
    // Within a cell slots ascend by index, so targets come before others.
    let middles: Vec<usize> = (0..list.cells())
        .map(|cell| {
            let order = &list.order()[list.slots(cell)];
            list.slots(cell).start + order.partition_point(|&index| (index as usize) < targets.len())
        })
        .collect();
    let mut near = vec![false; targets.len()];
    let mut look = |from: usize, into: usize| {
        let others = &list.points()[middles[into]..list.slots(into).end];
        for slot in list.slots(from).start..middles[from] {
            let near = &mut near[list.order()[slot] as usize];
            let point = &list.points()[slot];
            *near = *near || others.iter().any(|other| squared_distance(point, other) <= radius * radius);
        }
    };
    (0..list.cells()).for_each(|cell| look(cell, cell));
    list.for_each_cell_pair(1, |a, b| {
        look(a, b);
        look(b, a);
    });
    near
}
