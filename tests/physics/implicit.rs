//! Semi-implicit and trapezoidal steps: orders, damping, stability, contact, and what happens where a solve fails.

use snowlab_solver::collision::Contact;
use snowlab_solver::diagnostics::{energies, linear_momentum};
use snowlab_solver::error::RejectionReason;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{
    Elastic, Integrator, KernelKind, Lame, LinearSolve, Material, Method, Scene, Simulation, SimulationError,
    State, StepLength, TimeStepControl, Transfer,
};

use crate::support::{
    DENSITY, KERNELS, M, Random, assert_near, elastic_scene, fixed, flip, floor, half_space, lattice,
    particle, state, vector,
};

const TIGHT: LinearSolve =
    LinearSolve { method: Method::Minres, tolerance: 1e-11, max_iterations: 2000, definite: false };

fn semi_implicit(beta: f64) -> Integrator {
    Integrator::SemiImplicit { beta, solve: TIGHT }
}

/// Length of the bar [m].
const LENGTH: f64 = 1.0;
/// Cells along it. What particles and grid tell each other is smoothed by w = sinc^4(k h / 2), so that a step's F and its velocities differ by
/// dt (1 - w^2) of the acceleration, an error of first order in dt that must be small beside the integrator's own.
const CELLS: i32 = 64;
/// Largest velocity at the start [m/s]: strains of 1e-5, so that the elastic law is linear.
const VELOCITY: f64 = 1e-4;

/// A bar that vibrates along its length between mirrors: amplitude of its first mode after each of `steps` steps [m].
fn vibration(kernel: KernelKind, integrator: Integrator, cells: i32, dt: f64, steps: usize) -> Vec<f64> {
    let h = LENGTH / f64::from(cells);
    let mut scene =
        Scene { kernel, integrator, transfer: flip(1.0), time_step: fixed(dt), ..elastic_scene::<f64, 2>(h) };
    scene.colliders = vec![
        half_space(0, 1.0, 0.0, Contact::Mirror),
        half_space(0, -1.0, LENGTH, Contact::Mirror),
        half_space(1, 1.0, 0.0, Contact::Mirror),
        half_space(1, -1.0, 4.0 * h, Contact::Mirror),
    ];
    let mut particles = lattice(h, [0, 0], [cells, 4], 2, [0.0, 0.0]);
    let shape = |x: f64| (std::f64::consts::PI * x / LENGTH).sin();
    particles.iter_mut().for_each(|particle| particle.velocity.x = VELOCITY * shape(particle.position.x));
    let norm: f64 = particles.iter().map(|particle| shape(particle.position.x).powi(2)).sum();
    let mut simulation = Simulation::new(scene.clone(), state(&scene, &particles)).expect("a valid scene");
    (0..steps)
        .map(|_| {
            simulation.advance_one(f64::INFINITY).expect("a stable run");
            let State { motion, constants, .. } = simulation.state();
            let moved = motion.position.iter().zip(&constants.id).map(|(x, &id)| {
                let rest = particles[id as usize].position.x;
                (x.x - rest) * shape(rest)
            });
            moved.sum::<f64>() / norm
        })
        .collect()
}

/// Angular frequency of the bar's first mode as the grid sees it [1/s], from a run of steps so short that their length does not show.
fn frequency(kernel: KernelKind) -> f64 {
    let dt = 2e-5;
    let [determinant, trace] = recurrence(&vibration(kernel, Integrator::Explicit, CELLS, dt, 1500));
    assert!((determinant - 1.0).abs() < 1e-6, "explicit steps do not damp: {determinant}");
    (determinant - 0.25 * trace * trace).sqrt() / dt
}

