//! A few steps of the fast engine on one thread, for a program that counts instructions; `run` beside this file starts it so.
//!
//! ```text
//! instructions             lists the cases
//! instructions NAME        takes the case's steps, the counted ones in `counted`, and says how many particle-steps those are
//! ```

#[path = "../../crates/solver/benches/step/ball.rs"]
mod ball;

use ball::{Ball, PARTICLES_A_CELL, RADIUS, SPEED};
use snowlab_solver::{FlipShare, KernelKind, Real, Simulation, Transfer};

/// The fast engine sorts in every 16th step at least (chosen: one such round; its watchdog, which looks every 50 steps, is off).
const STEPS: usize = 16;

type Case = (&'static str, fn() -> usize);

const CASES: [Case; 4] = [
    ("2D_cubic_f32_FLIP_10k_falling", || count::<2>(FLIP, 10_000, false)),
    ("2D_cubic_f32_FLIP_10k_impact", || count::<2>(FLIP, 10_000, true)),
    ("3D_cubic_f32_MLS_20k_falling", || count::<3>(Transfer::Mls, 20_000, false)),
    ("3D_cubic_f32_MLS_20k_impact", || count::<3>(Transfer::Mls, 20_000, true)),
];
const FLIP: Transfer = Transfer::Flip(FlipShare::PerStep(0.95));

fn main() {
    let Some(name) = std::env::args().nth(1) else {
        CASES.iter().for_each(|(name, _)| println!("{name}"));
        return;
    };
    let case = CASES.iter().find(|(known, _)| *known == name);
    let (_, run) = case.unwrap_or_else(|| panic!("no case {name}; without an argument all are listed"));
    println!("{}", run());
}

/// Particle-steps counted. In an impact the strain has passed the yield surface, and most particles yield.
fn count<const D: usize>(transfer: Transfer, particles: usize, impact: bool) -> usize {
    let gap = if impact { 0.0 } else { 1e3 };
    let ball = Ball {
        kernel: KernelKind::Cubic,
        transfer,
        particles,
        gap,
        squashed: impact,
        energy_budget: false,
        per_cell: PARTICLES_A_CELL,
    };
    let (mut scene, state) = ball.build::<f32, D>();
    scene.time_step.watchdog_interval = 0;
    let mut simulation = Simulation::new(scene, state).expect("a valid scene");
    simulation.advance_to(if impact { 0.05 * RADIUS / SPEED } else { 0.0 }).expect("a stable run");
    // Loads the particles, which is not part of a step.
    simulation.advance_one(f64::INFINITY).expect("a stable run");
    counted(&mut simulation);
    STEPS * particles
}

#[inline(never)]
fn counted<T: Real, const D: usize>(simulation: &mut Simulation<T, D>) {
    for _ in 0..STEPS {
        simulation.advance_one(f64::INFINITY).expect("a stable run");
    }
}
