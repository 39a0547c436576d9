//! Bounds on J_P in a run.

use snowlab_solver::geometry::Matrix;
use snowlab_solver::{Material, Scene, Simulation, Snow, Transfer};

use crate::support::{particle, scene, snow, state};

/// Two particles without a neighbour, one torn on and on: events are counted by step, particles once, through sorting and from a
/// state that is taken up again.
#[test]
fn particles_that_met_a_bound_are_remembered() {
    let unbounded = Scene { transfer: Transfer::Apic, ..scene::<f64, 2>(0.1) };
    let mut scene = unbounded.clone();
    let bounded = Snow { plastic_ratio_bounds: (0.0, 1.01), ..snow() };
    scene.materials = vec![Material::Snow(bounded)];
    let mut start =
        state(&scene, &[particle([5.0, 0.0], [0.0; 2], 1e-3), particle([0.0; 2], [0.0; 2], 1e-3)]);
    start.motion.affine[1] = Matrix::identity() * 20.0;
    let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
    simulation.advance_to(0.01).expect("a stable run");
    let torn = simulation.state().clone();
    assert!(torn.ledger.clamps > 1, "{} events", torn.ledger.clamps);
    assert_eq!(torn.clamped_particles(), 1);
    let p = torn.motion.clamped.iter().position(|&clamped| clamped).expect("one is");
    assert_eq!(torn.constants.id[p], 1);
    let mut again = Simulation::new(scene, torn).expect("a valid scene");
    again.advance_to(0.011).expect("a stable run");
    assert_eq!(again.state().clamped_particles(), 1);
    assert!(state(&unbounded, &[particle([0.0; 2], [0.0; 2], 1e-3)]).motion.clamped.is_empty());
}
