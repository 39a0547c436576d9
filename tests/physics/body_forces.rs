//! Forces of the particles' own, beside gravity.

use snowlab_solver::diagnostics::linear_momentum;
use snowlab_solver::geometry::Vector;
use snowlab_solver::{KernelKind, Real, Scene, SceneError, Simulation, State, Transfer};

use crate::support::{KERNELS, Random, elastic_scene, fixed, lattice, state, transfers, vector};

/// A block on which every particle has an acceleration of its own, followed by so many steps.
fn pushed<T: Real, const D: usize>(
    kernel: KernelKind,
    transfer: Transfer,
    acceleration: impl Fn(usize) -> Vector<f64, D>,
    gravity: Vector<f64, D>,
) -> State<T, D> {
    let scene = Scene {
        kernel,
        transfer,
        time_step: fixed(1e-4),
        energy_budget: true,
        gravity: gravity.map(T::of),
        ..elastic_scene::<T, D>(0.05)
    };
    let mut start = state(&scene, &lattice(0.05, [0; D], [3; D], 2, [0.0; D]));
    // In the reverse of the order that the sort brings, so that what it forgets shows.
    start.motion.position.reverse();
    start.body_acceleration = (0..start.len()).map(|id| acceleration(id).map(T::of)).collect();
    let mut simulation = Simulation::new(scene, start).expect("a valid scene");
    for _ in 0..40 {
        simulation.advance_one(f64::INFINITY).expect("a stable step");
    }
    simulation.state().clone()
}

fn check<T: Real, const D: usize>(tolerance: f64) {
    let mut random = Random(71);
    let drawn: Vec<Vector<f64, D>> = (0..6_usize.pow(D as u32)).map(|_| random.vector(20.0)).collect();
    for kernel in KERNELS {
        for transfer in transfers() {
            // The same for all, it is gravity.
            let g = vector([3.0; D]);
            let one = pushed::<T, D>(kernel, transfer, |_| g, Vector::zeros());
            let other = pushed::<T, D>(kernel, transfer, |_| Vector::zeros(), g);
            for (p, q) in one.by_id().into_iter().zip(other.by_id()) {
                let apart = (one.motion.position[p] - other.motion.position[q]).norm().as_f64();
                assert!(apart < tolerance * 0.05, "{kernel:?} {transfer:?}: {apart:e}");
            }
            // One by one, the momentum they give is sum m a t, whoever has been sorted where.
            let end = pushed::<T, D>(kernel, transfer, |id| drawn[id], Vector::zeros());
            let mut expected = Vector::<f64, D>::zeros();
            for p in 0..end.len() {
                let own = drawn[end.constants.id[p] as usize];
                let kept = end.body_acceleration[p].map(|a| a.as_f64());
                assert!((kept - own).norm() < 1e-5, "particle {p} has another's acceleration");
                expected += own * (end.constants.mass[p].as_f64() * end.time);
            }
            let off = (linear_momentum(&end) - expected).norm() / expected.norm();
            assert!(off < tolerance, "{kernel:?} {transfer:?}: momentum off by {off:e}");
        }
    }
}

#[test]
fn a_force_of_its_own_pushes_each_particle() {
    check::<f64, 2>(1e-11);
    check::<f64, 3>(1e-11);
    check::<f32, 2>(1e-3);
}

#[test]
fn accelerations_are_for_all_particles_or_none() {
    let scene = elastic_scene::<f64, 2>(0.05);
    let mut start = state(&scene, &lattice(0.05, [0; 2], [3; 2], 1, [0.0; 2]));
    start.body_acceleration = vec![Vector::zeros(); 2];
    let error = Simulation::new(scene, start).expect_err("two accelerations for nine particles");
    assert_eq!(error, SceneError::Length { field: "body_acceleration", found: 2, expected: 9 });
}
