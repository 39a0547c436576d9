//! A bar that vibrates along its length, beside the dispersion relation of each transfer.
//!
//! On a uniform lattice of many particles, a wave e^{ikx} loses the factor w(k) when it goes from particles to grid or back, w the
//! Fourier transform of the kernel, sinc^4(kh/2) for the cubic and sinc^3 for the quadratic one; an affine matrix carries
//! w'(k) besides. With F driven by ik w V and the force by ik w sigma (for mls by D^-1 w' in the place of k w):
//!
//! ```text
//! flip   omega = c k w^2         loss (1 - a)(1 - w^2) / (2 dt)          a the share, c^2 = (lambda + 2 mu) / rho
//! apic   omega = c k w           loss (1 - w^2 - D^-1 w'^2) / (2 dt)     w^2 + D^-1 w'^2 = 1 - O((kh)^4)
//! mls    omega = c D^-1 |w'|     the same
//! ```

use std::f64::consts::PI;

use rayon::prelude::*;
use snowlab_solver::collision::Contact;
use snowlab_solver::geometry::Vector;
use snowlab_solver::{KernelKind, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::{
    KERNELS, TRANSFERS, elastic, kernel_name, lattice, observed_order, scene, transfer_name, wall, wave_speed,
};
use crate::figure::axis::Scale;
use crate::statistics::least_squares_slope;
use crate::table::{Row, Table};

/// Length of the bar, of which half a wave fits in [m].
const LENGTH: f64 = 1.0;
/// Width in cells: that of the kernel's support.
const WIDTH: usize = 4;
/// Largest velocity at the start [m/s]: strains of 5e-5, so that the elastic law is linear.
const VELOCITY: f64 = 1e-3;
/// Periods watched.
const PERIODS: f64 = 11.0;

struct Run {
    kernel: KernelKind,
    transfer: Transfer,
    cells: usize,
    dt: f64,
    /// Angular frequency [1/s].
    frequency: f64,
    /// Decay of the amplitude [1/s].
    decay: f64,
    /// The first crest's displacement over VELOCITY / frequency.
    amplitude: f64,
}

/// The Fourier transform of the kernel and its derivative over h, at k h = `phase`.
fn transform(kernel: KernelKind, phase: f64) -> (f64, f64) {
    let power = match kernel {
        KernelKind::Cubic => 4,
        KernelKind::Quadratic => 3,
    };
    let x = 0.5 * phase;
    let (sin, cos) = libm::sincos(x);
    let (sinc, slope) = (sin / x, (x * cos - sin) / (x * x));
    (sinc.powi(power), 0.5 * f64::from(power) * sinc.powi(power - 1) * slope)
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
    fn new(kernel: KernelKind, transfer: Transfer, cells: usize) -> anyhow::Result<Self> {
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
        let mut bodies = lattice::<2>(h, [cells, WIDTH], 2);
        let shapes: Vec<f64> = bodies.iter().map(|body| libm::sin(PI * body.position[0] / LENGTH)).collect();
        let rest: Vec<Vector<f64, 2>> = bodies.iter().map(|body| body.position).collect();
        for (body, shape) in bodies.iter_mut().zip(&shapes) {
            body.velocity[0] = VELOCITY * shape;
        }
        let state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
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
        // In the first period the affine matrices take up their motion.
        let (times, logarithms): (Vec<f64>, Vec<f64>) =
            crests[2..].iter().map(|(time, height)| (*time, libm::log(*height))).unzip();
        let frequency = PI * (crossings.len() - 1) as f64 / (ended - begun);
        Ok(Run {
            kernel,
            transfer,
            cells,
            dt: state.time / state.steps as f64,
            frequency,
            decay: -least_squares_slope(&times, &logarithms).unwrap_or(f64::NAN),
            amplitude: crests[0].1 * frequency / VELOCITY,
        })
    }

    /// Frequency and decay by the dispersion relation [1/s].
    fn predicted(&self) -> (f64, f64) {
        let (k, h) = (PI / LENGTH, LENGTH / self.cells as f64);
        let (w, slope) = transform(self.kernel, k * h);
        let inverse_inertia = self.kernel.inverse_inertia();
        let affine = 1.0 - w * w - inverse_inertia * slope * slope;
        let (wave, kept) = match self.transfer {
            Transfer::Flip(share) => (k * w * w, (1.0 - share.of_step(self.dt)) * (1.0 - w * w)),
            Transfer::Apic => (k * w, affine),
            Transfer::Mls => (inverse_inertia * slope.abs() / h, affine),
        };
        (wave_speed() * wave, kept / (2.0 * self.dt))
    }

    fn name(&self) -> String {
        format!("{} {}", kernel_name(self.kernel), transfer_name(self.transfer))
    }

    /// Relative error against the continuum's frequency.
    fn frequency_error(&self) -> f64 {
        (self.frequency / continuum() - 1.0).abs()
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
    let cases: Vec<_> = KERNELS
        .into_iter()
        .flat_map(|kernel| TRANSFERS.into_iter().map(move |transfer| (kernel, transfer)))
        .flat_map(|(kernel, transfer)| grids.iter().map(move |cells| (kernel, transfer, *cells)))
        .collect();
    let runs = cases
        .into_par_iter()
        .map(|(kernel, transfer, cells)| Run::new(kernel, transfer, cells))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let series: Vec<&[Run]> = runs.chunks(grids.len()).collect();
    let line = |value: fn(&Run) -> f64| -> Vec<Line> {
        let points =
            |runs: &&[Run]| Line::new(runs[0].name(), runs.iter().map(|run| (run.cells as f64, value(run))));
        series.iter().map(points).collect()
    };
    let scale = Scale::Logarithmic;
    let panels = [
        Panel::new("error of frequency", scale, line(Run::frequency_error)),
        Panel::new("decay [1/s]", scale, line(|run| run.decay)),
    ];
    Ok(Evidence {
        figures: vec![EvidenceFigure {
            name: "vibration",
            caption: "A vibrating bar: relative error of its frequency, and decay of its amplitude.",
            drawing: chart(
                "cells to half a wave",
                scale,
                "The frequency is compared with pi c / L.",
                &panels,
            )?,
        }],
        checks: series.iter().flat_map(|runs| checks(runs)).collect(),
        tables: vec![table(&runs)],
    })
}

fn checks(runs: &[Run]) -> Vec<Check> {
    let finest = &runs[runs.len() - 1];
    let (frequency, decay) = finest.predicted();
    let order: Vec<(f64, f64)> = runs.iter().map(|run| (run.dt, run.frequency_error())).collect();
    vec![
        Check {
            quantity: format!(
                "frequency over the dispersion relation's, {}, {} cells",
                finest.name(),
                finest.cells
            ),
            measured: finest.frequency / frequency,
            theory: "1".into(),
            allowed: [0.999, 1.001],
            source: "dispersion relation; chosen: a tenth of what the grid shifts it at 16 cells",
        },
        Check {
            quantity: format!(
                "decay over the dispersion relation's, {}, {} cells",
                finest.name(),
                finest.cells
            ),
            measured: finest.decay / decay,
            theory: "1".into(),
            allowed: [0.9, 1.1],
            source: "dispersion relation; chosen: 10 %, for what the lattice of particles aliases",
        },
        Check {
            quantity: format!("order of the frequency's error, {}", finest.name()),
            measured: observed_order(&order),
            theory: "2".into(),
            allowed: [1.8, 2.2],
            source: "1 - w(k) is of second order in kh",
        },
        Check {
            quantity: format!(
                "displacement over velocity / frequency, {}, {} cells",
                finest.name(),
                finest.cells
            ),
            measured: finest.amplitude,
            theory: "1".into(),
            allowed: [0.98, 1.02],
            source: "harmonic motion",
        },
    ]
}

fn table(runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let (frequency, decay) = run.predicted();
        let mut row = Row::default();
        row.put("kernel", "-", "B-spline", kernel_name(run.kernel))
            .put("transfer", "-", "velocity transfer", transfer_name(run.transfer))
            .count("cells", "cells to half a wave", run.cells as u64)
            .number("dt", "s", "mean step", run.dt)
            .number("frequency", "1/s", "angular frequency", run.frequency)
            .number("frequency_predicted", "1/s", "the same by the dispersion relation", frequency)
            .number("frequency_error", "-", "relative error against pi c / L", run.frequency_error())
            .number("decay", "1/s", "decay of the amplitude", run.decay)
            .number("decay_predicted", "1/s", "the same by the dispersion relation", decay)
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
