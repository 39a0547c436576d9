//! What a run keeps: mass, momentum, angular momentum; and motions that are reproduced exactly.

use snowlab_solver::diagnostics::{angular_momentum, energies, linear_momentum, total_mass};
use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::step::{Workspace, step};
use snowlab_solver::{Engine, InitialParticle, KernelKind, Real, Scene, State, Transfer};

use crate::support::{
    KERNELS, Random, assert_near, elastic_scene, flip, largest, lattice, particle, scene, state, transfers,
    vector,
};

fn run<T: Real, const D: usize>(scene: &Scene<T, D>, state: &mut State<T, D>, dt: f64, steps: usize) {
    let mut workspace = Workspace::new(scene, state).expect("a valid scene");
    for _ in 0..steps {
        step(scene, state, &mut workspace, dt).expect("a stable step");
    }
}

/// `count` particles at random in a cube of `size` about `centre`, masses spread over a factor of 4.
fn cloud<const D: usize>(
    random: &mut Random,
    count: usize,
    centre: [f64; D],
    size: f64,
    velocity: [f64; D],
) -> Vec<InitialParticle<D>> {
    (0..count)
        .map(|_| {
            let place = vector(centre) + random.vector::<f64, D>(0.5 * size);
            let mut p = particle::<D>([0.0; D], velocity, size.powi(D as i32) / count as f64);
            p.position = place;
            p.mass *= random.between(0.5, 2.0);
            p
        })
        .collect()
}

/// Two clouds of snow that run into each other; momentum against the sum of its terms' sizes.
fn check_momentum<T: Real, const D: usize>() {
    // One rounding a step.
    let tolerance = 150.0 * T::default_epsilon().as_f64();
    let mut random = Random(31);
    let mut apart = [0.0; D];
    apart[0] = 0.2;
    let mut velocity = [0.3; D];
    velocity[0] = -9.0;
    let mut particles = cloud(&mut random, 150, [0.0; D], 0.15, [0.0; D]);
    particles.extend(cloud(&mut random, 150, apart, 0.15, velocity));
    for kernel in KERNELS {
        for transfer in transfers() {
            let scene = Scene { kernel, transfer, ..scene::<T, D>(0.03125) };
            let mut state = state(&scene, &particles);
            let (mass, momentum) = (total_mass(&state), linear_momentum(&state));
            let size = mass * 9.0;
            run(&scene, &mut state, 1e-4, 150);
            assert_eq!(total_mass(&state), mass);
            let drift = (linear_momentum(&state) - momentum).norm() / size;
            assert!(drift < tolerance, "{D}D {kernel:?} {transfer:?}: momentum drifts by {drift:e}");
            let moved = state.motion.plastic_ratio.iter().filter(|j| **j != T::one()).count();
            assert!(moved > 50, "the clouds must have met: {moved} particles yielded");
        }
    }
}

#[test]
fn linear_momentum_is_kept_to_round_off_through_an_impact() {
    check_momentum::<f64, 2>();
    check_momentum::<f64, 3>();
    check_momentum::<f32, 2>();
    check_momentum::<f32, 3>();
}

#[test]
fn the_grid_holds_the_mass_and_momentum_of_the_particles() {
    let mut random = Random(32);
    let particles = cloud(&mut random, 300, [-0.3, 0.1, 5.0], 0.2, [1.0, -2.0, 3.0]);
    for kernel in KERNELS {
        for transfer in transfers() {
            // The fast engine's grid is tested beside it.
            let scene = Scene { kernel, transfer, engine: Engine::Reference, ..scene::<f64, 3>(0.05) };
            let mut state = state(&scene, &particles);
            for c in &mut state.motion.affine {
                *c = random.matrix(10.0);
            }
            let momentum = linear_momentum(&state);
            let mut workspace = Workspace::new(&scene, &state).expect("a valid scene");
            step(&scene, &mut state, &mut workspace, 1e-5).expect("a stable step");
            let nodes = &workspace.grid().sums;
            let mass: f64 = nodes.iter().map(|n| n.mass).sum();
            let sum = nodes.iter().fold(Vector::<f64, 3>::zeros(), |sum, n| sum + n.momentum);
            assert_near(mass, total_mass(&state), 1e-14, "mass");
            assert!((sum - momentum).norm() < 1e-14 * momentum.norm() * 50.0, "{sum} against {momentum}");
            let force = nodes.iter().fold(Vector::<f64, 3>::zeros(), |sum, n| sum + n.force);
            assert!(force.norm() < 1e-9, "internal forces balance: {force}");
        }
    }
}

