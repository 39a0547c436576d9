//! The naive step is right: it moves a body that falls, strikes the floor and yields as the reference engine does.

use snowlab_solver::timestep::step_length;
use snowlab_solver::{Engine, FlipShare, KernelKind, Simulation, StepLength, Transfer};

use crate::ball::{Ball, PARTICLES_A_CELL};
use crate::decomposition::{Decomposition, General, Own};
use crate::naive::Naive;

const STEPS: usize = 50;
/// The greatest distance allowed [cells].
const TOLERANCE: f64 = 1e-6;

/// Every transfer and kernel in 2D and 3D, with both decompositions.
pub fn check() {
    for transfer in [Transfer::Flip(FlipShare::PerStep(0.95)), Transfer::Apic, Transfer::Mls] {
        check_kernel::<2, 4>(KernelKind::Cubic, transfer);
        check_kernel::<2, 3>(KernelKind::Quadratic, transfer);
        check_kernel::<3, 4>(KernelKind::Cubic, transfer);
        check_kernel::<3, 3>(KernelKind::Quadratic, transfer);
    }
}

fn check_kernel<const D: usize, const N: usize>(kernel: KernelKind, transfer: Transfer) {
    check_case::<D, N, General>(kernel, transfer);
    check_case::<D, N, Own>(kernel, transfer);
}

fn check_case<const D: usize, const N: usize, S: Decomposition>(kernel: KernelKind, transfer: Transfer) {
    let mut ball = Ball {
        kernel,
        transfer,
        particles: 2000,
        gap: 0.0,
        squashed: false,
        energy_budget: false,
        per_cell: PARTICLES_A_CELL,
    };
    // chosen: particles reach nodes two cells away, so that the ball falls freely for a few steps, then strikes.
    ball.gap = 2.3 * ball.spacing(D);
    let (mut scene, state) = ball.build::<f64, D>();
    // chosen: the hardening of these steps leaves them stable.
    let dt = 0.6 * step_length(&scene, &state);
    scene.engine = Engine::Reference;
    scene.time_step.length = StepLength::Fixed(dt);
    let mut naive = Naive::<f64, D, N>::new(&scene, &state);
    let mut reference = Simulation::new(scene.clone(), state).expect("a valid scene");
    for _ in 0..STEPS {
        naive.step::<S>(dt);
        reference.advance_one(f64::INFINITY).expect("a stable run");
    }
    let state = reference.state();
    let order = state.by_id();
    let apart = naive
        .particles
        .iter()
        .map(|p| (p.position - state.motion.position[order[p.id as usize]]).norm() / scene.spacing);
    // A NaN is greater than all.
    let apart = apart.max_by(f64::total_cmp).expect("particles");
    let yielded = state.motion.plastic_ratio.iter().filter(|&&ratio| ratio != 1.0).count();
    let name = format!("{D}D {kernel:?} {transfer:?}");
    assert!(state.first_contact.is_some_and(|time| time > dt), "{name}: no impact");
    assert!(yielded > state.len() / 20, "{name}: only {yielded} particles have yielded");
    assert!(apart <= TOLERANCE, "{name}: {apart:.1e} cells from the reference engine");
    println!("{name}: naive and reference {apart:.1e} cells apart after {STEPS} steps");
}
