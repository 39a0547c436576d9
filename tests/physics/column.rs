//! A column under its own weight between mirrors. Uniaxial fixed corotated elasticity is exactly P = M (F - 1), so
//! F(Y) = 1 - rho g (H - Y) / M, and the top goes down by rho g H^2 / 2M = 0.50451 mm for H = 0.2 m.

use snowlab_solver::collision::Contact;
use snowlab_solver::{KernelKind, Scene, Simulation, Transfer};

use crate::support::{
    DENSITY, KERNELS, M, assert_near, elastic_scene, flip, floor, half_space, lattice, state,
};

const HEIGHT: f64 = 0.2;
const GRAVITY: f64 = 9.81;
/// Twice the frequency pi c / 2 H of the column's slowest wave, c = 19.72 m/s [1/s]: at it the column comes to rest fastest.
const CRITICAL: f64 = 310.0;

/// Displacement of the material point at height `y` of the column at rest [m].
fn exact(y: f64) -> f64 {
    -DENSITY * GRAVITY / M * (HEIGHT * y - 0.5 * y * y)
}

/// The displacement of the top of a column of `cells` cells 0.1 s (2.5 periods) after it was left in the exact state, and the greatest
/// speed then. Velocities are damped at the rate `damping` [1/s]. The top is the uppermost row plus the exact rest.
fn top(cells: i32, kernel: KernelKind, transfer: Transfer, contact: Contact, damping: f64) -> (f64, f64) {
    let h = HEIGHT / f64::from(cells);
    let mut scene = Scene { kernel, transfer, ..elastic_scene::<f64, 2>(h) };
    scene.gravity[1] = -GRAVITY;
    scene.colliders = vec![
        half_space(0, 1.0, 0.0, Contact::Mirror),
        half_space(0, -1.0, 2.0 * h, Contact::Mirror),
        floor(0.0, contact, 0.0),
    ];
    let particles = lattice(h, [0, 0], [2, cells], 2, [0.0, 0.0]);
    let mut start = state(&scene, &particles);
    for p in 0..start.len() {
        let y = particles[p].position.y;
        start.motion.position[p].y += exact(y);
        start.motion.deformation[p][(1, 1)] = 1.0 - DENSITY * GRAVITY * (HEIGHT - y) / M;
    }
    let mut simulation = Simulation::new(scene, start).expect("a valid scene");
    while simulation.state().time < 0.1 {
        let before = simulation.state().time;
        simulation.advance_one(0.1).expect("a stable run");
        let kept = 1.0 - damping * (simulation.state().time - before);
        simulation.state_mut().motion.velocity.iter_mut().for_each(|v| *v *= kept);
    }
    let end = simulation.state();
    let (mut highest, mut fastest) = (0.0, 0.0f64);
    for p in 0..end.len() {
        let rest = particles[end.constants.id[p] as usize].position;
        assert!((end.motion.position[p].x - rest.x).abs() < 1e-12, "uniaxial");
        fastest = fastest.max(end.motion.velocity[p].norm());
        if rest.y > HEIGHT - 0.5 * h {
            highest = end.motion.position[p].y - rest.y - exact(rest.y) + exact(HEIGHT);
        }
    }
    (highest, fastest)
}

#[test]
fn the_closed_form_has_its_number() {
    assert_near(exact(HEIGHT), -5.0451e-4, 1e-4, "top displacement");
}

/// On a mirrored floor the exact state is the discrete one to second order: it stays.
#[test]
fn a_column_on_a_mirror_stays_in_its_exact_state() {
    for kernel in KERNELS {
        for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
            let (displacement, speed) = top(20, kernel, transfer, Contact::Mirror, 0.0);
            assert_near(displacement, exact(HEIGHT), 0.01, &format!("{kernel:?} {transfer:?}"));
            // Let go undeformed it would fall at up to g H / c = 0.1 m/s.
            assert!(speed < 2e-3, "{kernel:?} {transfer:?}: {speed} m/s");
        }
    }
}

/// Nodes held at zero on the floor and below take half of what a symmetric floor would mirror: first order, some
/// percent at 20 cells, and gone by
/// extrapolation.
#[test]
fn a_sticky_floor_is_first_order_and_extrapolates_to_the_closed_form() {
    for kernel in KERNELS {
        let transfer = flip(0.95);
        let error = |cells| {
            let (displacement, speed) = top(cells, kernel, transfer, Contact::Sticky, CRITICAL);
            assert!(speed < 1e-6, "{kernel:?}: not at rest, {speed} m/s");
            displacement / exact(HEIGHT) - 1.0
        };
        let (coarse, fine) = (error(20), error(40));
        assert!((0.01..0.06).contains(&coarse), "{kernel:?}: {coarse} at 20 cells");
        let order = (coarse / fine).log2();
        assert!((0.9..1.1).contains(&order), "{kernel:?}: order {order}, errors {coarse} and {fine}");
        let extrapolated = 2.0 * fine - coarse;
        assert!(extrapolated.abs() < 1e-3, "{kernel:?}: extrapolated error {extrapolated}");
    }
}
