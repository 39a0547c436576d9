//! Planes of symmetry: half a body against a mirror is half of the whole body's motion.

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::diagnostics::linear_momentum;
use snowlab_solver::geometry::{Shape, Vector};
use snowlab_solver::{InitialParticle, KernelKind, Scene, Simulation, State, Transfer};

use crate::support::{
    KERNELS, Random, elastic_scene, fixed, flip, floor, half_space, lattice, scene, state, vector,
};

const H: f64 = 0.0625;

fn run<const D: usize>(scene: &Scene<f64, D>, particles: &[InitialParticle<D>], time: f64) -> State<f64, D> {
    let mut simulation = Simulation::new(scene.clone(), state(scene, particles)).expect("a valid scene");
    simulation.advance_to(time).expect("a stable run");
    simulation.state().clone()
}

/// A body on the side x > 0 that falls on a rough floor and a ball on the axis, and spreads.
fn half<const D: usize>(transfer: Transfer, kernel: KernelKind) -> (Scene<f64, D>, Vec<InitialParticle<D>>) {
    let mut scene = Scene { transfer, kernel, time_step: fixed(2e-4), ..scene::<f64, D>(H) };
    scene.gravity[1] = -9.81;
    scene.colliders = vec![
        floor(0.0, Contact::Separate, 0.4),
        Collider {
            shape: Shape::Ball { centre: Vector::zeros(), radius: 0.13 },
            contact: Contact::Sticky,
            friction: 0.0,
            velocity: Vector::zeros(),
        },
    ];
    let (mut first, mut cells) = ([0; D], [3; D]);
    (first[1], cells[1]) = (2, 4);
    let mut particles = lattice(H, first, cells, 2, [0.0; D]);
    let mut random = Random(61);
    for p in &mut particles {
        p.position += random.vector::<f64, D>(0.01);
        p.velocity = random.vector(0.5);
        p.velocity[1] -= 6.0;
        p.mass *= random.between(0.7, 1.3);
    }
    (scene, particles)
}

fn image<const D: usize>(p: &InitialParticle<D>, axis: usize) -> InitialParticle<D> {
    let mut image = p.clone();
    image.position[axis] *= -1.0;
    image.velocity[axis] *= -1.0;
    image
}

fn check_symmetry<const D: usize>(transfer: Transfer, kernel: KernelKind, axes: &[usize], above: bool) {
    let (scene, mut part) = half::<D>(transfer, kernel);
    let mut with_mirrors = scene.clone();
    for &axis in axes {
        let sign = if above { 1.0 } else { -1.0 };
        with_mirrors.colliders.push(half_space(axis, sign, 0.0, Contact::Mirror));
        if !above {
            part = part.iter().map(|p| image(p, axis)).collect();
        }
    }
    let mut whole = part.clone();
    for &axis in axes {
        let images: Vec<_> = whole.iter().map(|p| image(p, axis)).collect();
        whole.extend(images);
    }
    let time = 60.0 * 2e-4;
    let (one, all) = (run(&with_mirrors, &part, time), run(&scene, &whole, time));
    let (first, second) = (one.by_id(), all.by_id());
    for p in 0..part.len() {
        let (i, j) = (first[p], second[p]);
        let x = (one.motion.position[i] - all.motion.position[j]).norm();
        let v = (one.motion.velocity[i] - all.motion.velocity[j]).norm();
        let ratio = (one.motion.plastic_ratio[i] - all.motion.plastic_ratio[j]).abs();
        assert!(
            x < 1e-11 && v < 1e-8 && ratio < 1e-9,
            "{D}D {transfer:?} {kernel:?} {axes:?}: particle {p} is off by {x:e} m, {v:e} m/s, J_P {ratio:e}"
        );
    }
    assert!(one.motion.plastic_ratio.iter().filter(|j| **j != 1.0).count() > 20);
    // The floor and the ball carry a share of the whole body's load each, along the planes. (Along a normal the shares cancel.)
    let share = f64::from(1 << axes.len());
    for number in 0..2 {
        let (own, total) = (one.ledger.colliders[number].impulse[1], all.ledger.colliders[number].impulse[1]);
        assert!((own * share - total).abs() < 1e-8 * total.abs(), "impulse {own} of {total}");
    }
    assert!(one.ledger.colliders[0].impulse[1] < -0.1, "the floor was hit");
    assert!(one.ledger.colliders[1].impulse[1] < -0.1, "the ball was hit");
}