/// A spinning disc (bar in 3D) with a compressed middle, so that it also vibrates.
fn spinning<const D: usize>(transfer: Transfer, kernel: KernelKind) -> (Scene<f64, D>, State<f64, D>) {
    let scene = Scene { transfer, kernel, ..elastic_scene::<f64, D>(0.05) };
    let mut particles = lattice::<D>(0.05, [-3; D], [6; D], 2, [0.0; D]);
    for p in &mut particles {
        (p.velocity[0], p.velocity[1]) = (-20.0 * p.position[1], 20.0 * p.position[0]);
        p.velocity[D - 1] += 0.5;
    }
    let mut state = state(&scene, &particles);
    for p in 0..state.len() {
        state.motion.deformation[p] *= 1.0 - 0.02 * (10.0 * state.motion.position[p][0]).cos();
    }
    (scene, state)
}

fn check_spin<const D: usize>() {
    for kernel in KERNELS {
        for transfer in [Transfer::Apic, Transfer::Mls] {
            let (scene, mut state) = spinning::<D>(transfer, kernel);
            let before = angular_momentum(&scene, &state);
            assert!(before[(0, 1)] > 0.01);
            run(&scene, &mut state, 2e-4, 400);
            let drift = largest(&(angular_momentum(&scene, &state) - before)) / before[(0, 1)];
            assert!(drift < 1e-12, "{D}D {kernel:?} {transfer:?}: angular momentum drifts by {drift:e}");
            // It turned by more than a radian, so that the test is not one of standing still.
            let turned = snowlab_solver::math::polar_rotation(&state.motion.deformation[0]);
            assert!(turned[(0, 0)] < 0.3, "turned by {turned}");
        }
    }
}

#[test]
fn affine_transfers_keep_angular_momentum_to_round_off() {
    check_spin::<2>();
    check_spin::<3>();
}

#[test]
fn pic_loses_angular_momentum_by_what_it_drops_and_flip_far_less() {
    let left = |transfer| {
        let (scene, mut state) = spinning::<2>(transfer, KernelKind::Cubic);
        let start = angular_momentum(&scene, &state)[(0, 1)];
        [5, 10, 20].map(|steps| {
            run(&scene, &mut state, 2e-4, steps);
            angular_momentum(&scene, &state)[(0, 1)] / start
        })
    };
    let (pic, flip) = (left(flip(0.0)), left(flip(1.0)));
    // A PIC step drops m B = m C h^2/3 of every particle, 2 h^2/3 in L for each unit of spin, of a mean r^2 of 6 h^2 in this square of 6 h;
    // so it goes while the body stays rigid.
    let rigid = 1.0 - 2.0 / 3.0 / 6.0;
    assert!(
        (pic[0] - f64::powi(rigid, 5)).abs() < 0.1,
        "PIC keeps {pic:?}, a rigid body {}",
        f64::powi(rigid, 5)
    );
    assert!(pic[1] < pic[0] && pic[2] < pic[1] && pic[2] < 0.1, "PIC keeps {pic:?}");
    assert!(flip[2] > 0.95, "FLIP keeps {flip:?}");
}

fn check_flight<T: Real, const D: usize>(tolerance: f64) {
    let mut random = Random(33);
    let velocity: [f64; D] = std::array::from_fn(|k| 3.0 - 2.0 * k as f64);
    let particles = cloud(&mut random, 60, [0.2; D], 0.3, velocity);
    for kernel in KERNELS {
        for transfer in transfers() {
            let mut scene = Scene { kernel, transfer, ..scene::<T, D>(0.1) };
            scene.gravity[1] = T::of(-9.81);
            let mut state = state(&scene, &particles);
            let (dt, steps) = (1e-3, 200);
            run(&scene, &mut state, dt, steps);
            // Symplectic Euler: v_n = v_0 + n dt g, x_n = x_0 + n dt v_0 + n (n + 1) / 2 dt^2 g.
            let n = steps as f64;
            let gravity = scene.gravity.map(|g| g.as_f64());
            let speed = vector(velocity) + gravity * (n * dt);
            let path = vector(velocity) * (n * dt) + gravity * (0.5 * n * (n + 1.0) * dt * dt);
            for p in 0..state.len() {
                let v = state.motion.velocity[p].map(|c| c.as_f64());
                let x = state.motion.position[p].map(|c| c.as_f64());
                assert!((v - speed).norm() < tolerance * 5.0, "{kernel:?} {transfer:?}: v = {v}");
                assert!((x - particles[p].position - path).norm() < tolerance * 2.0, "x = {x}");
                assert!(largest(&(state.motion.deformation[p] - Matrix::identity())) < tolerance * 10.0);
                assert_eq!(state.motion.plastic_ratio[p], T::one());
            }
        }
    }
}

