//! Obstacles: distances, contact rules, what they carry, and what they let through.

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::diagnostics::{linear_momentum, total_mass};
use snowlab_solver::geometry::{Matrix, Shape, Vector, unit};
use snowlab_solver::{Advection, InitialParticle, Real, Scene, Simulation, State, Transfer};

use crate::support::{
    KERNELS, Random, elastic_scene, fixed, flip, floor, half_space, lattice, particle, scene, state,
    transfers, vector,
};

const H: f64 = 0.0625;

fn check_distances<const D: usize>() {
    let mut random = Random(71);
    for _ in 0..60 {
        let (centre, half_extent) =
            (random.vector::<f64, D>(1.0), random.vector::<f64, D>(1.0).map(|c| c.abs() + 0.1));
        let orientation = random.rotation::<f64, D>();
        let brick = Shape::Box { centre, half_extent, orientation };
        // Points of the surface: a point of the solid with one coordinate moved to a face.
        let mut surface: Vec<Vector<f64, D>> = Vec::new();
        let steps = if D == 2 { 400usize } else { 60 };
        for face in 0..2 * D {
            for index in 0..steps.pow(D as u32 - 1) {
                let mut rest = index;
                let mut x = Vector::<f64, D>::zeros();
                for k in (0..D).filter(|k| *k != face / 2) {
                    x[k] = half_extent[k] * (2.0 * (rest % steps) as f64 / (steps - 1) as f64 - 1.0);
                    rest /= steps;
                }
                x[face / 2] = half_extent[face / 2] * if face % 2 == 0 { 1.0 } else { -1.0 };
                surface.push(centre + orientation * x);
            }
        }
        // No point of the surface is further from the nearest sample than half the samples' diagonal.
        let slack = 1.1 * 1.5 / (steps - 1) as f64;
        for _ in 0..20 {
            let x = centre + random.vector::<f64, D>(2.0);
            let nearest = surface.iter().map(|s| (s - x).norm()).fold(f64::INFINITY, f64::min);
            let local = orientation.transpose() * (x - centre);
            let inside = (0..D).all(|k| local[k].abs() <= half_extent[k]);
            let got = brick.surface(&x);
            let (distance, size) = (got.distance, got.distance.abs());
            assert_eq!(distance <= 0.0, inside);
            assert!(
                size <= nearest + 1e-12 && size >= nearest - slack,
                "{size} against {nearest} by samples"
            );
        }
        let shapes = [
            brick,
            Shape::Ball { centre, radius: 0.7 },
            Shape::HalfSpace { point: centre, normal: orientation.column(0).into_owned() },
        ];
        for (shape, _) in shapes.iter().flat_map(|s| (0..20).map(move |i| (s, i))) {
            let x = centre + random.vector::<f64, D>(2.0);
            let got = shape.surface(&x);
            assert!((got.normal.norm() - 1.0).abs() < 1e-12);
            // n = grad phi, and a step of -phi n ends on the surface (eikonal), away from the medial axis.
            let ahead = shape.surface(&(x + got.normal * 1e-7)).distance;
            assert!(((ahead - got.distance) / 1e-7 - 1.0).abs() < 1e-6);
            assert!(shape.surface(&(x - got.normal * got.distance)).distance.abs() < 1e-12);
        }
        let ball = Shape::Ball { centre, radius: 0.7 };
        let x = random.vector::<f64, D>(2.0);
        assert!((ball.surface(&x).distance - ((x - centre).norm() - 0.7)).abs() < 1e-14);
        assert_eq!(ball.surface(&centre).distance, -0.7);
        assert!((ball.surface(&centre).normal.norm() - 1.0).abs() < 1e-15, "a normal at the centre too");
    }
}

#[test]
fn signed_distances_agree_with_samples_of_the_surface() {
    check_distances::<2>();
    check_distances::<3>();
}

