//! The method has no preferred place, direction, side or particle: what maps the grid onto itself maps runs onto runs.

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::{Matrix, Shape, Vector};
use snowlab_solver::{InitialParticle, KernelKind, Scene, Simulation, State, Transfer};

use crate::support::{Random, fixed, flip, half_space, largest, lattice, scene, state, vector};

/// x -> turn x + shift.
struct Isometry<const D: usize> {
    turn: Matrix<f64, D>,
    shift: Vector<f64, D>,
}

impl<const D: usize> Isometry<D> {
    fn scene(&self, scene: &Scene<f64, D>) -> Scene<f64, D> {
        let mut moved = scene.clone();
        moved.gravity = self.turn * scene.gravity;
        for collider in &mut moved.colliders {
            collider.velocity = self.turn * collider.velocity;
            collider.shape = match collider.shape {
                Shape::HalfSpace { point, normal } => {
                    Shape::HalfSpace { point: self.turn * point + self.shift, normal: self.turn * normal }
                }
                Shape::Ball { centre, radius } => {
                    Shape::Ball { centre: self.turn * centre + self.shift, radius }
                }
                Shape::Box { centre, half_extent, orientation } => Shape::Box {
                    centre: self.turn * centre + self.shift,
                    half_extent,
                    // A cube: its image has the same half extents and a proper rotation.
                    orientation: self.turn * orientation * self.turn.transpose(),
                },
            };
        }
        moved
    }

    fn particles(&self, particles: &[InitialParticle<D>]) -> Vec<InitialParticle<D>> {
        particles
            .iter()
            .map(|p| InitialParticle {
                position: self.turn * p.position + self.shift,
                velocity: self.turn * p.velocity,
                ..p.clone()
            })
            .collect()
    }
}

/// A jittered block of snow that hits a rough floor, a ball and a moving box.
fn impact<const D: usize>(
    transfer: Transfer,
    kernel: KernelKind,
) -> (Scene<f64, D>, Vec<InitialParticle<D>>) {
    let h = 0.0625;
    let mut scene = Scene { transfer, kernel, time_step: fixed(2e-4), ..scene::<f64, D>(h) };
    scene.gravity[1] = -9.81;
    let mut floor = half_space(1, 1.0, 0.0, Contact::Separate);
    floor.friction = 0.4;
    let mut ball = [0.0; D];
    (ball[0], ball[1]) = (if D == 2 { 0.55 } else { 0.4 }, 0.1);
    let mut centre = [0.1; D];
    (centre[0], centre[1]) = (-0.4, 0.25);
    let mut push = Vector::zeros();
    push[0] = 1.0;
    scene.colliders = vec![
        floor,
        Collider {
            shape: Shape::Ball { centre: vector(ball), radius: 0.2 },
            contact: Contact::Slip,
            friction: 0.1,
            velocity: Vector::zeros(),
        },
        Collider {
            shape: Shape::Box {
                centre: vector(centre),
                half_extent: Vector::repeat(0.3),
                orientation: Matrix::identity(),
            },
            contact: Contact::Sticky,
            friction: 0.0,
            velocity: push,
        },
    ];
    let mut velocity = [0.5; D];
    velocity[1] = -6.0;
    let cells = if D == 2 { 6 } else { 4 };
    let mut first = [-1; D];
    first[1] = 0;
    let mut particles = lattice(h, first, [cells; D], 2, velocity);
    let mut random = Random(41);
    for p in &mut particles {
        p.position += random.vector::<f64, D>(0.004);
        // No two particles are alike, so that none can take another's place.
        let unlike = random.vector::<f64, 3>(0.2);
        (p.mass, p.volume) = (p.mass * (1.0 + unlike[0]), p.volume * (1.0 + unlike[1]));
        p.stiffness_scale = 1.0 + unlike[2];
    }
    (scene, particles)
}

const STEPS: f64 = 60.0;

/// The state after the run, in the order of the initial particles.
fn run<const D: usize>(scene: &Scene<f64, D>, particles: &[InitialParticle<D>]) -> State<f64, D> {
    let mut simulation = Simulation::new(scene.clone(), state(scene, particles)).expect("a valid scene");
    simulation.advance_to(STEPS * 2e-4).expect("a stable run");
    simulation.state().clone()
}

