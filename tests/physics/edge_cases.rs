//! No particle, one particle, several in one place, and the ends of the ranges.

use snowlab_solver::collision::Contact;
use snowlab_solver::diagnostics::energies;
use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::{InitialParticle, Lame, Material, Real, Scene, Simulation, Snow, State};

use crate::support::{DENSITY, KERNELS, floor, lattice, particle, scene, snow, state, transfers};

fn run<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    particles: &[InitialParticle<D>],
    time: f64,
) -> State<T, D> {
    let mut simulation = Simulation::new(scene.clone(), state(scene, particles)).expect("a valid scene");
    simulation.advance_to(time).expect("a stable run");
    let state = simulation.state().clone();
    assert_eq!(state.time, time);
    for p in 0..state.len() {
        let numbers = state.motion.position[p].iter().chain(state.motion.velocity[p].iter());
        assert!(numbers.chain(state.motion.deformation[p].iter()).all(|c| c.is_finite()));
        assert!(state.motion.plastic_ratio[p] >= T::zero());
    }
    state
}

fn falling<T: Real, const D: usize>() -> Scene<T, D> {
    let mut scene = scene::<T, D>(0.1);
    scene.gravity[1] = T::of(-10.0);
    scene.colliders = vec![floor(0.0, Contact::Separate, 0.0)];
    scene
}

fn check_none_and_one<T: Real, const D: usize>(tolerance: f64) {
    for kernel in KERNELS {
        for transfer in transfers() {
            let scene = Scene { kernel, transfer, ..falling::<T, D>() };
            let empty = run(&scene, &[], 0.05);
            assert_eq!((empty.len(), energies(&scene, &empty).kinetic), (0, 0.0));
            // Falls 0.3 m in 0.245 s, meets a smooth floor, which pushes straight up, and comes to rest on it.
            let mut position = [0.03; D];
            position[1] = 0.3;
            let one = run(&scene, &[particle(position, [0.0; D], 1e-3)], 0.5);
            let height = one.motion.position[0][1].as_f64();
            assert!((-1e-6..0.2).contains(&height), "{kernel:?} {transfer:?}: at {height}");
            assert!(one.motion.velocity[0].norm().as_f64() < 0.2, "{}", one.motion.velocity[0]);
            assert!((one.motion.position[0][0].as_f64() - 0.03).abs() < tolerance);
        }
    }
}

#[test]
fn no_particle_and_one_particle() {
    check_none_and_one::<f64, 2>(1e-12);
    check_none_and_one::<f32, 2>(1e-5);
    check_none_and_one::<f64, 3>(1e-12);
    check_none_and_one::<f32, 3>(1e-5);
}

#[test]
fn particles_in_one_place_move_as_one() {
    for kernel in KERNELS {
        for transfer in transfers() {
            // On a node, on a cell's middle, and anywhere.
            for place in [0.0, 0.05, 0.0321] {
                let scene = Scene { kernel, transfer, colliders: vec![], ..falling::<f64, 2>() };
                let fast = particle([place; 2], [2.0, 1.0], 1e-3);
                let slow = particle([place; 2], [-2.0, 1.0], 1e-3);
                let state = run(&scene, &[fast.clone(), fast.clone(), slow.clone(), slow.clone()], 0.02);
                // They meet on the same nodes with opposite velocities: nothing moves sideways, all falls.
                for p in 0..4 {
                    assert!((state.motion.position[p].x - place).abs() < 1e-12);
                    assert_eq!(state.motion.position[p], state.motion.position[0]);
                    assert!((state.motion.velocity[p].y - (1.0 - 0.2)).abs() < 1e-12);
                }
            }
        }
    }
}

/// A particle that sits on a node, in f32, has neighbours whose weight is 1e-7 cubed: they count as empty or are harmless.
#[test]
fn nearly_empty_nodes_do_no_harm() {
    for kernel in KERNELS {
        for transfer in transfers() {
            for off in [0.0f64, 1e-7, -1e-7, 1e-6, 1e-4] {
                let mut scene = Scene { kernel, transfer, ..scene::<f32, 3>(0.1) };
                scene.gravity[1] = -10.0;
                let at = |cells: f64| (cells + off) * 0.1;
                let body = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.5], [1.0, 0.5, 0.0]]
                    .map(|c| c.map(at))
                    .map(|x| particle(x, [0.0; 3], 1e-3));
                let mut start = state(&scene, &body);
                // Squeezed, so that forces act on the nodes of small weight too.
                start.motion.deformation.iter_mut().for_each(|f| *f = Matrix::identity() * 0.98);
                let before = energies(&scene, &start).elastic;
                let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
                simulation.advance_to(5e-3).expect("a stable run");
                let kinetic = energies(&scene, simulation.state()).kinetic;
                let fall = 0.5 * 1.2 * 0.05f64.powi(2);
                assert!(kinetic <= 1.05 * (before + fall), "{kernel:?} {transfer:?} {off}: {kinetic} J");
                assert!(simulation.state().ledger.dropped_mass < 1e-18 * 1.2);
            }
        }
    }
}