#[test]
fn free_flight_is_exact_in_every_step() {
    check_flight::<f64, 2>(1e-12);
    check_flight::<f64, 3>(1e-12);
    check_flight::<f32, 2>(1e-4);
    check_flight::<f32, 3>(1e-4);
}

/// v = a + B x on stress-free particles, one step: no force acts, so every particle keeps the field.
fn check_gradient<const D: usize>() {
    let mut random = Random(34);
    let (a, b) = (random.vector::<f64, D>(2.0), random.matrix::<f64, D>(3.0));
    let dt = 1e-3;
    let placements = [
        (true, lattice::<D>(0.1, [-5; D], [10; D], 2, [0.0; D])),
        (false, cloud(&mut random, 200, [0.1; D], 0.5, [0.0; D])),
    ];
    for (regular, mut particles) in placements {
        for p in &mut particles {
            p.velocity = a + b * p.position;
        }
        for kernel in KERNELS {
            for transfer in transfers() {
                let affine = transfer.keeps_affine();
                if !regular && !affine {
                    continue;
                }
                let scene = Scene { kernel, transfer, ..elastic_scene::<f64, D>(0.1) };
                let mut state = state(&scene, &particles);
                state.motion.affine.iter_mut().for_each(|c| *c = b);
                run(&scene, &mut state, dt, 1);
                let mut tried = 0;
                for p in 0..state.len() {
                    // Without affine matrices a node has the field's value only where particles surround it evenly.
                    if !affine && particles[p].position.amax() > 0.19 {
                        continue;
                    }
                    tried += 1;
                    let expected = Matrix::<f64, D>::identity() + b * dt;
                    let off = largest(&(state.motion.deformation[p] - expected));
                    assert!(off < 1e-14, "{kernel:?} {transfer:?}: F is {off:e} off I + dt grad v");
                    let v = a + b * particles[p].position;
                    assert!((state.motion.velocity[p] - v).norm() < 1e-13, "velocity");
                    let x = particles[p].position + v * dt;
                    assert!((state.motion.position[p] - x).norm() < 1e-15, "position");
                    if affine {
                        assert!(largest(&(state.motion.affine[p] - b)) < 1e-12, "C");
                    }
                }
                assert!(tried > 30, "{tried} particles");
            }
        }
    }
}

#[test]
fn a_uniform_velocity_gradient_is_exact() {
    check_gradient::<2>();
    check_gradient::<3>();
}

/// With C kept, kinetic energy counts it: 1/2 m |v|^2 + 1/2 m h^2/3 |C|^2 is what the grid holds for an affine field (no particle
/// to grid loss), for both kernels' inertias.
#[test]
fn an_affine_field_passes_to_the_grid_without_loss_of_energy() {
    let mut random = Random(35);
    let (a, b) = (random.vector::<f64, 2>(2.0), random.matrix::<f64, 2>(3.0));
    let mut particles = cloud(&mut random, 100, [0.0; 2], 0.4, [0.0; 2]);
    for p in &mut particles {
        p.velocity = a + b * p.position;
    }
    for kernel in KERNELS {
        let scene = Scene { kernel, transfer: Transfer::Apic, ..elastic_scene::<f64, 2>(0.1) };
        let mut state = state(&scene, &particles);
        state.motion.affine.iter_mut().for_each(|c| *c = b);
        let kinetic = energies(&scene, &state).kinetic;
        run(&scene, &mut state, 1e-6, 1);
        assert!(state.ledger.particles_to_grid_loss.abs() < 1e-13 * kinetic, "{:?}", state.ledger);
        assert!(state.ledger.grid_to_particles_loss.abs() < 1e-9 * kinetic, "{:?}", state.ledger);
    }
}
