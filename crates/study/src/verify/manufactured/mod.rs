//! Manufactured solutions: does the error fall with the grid, and how fast?

use std::f64::consts::TAU;

use rayon::prelude::*;
use snowlab_sampler::{Purpose, Streams, rng};
use snowlab_solver::collision::Contact;
use snowlab_solver::geometry::Vector;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{InitialParticle, KernelKind, Real, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Effort, Evidence, EvidenceFigure};
use super::scenes::{
    KERNELS, TRANSFERS, elastic, fixed_step, kernel_name, lattice, observed_order, particle, rate_form,
    scene, transfer_name, wall,
};
use super::solutions::{Solution, StandingWaves, Vortex, difference_from_finite_differences};
use crate::figure::Drawing;
use crate::figure::axis::Scale;
use crate::table::{Row, Table};

/// A = 0.05 m (strains to 16 %), c = sqrt(E / rho_0).
const WAVES: StandingWaves = StandingWaves { amplitude: 0.05, speed: 18.708_286_933_869_708 };
/// Shear R |dalpha/dR| to 1.06; chosen: a shear wave crosses the ring and comes back within the period.
const VORTEX: Vortex = Vortex { angle: 0.15, period: 0.1, middle: 1.0 };
/// The step for which FLIP's share is 0.95 [s] (chosen: the default step of the coarser grids).
const REFERENCE_STEP: f64 = 1e-3;
/// Times at which the error is taken [s]: shortly before the waves' first crest, and at the vortex's.
const WAVES_END: f64 = 0.4 / 18.708_286_933_869_708;
const VORTEX_END: f64 = 0.05;

/// By this share of their distance each ring of the vortex is turned against the one inside, so that no row of particles lies along a radius.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Where particles begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Placement {
    Lattice,
    Jittered,
    Random,
}

impl Placement {
    fn name(self) -> &'static str {
        match self {
            Placement::Lattice => "lattice",
            Placement::Jittered => "jittered",
            Placement::Random => "random",
        }
    }
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Waves2,
    Waves3,
    Vortex,
}

impl Motion {
    fn name(self) -> &'static str {
        match self {
            Motion::Waves2 => "waves 2D",
            Motion::Waves3 => "waves 3D",
            Motion::Vortex => "vortex",
        }
    }
}

/// One series: everything but the grid.
#[derive(Clone, Copy, Debug)]
struct Series {
    motion: Motion,
    kernel: KernelKind,
    transfer: Transfer,
    placement: Placement,
    single: bool,
    /// Whether walls reflect, or set the nodes' normal velocity to zero.
    mirrored: bool,
    /// Particles per cell and axis.
    per_axis: usize,
    /// Step over the default.
    step: f64,
}

impl Series {
    fn of(motion: Motion, kernel: KernelKind, transfer: Transfer) -> Self {
        let placement = Placement::Lattice;
        let per_axis = if motion == Motion::Waves3 { 2 } else { 4 };
        Series { motion, kernel, transfer, placement, single: false, mirrored: true, per_axis, step: 1.0 }
    }

    fn name(&self) -> String {
        let walls = if self.motion == Motion::Vortex || self.mirrored { "" } else { ", zeroed walls" };
        let precision = if self.single { ", f32" } else { "" };
        format!(
            "{}, {} {}, {}, {} per cell{precision}{walls}",
            self.motion.name(),
            kernel_name(self.kernel),
            transfer_name(self.transfer),
            self.placement_name(),
            self.per_cell()
        )
    }