/// Both runs, particle by particle; `order[p]` is where particle `p` of the first is in the second.
fn assert_alike<const D: usize>(
    a: &State<f64, D>,
    b: &State<f64, D>,
    isometry: &Isometry<D>,
    order: &[usize],
    what: &str,
) {
    let (first, second) = (a.by_id(), b.by_id());
    let q = &isometry.turn;
    for p in 0..a.len() {
        let (i, j) = (first[p], second[order[p]]);
        let x = (q * a.motion.position[i] + isometry.shift - b.motion.position[j]).norm();
        let v = (q * a.motion.velocity[i] - b.motion.velocity[j]).norm();
        // F_E maps material to space; the material turned along.
        let f = largest(&(q * a.motion.deformation[i] * q.transpose() - b.motion.deformation[j]));
        let ratio = (a.motion.plastic_ratio[i] - b.motion.plastic_ratio[j]).abs();
        assert!(
            x < 1e-11 && v < 1e-8 && f < 1e-9 && ratio < 1e-9,
            "{what}: particle {p} is off by {x:e} m, {v:e} m/s, F {f:e}, J_P {ratio:e}"
        );
        if let (Some(c), Some(d)) = (a.motion.affine.get(i), b.motion.affine.get(j)) {
            assert!(largest(&(q * c * q.transpose() - d)) < 1e-6, "{what}: C of particle {p}");
        }
    }
    for (c, d) in a.ledger.colliders.iter().zip(&b.ledger.colliders) {
        assert!((q * c.impulse - d.impulse).norm() < 1e-9 * (1.0 + c.impulse.norm()), "{what}: impulse");
        assert!((c.loss - d.loss).abs() < 1e-9 * (1.0 + c.loss.abs()), "{what}: loss");
    }
}

fn swap<const D: usize>(i: usize, j: usize) -> Matrix<f64, D> {
    let mut q = Matrix::identity();
    (q[(i, i)], q[(j, j)], q[(i, j)], q[(j, i)]) = (0.0, 0.0, -1.0, 1.0);
    q
}

fn reflect<const D: usize>(axis: usize) -> Matrix<f64, D> {
    let mut q = Matrix::identity();
    q[(axis, axis)] = -1.0;
    q
}

fn isometries<const D: usize>() -> Vec<(String, Isometry<D>)> {
    let none = Vector::zeros();
    let mut list: Vec<(String, Isometry<D>)> = Vec::new();
    for cells in [[1, 0, 0], [-7, 3, 2], [130, -65, 5]] {
        let shift = Vector::<f64, D>::from_fn(|k, _| f64::from(cells[k]) * 0.0625);
        list.push((format!("shift by {cells:?} cells"), Isometry { turn: Matrix::identity(), shift }));
    }
    for (i, j) in [(0, 1), (1, 2), (2, 0)].into_iter().filter(|&(i, j)| i < D && j < D) {
        list.push((format!("quarter turn of axes {i} and {j}"), Isometry { turn: swap(i, j), shift: none }));
    }
    for axis in 0..D {
        list.push((format!("mirror of axis {axis}"), Isometry { turn: reflect(axis), shift: none }));
    }
    list
}

fn check<const D: usize>(transfer: Transfer, kernel: KernelKind) {
    let (scene, particles) = impact::<D>(transfer, kernel);
    let plain = run(&scene, &particles);
    let yielded = plain.motion.plastic_ratio.iter().filter(|j| **j != 1.0).count();
    assert!(yielded > 20, "only {yielded} particles yielded");
    for entry in &plain.ledger.colliders {
        assert!(entry.impulse.norm() > 1e-3, "an obstacle was not met: {:?}", plain.ledger.colliders);
    }
    let same: Vec<usize> = (0..particles.len()).collect();
    for (what, isometry) in isometries::<D>() {
        let moved = run(&isometry.scene(&scene), &isometry.particles(&particles));
        assert_alike(&plain, &moved, &isometry, &same, &format!("{transfer:?} {kernel:?} {what}"));
    }
    // A permutation: particle p goes to place (p stride) mod n, stride prime to n.
    let (n, stride) = (particles.len(), 101);
    let order: Vec<usize> = (0..n).map(|p| p * stride % n).collect();
    let mut shuffled = particles.clone();
    for (p, &place) in order.iter().enumerate() {
        shuffled[place] = particles[p].clone();
    }
    let none = Isometry { turn: Matrix::identity(), shift: Vector::zeros() };
    assert_alike(&plain, &run(&scene, &shuffled), &none, &order, "permutation");
}

#[test]
fn runs_turn_shift_and_mirror_with_their_scene_in_2d() {
    check::<2>(flip(0.95), KernelKind::Cubic);
    check::<2>(flip(0.95), KernelKind::Quadratic);
    check::<2>(Transfer::Apic, KernelKind::Cubic);
    check::<2>(Transfer::Mls, KernelKind::Quadratic);
}

#[test]
fn runs_turn_shift_and_mirror_with_their_scene_in_3d() {
    check::<3>(flip(0.95), KernelKind::Cubic);
    check::<3>(Transfer::Mls, KernelKind::Quadratic);
}
