//! A bar that vibrates along its length, beside the dispersion relation of each transfer ([`super::dispersion`]).
//!
//! For kh small and many particles its frequency is c k w^2 (flip), c k w (apic) and c D^-1 |w'| (mls), w the Fourier transform of the
//! kernel, sinc^4(kh/2) for the cubic and sinc^3 for the quadratic one.

use std::f64::consts::PI;

use rayon::prelude::*;
use snowlab_solver::collision::Contact;
use snowlab_solver::geometry::Vector;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{KernelKind, Simulation, State, StepLength, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::dispersion::{Lattice, Wave};
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::{
    KERNELS, TRANSFERS, elastic, kernel_name, lattice, observed_order, scene, transfer_name, wall, wave_speed,
};
use crate::figure::Drawing;
use crate::figure::axis::Scale;
use crate::statistics::least_squares_slope;
use crate::table::{Row, Table};

/// Length of the bar, of which half a wave fits in [m].
const LENGTH: f64 = 1.0;
/// Width in cells: that of the kernel's support.
const WIDTH: usize = 4;
/// Largest velocity at the start [m/s]: strains of 5e-5, so that the elastic law is linear.
const VELOCITY: f64 = 1e-3;
/// Periods watched, the first not counted; chosen: the crossings tell the frequency to 1e-5 or so of itself.
const PERIODS: f64 = 11.0;
/// Particles per cell and axis.
const PER_AXIS: usize = 2;

struct Run {
    kernel: KernelKind,
    transfer: Transfer,
    cells: usize,
    /// Step over the default.
    step: f64,
    dt: f64,
    measured: Wave,
    /// The first crest's displacement over VELOCITY / frequency.
    amplitude: f64,
}

/// When a line through the last two of three points (t, y) passes zero.
fn crossing([_, (t1, y1), (t2, y2)]: [(f64, f64); 3]) -> Option<f64> {
    (y1 * y2 < 0.0).then(|| t1 + (t2 - t1) * y1 / (y1 - y2))
}

/// Time and height of the crest of the parabola through three points at equal distances, where it lies between them.
fn crest([(_, y0), (t1, y1), (t2, y2)]: [(f64, f64); 3]) -> Option<(f64, f64)> {
    let (slope, bend) = (0.5 * (y2 - y0), y0 - 2.0 * y1 + y2);
    let shift = -slope / bend;
    (y1.abs() > y0.abs() && y1.abs() >= y2.abs())
        .then(|| (t1 + shift * (t2 - t1), (y1 + 0.5 * slope * shift).abs()))
}

impl Run {
    fn new(kernel: KernelKind, transfer: Transfer, cells: usize, step: f64) -> anyhow::Result<Self> {
        let h = LENGTH / cells as f64;
        let mut scene = scene::<f64, 2>(h, kernel, transfer, elastic());
        // Symplectic Euler's energy swings by omega dt / 2 with the vibration, which here is more than the watchdog's 1 %.
        scene.time_step.watchdog_interval = 0;
        scene.colliders = vec![
            wall(0, 1.0, 0.0, Contact::Mirror),
            wall(0, -1.0, LENGTH, Contact::Mirror),
            wall(1, 1.0, 0.0, Contact::Mirror),
            wall(1, -1.0, WIDTH as f64 * h, Contact::Mirror),
        ];
        let mut bodies = lattice::<2>(h, [cells, WIDTH], PER_AXIS);
        let shapes: Vec<f64> = bodies.iter().map(|body| libm::sin(PI * body.position[0] / LENGTH)).collect();
        let rest: Vec<Vector<f64, 2>> = bodies.iter().map(|body| body.position).collect();
        for (body, shape) in bodies.iter_mut().zip(&shapes) {
            body.velocity[0] = VELOCITY * shape;
        }
        let mut state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        for (affine, rest) in state.motion.affine.iter_mut().zip(&rest) {
            affine[(0, 0)] = VELOCITY * PI / LENGTH * libm::cos(PI * rest[0] / LENGTH);
        }
        scene.time_step.length = StepLength::Fixed(step * step_length(&scene, &state));
        let mut simulation = Simulation::new(scene, state)?;
        let norm: f64 = shapes.iter().map(|shape| shape * shape).sum();
        let displacement = |simulation: &Simulation<f64, 2>| -> f64 {
            let state = simulation.state();
            let moved = state.by_id().into_iter().zip(rest.iter().zip(&shapes));
            moved.map(|(p, (rest, shape))| (state.motion.position[p] - rest)[0] * shape).sum::<f64>() / norm
        };
        let period = 2.0 * LENGTH / wave_speed();
        let (mut crossings, mut crests) = (Vec::new(), Vec::new());
        let mut last = [(0.0, 0.0); 3];
        while simulation.state().time < PERIODS * period {
            simulation.advance_one(f64::INFINITY)?;
            let [_, before, now] = last;
            last = [before, now, (simulation.state().time, displacement(&simulation))];
            crossings.extend(crossing(last));
            crests.extend(crest(last));
        }
        let state = simulation.state();
        let (begun, ended) = (crossings[0], crossings[crossings.len() - 1]);
        // In the first period motions of particles against each other die away.
        let (times, logarithms): (Vec<f64>, Vec<f64>) =
            crests[2..].iter().map(|(time, height)| (*time, libm::log(*height))).unzip();
        let frequency = PI * (crossings.len() - 1) as f64 / (ended - begun);
        Ok(Run {
            kernel,
            transfer,
            cells,
            step,
            dt: state.time / state.steps as f64,
            measured: Wave {
                frequency,
                decay: -least_squares_slope(&times, &logarithms).unwrap_or(f64::NAN),
            },
            amplitude: crests[0].1 * frequency / VELOCITY,
        })
    }

    fn lattice(&self) -> Lattice {
        Lattice {
            kernel: self.kernel,
            transfer: self.transfer,
            per_axis: PER_AXIS,
            spacing: LENGTH / self.cells as f64,
            speed: wave_speed(),
            dt: self.dt,
        }
    }

    /// By the dispersion relation.
    fn predicted(&self) -> Wave {
        self.lattice().wave(PI / LENGTH)
    }

    fn name(&self) -> String {
        format!("{} {}", kernel_name(self.kernel), transfer_name(self.transfer))
    }

    /// By how much the grid lowers the frequency, over pi c / L: measured, and predicted.
    fn shift(&self) -> [f64; 2] {
        [self.measured, self.predicted()].map(|wave| 1.0 - wave.frequency / continuum())
    }
}

/// pi c / L [1/s].
fn continuum() -> f64 {
    PI * wave_speed() / LENGTH
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let grids: &[usize] = effort.choose(&[16, 32], &[8, 16, 32, 64]);
    let pairs = KERNELS.into_iter().flat_map(|kernel| TRANSFERS.map(|transfer| (kernel, transfer)));
    // Every grid at the default step, then half of it on the one before the finest.
    let settings: Vec<(usize, f64)> =
        grids.iter().map(|&cells| (cells, 1.0)).chain([(grids[grids.len() - 2], 0.5)]).collect();
    let cases: Vec<_> = pairs.flat_map(|pair| settings.iter().map(move |setting| (pair, *setting))).collect();
    let runs = cases
        .into_par_iter()
        .map(|((kernel, transfer), (cells, step))| Run::new(kernel, transfer, cells, step))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let refined: Vec<&[Run]> = runs.chunks(settings.len()).map(|runs| &runs[..grids.len()]).collect();
    Ok(Evidence {
        figures: vec![EvidenceFigure {
            name: "vibration",
            caption: "A vibrating bar: by how much the grid lowers its frequency, and decay of its amplitude; points measured, dashed the dispersion relation.",
            drawing: figure(&refined)?,
        }],
        checks: refined
            .iter()
            .flat_map(|runs| order(runs).into_iter().chain(checks(&runs[runs.len() - 1])))
            .chain(runs.iter().filter(|run| run.step < 1.0).flat_map(checks))
            .collect(),
        tables: vec![table(&runs)],
    })
}

fn figure(refined: &[&[Run]]) -> anyhow::Result<Drawing> {
    let lines = |value: fn(&Run) -> f64| -> Vec<Line> {
        let line =
            |runs: &&[Run]| Line::new(runs[0].name(), runs.iter().map(|run| (run.cells as f64, value(run))));
        refined.iter().map(line).collect()
    };
    let scale = Scale::Logarithmic;
    let panels = [
        Panel {
            theory: lines(|run| run.shift()[1]),
            ..Panel::new("shift of frequency", scale, lines(|run| run.shift()[0]))
        },
        Panel {
            theory: lines(|run| run.predicted().decay),
            ..Panel::new("decay [1/s]", scale, lines(|run| run.measured.decay))
        },
    ];
    chart("cells to half a wave", scale, "The frequency is compared with pi c / L.", &panels)
}

/// The order of the shift.
fn order(runs: &[Run]) -> [Check; 1] {
    let points: Vec<(f64, f64)> =
        runs.iter().map(|run| (1.0 / run.cells as f64, run.shift()[0].abs())).collect();
    [Check {
        quantity: format!("order of the frequency's shift, {}", runs[0].name()),
        measured: observed_order(&points),
        theory: "2".into(),
        allowed: [1.8, 2.2],
        source: "1 - w(k) is of second order in kh; chosen: 0.2, for the coarsest grid",
    }]
}

/// Frequency and decay beside the dispersion relation.
fn checks(run: &Run) -> [Check; 3] {
    let name =
        |what: &str| format!("{what}, {}, {} cells, {} of the default step", run.name(), run.cells, run.step);
    let (predicted, [shift, shift_predicted]) = (run.predicted(), run.shift());
    // With the decay of a quarter of a period.
    let crest =
        run.lattice().moving(PI / LENGTH) * libm::exp(-0.5 * PI * predicted.decay / predicted.frequency);
    let check = |quantity: String, measured: f64, off: f64, source: &'static str| Check {
        quantity,
        measured,
        theory: "1".into(),
        allowed: [1.0 - off, 1.0 + off],
        source,
    };
    [
        check(
            name("shift of the frequency over the dispersion relation's"),
            shift / shift_predicted,
            1e-3,
            "dispersion relation of the lattice and its steps; chosen: 0.1 %, for the interpolated crossings",
        ),
        check(
            name("decay over the dispersion relation's"),
            run.measured.decay / predicted.decay,
            1e-3,
            "dispersion relation of the lattice and its steps; chosen: 0.1 %, for the interpolated crests",
        ),
        check(
            name("displacement at the first crest over velocity / frequency, over the dispersion relation's"),
            run.amplitude / crest,
            1e-2,
            "harmonic motion; chosen: 1 %, for the first half step",
        ),
    ]
}

fn table(runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let predicted = run.predicted();
        let mut row = Row::default();
        row.put("kernel", "-", "B-spline", kernel_name(run.kernel))
            .put("transfer", "-", "velocity transfer", transfer_name(run.transfer))
            .count("cells", "cells to half a wave", run.cells as u64)
            .number("step", "-", "step over the default", run.step)
            .number("dt", "s", "step", run.dt)
            .number("frequency", "1/s", "angular frequency", run.measured.frequency)
            .number("frequency_predicted", "1/s", "the same by the dispersion relation", predicted.frequency)
            .number("shift", "-", "1 - frequency over pi c / L", run.shift()[0])
            .number("shift_predicted", "-", "the same by the dispersion relation", run.shift()[1])
            .number("decay", "1/s", "decay of the amplitude", run.measured.decay)
            .number("decay_predicted", "1/s", "the same by the dispersion relation", predicted.decay)
            .number(
                "amplitude",
                "-",
                "displacement of the first crest over velocity / frequency",
                run.amplitude,
            );
        row
    };
    Table { name: "vibration", rows: runs.iter().map(row).collect() }
}