    fn placement_name(&self) -> &'static str {
        if self.motion == Motion::Vortex { "rings" } else { self.placement.name() }
    }

    /// Particles per cell.
    fn per_cell(&self) -> usize {
        self.per_axis.pow(if self.motion == Motion::Waves3 { 3 } else { 2 })
    }

    /// The error on a grid of `cells` to the metre.
    fn run(&self, cells: usize) -> anyhow::Result<Run> {
        let [l2, linf, particles, steps] = match (self.motion, self.single) {
            (Motion::Waves2, false) => self.waves::<f64, 2>(cells),
            (Motion::Waves2, true) => self.waves::<f32, 2>(cells),
            (Motion::Waves3, false) => self.waves::<f64, 3>(cells),
            (Motion::Waves3, true) => self.waves::<f32, 3>(cells),
            (Motion::Vortex, false) => self.vortex::<f64>(cells),
            (Motion::Vortex, true) => self.vortex::<f32>(cells),
        }?;
        Ok(Run { series: *self, cells, particles, steps, l2, linf })
    }

    fn waves<T: Real, const D: usize>(&self, cells: usize) -> anyhow::Result<[f64; 4]> {
        let mut bodies = lattice::<D>(1.0 / cells as f64, [cells; D], self.per_axis);
        let mut stream = Streams::new(1).stream(Purpose::Placement);
        let apart = 1.0 / (cells * self.per_axis) as f64;
        for body in &mut bodies {
            let drawn = rng::uniform_vector::<D>(&mut stream);
            match self.placement {
                Placement::Lattice => {}
                Placement::Jittered => body.position += drawn.add_scalar(-0.5) * apart,
                Placement::Random => body.position = drawn,
            }
        }
        let contact = if self.mirrored { Contact::Mirror } else { Contact::Slip };
        let walls = (0..D).flat_map(|axis| [wall(axis, 1.0, 0.0, contact), wall(axis, -1.0, 1.0, contact)]);
        self.follow::<T, D>(&WAVES, cells, bodies, walls.collect(), WAVES_END, WAVES.amplitude)
    }

    fn vortex<T: Real>(&self, cells: usize) -> anyhow::Result<[f64; 4]> {
        // On rings, so that both edges are met exactly.
        let apart = 1.0 / (cells * self.per_axis) as f64;
        let inner = VORTEX.middle - 0.25;
        let mut ring = Vec::new();
        for number in 0..cells * self.per_axis / 2 {
            let radius = inner + (number as f64 + 0.5) * apart;
            let count = (TAU * radius / apart).round();
            let volume = TAU * radius * apart / count;
            ring.extend((0..count as usize).map(|place| {
                let (sin, cos) = libm::sincos(TAU * (place as f64 + GOLDEN * number as f64) / count);
                particle(Vector::<f64, 2>::new(cos, sin) * radius, volume)
            }));
        }
        let size = VORTEX.angle * VORTEX.middle;
        self.follow::<T, 2>(&VORTEX, cells, ring, Vec::new(), VORTEX_END, size)
    }

    /// Follows the solution to `end` [s]; L2 and largest error of the particles' displacement over `size` [m], particles and
    /// steps.
    fn follow<T: Real, const D: usize>(
        &self,
        solution: &impl Solution<D>,
        cells: usize,
        mut bodies: Vec<InitialParticle<D>>,
        walls: Vec<snowlab_solver::Collider<T, D>>,
        end: f64,
        size: f64,
    ) -> anyhow::Result<[f64; 4]> {
        let transfer = rate_form(self.transfer, REFERENCE_STEP);
        let mut scene = scene::<T, D>(1.0 / cells as f64, self.kernel, transfer, elastic());
        scene.colliders = walls;
        // Steps of one length, that of the default at the start: where it varies, symplectic Euler is of first order in time.
        let longest = self.step * step_length(&scene, &State::at_rest(&scene, Vector::zeros(), &bodies)?);
        let dt = end / (end / longest).ceil();
        scene.time_step = fixed_step(dt);
        let rest: Vec<Vector<f64, D>> = bodies.iter().map(|body| body.position).collect();
        // A step takes velocities from half a step before the positions to half a step after.
        for body in &mut bodies {
            let now = solution.position(&body.position, 0.0);
            body.velocity = (now - solution.position(&body.position, -dt)) / dt;
        }
        let state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        let mut simulation = Simulation::new(scene, state)?;
        while simulation.state().time < end {
            let state = simulation.state_mut();
            let now = state.time;
            state.body_acceleration = state
                .constants
                .id
                .iter()
                .map(|&id| solution.body_acceleration(&rest[id as usize], now).map(T::of))
                .collect();
            simulation.advance_one(end)?;
        }
        let state = simulation.state();
        let (mut squares, mut largest) = (0.0, 0.0_f64);
        for (p, rest) in state.by_id().into_iter().zip(&rest) {
            let off = (state.world_position(p) - solution.position(rest, state.time)).norm() / size;
            squares += off * off / bodies.len() as f64;
            largest = largest.max(off);
        }
        Ok([squares.sqrt(), largest, bodies.len() as f64, state.steps as f64])
    }
}

/// A series on one grid.
struct Run {
    series: Series,
    cells: usize,
    particles: f64,
    steps: f64,
    l2: f64,
    linf: f64,
}

