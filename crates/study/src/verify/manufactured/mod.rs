//! Manufactured solutions: does the error fall with the grid, and how fast?

mod follow;
mod series;
mod solutions;
mod tables;

use std::f64::consts::TAU;

use rayon::prelude::*;
use snowlab_sampler::{Purpose, Streams, rng};
use snowlab_solver::geometry::Vector;
use snowlab_solver::{KernelKind, Transfer};

use super::Setting;
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::kernel_name;
use follow::Run;
use series::{LIGHT, Motion, Series, VORTEX, grids, on_one_grid, refined, waves};
use solutions::difference_from_finite_differences;
use tables::{figure, finest, order, orders_table, runs_table, solutions_table};

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let series = refined(effort);
    let mut cases: Vec<(Series, usize)> =
        series.iter().flat_map(|s| grids(s, effort).iter().map(|&cells| (*s, cells))).collect();
    let at_one_grid = on_one_grid(effort);
    cases.extend(&at_one_grid);
    let runs =
        cases.into_par_iter().map(|(series, cells)| series.run(cells)).collect::<anyhow::Result<Vec<_>>>()?;
    let (runs, crowd) = runs.split_at(runs.len() - at_one_grid.len());
    let mut rest = runs;
    let mut grouped: Vec<&[Run]> = Vec::new();
    for s in &series {
        let (own, others) = rest.split_at(grids(s, effort).len());
        grouped.push(own);
        rest = others;
    }
    Ok(Evidence {
        tables: vec![
            runs_table("manufactured", runs),
            runs_table("manufactured-crowds", crowd),
            orders_table(&grouped),
            solutions_table(),
        ],
        figures: figures(&grouped)?,
        checks: forces().into_iter().chain(grouped.iter().filter_map(|runs| check(runs))).collect(),
    })
}

fn figures(grouped: &[&[Run]]) -> anyhow::Result<Vec<EvidenceFigure>> {
    let cubic = |s: &Series, motion| s.motion == motion && s.kernel == KernelKind::Cubic;
    let transfers = |s: &Series| {
        (s.motion == Motion::Waves2 && s.per_axis == 4)
            .then(|| format!("{} {}", kernel_name(s.kernel), s.transfer_name()))
    };
    let vortex = |s: &Series| {
        (cubic(s, Motion::Vortex) && s.reference_step == LIGHT)
            .then(|| format!("{}, {} per cell", s.transfer_name(), s.per_cell()))
    };
    let placements = |s: &Series| {
        let precision = if s.single { ", f32" } else { "" };
        let walls = if s.mirrored { "" } else { ", zeroed walls" };
        (cubic(s, Motion::Waves2) && s.transfer == Transfer::Mls && s.per_axis == 2)
            .then(|| format!("{}{precision}{walls}", s.placement_name()))
    };
    Ok(vec![
        EvidenceFigure {
            name: "manufactured-transfers",
            caption: "Standing waves in 2D, lattice of 16 particles per cell: error against cells per metre, each kernel and transfer.",
            drawing: figure(grouped, &transfers)?,
        },
        EvidenceFigure {
            name: "manufactured-vortex",
            caption: "The vortex, cubic kernel, 16 and 4 particles per cell: error against cells per metre.",
            drawing: figure(grouped, &vortex)?,
        },
        EvidenceFigure {
            name: "manufactured-placement",
            caption: "Standing waves in 2D, cubic mls, 4 particles per cell: placement, precision and walls.",
            drawing: figure(grouped, &placements)?,
        },
    ])
}

/// The body forces against finite differences of motion and stress.
fn forces() -> Vec<Check> {
    let mut stream = Streams::new(2).stream(Purpose::Placement);
    let in_square: Vec<Vector<f64, 2>> = (0..50).map(|_| rng::uniform_vector::<2>(&mut stream)).collect();
    let in_cube: Vec<Vector<f64, 3>> = (0..50).map(|_| rng::uniform_vector::<3>(&mut stream)).collect();
    let in_ring: Vec<Vector<f64, 2>> = (0..50)
        .map(|_| {
            let drawn = rng::uniform_vector::<2>(&mut stream);
            let (sin, cos) = libm::sincos(TAU * drawn[0]);
            // A hundredth inside both edges, so that differences stay within the ring.
            Vector::<f64, 2>::new(cos, sin) * (VORTEX.inner() + 0.01 + 0.48 * drawn[1])
        })
        .collect();
    // Times within the motions that are no multiples of a quarter of their periods, where terms would vanish.
    let (waves_time, vortex_time) = (0.24 / waves().speed, 0.3 * VORTEX.period);
    let found = [
        (Motion::Waves2, difference_from_finite_differences::<2>(&waves(), &in_square, waves_time)),
        (Motion::Waves3, difference_from_finite_differences::<3>(&waves(), &in_cube, waves_time)),
        (Motion::Vortex, difference_from_finite_differences::<2>(&VORTEX, &in_ring, vortex_time)),
    ];
    found
        .into_iter()
        .map(|(motion, measured)| Check {
            quantity: format!("body force against finite differences, over the largest, {}", motion.name()),
            measured,
            theory: "0".into(),
            allowed: [0.0, 1e-4],
            source: "central differences of motion and stress",
        })
        .collect()
}

/// The order over the three finest grids, on a lattice with particles enough that the quadrature's error lies below: fewer, other placements,
/// and zeroed walls do not keep it. Nor do 8 particles per cell in 3D with the quadratic kernel and an affine transfer, whose order is a
/// finding; more cannot be afforded.
fn check(runs: &[Run]) -> Option<Check> {
    let series = runs[0].series;
    let enough = series.per_axis == Series::of(series.motion, series.kernel, series.transfer).per_axis;
    let too_few = series.motion == Motion::Waves3
        && series.kernel == KernelKind::Quadratic
        && series.transfer.keeps_affine();
    let standard = series.reference_step == LIGHT;
    (enough && standard && !too_few).then(|| Check {
        quantity: format!(
            "order of the L2 error, {}, to {} cells per metre",
            series.name(),
            runs[runs.len() - 1].cells
        ),
        measured: order(finest(runs), |errors| errors.l2),
        theory: "2".into(),
        allowed: [1.6, 3.0],
        source: "the kernels' transform is 1 - O((kh)^2), steps are of the second order; chosen: 0.4 below, where the quadrature's error begins",
    })
}
