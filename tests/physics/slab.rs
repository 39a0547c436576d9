//! Plane strain: a 3D slab between two mirrors, uniform across, is the 2D run.

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::{Matrix, Shape, Vector};
use snowlab_solver::{InitialParticle, KernelKind, Scene, Simulation, State, Transfer};

use crate::support::{KERNELS, Random, fixed, flip, floor, half_space, scene, state};

const H: f64 = 0.0625;

fn flat(transfer: Transfer, kernel: KernelKind) -> (Scene<f64, 2>, Vec<InitialParticle<2>>) {
    let mut scene = Scene { transfer, kernel, time_step: fixed(1e-4), ..scene::<f64, 2>(H) };
    scene.gravity[1] = -9.81;
    scene.colliders = vec![
        floor(0.0, Contact::Separate, 0.4),
        Collider {
            shape: Shape::HalfSpace {
                point: Vector::<f64, 2>::new(-0.05, 0.0),
                normal: Vector::<f64, 2>::new(0.8, 0.6),
            },
            contact: Contact::Slip,
            friction: 0.2,
            velocity: Vector::<f64, 2>::new(0.5, 0.0),
        },
    ];
    let mut particles = crate::support::lattice(H, [-1, 1], [5, 4], 2, [-2.0, -8.0]);
    let mut random = Random(91);
    particles.iter_mut().for_each(|p| p.position += random.vector::<f64, 2>(0.01));
    (scene, particles)
}

/// The same with `cells` cells of depth, two particles in each.
fn deep(
    flat: &Scene<f64, 2>,
    particles: &[InitialParticle<2>],
    cells: i32,
) -> (Scene<f64, 3>, Vec<InitialParticle<3>>) {
    let lift = |v: Vector<f64, 2>| Vector::<f64, 3>::new(v.x, v.y, 0.0);
    let mut scene = Scene::<f64, 3> {
        transfer: flat.transfer,
        kernel: flat.kernel,
        time_step: flat.time_step,
        energy_budget: flat.energy_budget,
        gravity: lift(flat.gravity),
        ..scene::<f64, 3>(H)
    };
    for collider in &flat.colliders {
        let Shape::HalfSpace { point, normal } = collider.shape else { unreachable!("only planes") };
        scene.colliders.push(Collider {
            shape: Shape::HalfSpace { point: lift(point), normal: lift(normal) },
            contact: collider.contact,
            friction: collider.friction,
            velocity: lift(collider.velocity),
        });
    }
    scene.colliders.push(half_space(2, 1.0, 0.0, Contact::Mirror));
    scene.colliders.push(half_space(2, -1.0, f64::from(cells) * H, Contact::Mirror));
    let layers = (0..2 * cells).flat_map(|layer| {
        particles.iter().map(move |p| {
            let mut position = lift(p.position);
            position.z = (f64::from(layer) + 0.5) * 0.5 * H;
            InitialParticle {
                position,
                velocity: lift(p.velocity),
                mass: p.mass * 0.5 * H,
                volume: p.volume * 0.5 * H,
                stiffness_scale: p.stiffness_scale,
                material: p.material,
                deformation: Matrix::identity(),
                plastic_ratio: p.plastic_ratio,
            }
        })
    });
    let particles = layers.collect();
    (scene, particles)
}

fn run<const D: usize>(scene: &Scene<f64, D>, particles: &[InitialParticle<D>]) -> State<f64, D> {
    let mut simulation = Simulation::new(scene.clone(), state(scene, particles)).expect("a valid scene");
    simulation.advance_to(0.02).expect("a stable run");
    simulation.state().clone()
}

#[test]
fn a_slab_between_mirrors_is_plane_strain() {
    for kernel in KERNELS {
        for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
            let (scene, particles) = flat(transfer, kernel);
            let plane = run(&scene, &particles);
            let order = plane.by_id();
            assert!(
                plane.motion.plastic_ratio.iter().filter(|j| **j != 1.0).count() > 30,
                "an impact that yields"
            );
            for cells in [1, 2, 3] {
                let (scene, thick) = deep(&scene, &particles, cells);
                let slab = run(&scene, &thick);
                for q in 0..slab.len() {
                    let id = slab.constants.id[q] as usize;
                    let p = order[id % particles.len()];
                    let x = (slab.motion.position[q].xy() - plane.motion.position[p]).norm();
                    let z = (slab.motion.position[q].z - thick[id].position.z).abs();
                    let v = (slab.motion.velocity[q].xy() - plane.motion.velocity[p]).norm();
                    let f = slab.motion.deformation[q].fixed_view::<2, 2>(0, 0) - plane.motion.deformation[p];
                    let ratio = (slab.motion.plastic_ratio[q] - plane.motion.plastic_ratio[p]).abs();
                    assert!(
                        x < 1e-12 && z < 1e-12 && v < 1e-9 && f.norm() < 1e-9 && ratio < 1e-9,
                        "{kernel:?} {transfer:?} {cells} cells: x {x:e} z {z:e} v {v:e} F {:e} J_P {ratio:e}",
                        f.norm()
                    );
                    assert!((slab.motion.deformation[q][(2, 2)] - 1.0).abs() < 1e-12);
                }
                // Loads are per metre of depth in 2D.
                let depth = f64::from(cells) * H;
                for (a, b) in plane.ledger.colliders.iter().zip(&slab.ledger.colliders) {
                    assert!(a.impulse.norm() > 0.1, "both planes are met");
                    let off = (a.impulse * depth - b.impulse.xy()).norm();
                    assert!(
                        off < 1e-9 * a.impulse.norm(),
                        "impulse {} of {} is off by {off:e}",
                        b.impulse,
                        a.impulse
                    );
                }
            }
        }
    }
}