/// Obstacles that all have the point `at` just inside with the outward normal (0.6, 0.8, 0).
fn obstacles<T: Real, const D: usize>() -> (Vec<Shape<T, D>>, Vector<T, D>, Vector<T, D>) {
    let mut normal = Vector::<f64, D>::zeros();
    (normal[0], normal[1]) = (0.6, 0.8);
    let mut orientation = Matrix::<f64, D>::identity();
    (orientation[(0, 0)], orientation[(1, 0)]) = (0.6, 0.8);
    (orientation[(0, 1)], orientation[(1, 1)]) = (-0.8, 0.6);
    let at = normal * 0.99;
    let to = |v: Vector<f64, D>| v.map(T::of);
    let shapes = vec![
        Shape::HalfSpace { point: to(normal), normal: to(normal) },
        Shape::Ball { centre: Vector::zeros(), radius: T::one() },
        Shape::Box {
            centre: Vector::zeros(),
            half_extent: Vector::repeat(T::one()),
            orientation: orientation.map(T::of),
        },
    ];
    (shapes, to(at), to(normal))
}

fn check_rules<T: Real, const D: usize>(tolerance: f64) {
    let (shapes, at, n) = obstacles::<T, D>();
    let mut t = Vector::<f64, D>::zeros();
    (t[0], t[1]) = (-0.8, 0.6);
    let t = t.map(T::of);
    let drift = Vector::<T, D>::from_fn(|k, _| T::of(0.3 - 0.4 * k as f64));
    let (three, two, half) = (T::of(3.0), T::of(2.0), T::of(0.5));
    for shape in shapes {
        for velocity in [Vector::zeros(), drift] {
            let respond = |contact, friction: f64, v: Vector<T, D>| {
                let collider = Collider { shape, contact, friction: T::of(friction), velocity };
                // At a later time the obstacle and the point have moved on together.
                let later = at + velocity * T::of(2.0);
                collider.respond(&later, &(v + velocity), 2.0).map(|v| v - velocity)
            };
            let near = |got: Option<Vector<T, D>>, expected: Vector<T, D>| {
                let got = got.expect("contact");
                assert!((got - expected).norm().as_f64() < tolerance, "{got} is not {expected}");
            };
            let pressed = t * three - n * two;
            let leaving = t * three + n * two;
            // |v_t| = 3, v_n = -2, mu = 0.5: Coulomb takes 1 of 3.
            near(respond(Contact::Separate, 0.5, pressed), t * two);
            near(respond(Contact::Slip, 0.5, pressed), t * two);
            // mu = 1.4 takes 2.8; mu = 1.5 takes all, and more cannot be taken.
            near(respond(Contact::Separate, 1.4, pressed), t * T::of(0.2));
            near(respond(Contact::Separate, 1.5, pressed), Vector::zeros());
            near(respond(Contact::Separate, 80.0, pressed), Vector::zeros());
            near(respond(Contact::Separate, 0.0, pressed), t * three);
            near(respond(Contact::Sticky, 0.5, pressed), Vector::zeros());
            // Leaving: free, held along the normal only, or held.
            assert_eq!(respond(Contact::Separate, 0.5, leaving), None);
            near(respond(Contact::Slip, 0.5, leaving), t * three);
            near(respond(Contact::Sticky, 0.5, leaving), Vector::zeros());
            // Straight into the surface: no division by |v_t| = 0.
            near(respond(Contact::Separate, 0.5, -n * half), Vector::zeros());
            // Outside: nothing, whatever the rule.
            for contact in [Contact::Separate, Contact::Slip, Contact::Sticky] {
                let collider = Collider { shape, contact, friction: half, velocity };
                assert_eq!(collider.respond(&(n * T::of(1.01)), &pressed, 0.0), None);
            }
        }
    }
}

#[test]
fn contact_rules_and_coulombs_number() {
    check_rules::<f64, 2>(1e-12);
    check_rules::<f64, 3>(1e-12);
    check_rules::<f32, 2>(1e-5);
    check_rules::<f32, 3>(1e-5);
}

fn run<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    particles: &[InitialParticle<D>],
    time: f64,
) -> State<T, D> {
    let mut simulation = Simulation::new(scene.clone(), state(scene, particles)).expect("a valid scene");
    simulation.advance_to(time).expect("a stable run");
    simulation.state().clone()
}