fn all_series(effort: Effort) -> Vec<Series> {
    let mut all = Vec::new();
    for kernel in KERNELS {
        for transfer in TRANSFERS {
            all.push(Series::of(Motion::Waves2, kernel, transfer));
            all.push(Series::of(Motion::Vortex, kernel, transfer));
            all.push(Series::of(Motion::Waves3, kernel, transfer));
        }
    }
    // With 4 particles per cell, as the studies have.
    for transfer in TRANSFERS {
        let few = |motion, kernel| Series { per_axis: 2, ..Series::of(motion, kernel, transfer) };
        let waves = few(Motion::Waves2, KernelKind::Cubic);
        all.extend([
            waves,
            few(Motion::Vortex, KernelKind::Cubic),
            few(Motion::Waves2, KernelKind::Quadratic),
        ]);
        for placement in [Placement::Jittered, Placement::Random] {
            all.push(Series { placement, ..waves });
        }
        all.push(Series { mirrored: false, ..waves });
        all.push(Series { single: true, ..waves });
    }
    if effort == Effort::Quick {
        all.retain(|series| series.kernel == KernelKind::Cubic && series.motion != Motion::Waves3);
    }
    all
}

/// On one grid: ever more particles, where the error no longer falls with the grid; and ever shorter steps.
fn on_one_grid(effort: Effort) -> Vec<(Series, usize)> {
    let (crowds, cells): (&[usize], usize) = effort.choose((&[2, 4], 32), (&[2, 4, 8], 64));
    let waves = Series { per_axis: 2, ..Series::of(Motion::Waves2, KernelKind::Cubic, Transfer::Mls) };
    let quadratic = Series { kernel: KernelKind::Quadratic, ..waves };
    let mut cases: Vec<(Series, usize)> = [0.5, 0.25].map(|step| (Series { step, ..waves }, cells)).into();
    for series in [
        waves,
        Series { placement: Placement::Random, ..waves },
        quadratic,
        Series { transfer: Transfer::Apic, ..quadratic },
        Series { motion: Motion::Vortex, ..waves },
        Series { motion: Motion::Vortex, ..quadratic },
    ] {
        cases.extend(crowds.iter().map(|&per_axis| (Series { per_axis, ..series }, cells)));
    }
    cases
}

fn grids(motion: Motion, effort: Effort) -> &'static [usize] {
    match (motion, effort) {
        (Motion::Waves3, _) => &[4, 8, 16, 32],
        (Motion::Waves2, Effort::Quick) => &[8, 16, 32, 64],
        (Motion::Waves2, Effort::Full) => &[8, 16, 32, 64, 128],
        (Motion::Vortex, Effort::Quick) => &[8, 16, 32],
        (Motion::Vortex, Effort::Full) => &[8, 16, 32, 64],
    }
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let series = all_series(effort);
    let mut cases: Vec<(Series, usize)> =
        series.iter().flat_map(|s| grids(s.motion, effort).iter().map(|&cells| (*s, cells))).collect();
    let at_one_grid = on_one_grid(effort);
    cases.extend(&at_one_grid);
    let runs =
        cases.into_par_iter().map(|(series, cells)| series.run(cells)).collect::<anyhow::Result<Vec<_>>>()?;
    let (runs, crowd) = runs.split_at(runs.len() - at_one_grid.len());
    let mut rest = runs;
    let mut grouped: Vec<&[Run]> = Vec::new();
    for s in &series {
        let (own, others) = rest.split_at(grids(s.motion, effort).len());
        grouped.push(own);
        rest = others;
    }
    Ok(Evidence {
        tables: vec![table("manufactured", runs), table("manufactured-crowds", crowd), orders(&grouped)],
        figures: vec![
            EvidenceFigure {
                name: "manufactured-transfers",
                caption: "Standing waves in 2D, lattice of 16 particles per cell: error against cells per metre, each kernel and transfer.",
                drawing: figure(&grouped, &|s| s.motion == Motion::Waves2 && s.per_axis == 4)?,
            },
            EvidenceFigure {
                name: "manufactured-vortex",
                caption: "The vortex: error against cells per metre.",
                drawing: figure(&grouped, &|s| {
                    s.motion == Motion::Vortex && (s.per_axis == 4 || s.transfer == Transfer::Mls)
                })?,
            },
            EvidenceFigure {
                name: "manufactured-placement",
                caption: "Standing waves in 2D, cubic mls, 4 particles per cell: placement, precision and walls.",
                drawing: figure(&grouped, &|s| {
                    s.motion == Motion::Waves2
                        && s.kernel == KernelKind::Cubic
                        && s.transfer == Transfer::Mls
                        && s.per_axis == 2
                })?,
            },
        ],
        checks: forces().into_iter().chain(grouped.iter().filter_map(|runs| check(runs))).collect(),
    })
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
            Vector::<f64, 2>::new(cos, sin) * (0.76 + 0.48 * drawn[1])
        })
        .collect();
    let found = [
        (Motion::Waves2, difference_from_finite_differences::<2>(&WAVES, &in_square, 0.013)),
        (Motion::Waves3, difference_from_finite_differences::<3>(&WAVES, &in_cube, 0.013)),
        (Motion::Vortex, difference_from_finite_differences::<2>(&VORTEX, &in_ring, 0.03)),
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

/// The order on a lattice with particles enough that the quadrature's floor lies below: fewer, other placements, and zeroed walls do not keep
/// it. With the cubic kernel over the three finest grids; the quadratic one, whose slope has kinks, meets its floor in 2D beyond 32
/// cells even so.
fn check(runs: &[Run]) -> Option<Check> {
    let series = runs[0].series;
    let kept = series.per_axis == Series::of(series.motion, series.kernel, series.transfer).per_axis;
    let above_floor = match series.kernel {
        KernelKind::Cubic => runs,
        KernelKind::Quadratic => &runs[..runs.partition_point(|run| run.cells <= 32)],
    };
    let finest = above_floor[above_floor.len() - 1].cells;
    kept.then(|| Check {
        quantity: format!("order of the L2 error, {}, to {finest} cells per metre", series.name()),
        measured: order(above_floor, |run| run.l2),
        theory: "2".into(),
        allowed: [1.6, 3.0],
        source: "second order in space for both splines on a lattice (Steffen, Kirby & Berzins 2008)",
    })
}

/// From the three finest of the grids.
fn order(runs: &[Run], error: impl Fn(&Run) -> f64) -> f64 {
    let points: Vec<(f64, f64)> = runs.iter().map(|run| (1.0 / run.cells as f64, error(run))).collect();
    observed_order(&points[points.len().saturating_sub(3)..])
}

fn identity(row: &mut Row, series: &Series) {
    row.put("solution", "-", "motion", series.motion.name())
        .put("kernel", "-", "B-spline", kernel_name(series.kernel))
        .put("transfer", "-", "velocity transfer", transfer_name(series.transfer))
        .put("placement", "-", "where particles begin", series.placement_name())
        .put("precision", "-", "floating point type", if series.single { "f32" } else { "f64" })
        .put(
            "walls",
            "-",
            "mirrored, or normal velocity zeroed",
            if series.mirrored { "mirrored" } else { "zeroed" },
        );
}

fn table(name: &'static str, runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let mut row = Row::default();
        identity(&mut row, &run.series);
        row.count("cells", "cells per metre", run.cells as u64)
            .number("step", "-", "step over the default", run.series.step)
            .count("particles", "number of particles", run.particles as u64)
            .count("particles_per_cell", "particles per cell", run.series.per_cell() as u64)
            .count("steps", "steps", run.steps as u64)
            .number("l2", "-", "root mean square error of displacement over its amplitude", run.l2)
            .number("linf", "-", "largest error of displacement over its amplitude", run.linf);
        row
    };
    Table { name, rows: runs.iter().map(row).collect() }
}