/// Determinant and trace of x_{n+1} = trace x_n - determinant x_{n-1}, by least squares.
fn recurrence(x: &[f64]) -> [f64; 2] {
    let (mut aa, mut ab, mut bb, mut ac, mut bc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for three in x.windows(3) {
        let [b, a, c] = [-three[0], three[1], three[2]];
        (aa, ab, bb, ac, bc) = (aa + a * a, ab + a * b, bb + b * b, ac + a * c, bc + b * c);
    }
    let whole = aa * bb - ab * ab;
    [(aa * bc - ab * ac) / whole, (ac * bb - bc * ab) / whole]
}

/// Determinant and trace of a step of an oscillator of angular frequency `omega` whose grid sees w times its velocity and gives back w times
/// its change.
fn propagator(integrator: Integrator, omega: f64, w: f64, dt: f64) -> [f64; 2] {
    let square = (omega * dt).powi(2);
    let step = |[velocity, position]: [f64; 2]| {
        let start = w * velocity;
        // (1 + c) (end - start) = - square position / dt - s start, and the share of `end` in what moves the position.
        let (c, s, share) = match integrator {
            Integrator::Explicit => (0.0, 0.0, 1.0),
            Integrator::SemiImplicit { beta, .. } => (beta * square, beta * square, 1.0),
            Integrator::Trapezoidal { .. } => (0.25 * square, 0.5 * square, 0.5),
        };
        let change = (-square * position / dt - s * start) / (1.0 + c);
        [velocity + w * change, position + dt * (start + share * change)]
    };
    let ([a, b], [c, d]) = (step([1.0, 0.0]), step([0.0, 1.0]));
    [a * d - b * c, a + d]
}

/// For w = 1 the determinant is 1 / (1 + beta (omega dt)^2).
#[test]
fn a_step_damps_by_what_its_beta_says() {
    for (kernel, power) in KERNELS.into_iter().zip([4, 3]) {
        let half = 0.5 * std::f64::consts::PI / f64::from(CELLS);
        let w = (half.sin() / half).powi(power);
        let omega = frequency(kernel) / w;
        // Six to eighty times the explicit limit, which is 0.65 h / c or so.
        for (dt, steps) in [(0.2 / omega, 60), (1.0 / omega, 12), (4.0 / omega, 12)] {
            for integrator in [0.5, 0.75, 1.0]
                .map(semi_implicit)
                .into_iter()
                .chain([Integrator::Trapezoidal { solve: TIGHT }])
            {
                let found = recurrence(&vibration(kernel, integrator, CELLS, dt, steps));
                let expected = propagator(integrator, omega, w, dt);
                for k in 0..2 {
                    let what = format!("{kernel:?} {integrator:?} omega dt {}", omega * dt);
                    assert!((found[k] - expected[k]).abs() < 3e-4, "{what}: {found:?} is not {expected:?}");
                }
                if let Integrator::SemiImplicit { beta, .. } = integrator {
                    let damped = 1.0 / (1.0 + beta * (omega * dt).powi(2)).sqrt();
                    assert!((expected[0].sqrt() - damped).abs() < 2e-3);
                } else {
                    assert!((expected[0] - 1.0).abs() < 2e-3);
                }
            }
        }
    }
}

/// The observed order of the bar's amplitude after 0.9 of a quarter period, by `steps`, twice and four times as many steps.
fn order(integrator: Integrator, cells: i32, steps: usize) -> f64 {
    let end = 0.9 * 0.25 * 2.0 * LENGTH / (M / DENSITY).sqrt();
    let [coarse, middle, fine] = [steps, 2 * steps, 4 * steps].map(|steps| {
        *vibration(KernelKind::Cubic, integrator, cells, end / steps as f64, steps).last().expect("a step")
    });
    ((coarse - middle) / (middle - fine)).log2()
}

#[test]
fn orders_in_time_are_as_derived() {
    // The explicit step is bound by its grid: only on a fine one is the smoothing small beside its own error.
    let observed = order(Integrator::Explicit, 256, 250);
    assert!((observed - 2.0).abs() < 0.15, "explicit: {observed}");
    for (integrator, steps, expected) in [
        (semi_implicit(0.5), 32, 1.0),
        (semi_implicit(1.0), 32, 1.0),
        (Integrator::Trapezoidal { solve: TIGHT }, 4, 2.0),
        (Integrator::Trapezoidal { solve: TIGHT }, 8, 2.0),
    ] {
        let observed = order(integrator, CELLS, steps);
        assert!((observed - expected).abs() < 0.1, "{integrator:?}: {observed}, not {expected}");
    }
}

/// A block of elastic material pressed to 0.8 on both axes, let go; its energy after so many steps of `multiple` times the default length, over
/// that at the beginning, or `None` where the run stops.
fn released(integrator: Integrator, multiple: f64, steps: usize) -> Option<f64> {
    let mut scene = Scene { integrator, transfer: Transfer::Apic, ..elastic_scene::<f64, 2>(0.05) };
    let mut start = state(&scene, &lattice(0.05, [0, 0], [6, 6], 2, [0.0, 0.0]));
    start.motion.deformation.iter_mut().for_each(|f| *f *= 0.8);
    start.motion.position.iter_mut().for_each(|x| *x *= 0.8);
    scene.time_step =
        fixed(multiple * step_length(&Scene { integrator: Integrator::Explicit, ..scene.clone() }, &start));
    let total = |state: &State<f64, 2>| {
        let e = energies(&scene, state);
        e.kinetic + e.elastic
    };
    let first = total(&start);
    let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
    for _ in 0..steps {
        simulation.advance_one(f64::INFINITY).ok()?;
    }
    Some(total(simulation.state()) / first)
}

#[test]
fn a_block_that_bursts_explicitly_stays_bounded() {
    let explicit = released(Integrator::Explicit, 6.0, 40);
    assert!(explicit.is_none_or(|energy| energy > 10.0), "the explicit run is stable: {explicit:?}");
    for beta in [0.5, 1.0] {
        let energy = released(semi_implicit(beta), 6.0, 40).expect("a stable run");
        assert!(energy < 1.0, "beta {beta}: {energy}");
    }
}

/// E = 1e8 Pa at 20 and 50 times the explicit step: a block falls on a floor, comes to rest there, and gains no energy on the way.
#[test]
fn stiff_material_takes_long_steps() {
    let lame = Lame::from_young(1e8, 0.2);
    for multiple in [20.0, 50.0] {
        let mut scene = Scene {
            integrator: Integrator::SemiImplicit {
                beta: 1.0,
                solve: LinearSolve { tolerance: 1e-6, ..TIGHT },
            },
            transfer: Transfer::Mls,
            materials: vec![Material::Elastic(Elastic { lame })],
            colliders: vec![floor(0.0, Contact::Separate, 0.3)],
            ..elastic_scene::<f64, 2>(0.05)
        };
        scene.gravity[1] = -9.81;
        let start = state(&scene, &lattice(0.05, [0, 1], [6, 6], 2, [0.0, -1.0]));
        let explicit = Scene { integrator: Integrator::Explicit, ..scene.clone() };
        scene.time_step = fixed(multiple * step_length(&explicit, &start));
        let total = |state: &State<f64, 2>| {
            let e = energies(&scene, state);
            e.kinetic + e.elastic + e.potential
        };
        let first = total(&start);
        let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
        while simulation.time() < 0.3 {
            simulation.advance_one(0.3).expect("a stable run");
            assert!(total(simulation.state()) <= first * (1.0 + 1e-9), "energy out of nothing at {multiple}");
        }
        let impulse = simulation.state().ledger.colliders[0].impulse[1];
        let mass: f64 = simulation.state().constants.mass.iter().sum();
        // It has come to rest: what the floor took is what it arrived with, and its weight.
        assert_near(impulse, -mass * (1.0 + 9.81 * 0.3), 0.05, "impulse on the floor");
    }
}

/// Particles of masses from 1e-12 to 1 kg in one body.
#[test]
fn masses_over_twelve_decades_converge() {
    let integrator = Integrator::SemiImplicit { beta: 1.0, solve: LinearSolve { tolerance: 1e-8, ..TIGHT } };
    let mut scene = Scene { integrator, time_step: fixed(1e-5), ..elastic_scene::<f64, 2>(0.05) };
    scene.gravity[1] = -9.81;
    let mut particles = lattice(0.05, [0, 0], [6, 6], 2, [0.0, 0.0]);
    let mut random = Random(3);
    for particle in &mut particles {
        particle.mass = 10_f64.powf(random.between(-12.0, 0.0));
        particle.stiffness_scale = particle.mass / 0.25;
        particle.velocity = random.vector(0.1);
    }
    let mut simulation = Simulation::new(scene.clone(), state(&scene, &particles)).expect("a valid scene");
    for _ in 0..5 {
        simulation.advance_one(f64::INFINITY).expect("a solve that converges");
    }
    assert!(simulation.state().ledger.largest_residual <= 1e-8);
}

fn falling(solve: LinearSolve) -> Scene<f64, 2> {
    let integrator = Integrator::SemiImplicit { beta: 0.5, solve };
    let mut scene = Scene {
        integrator,
        transfer: Transfer::Mls,
        colliders: vec![floor(0.0, Contact::Separate, 0.3)],
        ..elastic_scene::<f64, 2>(0.05)
    };
    scene.gravity[1] = -9.81;
    scene
}

#[test]
fn a_solve_that_fails_is_an_error_with_its_numbers_and_changes_nothing() {
    let mut scene = falling(LinearSolve { tolerance: 1e-12, max_iterations: 2, ..TIGHT });
    scene.time_step =
        TimeStepControl { length: StepLength::Fixed(4e-3), watchdog_interval: 0, ..scene.time_step };
    let mut start = state(&scene, &lattice(0.05, [0, 1], [6, 6], 2, [0.0, -3.0]));
    start.motion.deformation[5] *= 0.97;
    let mut simulation = Simulation::new(scene, start.clone()).expect("a valid scene");
    let error = simulation.advance_one(f64::INFINITY).expect_err("two iterations are too few");
    let SimulationError::StepRejected { particle: None, dt, halvings: 0, reason, .. } = &error else {
        panic!("{error}");
    };
    let RejectionReason::NotConverged { iterations, residual, tolerance } = reason else { panic!("{error}") };
    assert!((*dt, *iterations, *tolerance) == (4e-3, 2, 1e-12) && *residual > 1e-12, "{error}");
    let message = error.to_string();
    for part in ["at t = 0", "2 iterations", "1.000e-12", "4.000e-3 s", &format!("{residual:.3e}")] {
        assert!(message.contains(part), "{part} is not in: {message}");
    }
    let State { motion, time, steps, .. } = simulation.state();
    assert_eq!((*time, *steps), (0.0, 0));
    for (p, id) in simulation.state().constants.id.iter().enumerate() {
        let before = *id as usize;
        assert_eq!(motion.position[p], start.motion.position[before]);
        assert_eq!(motion.velocity[p], start.motion.velocity[before]);
        assert_eq!(motion.deformation[p], start.motion.deformation[before]);
    }
}

/// The step grows from the explicit length to what advection allows, and is halved where a solve takes too many iterations.
#[test]
fn the_step_grows_to_the_advective_limit_and_shrinks_where_a_solve_fails() {
    let run = |max_iterations: u32| {
        let mut scene = falling(LinearSolve { tolerance: 1e-4, max_iterations, ..TIGHT });
        scene.materials = vec![Material::Elastic(Elastic { lame: Lame::from_young(1e7, 0.2) })];
        let particles = lattice(0.05, [0, 4], [6, 6], 2, [0.0, -1.0]);
        let mut simulation =
            Simulation::new(scene.clone(), state(&scene, &particles)).expect("a valid scene");
        let mut lengths = Vec::new();
        while simulation.time() < 0.25 {
            let before = simulation.time();
            simulation.advance_one(0.25).expect("a stable run");
            lengths.push(simulation.time() - before);
        }
        let fastest =
            simulation.state().motion.velocity.iter().fold(0.0_f64, |fastest, v| fastest.max(v.norm()));
        (lengths, 0.25 * 0.05 / fastest, simulation.state().ledger.clone())
    };
    let (lengths, advective, ledger) = run(2000);
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    assert!(longest > 20.0 * lengths[0], "from {} to {longest} s", lengths[0]);
    assert!(
        longest <= 1e-2 * (1.0 + 1e-12) && longest > 0.5 * advective.min(1e-2),
        "{longest} beside {advective}"
    );
    assert!(lengths.windows(2).all(|pair| pair[1] <= pair[0] * 1.5 * (1.0 + 1e-12)));
    assert_eq!(ledger.rejected_steps, 0);
    assert!(ledger.iterations > lengths.len() as u64 && ledger.most_iterations > 2);
    assert!(ledger.largest_residual <= 1e-4 && ledger.largest_residual > 0.0);
    let (_, _, hindered) = run(u32::midpoint(ledger.most_iterations, 3).min(ledger.most_iterations - 1));
    assert!(hindered.rejected_steps > 0, "{hindered:?}");
    assert!(hindered.most_iterations < ledger.most_iterations);
}

/// Coulomb's law sees the whole normal impulse, the solver's reaction included: a block slides down at g (sin - mu cos), or stays.
#[test]
fn friction_acts_on_the_whole_normal_impulse() {
    let solve = LinearSolve { tolerance: 1e-8, ..TIGHT };
    let mut runs = Vec::new();
    for integrator in [Integrator::SemiImplicit { beta: 0.5, solve }, Integrator::Trapezoidal { solve }] {
        for transfer in [flip(0.95), Transfer::Mls] {
            runs.extend(
                [(0.2, true), (1.2, false)]
                    .map(|(friction, slides)| (friction, slides, integrator, transfer)),
            );
        }
    }
    for (friction, slides, integrator, transfer) in runs {
        let mut scene = Scene { integrator, transfer, ..falling(solve) };
        scene.colliders[0].friction = friction;
        // 45 degrees, the floor level.
        let component = 9.81 * 0.5_f64.sqrt();
        scene.gravity = vector([component, -component]);
        let particles = lattice(0.05, [0, 0], [8, 4], 2, [0.0, 0.0]);
        let start = state(&scene, &particles);
        let explicit = Scene { integrator: Integrator::Explicit, ..scene.clone() };
        scene.time_step = fixed(5.0 * step_length(&explicit, &start));
        let mut simulation = Simulation::new(scene, start).expect("a valid scene");
        simulation.advance_to(0.2).expect("a stable run");
        let momentum = linear_momentum::<f64, 2>(simulation.state());
        let mass: f64 = simulation.state().constants.mass.iter().sum();
        if slides {
            assert_near(momentum[0] / mass, component * (1.0 - friction) * 0.2, 0.02, "speed down the slope");
        } else {
            // While the floor's pressure builds up it slides a little; the explicit step at a fifth of this length has 0.19.
            assert!((momentum[0] / mass).abs() < 0.2 * component * 0.2, "{momentum}");
        }
        let ledger = &simulation.state().ledger;
        // Momentum: gravity gave what the body has and what the floor took, to round-off.
        for k in 0..2 {
            let given = mass * [component, -component][k] * 0.2;
            let error = (momentum[k] + ledger.colliders[0].impulse[k] - given).abs();
            assert!(error < 1e-10 * mass * component, "momentum is off by {error:e}");
        }
    }
}

/// Momentum is kept to round-off however coarsely the system is solved.
#[test]
fn momentum_does_not_know_the_tolerance() {
    for integrator in [
        Integrator::SemiImplicit { beta: 1.0, solve: LinearSolve { tolerance: 0.5, ..TIGHT } },
        Integrator::Trapezoidal { solve: LinearSolve { tolerance: 0.5, ..TIGHT } },
    ] {
        for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
            let scene =
                Scene { integrator, transfer, time_step: fixed(2e-3), ..elastic_scene::<f64, 2>(0.05) };
            let mut random = Random(9);
            let mut particles = lattice(0.05, [0, 0], [5, 5], 2, [3.0, 1.0]);
            particles.iter_mut().for_each(|particle| particle.velocity += random.vector(0.2));
            let start = state(&scene, &particles);
            let before = linear_momentum::<f64, 2>(&start);
            let mut simulation = Simulation::new(scene, start).expect("a valid scene");
            for _ in 0..20 {
                simulation.advance_one(f64::INFINITY).expect("a stable run");
            }
            assert!(simulation.state().ledger.largest_residual > 1e-2, "the solves are coarse");
            let after = linear_momentum::<f64, 2>(simulation.state());
            assert!((after - before).norm() < 1e-12 * before.norm(), "{before} {after}");
        }
    }
}