/// A block that slides slows down by mu g, and the floor's impulse has friction / pressure = mu.
#[test]
fn a_sliding_block_slows_by_coulombs_law() {
    for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
        let mut scene = Scene { transfer, ..elastic_scene::<f64, 2>(H) };
        scene.gravity[1] = -9.81;
        scene.colliders = vec![floor(0.0, Contact::Separate, 0.3)];
        let particles = lattice(H, [0, 0], [8, 3], 2, [3.0, 0.0]);
        let end = run(&scene, &particles, 0.5);
        let slowed = 3.0 - linear_momentum(&end).x / total_mass(&end);
        let expected = 0.3 * 9.81 * 0.5;
        assert!(
            (slowed / expected - 1.0).abs() < 0.03,
            "{transfer:?}: slowed by {slowed}, not {expected} m/s"
        );
        let impulse = end.ledger.colliders[0].impulse;
        assert!((impulse.x / -impulse.y - 0.3).abs() < 0.003, "{transfer:?}: {impulse}");
        // All that is lost to friction: mu m g times the way, about.
        let way = 3.0 * 0.5 - 0.5 * 0.3 * 9.81 * 0.25;
        let heat = 0.3 * 9.81 * total_mass(&end) * way;
        let loss = end.ledger.colliders[0].loss;
        assert!((loss / heat - 1.0).abs() < 0.1, "{transfer:?}: {loss} J lost, {heat} J by Coulomb");
    }
}

/// A platform that rises, a wall that pushes and a ball that does, each at 0.5 m/s: what they touch ends as fast.
#[test]
fn moving_obstacles_carry_the_material_along() {
    for transfer in [flip(0.9), Transfer::Apic] {
        for (axis, shape) in [
            (1, Shape::HalfSpace { point: Vector::zeros(), normal: unit(1) }),
            (0, Shape::HalfSpace { point: vector([-2.0 * H, 0.0]), normal: unit(0) }),
            (
                0,
                Shape::Box {
                    centre: vector([-6.0 * H, 0.0]),
                    half_extent: vector([4.0 * H, 10.0 * H]),
                    orientation: Matrix::identity(),
                },
            ),
            (0, Shape::Ball { centre: vector([-8.0 * H, 2.0 * H]), radius: 6.0 * H }),
        ] {
            let mut scene = Scene { transfer, ..elastic_scene::<f64, 2>(H) };
            let velocity = unit::<f64, 2>(axis) * 0.5;
            scene.colliders = vec![Collider { shape, contact: Contact::Slip, friction: 0.0, velocity }];
            let particles = lattice(H, [-2, 0], [4, 4], 2, [0.0, 0.0]);
            let end = run(&scene, &particles, 0.4);
            let speed = linear_momentum(&end)[axis] / total_mass(&end);
            // A first push leaves the block between the obstacle's speed and, were it an elastic bounce, twice that.
            assert!((0.4..1.0).contains(&speed), "{shape:?} {transfer:?}: the block moves at {speed} m/s");
            let entry = &end.ledger.colliders[0];
            assert!((entry.work - 0.5 * -entry.impulse[axis]).abs() < 1e-12, "work is force times way");
            assert!(entry.work > 0.0);
            for p in 0..end.len() {
                let inside = shape.surface(&(end.motion.position[p] - velocity * end.time)).distance;
                assert!(inside > -1e-9 - 0.01 * H, "a particle is {inside} m inside {shape:?}");
            }
        }
    }
    // Held by a sticky platform under gravity, a block goes up with it and stays whole.
    let mut lift = Scene { transfer: flip(0.9), ..elastic_scene::<f64, 2>(H) };
    lift.gravity[1] = -9.81;
    lift.colliders = vec![Collider { velocity: vector([0.2, 0.5]), ..floor(0.0, Contact::Sticky, 0.0) }];
    let particles = lattice(H, [-2, 0], [4, 4], 2, [0.0, 0.0]);
    let end = run(&lift, &particles, 1.0);
    for p in 0..end.len() {
        let moved = end.motion.position[p] - particles[end.constants.id[p] as usize].position;
        assert!((moved - vector([0.2, 0.5])).norm() < 0.02, "moved by {moved}");
    }
    let weight = -end.ledger.colliders[0].impulse.y / (total_mass(&end) * 9.81);
    assert!((weight - 1.0).abs() < 0.08, "the platform carries {weight} of the weight");
}