#[test]
fn half_a_body_at_a_mirror_moves_as_in_the_whole() {
    for kernel in KERNELS {
        for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
            check_symmetry::<2>(transfer, kernel, &[0], true);
            check_symmetry::<2>(transfer, kernel, &[0], false);
        }
    }
    check_symmetry::<3>(flip(0.95), KernelKind::Cubic, &[2], true);
    check_symmetry::<3>(Transfer::Apic, KernelKind::Quadratic, &[0], false);
}

#[test]
fn a_quarter_of_a_body_in_the_corner_of_two_mirrors_too() {
    check_symmetry::<3>(flip(0.95), KernelKind::Cubic, &[0, 2], true);
    check_symmetry::<3>(Transfer::Mls, KernelKind::Quadratic, &[2, 0], true);
}

/// A column that is squeezed and let go between mirrors has no width: one cell or five are the same column.
fn column(cells: i32, kernel: KernelKind, transfer: Transfer) -> Vec<(f64, f64)> {
    let mut scene = Scene { kernel, transfer, time_step: fixed(2e-4), ..elastic_scene::<f64, 2>(H) };
    scene.gravity[1] = -9.81;
    scene.colliders = vec![
        half_space(0, 1.0, 0.0, Contact::Mirror),
        half_space(0, -1.0, f64::from(cells) * H, Contact::Mirror),
        floor(0.0, Contact::Separate, 0.0),
    ];
    let particles = lattice(H, [0, 0], [cells, 6], 2, [0.0, -2.0]);
    let end = run(&scene, &particles, 100.0 * 2e-4);
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for p in end.by_id().into_iter().take(12) {
        rows.push((end.motion.position[p].y, end.motion.deformation[p][(1, 1)]));
    }
    for p in 0..end.len() {
        let id = end.constants.id[p] as usize;
        let (x, y) = (end.motion.position[p].x - particles[id].position.x, end.motion.position[p].y);
        assert!(x.abs() < 1e-13, "a particle moved sideways by {x}");
        assert!((y - rows[id % 12].0).abs() < 1e-13, "particles of one height part");
    }
    let sideways: f64 = end.ledger.colliders[..2].iter().map(|c| c.impulse.x).sum();
    assert!(sideways.abs() < 1e-10, "the walls' impulses balance: {sideways}");
    // nu > 0: the squeezed column presses on its walls.
    assert!(end.ledger.colliders[0].impulse.x < -0.01, "{:?}", end.ledger.colliders);
    rows
}

#[test]
fn the_distance_of_two_mirrors_does_not_matter() {
    for kernel in KERNELS {
        for transfer in [flip(1.0), Transfer::Apic, Transfer::Mls] {
            let wide = column(5, kernel, transfer);
            for cells in [1, 2, 3] {
                let narrow = column(cells, kernel, transfer);
                for (a, b) in wide.iter().zip(&narrow) {
                    let off = (a.0 - b.0).abs().max((a.1 - b.1).abs());
                    assert!(off < 1e-12, "{kernel:?} {transfer:?}: {cells} cells differ by {off:e}");
                }
            }
        }
    }
}

