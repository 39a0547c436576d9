//! The ledger: what is left of the energy and what took the rest.

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::diagnostics::energies;
use snowlab_solver::{FlipShare, Scene, Simulation, State, Transfer};

use crate::support::{Random, elastic_scene, fixed, flip, floor, lattice, scene, state, vector};

const H: f64 = 0.0125;

fn total(scene: &Scene<f64, 2>, state: &State<f64, 2>) -> f64 {
    let e = energies(scene, state);
    e.kinetic + e.elastic + e.potential
}

/// Energy at the end plus all that was booked as lost, less the obstacles' work, over the energy put in, less 1.
fn residual(scene: &Scene<f64, 2>, start: &State<f64, 2>, time: f64) -> (f64, State<f64, 2>) {
    let before = total(scene, start);
    let mut simulation = Simulation::new(scene.clone(), start.clone()).expect("a valid scene");
    simulation.advance_to(time).expect("a stable run");
    let end = simulation.state().clone();
    let contact: f64 = end.ledger.colliders.iter().map(|c| c.loss - c.work).sum();
    let transfer = end.ledger.particles_to_grid_loss + end.ledger.grid_to_particles_loss;
    let sum = total(scene, &end) + contact + transfer + end.ledger.plastic_loss;
    let size = energies(scene, start).kinetic + energies(scene, start).elastic;
    ((sum - before) / size, end)
}

/// A block of snow that hits a rough floor at 8 m/s and a moving wall; J_P noise by a jittered lattice.
fn impact(transfer: Transfer, dt: f64) -> (Scene<f64, 2>, State<f64, 2>) {
    let mut scene = Scene { transfer, time_step: fixed(dt), ..scene::<f64, 2>(H) };
    scene.gravity[1] = -9.81;
    let wall = snowlab_solver::geometry::Shape::HalfSpace {
        point: vector([6.0 * H, 0.0]),
        normal: vector([-1.0, 0.0]),
    };
    scene.colliders = vec![
        floor(0.0, Contact::Separate, 0.4),
        Collider { shape: wall, contact: Contact::Separate, friction: 0.1, velocity: vector([-2.0, 0.0]) },
    ];
    let mut body = lattice(H, [-4, 1], [8, 8], 2, [3.0, -8.0]);
    let mut random = Random(95);
    body.iter_mut().for_each(|p| p.position += random.vector::<f64, 2>(0.2 * H));
    let start = state(&scene, &body);
    (scene, start)
}

#[test]
fn the_ledger_closes_through_an_impact_and_the_better_the_smaller_the_step() {
    for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
        let at = |dt| {
            let (scene, start) = impact(transfer, dt);
            residual(&scene, &start, 0.012)
        };
        let ((coarse, end), (middle, _), (fine, _)) = (at(4e-5), at(2e-5), at(1e-5));
        assert!(fine.abs() < 0.03, "{transfer:?}: {fine} of the energy is missing");
        let falls = middle.abs() < 0.75 * coarse.abs() && fine.abs() < 0.75 * middle.abs();
        assert!(falls, "{transfer:?}: {coarse} {middle} {fine}");
        // Each of the ways to lose energy has its share in this scene, and the wall worked on the snow.
        let kinetic = energies(&impact(transfer, 1e-5).0, &impact(transfer, 1e-5).1).kinetic;
        assert!(end.ledger.plastic_loss > 0.05 * kinetic, "{:?}", end.ledger);
        assert!(end.ledger.colliders[0].loss > 0.01 * kinetic, "{:?}", end.ledger);
        assert!(end.ledger.colliders[1].work > 0.01 * kinetic, "{:?}", end.ledger);
    }
}

/// What is not booked is the integrator's own: a strain that the particles' velocities cannot follow decays by z = (dt omega)^2 a step, and
/// of its energy only the half that passed through the grid's motion is seen.
#[test]
fn an_elastic_bounce_keeps_its_books() {
    let rate = FlipShare::Rate { share: 0.95, reference_step: 1e-5 };
    for transfer in [Transfer::Flip(rate), Transfer::Apic, Transfer::Mls] {
        let at = |dt| {
            let mut scene = Scene { transfer, time_step: fixed(dt), ..elastic_scene::<f64, 2>(H) };
            scene.colliders = vec![floor(0.0, Contact::Separate, 0.0)];
            let start = state(&scene, &lattice(H, [-4, 1], [8, 8], 2, [0.0, -2.0]));
            residual(&scene, &start, 0.04)
        };
        let ((coarse, _), (fine, end)) = (at(1e-5), at(5e-6));
        assert!(fine.abs() < 0.02, "{transfer:?}: {fine} of the energy is missing");
        assert!(fine.abs() < 0.75 * coarse.abs(), "{transfer:?}: {coarse} {fine}");
        assert!(end.motion.velocity.iter().map(|v| v.y).sum::<f64>() > 0.0, "it bounced");
        assert_eq!((end.ledger.plastic_loss, end.ledger.colliders[0].work), (0.0, 0.0));
    }
}

/// Free flight books nothing.
#[test]
fn free_flight_loses_nothing() {
    for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
        let mut scene = Scene { transfer, time_step: fixed(1e-4), ..scene::<f64, 2>(H) };
        scene.gravity[1] = -9.81;
        let start = state(&scene, &lattice(H, [0, 0], [4, 4], 2, [1.0, 2.0]));
        let kinetic = energies(&scene, &start).kinetic;
        let (_, end) = residual(&scene, &start, 0.02);
        let ledger = &end.ledger;
        for loss in [ledger.particles_to_grid_loss, ledger.grid_to_particles_loss, ledger.plastic_loss] {
            assert!(loss.abs() < 1e-12 * kinetic * 200.0, "{transfer:?}: {ledger:?}");
        }
    }
}