/// p(t) + impulse on obstacles = p(0) + m g t, exactly, whatever touches whatever.
fn check_balance<T: Real, const D: usize>(tolerance: f64) {
    let mut random = Random(72);
    let cells = if D == 2 { 5 } else { 3 };
    let mut velocity = [1.0; D];
    velocity[1] = -8.0;
    let mut first = [-1; D];
    first[1] = 1;
    let mut particles = lattice::<D>(H, first, [cells; D], 2, velocity);
    particles.iter_mut().for_each(|p| p.position += random.vector::<f64, D>(0.01));
    let mut wall = Vector::zeros();
    wall[0] = T::of(-3.0);
    let mut side = [0.0; D];
    side[0] = 6.0 * H;
    let mut low = [0.0; D];
    low[1] = 0.1 * H;
    let colliders = vec![
        floor(0.0, Contact::Separate, 0.4),
        Collider {
            shape: Shape::Ball { centre: vector(low).map(T::of), radius: T::of(1.3 * H) },
            contact: Contact::Slip,
            friction: T::of(0.2),
            velocity: Vector::zeros(),
        },
        Collider {
            shape: Shape::Box {
                centre: vector(side).map(T::of),
                half_extent: Vector::repeat(T::of(2.0 * H)),
                orientation: random.rotation(),
            },
            contact: Contact::Sticky,
            friction: T::zero(),
            velocity: wall,
        },
        half_space(0, 1.0, -H, Contact::Mirror),
    ];
    for kernel in KERNELS {
        for (transfer, advection) in transfers()
            .map(|t| (t, Advection::Interpolated))
            .into_iter()
            .chain([(flip(0.95), Advection::Blended), (Transfer::Apic, Advection::Blended)])
        {
            let mut scene = Scene { kernel, transfer, advection, ..scene::<T, D>(H) };
            scene.gravity = Vector::from_fn(|k, _| T::of([0.5, -9.81, 0.2][k]));
            scene.colliders = colliders.clone();
            scene.time_step = fixed(1e-4);
            let start = state(&scene, &particles);
            let end = run(&scene, &particles, 0.025);
            let fall = scene.gravity.map(|g| g.as_f64()) * (total_mass(&start) * end.time);
            let given = end.ledger.colliders.iter().fold(Vector::<f64, D>::zeros(), |s, c| s + c.impulse);
            let off = linear_momentum(&end) + given - linear_momentum(&start) - fall;
            let size = total_mass(&start) * 8.0;
            assert!(
                off.norm() < tolerance * size,
                "{kernel:?} {transfer:?} {advection:?}: {off} kg m/s missing"
            );
            for (number, entry) in end.ledger.colliders.iter().enumerate() {
                assert!(
                    entry.impulse.norm() > 1e-3 * size,
                    "{D}D {transfer:?}: obstacle {number} was not met"
                );
            }
        }
    }
}

#[test]
fn obstacles_book_the_impulse_they_give() {
    check_balance::<f64, 2>(1e-13);
    check_balance::<f64, 3>(1e-13);
    check_balance::<f32, 2>(3e-5);
}

