//! Semi-implicit and trapezoidal steps: damping and order on a vibrating bar, and where they are stable.

use std::f64::consts::PI;

use rayon::prelude::*;
use snowlab_sampler::{Purpose, Streams, rng};
use snowlab_solver::collision::Contact;
use snowlab_solver::geometry::Vector;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{FlipShare, Integrator, KernelKind, LinearSolve, Scene, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::{elastic, fixed_step, lattice, observed_order, scene, wall, wave_speed};
use super::stability::bounded;
use crate::figure::axis::Scale;
use crate::table::{Row, Table};

/// Length of the bar [m], and cells along it: so many that what particles and grid lose to each other's smoothing is small beside the integrators'
/// errors.
const LENGTH: f64 = 1.0;
const CELLS: usize = 64;
/// Largest velocity at the start [m/s]: strains of 1e-5, so that the elastic law is linear.
const VELOCITY: f64 = 1e-4;
/// Steps over which the energy of a block must stay bounded (chosen: 1.5 % above its limit at beta = 0.4 it grows by 1e9 in 1000).
const STEPS: usize = 4000;
/// Over the explicit limit: a step that must be stable where no limit was derived (chosen: beyond any that advection allows).
const FAR: f64 = 100.0;

/// Undamped transfers: what is lost is the integrator's.
const FLIP: Transfer = Transfer::Flip(FlipShare::PerStep(1.0));

/// Solved to round-off, so that the solver does not show.
const SOLVE: LinearSolve = LinearSolve {
    method: snowlab_solver::Method::Minres,
    tolerance: 1e-11,
    max_iterations: 5000,
    definite: false,
};

fn semi_implicit(beta: f64) -> Integrator {
    Integrator::SemiImplicit { beta, solve: SOLVE }
}

fn name(integrator: &Integrator) -> String {
    match integrator {
        Integrator::Explicit => "explicit".into(),
        Integrator::SemiImplicit { beta, .. } => format!("beta = {beta}"),
        Integrator::Trapezoidal { .. } => "trapezoidal".into(),
    }
}

/// Amplitude of the bar's slowest vibration along its length after each of `steps` steps [m].
fn vibration(integrator: Integrator, dt: f64, steps: usize) -> anyhow::Result<Vec<f64>> {
    let h = LENGTH / CELLS as f64;
    let mut scene = scene::<f64, 2>(h, KernelKind::Cubic, FLIP, elastic());
    scene.integrator = integrator;
    scene.time_step = fixed_step(dt);
    scene.colliders = vec![
        wall(0, 1.0, 0.0, Contact::Mirror),
        wall(0, -1.0, LENGTH, Contact::Mirror),
        wall(1, 1.0, 0.0, Contact::Mirror),
        wall(1, -1.0, 4.0 * h, Contact::Mirror),
    ];
    let mut bodies = lattice::<2>(h, [CELLS, 4], 2);
    let shape = |x: f64| libm::sin(PI * x / LENGTH);
    bodies.iter_mut().for_each(|body| body.velocity[0] = VELOCITY * shape(body.position[0]));
    let norm: f64 = bodies.iter().map(|body| shape(body.position[0]).powi(2)).sum();
    let state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
    let mut simulation = Simulation::new(scene, state)?;
    let mut amplitudes = Vec::with_capacity(steps);
    for _ in 0..steps {
        simulation.advance_one(f64::INFINITY)?;
        let state = simulation.state();
        let moved = state
            .by_id()
            .into_iter()
            .zip(&bodies)
            .map(|(p, body)| (state.motion.position[p] - body.position)[0] * shape(body.position[0]));
        amplitudes.push(moved.sum::<f64>() / norm);
    }
    Ok(amplitudes)
}

/// Share of the amplitude that a step keeps: the root of the determinant of x_{n+1} = trace x_n - determinant x_{n-1}, by least squares.
fn kept(x: &[f64]) -> f64 {
    let (mut aa, mut ab, mut bb, mut ac, mut bc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for three in x.windows(3) {
        let [b, a, c] = [-three[0], three[1], three[2]];
        (aa, ab, bb, ac, bc) = (aa + a * a, ab + a * b, bb + b * b, ac + a * c, bc + b * c);
    }
    ((aa * bc - ab * ac) / (aa * bb - ab * ab)).abs().sqrt()
}

/// A bar that vibrates at one step.
struct Damping {
    integrator: Integrator,
    omega_dt: f64,
    measured: f64,
    derived: f64,
}

fn damping() -> anyhow::Result<Vec<Damping>> {
    let omega = PI * wave_speed() / LENGTH;
    let mut rows = Vec::new();
    for integrator in [
        semi_implicit(0.5),
        semi_implicit(0.75),
        semi_implicit(1.0),
        Integrator::Trapezoidal { solve: SOLVE },
    ] {
        for (omega_dt, steps) in [(0.2, 60), (1.0, 12), (4.0, 12)] {
            let derived = match integrator {
                Integrator::SemiImplicit { beta, .. } => 1.0 / (1.0 + beta * omega_dt * omega_dt).sqrt(),
                _ => 1.0,
            };
            let measured = kept(&vibration(integrator, omega_dt / omega, steps)?);
            rows.push(Damping { integrator, omega_dt, measured, derived });
        }
    }
    Ok(rows)
}

/// Change of the amplitude at 0.9 of a quarter period when the step is halved, by step.
struct Series {
    integrator: Integrator,
    points: Vec<(f64, f64)>,
}

fn series(integrator: Integrator, coarsest: usize) -> anyhow::Result<Series> {
    let end = 0.9 * 0.5 * LENGTH / wave_speed();
    let amplitude = |steps: usize| -> anyhow::Result<f64> {
        Ok(*vibration(integrator, end / steps as f64, steps)?.last().unwrap_or(&f64::NAN))
    };
    let counts: Vec<usize> = (0..5).map(|k| coarsest << k).collect();
    let amplitudes = counts.iter().map(|&steps| amplitude(steps)).collect::<anyhow::Result<Vec<f64>>>()?;
    let exact = VELOCITY * LENGTH / (PI * wave_speed());
    let change = |k: usize| (end / counts[k] as f64, (amplitudes[k] - amplitudes[k + 1]).abs() / exact);
    Ok(Series { integrator, points: (0..counts.len() - 1).map(change).collect() })
}

/// The largest stable step over the explicit one's.
struct Limit {
    integrator: Integrator,
    over_explicit: f64,
    derived: Option<f64>,
}

/// An elastic block of 6 by 6 cells that is shaken a little.
fn shaken(scene: &Scene<f64, 2>) -> anyhow::Result<State<f64, 2>> {
    let mut stream = Streams::new(5).stream(Purpose::Perturbation);
    let mut bodies = lattice::<2>(1.0, [6, 6], 2);
    for body in &mut bodies {
        body.velocity = rng::uniform_vector::<2>(&mut stream).add_scalar(-0.5) * 2e-5;
    }
    Ok(State::at_rest(scene, Vector::zeros(), &bodies)?)
}

fn is_bounded(integrator: Integrator, dt: f64, steps: usize) -> anyhow::Result<bool> {
    let scene = Scene { integrator, ..scene::<f64, 2>(1.0, KernelKind::Cubic, FLIP, elastic()) };
    bounded(&scene, &shaken(&scene)?, dt, steps)
}

fn largest_stable(integrator: Integrator, unit: f64, steps: usize) -> anyhow::Result<f64> {
    let (mut stable, mut unstable) = (0.5, 1.0);
    while is_bounded(integrator, unstable * unit, steps)? {
        (stable, unstable) = (unstable, 2.0 * unstable);
    }
    while unstable / stable > 1.002 {
        let middle = f64::sqrt(stable * unstable);
        if is_bounded(integrator, middle * unit, steps)? { stable = middle } else { unstable = middle }
    }
    Ok(stable * unit)
}

fn limits(steps: usize) -> anyhow::Result<Vec<Limit>> {
    let scene = scene::<f64, 2>(1.0, KernelKind::Cubic, FLIP, elastic());
    let unit = step_length(&scene, &shaken(&scene)?);
    let betas = [0.0, 0.25, 0.4];
    let found = betas
        .par_iter()
        .map(|&beta| largest_stable(semi_implicit(beta), unit, steps))
        .collect::<anyhow::Result<Vec<f64>>>()?;
    let mut limits: Vec<Limit> = betas
        .iter()
        .zip(&found)
        .map(|(&beta, &limit)| Limit {
            integrator: semi_implicit(beta),
            over_explicit: limit / found[0],
            derived: Some(1.0 / (1.0 - 2.0 * beta).sqrt()),
        })
        .collect();
    for integrator in [semi_implicit(0.5), semi_implicit(1.0), Integrator::Trapezoidal { solve: SOLVE }] {
        let stable = is_bounded(integrator, FAR * found[0], steps / 5)?;
        limits.push(Limit { integrator, over_explicit: if stable { FAR } else { 0.0 }, derived: None });
    }
    Ok(limits)
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let damping = damping()?;
    let series =
        [(semi_implicit(0.5), 16), (semi_implicit(1.0), 16), (Integrator::Trapezoidal { solve: SOLVE }, 2)]
            .into_par_iter()
            .map(|(integrator, coarsest)| series(integrator, coarsest))
            .collect::<anyhow::Result<Vec<Series>>>()?;
    let limits = limits(setting.effort.choose(STEPS / 2, STEPS))?;
    let lines =
        series.iter().map(|series| Line::new(name(&series.integrator), series.points.iter().copied()));
    let panel =
        Panel::new("change of the amplitude when the step is halved", Scale::Logarithmic, lines.collect());
    let note = "relative to the amplitude; a bar of 64 cells, 0.9 of a quarter period";
    Ok(Evidence {
        checks: checks(&damping, &series, &limits),
        figures: vec![EvidenceFigure {
            name: "implicit",
            caption: "A bar's amplitude after 0.9 of a quarter period: its change when the step is halved, by step.",
            drawing: chart("step [s]", Scale::Logarithmic, note, &[panel.with_orders(1.0)])?,
        }],
        tables: vec![damping_table(&damping), limit_table(&limits)],
    })
}

fn checks(damping: &[Damping], series: &[Series], limits: &[Limit]) -> Vec<Check> {
    let damped = damping.iter().map(|row| Check {
        quantity: format!(
            "share of the amplitude kept in a step, {}, omega dt = {}",
            name(&row.integrator),
            row.omega_dt
        ),
        measured: row.measured,
        theory: if row.derived < 1.0 { "1 / sqrt(1 + beta (omega dt)^2)".into() } else { "1".into() },
        allowed: [row.derived - 3e-3, row.derived + 3e-3],
        source: "the smoothing between particles and grid, (1 - w^2) (omega dt)^2 / 2 and less",
    });
    let orders = series.iter().map(|series| {
        let order = if matches!(series.integrator, Integrator::Trapezoidal { .. }) { 2.0 } else { 1.0 };
        Check {
            quantity: format!("order in time, {}", name(&series.integrator)),
            measured: observed_order(&series.points),
            theory: format!("{order}"),
            allowed: [order - 0.1, order + 0.1],
            source: "chosen: from steps that are not yet short",
        }
    });
    let limited = limits.iter().map(|limit| Check {
        quantity: format!("largest stable step over the explicit one, {}", name(&limit.integrator)),
        measured: limit.over_explicit,
        theory: limit.derived.map_or("no limit".into(), |_| "1 / sqrt(1 - 2 beta)".into()),
        allowed: limit.derived.map_or([FAR, f64::INFINITY], |derived| [0.99 * derived, 1.01 * derived]),
        source: "bisection to 0.2 % of each limit; where there is none, 100 times the explicit step",
    });
    damped.chain(orders).chain(limited).collect()
}

fn damping_table(rows: &[Damping]) -> Table {
    let row = |damping: &Damping| {
        let mut row = Row::default();
        row.put("integrator", "-", "integrator", name(&damping.integrator).as_str())
            .number("omega_dt", "-", "angular frequency times step", damping.omega_dt)
            .number("kept", "-", "share of the amplitude that a step keeps", damping.measured)
            .number("derived", "-", "the same, derived", damping.derived);
        row
    };
    Table { name: "implicit-damping", rows: rows.iter().map(row).collect() }
}

fn limit_table(limits: &[Limit]) -> Table {
    let row = |limit: &Limit| {
        let mut row = Row::default();
        row.put("integrator", "-", "integrator", name(&limit.integrator).as_str())
            .number("over_explicit", "-", "largest stable step over the explicit one", limit.over_explicit)
            .put("derived", "-", "the same, derived; empty: no limit", limit.derived);
        row
    };
    Table { name: "implicit-limits", rows: limits.iter().map(row).collect() }
}