/// A block of snow dropped onto a floor, over the ranges that the specification names.
fn check_range<T: Real>(young: f64, hardening: f64, speed: f64, spacing: f64, mass_scale: f64) {
    let mut scene = falling::<T, 2>();
    scene.spacing = T::of(spacing);
    scene.materials = vec![Material::Snow(Snow {
        lame: Lame::from_young(young, 0.2),
        hardening: T::of(hardening),
        ..snow()
    })];
    let mut particles = lattice(spacing, [-2, 1], [4, 3], 2, [0.2 * speed, -speed]);
    particles.iter_mut().for_each(|p| p.mass *= mass_scale);
    // Until the block has come the way of its own height.
    let what = format!("E {young} xi {hardening} v {speed} h {spacing} mass {mass_scale}");
    let mut simulation = Simulation::new(scene.clone(), state(&scene, &particles)).expect("a valid scene");
    let mut tries = 0;
    while simulation.state().time < 4.0 * spacing / speed && tries < 3000 {
        tries += 1;
        if simulation.advance_one(4.0 * spacing / speed).is_err() {
            break;
        }
    }
    let state = simulation.state();
    for p in 0..state.len() {
        assert!(state.motion.position[p].iter().all(|c| c.is_finite()), "{what}");
        let (x, j) = (state.motion.position[p].y.as_f64() / spacing, state.motion.plastic_ratio[p].as_f64());
        assert!((-1e-4..20.0).contains(&x), "{what}: a particle at {x} cells");
        assert!(j >= 0.0 && j.is_finite(), "{what}: J_P = {j}");
    }
    let total = energies(&scene, state);
    assert!((total.kinetic + total.elastic).is_finite(), "{what}");
}

#[test]
fn extreme_values_give_numbers_or_a_typed_error() {
    for young in [1.0, 1.4e5, 1e9] {
        check_range::<f64>(young, 10.0, 8.0, 0.02, 1.0);
        check_range::<f32>(young, 10.0, 8.0, 0.02, 1.0);
    }
    for hardening in [0.0, 30.0] {
        check_range::<f64>(1.4e5, hardening, 8.0, 0.02, 1.0);
        check_range::<f32>(1.4e5, hardening, 8.0, 0.02, 1.0);
    }
    for (speed, spacing) in [(100.0, 0.02), (8.0, 1e-3), (8.0, 1.0), (0.01, 0.02)] {
        check_range::<f64>(1.4e5, 10.0, speed, spacing, 1.0);
        check_range::<f32>(1.4e5, 10.0, speed, spacing, 1.0);
    }
    // 0.04 kg a particle scaled to 4e-14 kg and to 4e3 kg, with the density following.
    for mass_scale in [1e-12, 1e5] {
        check_range::<f64>(1.4e5, 10.0, 8.0, 0.02, mass_scale);
        check_range::<f32>(1.4e5, 10.0, 8.0, 0.02, mass_scale);
    }
}

/// Stiffness and mass differ by particle without one touching the other.
#[test]
fn particles_of_several_materials_and_scales_share_a_scene() {
    let mut scene = falling::<f64, 2>();
    scene.materials.push(Material::Elastic(crate::support::elastic()));
    let mut particles = lattice(0.1, [-2, 1], [4, 3], 2, [0.0, -3.0]);
    for (number, p) in particles.iter_mut().enumerate() {
        p.material = (number % 2) as u16;
        p.stiffness_scale = 0.5 + (number % 3) as f64;
        p.mass = DENSITY * p.volume;
    }
    let state = run(&scene, &particles, 0.1);
    for p in 0..state.len() {
        let id = state.constants.id[p] as usize;
        assert_eq!(state.constants.material[p], particles[id].material);
        assert_eq!(state.constants.stiffness_scale[p], particles[id].stiffness_scale);
        if particles[id].material == 1 {
            assert_eq!(state.motion.plastic_ratio[p], 1.0);
            assert_eq!(state.motion.stiffness[p], particles[id].stiffness_scale);
        } else {
            let hardening = (10.0 * (1.0 - state.motion.plastic_ratio[p])).exp();
            let expected = particles[id].stiffness_scale * hardening;
            assert!((state.motion.stiffness[p] / expected - 1.0).abs() < 1e-12);
        }
    }
    let velocity: Vector<f64, 2> = state.motion.velocity[0];
    assert!(velocity.norm() < 10.0);
}