/// The particle stage alone: the grid does not feel a ball that lies between its nodes, a particle does.
#[test]
fn particle_contacts_are_felt_and_booked_without_a_node_inside() {
    for contact in [Contact::Separate, Contact::Slip, Contact::Sticky] {
        let mut scene = Scene { time_step: fixed(1e-3), ..elastic_scene::<f64, 2>(1.0) };
        let ball = Shape::Ball { centre: vector([0.5, 0.5]), radius: 0.2 };
        scene.colliders = vec![Collider { shape: ball, contact, friction: 0.0, velocity: Vector::zeros() }];
        let one = particle([0.5, 0.8], [1.0, -4.0], 0.01);
        // 0.1 m at 4 m/s: contact after 25 ms.
        let before = run(&scene, std::slice::from_ref(&one), 0.020);
        assert_eq!((before.ledger.colliders[0].impulse, before.first_contact), (Vector::zeros(), None));
        let end = run(&scene, std::slice::from_ref(&one), 0.040);
        assert!(end.first_contact.is_some_and(|t| (0.020..0.030).contains(&t)), "{:?}", end.first_contact);
        let given = one.velocity * one.mass - end.motion.velocity[0] * one.mass;
        assert!((given - end.ledger.colliders[0].impulse).norm() < 1e-13, "{:?}", end.ledger);
        assert!(ball.surface(&end.motion.position[0]).distance > -1e-3);
        if contact == Contact::Sticky {
            assert!(end.motion.velocity[0].norm() < 1e-13);
        }
    }
}

/// Nothing that starts outside an obstacle with flat faces ends inside: a hard fall on floors and in corners, all transfers.
fn check_floors<T: Real>(tolerance: f64) {
    let tilted = Vector::<f64, 2>::new(0.6, 0.8);
    let plane = |normal: Vector<f64, 2>, contact, friction: f64| Collider {
        shape: Shape::HalfSpace { point: Vector::zeros(), normal: normal.map(T::of) },
        contact,
        friction: T::of(friction),
        velocity: Vector::zeros(),
    };
    let scenes = [
        vec![plane(vector([0.0, 1.0]), Contact::Separate, 0.0)],
        vec![plane(vector([0.0, 1.0]), Contact::Sticky, 0.0)],
        vec![plane(vector([0.0, 1.0]), Contact::Slip, 0.5)],
        vec![plane(vector([0.0, 1.0]), Contact::Mirror, 0.0)],
        vec![plane(tilted, Contact::Separate, 0.2)],
        vec![
            plane(vector([0.0, 1.0]), Contact::Separate, 0.3),
            plane(vector([1.0, 0.0]), Contact::Separate, 0.3),
        ],
    ];
    for colliders in scenes {
        for transfer in transfers() {
            for advection in [Advection::Interpolated, Advection::Blended] {
                let mut scene = Scene { transfer, advection, ..scene::<T, 2>(H) };
                scene.gravity[1] = T::of(-9.81);
                scene.colliders = colliders.clone();
                let particles = lattice(H, [0, 1], [4, 4], 2, [-6.0, -12.0]);
                let end = run(&scene, &particles, 0.05);
                for (p, collider) in (0..end.len()).flat_map(|p| scene.colliders.iter().map(move |c| (p, c)))
                {
                    let distance = collider.shape.surface(&end.motion.position[p]).distance.as_f64();
                    assert!(
                        distance >= -tolerance,
                        "{distance:e} m below {:?}, {transfer:?}",
                        collider.shape
                    );
                }
                assert!(
                    end.ledger.colliders.iter().all(|c| c.impulse.norm() > 0.1),
                    "an obstacle was not met"
                );
            }
        }
    }
}

#[test]
fn no_particle_ends_below_a_floor() {
    check_floors::<f64>(1e-14);
    check_floors::<f32>(2e-6);
}

#[test]
fn a_box_touches_up_to_its_corners() {
    let sides = [0.3, 0.1];
    let block = Collider {
        shape: Shape::Box {
            centre: vector([1.0, 2.0]),
            half_extent: vector(sides),
            orientation: Matrix::<f64, 2>::identity(),
        },
        contact: Contact::Sticky,
        friction: 0.0,
        velocity: vector([0.0, 0.0]),
    };
    let at = |share: f64| vector([1.0 + share * sides[0], 2.0 - share * sides[1]]);
    assert_eq!(block.respond(&at(0.99), &vector([1.0, 3.0]), 0.0), Some(vector([0.0, 0.0])));
    assert_eq!(block.respond(&at(1.01), &vector([1.0, 3.0]), 0.0), None);
}