/// Momentum of the material plus that handed to obstacles, less gravity's, is constant: mirrors one, two and more cells apart, along
/// and across gravity, alone and together with friction.
#[test]
fn mirrors_book_the_impulse_they_give() {
    for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
        for kernel in KERNELS {
            for cells in [1, 2, 3, 4] {
                for contact in [Contact::Separate, Contact::Sticky, Contact::Mirror] {
                    let mut scene = Scene { kernel, transfer, time_step: fixed(1e-4), ..scene::<f64, 2>(H) };
                    scene.gravity = vector([3.0, -9.81]);
                    let friction = if contact == Contact::Separate { 0.5 } else { 0.0 };
                    scene.colliders = vec![
                        half_space(0, 1.0, 0.0, Contact::Mirror),
                        floor(0.0, contact, friction),
                        half_space(0, -1.0, f64::from(cells) * H, Contact::Mirror),
                    ];
                    let mut particles = lattice(H, [0, 0], [cells, 4], 2, [0.0, -4.0]);
                    let mut random = Random(62);
                    for p in &mut particles {
                        p.position += vector([0.0, 0.02]) + random.vector::<f64, 2>(0.01);
                        p.velocity += random.vector::<f64, 2>(1.0);
                    }
                    let start = state(&scene, &particles);
                    let mass: f64 = particles.iter().map(|p| p.mass).sum();
                    let before = linear_momentum(&start);
                    let end = run(&scene, &particles, 0.02);
                    let given = end.ledger.colliders.iter().fold(Vector::zeros(), |s, c| s + c.impulse);
                    let expected = before + vector([3.0, -9.81]) * (mass * end.time);
                    let off = (linear_momentum(&end) + given - expected).norm();
                    assert!(
                        off < 1e-11,
                        "{kernel:?} {transfer:?} {contact:?} {cells} cells: {off:e} kg m/s missing"
                    );
                    assert!(given.norm() > 0.1);
                }
            }
        }
    }
}

/// Gravity into the plane: the image falls the other way, so nothing sinks through. The weight is what the mirror carries.
#[test]
fn a_body_rests_on_a_mirror() {
    for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
        let mut scene = Scene { transfer, ..elastic_scene::<f64, 2>(H) };
        scene.gravity[1] = -9.81;
        scene.colliders = vec![floor(0.0, Contact::Mirror, 0.0)];
        let particles = lattice(H, [-2, 0], [4, 4], 2, [0.0, 0.0]);
        let mass: f64 = particles.iter().map(|p| p.mass).sum();
        let end = run(&scene, &particles, 0.2);
        let load = -end.ledger.colliders[0].impulse.y / (mass * 9.81 * 0.2);
        assert!((load - 1.0).abs() < 0.05, "{transfer:?}: the mirror carries {load} of the weight");
        for p in 0..end.len() {
            let id = end.constants.id[p] as usize;
            let sunk = particles[id].position.y - end.motion.position[p].y;
            // Twice the static sag rho g H^2 / 2M of 0.8 mm, for it was let go suddenly.
            assert!((-1e-4..1.8e-3).contains(&sunk), "{transfer:?}: a particle sank by {sunk} m");
        }
    }
}

/// On a mirror nothing is lost: a ball of material that meets its image is an elastic bounce.
#[test]
fn a_mirror_takes_no_energy() {
    // A sixteenth of the stable step: the ledger's sum closes to first order in dt.
    let mut scene = Scene { transfer: flip(1.0), time_step: fixed(1e-4), ..elastic_scene::<f64, 2>(H) };
    scene.colliders = vec![floor(0.0, Contact::Mirror, 0.0)];
    let particles = lattice(H, [-3, 0], [6, 6], 2, [0.0, 0.0]);
    let mut start = state(&scene, &particles);
    for f in &mut start.motion.deformation {
        f[(1, 1)] = 0.98;
    }
    let before = snowlab_solver::diagnostics::energies(&scene, &start);
    let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
    simulation.advance_to(0.05).expect("a stable run");
    let end = simulation.state();
    let after = snowlab_solver::diagnostics::energies(&scene, end);
    assert_eq!(end.ledger.colliders[0].loss, 0.0);
    let losses = end.ledger.particles_to_grid_loss + end.ledger.grid_to_particles_loss;
    let off = (after.kinetic + after.elastic + losses) / before.elastic - 1.0;
    assert!(off.abs() < 0.03, "energy is off by {off}");
    assert_eq!(end.first_contact, None, "a plane of symmetry is no obstacle to meet");
}
