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

/// The centres of all raster cells of side `spacing` within `clearance` [m] of some particle (and some
/// beyond).
fn probes<const D: usize>(positions: &[Vector<f64, D>], spacing: f64, clearance: f64) -> Vec<Vector<f64, D>> {
    let steps = (clearance / spacing).ceil() as i32;
    let list = CellList::new(positions, spacing, Some(Vector::zeros()));
    let mut centres: Vec<[f64; D]> = (0..list.cells())
        .map(|cell| {
            let point = list.points()[list.slots(cell).start];
            std::array::from_fn(|axis| ((point[axis] / spacing).floor() + 0.5) * spacing)
        })
        .collect();
    // A box is widened axis by axis: D short passes in place of one of (2 steps + 1)^D.
    for axis in 0..D {
        centres = centres
            .into_iter()
            .flat_map(|centre| {
                (-steps..=steps).map(move |step| {
                    let mut moved = centre;
                    moved[axis] = ((centre[axis] / spacing).floor() + f64::from(step) + 0.5) * spacing;
                    moved
                })
            })
            .collect();
        centres.sort_unstable_by(|a, b| a.partial_cmp(b).expect("raster centres are finite"));
        centres.dedup();
    }
    centres.into_iter().map(Vector::from).collect()
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
