//! Which particles lie deep inside their body, farther than a given depth from its edge, voids included.

use super::cell_list::{CellList, side_over, squared_distance};
use super::error::{LENGTH_RANGE, MetricError, check_parameter, check_positions};
use snowlab_solver::geometry::Vector;

/// Radius of the balls that roll round the body, in depths. Chosen: random placement leaves a ball of this radius empty
/// inside a body with a chance of e^-9 at PPC 1.3 (2D, depth 2h), and a ball still enters voids 2 depths wide.
const PROBE_RADIUS: f64 = 0.75;
/// Raster points per depth at which such balls are tried. Chosen: every void of radius 1.1 depths is then found (half the
/// raster's diagonal more than the ball).
const PROBES_PER_DEPTH: f64 = 3.0;

/// Marks the particles farther than `depth` [m] from the edge of their body.
///
/// The body is what balls of radius 0.75 `depth` that hold no particle cannot reach (the closing of the particles by
/// that ball; an alpha shape, Edelsbrunner & Muecke, ACM TOG 13(1), 1994). Centres of such balls are tried on a raster of
/// spacing `depth`/3, and a particle is marked where no empty ball is centred within depth + radius + the raster's
/// diagonal. The last term makes up for the centres between raster points: half of it to lie inside the void, half to reach
/// a raster point. So a marked particle is never too near the edge, and only some that are deep enough are left out.
///
/// # Errors
/// Positions or a depth that are not finite; a depth that is not positive.
pub fn interior<const D: usize>(positions: &[Vector<f64, D>], depth: f64) -> Result<Vec<bool>, MetricError> {
    check_positions(positions)?;
    check_parameter("depth of the interior [m]", depth, LENGTH_RANGE)?;
    let spacing = depth / PROBES_PER_DEPTH;
    let radius = PROBE_RADIUS * depth;
    let clearance = depth + radius + spacing * (D as f64).sqrt();
    let empty = empty_probes(positions, probes(positions, spacing, clearance), radius);

    let mut inside = vec![true; positions.len()];
    for_each_meeting(positions, &empty, clearance, |particle, _| inside[particle] = false);
    Ok(inside)
}

/// The centres of all raster cells of side `spacing` within `clearance` [m] of some particle (and some beyond).
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

/// The probes with no particle within `radius` [m].
fn empty_probes<const D: usize>(
    positions: &[Vector<f64, D>],
    probes: Vec<Vector<f64, D>>,
    radius: f64,
) -> Vec<Vector<f64, D>> {
    let mut empty = vec![true; probes.len()];
    for_each_meeting(positions, &probes, radius, |_, probe| empty[probe] = false);
    probes.into_iter().zip(empty).filter_map(|(probe, empty)| empty.then_some(probe)).collect()
}

/// Calls `meet(a, b)` for the points a of `first` and b of `second` within `radius` [m] of each other.
fn for_each_meeting<const D: usize>(
    first: &[Vector<f64, D>],
    second: &[Vector<f64, D>],
    radius: f64,
    mut meet: impl FnMut(usize, usize),
) {
    let both: Vec<Vector<f64, D>> = first.iter().chain(second).copied().collect();
    let list = CellList::new(&both, side_over(radius), None);
    // Within a cell slots ascend by index, so the points of `first` come before those of `second`.
    let split = |cell: usize| {
        let slots = list.slots(cell);
        let middle =
            slots.start + list.order()[slots.clone()].partition_point(|&i| (i as usize) < first.len());
        (slots.start..middle, middle..slots.end)
    };
    let splits: Vec<_> = (0..list.cells()).map(split).collect();
    let mut between = |a: usize, b: usize| {
        for i in splits[a].0.clone() {
            for j in splits[b].1.clone() {
                if squared_distance(&list.points()[i], &list.points()[j]) <= radius * radius {
                    meet(list.order()[i] as usize, list.order()[j] as usize - first.len());
                }
            }
        }
    };
    (0..list.cells()).for_each(|cell| between(cell, cell));
    list.for_each_cell_pair(1, |a, b| {
        between(a, b);
        between(b, a);
    });
}