fn orders(grouped: &[&[Run]]) -> Table {
    let row = |runs: &&[Run]| {
        let last = &runs[runs.len() - 1];
        let mut row = Row::default();
        identity(&mut row, &last.series);
        row.count("particles_per_cell", "particles per cell", last.series.per_cell() as u64)
            .count("cells", "cells per metre of the finest grid", last.cells as u64)
            .number("l2", "-", "L2 error on the finest grid", last.l2)
            .number("linf", "-", "largest error on the finest grid", last.linf)
            .number(
                "order_l2_coarse",
                "-",
                "order of the L2 error over the three coarsest grids",
                order(&runs[..3], |run| run.l2),
            )
            .number(
                "order_l2",
                "-",
                "order of the L2 error over the three finest grids",
                order(runs, |run| run.l2),
            )
            .number(
                "order_linf",
                "-",
                "order of the largest error over the three finest grids",
                order(runs, |run| run.linf),
            );
        row
    };
    Table { name: "manufactured-orders", rows: grouped.iter().map(row).collect() }
}

fn figure(grouped: &[&[Run]], chosen: &dyn Fn(&Series) -> bool) -> anyhow::Result<Drawing> {
    let lines = |error: fn(&Run) -> f64| -> Vec<Line> {
        let shown = grouped.iter().filter(|runs| chosen(&runs[0].series));
        shown
            .map(|runs| {
                Line::new(runs[0].series.name(), runs.iter().map(|run| (run.cells as f64, error(run))))
            })
            .collect()
    };
    let scale = Scale::Logarithmic;
    let panels = [
        Panel::new("L2 error", scale, lines(|run| run.l2)),
        Panel::new("largest error", scale, lines(|run| run.linf)),
    ];
    chart("cells per metre", scale, "Error of the particles' displacement over its amplitude.", &panels)
}
