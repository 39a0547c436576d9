//! What an application of an implicit step's operator costs, with the algebra of its solve, beside an explicit step.

use std::time::Instant;

use snowlab_solver::timestep::step_length;
use snowlab_solver::{
    Integrator, KernelKind, LinearSolve, Real, Simulation, StepLength, TimeStepControl, Transfer,
};

use crate::ball::{Ball, PARTICLES_A_CELL};
use crate::contest::burst_of;

/// Bursts of which the median is taken (chosen: as many as of explicit steps).
const BURSTS: usize = 11;
/// Steps of a burst (chosen: a burst takes about a second at 100 thousand particles).
const STEPS: u64 = 2;
/// Steps over the explicit length (chosen: some 30 applications a step).
const MULTIPLE: f64 = 20.0;

/// Measures and prints the table.
pub fn run() {
    println!(
        "{:<30}{:>14}{:>14}{:>8}{:>14}",
        "case, one thread", "explicit", "application", "ratio", "applications"
    );
    println!("{:<30}{:>14}{:>14}{:>8}{:>14}", "", "ns/particle", "ns/particle", "", "a step");
    for transfer in [Transfer::Mls, Transfer::Apic] {
        case::<f32, 2>(30_000, transfer);
        case::<f64, 2>(30_000, transfer);
        case::<f32, 3>(100_000, transfer);
        case::<f64, 3>(100_000, transfer);
    }
}

fn case<T: Real, const D: usize>(particles: usize, transfer: Transfer) {
    let ball = Ball {
        kernel: KernelKind::Cubic,
        transfer,
        particles,
        gap: 1e3,
        squashed: false,
        energy_budget: false,
        per_cell: PARTICLES_A_CELL,
    };
    let explicit = burst_of::<T, D>(&ball, 1) / particles as f64;
    let mut applications: Vec<(f64, f64)> = (0..BURSTS).map(|_| application::<T, D>(&ball)).collect();
    applications.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (application, count) = applications[BURSTS / 2];
    let application = application / particles as f64;
    println!(
        "{:<30}{:>14.1}{:>14.1}{:>8.2}{:>14.0}",
        format!(
            "{D}D cubic {} {transfer:?} {}k",
            if size_of::<T>() == 4 { "f32" } else { "f64" },
            particles / 1000
        ),
        explicit * 1e9,
        application * 1e9,
        application / explicit,
        count
    );
}

/// Seconds an application takes, by two solves that differ in nothing but their tolerance, and the applications of the closer one a step.
fn application<T: Real, const D: usize>(ball: &Ball) -> (f64, f64) {
    let [(coarse, few), (fine, many)] = [1e-1, 1e-4].map(|tolerance| {
        let (mut scene, mut state) = ball.build::<T, D>();
        // Every particle with a small velocity of its own, from a sine of its number.
        for (p, v) in state.motion.velocity.iter_mut().enumerate() {
            v.iter_mut()
                .enumerate()
                .for_each(|(k, v)| *v = T::of(1e-2 * (p as f64 * 12.9898 + k as f64).sin()));
        }
        let dt = MULTIPLE * step_length(&scene, &state);
        let solve = LinearSolve { tolerance, max_iterations: 10_000, ..LinearSolve::default() };
        scene.integrator = Integrator::SemiImplicit { beta: 1.0, solve };
        scene.time_step =
            TimeStepControl { length: StepLength::Fixed(dt), watchdog_interval: 0, ..scene.time_step };
        let mut simulation = Simulation::new(scene, state).expect("a valid scene");
        let start = Instant::now();
        (0..STEPS).for_each(|_| simulation.advance_one(f64::INFINITY).expect("a stable run"));
        (start.elapsed().as_secs_f64(), simulation.state().ledger.iterations)
    });
    ((fine - coarse) / (many - few) as f64, many as f64 / STEPS as f64)
}