/// With beta = 0 a step is the explicit one, bit by bit.
#[test]
fn beta_0_is_the_explicit_step() {
    let run = |integrator| {
        let mut scene = Scene { integrator, ..falling(TIGHT) };
        scene.time_step = fixed(2e-4);
        let particles = lattice(0.05, [0, 0], [4, 4], 2, [0.5, -2.0]);
        let mut simulation =
            Simulation::new(scene.clone(), state(&scene, &particles)).expect("a valid scene");
        simulation.advance_to(0.02).expect("a stable run");
        simulation.state().motion.clone()
    };
    assert!(run(Integrator::Explicit) == run(semi_implicit(0.0)), "the runs differ");
}

#[test]
fn wrong_settings_are_refused() {
    let refused = |integrator| {
        let scene = Scene { integrator, ..elastic_scene::<f64, 2>(0.05) };
        let start = State::at_rest(&scene, vector([0.0, 0.0]), &[particle([0.1, 0.1], [0.0, 0.0], 1e-3)]);
        start.expect_err("a wrong setting").to_string()
    };
    assert!(refused(semi_implicit(1.5)).contains("beta is 1.5"));
    let solve = LinearSolve { tolerance: 0.0, ..TIGHT };
    assert!(refused(Integrator::Trapezoidal { solve }).contains("tolerance of the solve is 0"));
    let solve = LinearSolve { max_iterations: 0, ..TIGHT };
    assert!(refused(Integrator::SemiImplicit { beta: 1.0, solve }).contains("iterations of the solve is 0"));
}
