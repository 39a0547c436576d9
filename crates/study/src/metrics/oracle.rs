//! The same metrics by their bare definitions, over all pairs of particles: O(N^2), slow and plain. The fast
//! versions are tested against these.

use super::cell_list::squared_distance;
use super::error::MetricError;
use super::flood_fill::FloodRaster;
use super::fragments::FragmentAnalysis;
use snowlab_solver::KernelKind;
use snowlab_solver::geometry::Vector;

/// The connected components of a graph given by its edges, found by walking from particle to particle:
/// `joined(i, j)` says whether two particles share an edge.
///
/// # Errors
/// Masses [kg] that are not finite and positive.
pub fn components(
    masses: &[f64],
    joined: impl Fn(usize, usize) -> bool,
) -> Result<FragmentAnalysis, MetricError> {
    let particles = masses.len();
    let mut component = vec![None; particles];
    for seed in 0..particles {
        if component[seed].is_some() {
            continue;
        }
        component[seed] = Some(seed as u32);
        let mut frontier = vec![seed];
        while let Some(here) = frontier.pop() {
            for there in 0..particles {
                if component[there].is_none() && joined(here, there) {
                    component[there] = Some(seed as u32);
                    frontier.push(there);
                }
            }
        }
    }
    let names: Vec<u32> = component.into_iter().flatten().collect();
    FragmentAnalysis::of_partition(&names, masses)
}

/// [`friends_of_friends`](super::friends_of_friends::friends_of_friends): joined where the distance is at
/// most `link` [m].
///
/// # Errors
/// As [`components`].
pub fn friends_of_friends<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    link: f64,
) -> Result<FragmentAnalysis, MetricError> {
    components(masses, |i, j| squared_distance(&positions[i], &positions[j]) <= link * link)
}

/// [`BondGraph`](super::bond_graph::BondGraph): joined where within 2h at `reference` and within 3h at
/// `positions` [m]. Returns the fragments and the number of cut bonds.
///
/// # Errors
/// As [`components`].
pub fn bond_graph<const D: usize>(
    reference: &[Vector<f64, D>],
    positions: &[Vector<f64, D>],
    masses: &[f64],
    spacing: f64,
) -> Result<(FragmentAnalysis, usize), MetricError> {
    let within = |points: &[Vector<f64, D>], i: usize, j: usize, reach: f64| {
        squared_distance(&points[i], &points[j]) <= (reach * spacing) * (reach * spacing)
    };
    let bonded = |i, j| within(reference, i, j, 2.0);
    let held = |i, j| within(positions, i, j, 3.0);
    let pairs = (0..positions.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let cut = pairs.filter(|&(i, j)| bonded(i, j) && !held(i, j)).count();
    Ok((components(masses, |i, j| bonded(i, j) && held(i, j))?, cut))
}

/// [`flood_fill`](super::flood_fill::flood_fill): joined where both cells are full and equal or side by side.
///
/// # Errors
/// As [`components`].
pub fn flood_fill<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    raster: FloodRaster<D>,
) -> Result<FragmentAnalysis, MetricError> {
    let cell = |i: usize| (positions[i] - raster.origin).map(|x| (x / raster.side).floor());
    let density = |i: usize| {
        let here = (0..positions.len()).filter(|&j| cell(j) == cell(i)).map(|j| masses[j]);
        here.sum::<f64>() / raster.side.powi(D as i32)
    };
    let full: Vec<bool> = (0..positions.len()).map(|i| density(i) > 0.25 * raster.rest_density).collect();
    components(masses, |i, j| full[i] && full[j] && (cell(i) - cell(j)).lp_norm(1) <= 1.0)
}

/// [`kernel_graph`](super::kernel_graph::kernel_graph): joined where, on every axis, some node is within the
/// kernel's support of both.
///
/// # Errors
/// As [`components`].
pub fn kernel_graph<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    spacing: f64,
    origin: Vector<f64, D>,
    kernel: KernelKind,
) -> Result<FragmentAnalysis, MetricError> {
    let support = match kernel {
        KernelKind::Cubic => 2.0,
        KernelKind::Quadratic => 1.5,
    };
    let scaled = |i: usize, axis: usize| (positions[i][axis] - origin[axis]) / spacing;
    let shared = |a: f64, b: f64| {
        let nearest = a.round();
        (-2..=2)
            .map(|k| nearest + f64::from(k))
            .any(|node| (a - node).abs() < support && (b - node).abs() < support)
    };
    components(masses, |i, j| (0..D).all(|axis| shared(scaled(i, axis), scaled(j, axis))))
}

/// The squared edge lengths [m^2] of the Euclidean minimum spanning tree, ascending (Prim, Bell System
/// Technical Journal 36, 1957): [`LinkCurve`](super::link_curve::LinkCurve) has N minus the number of edges
/// up to the link.
pub fn spanning_tree<const D: usize>(positions: &[Vector<f64, D>]) -> Vec<f64> {
    let mut nearest = vec![f64::INFINITY; positions.len()];
    let mut left: Vec<usize> = (1..positions.len()).collect();
    let (mut last, mut edges) = (0, Vec::new());
    while !left.is_empty() {
        for &particle in &left {
            nearest[particle] =
                nearest[particle].min(squared_distance(&positions[last], &positions[particle]));
        }
        let closest =
            (0..left.len()).fold(0, |best, k| if nearest[left[k]] < nearest[left[best]] { k } else { best });
        last = left.swap_remove(closest);
        edges.push(nearest[last]);
    }
    edges.sort_unstable_by(f64::total_cmp);
    edges
}
