//! What concerns this engine alone: instruction sets and threads do not show in results, and its grid holds what particles gave it. All else is
//! tested for both engines alike.

use super::dispatch::Set;
use super::step::Fast;
use crate::collision::{Collider, Contact};
use crate::diagnostics::{linear_momentum, total_mass};
use crate::geometry::{Shape, Vector, unit};
use crate::material::{Elastic, Lame, Material, Snow};
use crate::real::Real;
use crate::scene::{
    Advection, Engine, FlipShare, Integrator, LinearSolve, Scene, StepLength, TimeStepControl, Transfer,
};
use crate::state::{InitialParticle, State};
use crate::step::accept;
use crate::timestep::{StepHistory, step_length_for};
use crate::{KernelKind, Matrix, Method};

const SPACING: f64 = 0.0125;
/// Of a run that nothing has happened to.
const FRESH: StepHistory = StepHistory { factor: 1.0, reach: 0.0 };
const TRANSFERS: [Transfer; 3] = [Transfer::Flip(FlipShare::PerStep(0.95)), Transfer::Apic, Transfer::Mls];
const KERNELS: [KernelKind; 2] = [KernelKind::Cubic, KernelKind::Quadratic];

fn scene<T: Real, const D: usize>(kernel: KernelKind, transfer: Transfer) -> Scene<T, D> {
    let lame = Lame::from_young(1.4e5, 0.2);
    Scene {
        spacing: T::of(SPACING),
        kernel,
        transfer,
        engine: Engine::Fast,
        integrator: Integrator::Explicit,
        advection: Advection::Interpolated,
        materials: vec![
            Material::Snow(Snow {
                lame,
                critical_compression: T::of(2.5e-2),
                critical_stretch: T::of(7.5e-3),
                hardening: T::of(10.0),
                plastic_ratio_bounds: (T::of(0.6), T::of(20.0)),
                hardening_limit: T::of(20.0),
            }),
            Material::Elastic(Elastic { lame }),
        ],
        colliders: vec![Collider {
            shape: Shape::HalfSpace { point: Vector::zeros(), normal: unit(1) },
            contact: Contact::Separate,
            friction: T::of(0.5),
            velocity: Vector::zeros(),
        }],
        gravity: unit::<T, D>(1) * T::of(-9.81),
        time_step: TimeStepControl {
            length: StepLength::Adaptive { wave: None, advection: 0.25, greatest: 1e-2 },
            ..TimeStepControl::default()
        },
        energy_budget: true,
    }
}

/// A block of snow with an elastic half, shaken, on its way into the floor at 8 m/s.
fn block<T: Real, const D: usize>(scene: &Scene<T, D>) -> State<T, D> {
    let mut seed = 1_u64;
    let mut number = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    };
    let edge: usize = if D == 2 { 40 } else { 14 };
    let volume = (0.5 * SPACING).powi(D as i32);
    let mut particles = Vec::new();
    for k in 0..edge.pow(D as u32) {
        let mut rest = k;
        let place = Vector::<f64, D>::from_fn(|axis, _| {
            let cell = rest % edge;
            rest /= edge;
            (cell as f64 + 0.4 * number() + if axis == 1 { 2.5 } else { -6.0 }) * 0.5 * SPACING
        });
        particles.push(InitialParticle {
            position: place,
            velocity: unit::<f64, D>(1) * -8.0 + unit::<f64, D>(0),
            mass: 400.0 * volume * (1.0 + 0.2 * number()),
            volume,
            stiffness_scale: 1.0 + 0.5 * number(),
            material: u16::from(place[0] > 0.0),
            deformation: Matrix::identity(),
            plastic_ratio: 1.0,
        });
    }
    State::at_rest(scene, Vector::zeros(), &particles).expect("a valid body")
}

/// The state after `steps` steps.
fn run<T: Real, const D: usize>(scene: &Scene<T, D>, set: Set, threads: usize, steps: usize) -> State<T, D> {
    let mut state = block(scene);
    let mut fast = Fast::new(scene, threads).expect("a valid scene").expect("a CPU with AVX2");
    fast.set_instructions(set);
    fast.load(scene, &state);
    for _ in 0..steps {
        let dt = step_length_for(scene, FRESH, fast.fastest());
        let ledger = fast.step(scene, state.time, dt, false).expect("a stable step");
        accept(scene, &mut state, &ledger, dt);
    }
    fast.write(scene, &mut state);
    state
}

fn sets() -> Vec<Set> {
    static TOLD: std::sync::Once = std::sync::Once::new();
    let sets = Set::all();
    TOLD.call_once(|| println!("instruction sets tested: {sets:?}"));
    sets
}

/// Whether this CPU has no instruction set to test, which it says.
fn is_absent() -> bool {
    if sets().is_empty() {
        println!("this CPU runs the reference engine alone");
    }
    sets().is_empty()
}

/// Bits of all that a state holds, by FNV-1a of its text.
fn digest<T: Real, const D: usize>(state: &State<T, D>) -> u64 {
    format!("{state:?}").bytes().fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
    })
}

/// As in use, and with every option the other way round.
fn implicit() -> [Integrator; 2] {
    let solve = LinearSolve { tolerance: 1e-4, ..LinearSolve::default() };
    let other = LinearSolve { method: Method::ConjugateResiduals, definite: true, ..solve };
    [Integrator::SemiImplicit { beta: 0.5, solve }, Integrator::Trapezoidal { solve: other }]
}

fn check_bits<T: Real, const D: usize>() {
    for kernel in KERNELS {
        for transfer in TRANSFERS {
            for (energy_budget, integrator) in [true, false]
                .map(|budget| (budget, Integrator::Explicit))
                .into_iter()
                .chain(implicit().map(|integrator| (false, integrator)))
            {
                let scene = Scene { energy_budget, integrator, ..scene::<T, D>(kernel, transfer) };
                // A step with a solve is as long as ten without.
                let (steps, most) = if integrator == Integrator::Explicit { (50, 3) } else { (30, 2) };
                let first = run(&scene, Set::Avx2, 1, steps);
                assert!(first.ledger.plastic_loss > 0.0 && first.first_contact.is_some(), "an impact");
                for set in sets() {
                    for threads in 1..=most {
                        let other = run(&scene, set, threads, steps);
                        let what = format!("{D}D {kernel:?} {transfer:?} {set:?}, {threads} threads");
                        assert_eq!(digest(&first), digest(&other), "{what}");
                    }
                }
            }
        }
    }
}

#[test]
fn sets_and_threads_do_not_show_in_a_bit_of_an_impact() {
    if is_absent() {
        return;
    }
    check_bits::<f32, 2>();
    check_bits::<f64, 2>();
    check_bits::<f32, 3>();
    check_bits::<f64, 3>();
}

fn check_grid<T: Real, const D: usize>() {
    let tolerance = 100.0 * T::default_epsilon().as_f64();
    for set in sets() {
        for kernel in KERNELS {
            for transfer in TRANSFERS {
                let scene = scene::<T, D>(kernel, transfer);
                let mut state = block(&scene);
                state.motion.deformation.iter_mut().for_each(|f| f[(0, 1)] += T::of(0.01));
                let mut fast = Fast::new(&scene, 2).expect("a valid scene").expect("a CPU with AVX2");
                fast.set_instructions(set);
                fast.load(&scene, &state);
                let kinetic = fast.kinetic_on_grid(&scene);
                let (mass, momentum, force) = fast.grid_totals();
                let what = format!("{D}D {kernel:?} {transfer:?} {set:?}");
                assert!((mass / total_mass(&state) - 1.0).abs() < tolerance, "{what}: mass");
                let given = linear_momentum(&state);
                assert!((momentum - given).norm() < tolerance * given.norm(), "{what}: momentum");
                // Every force has its counterpart; the largest are of the order of tau h^(D-1).
                let scale = 1e5 * 0.01 * (0.15_f64).powi(D as i32 - 1);
                assert!(force.norm() < tolerance * scale, "{what}: internal forces balance: {force}");
                let particles = 0.5 * given.norm_squared() / mass;
                assert!((kinetic / particles - 1.0).abs() < 1e-3, "{what}: {kinetic} J on the grid");
            }
        }
    }
}

fn check_sorting<const D: usize>() {
    for kernel in KERNELS {
        let scene = scene::<f32, D>(kernel, Transfer::Apic);
        let mut fast = Fast::new(&scene, 2).expect("a valid scene").expect("a CPU with AVX2");
        fast.load(&scene, &block(&scene));
        let start = fast.sorted_ids(&scene, true);
        for number in 0..60 {
            let [anywhere, nearby] = [true, false].map(|from| fast.sorted_ids(&scene, from));
            assert!(anywhere == nearby, "{D}D {kernel:?}, step {number}");
            let dt = step_length_for(&scene, FRESH, fast.fastest());
            fast.step(&scene, 0.0, dt, false).expect("a stable step");
        }
        assert!(fast.sorted_ids(&scene, false) != start, "{D}D {kernel:?}: particles have changed places");
    }
}

/// The counting sort over all nodes is the definition.
#[test]
fn particles_sort_alike_from_anywhere_and_from_the_blocks_they_are_in() {
    if is_absent() {
        return;
    }
    check_sorting::<2>();
    check_sorting::<3>();
}

#[test]
fn the_grid_holds_the_mass_and_momentum_of_the_particles() {
    check_grid::<f32, 2>();
    check_grid::<f64, 2>();
    check_grid::<f32, 3>();
    check_grid::<f64, 3>();
}

#[test]
fn two_bodies_a_kilometre_apart_cost_no_more_than_two_bodies() {
    if is_absent() {
        return;
    }
    let scene = scene::<f64, 3>(KernelKind::Cubic, Transfer::Apic);
    let one = block(&scene);
    let nodes = |state: &State<f64, 3>| {
        let mut fast = Fast::new(&scene, 1).expect("a valid scene").expect("a CPU with AVX2");
        fast.load(&scene, state);
        fast.kinetic_on_grid(&scene);
        fast.bytes()
    };
    let mut particles: Vec<_> = (0..one.len()).map(|p| one.motion.position[p]).collect();
    particles.extend(particles.clone().iter().map(|x| x + unit::<f64, 3>(0) * 1000.0));
    let body: Vec<_> = particles
        .iter()
        .map(|&position| InitialParticle {
            position,
            velocity: Vector::zeros(),
            mass: 1.0,
            volume: 1e-3,
            stiffness_scale: 1.0,
            material: 0,
            deformation: Matrix::identity(),
            plastic_ratio: 1.0,
        })
        .collect();
    let two = State::at_rest(&scene, Vector::zeros(), &body).expect("valid bodies");
    assert!(nodes(&two) < 3 * nodes(&one), "{} bytes for two, {} for one", nodes(&two), nodes(&one));
}

/// A refused step is undone by taking those since the last sort again: to the same bits, however many they are.
#[test]
fn a_refused_step_leaves_every_bit_between_sorts_too() {
    if is_absent() {
        return;
    }
    let scene = scene::<f32, 3>(KernelKind::Cubic, Transfer::Mls);
    let start = block(&scene);
    let mut fast = Fast::new(&scene, 2).expect("a valid scene").expect("a CPU with AVX2");
    fast.load(&scene, &start);
    for number in 0..25 {
        let mut before = start.clone();
        fast.write(&scene, &mut before);
        let fastest = fast.fastest();
        fast.step(&scene, 0.0, 1.0, false).expect_err("an absurd step");
        let mut after = start.clone();
        fast.write(&scene, &mut after);
        // A sort that was due may have come first: compare by id.
        let by_id = |state: &State<f32, 3>| {
            let order = state.by_id();
            order.iter().map(|&p| (state.motion.position[p], state.motion.deformation[p])).collect::<Vec<_>>()
        };
        assert!(by_id(&before) == by_id(&after), "step {number}");
        assert_eq!(fastest, fast.fastest());
        let dt = step_length_for(&scene, FRESH, fast.fastest());
        fast.step(&scene, 0.0, dt, false).expect("a stable step");
    }
}

#[test]
fn a_refused_step_is_told_of_alike_by_every_set() {
    let scene = scene::<f32, 3>(KernelKind::Cubic, Transfer::Mls);
    let mut told = std::collections::BTreeSet::new();
    for k in 0..20 {
        // From steps that turn single particles inside out to ones that throw all too far.
        let dt = 3e-4 * 1.3_f64.powi(k);
        let rejections: Vec<String> = sets()
            .into_iter()
            .map(|set| {
                let mut fast = Fast::new(&scene, 1).expect("a valid scene").expect("a CPU with AVX2");
                fast.set_instructions(set);
                fast.load(&scene, &block(&scene));
                let number =
                    (0..40).find_map(|n| fast.step(&scene, 0.0, dt, false).err().map(|why| (n, why)));
                format!("{number:?}")
            })
            .collect();
        assert!(rejections.windows(2).all(|pair| pair[0] == pair[1]), "{dt:e} s: {rejections:?}");
        told.extend(rejections);
    }
    println!("{} rejections compared", told.len());
}

/// What lanes compute of `x`, put in all of them, for every instruction set.
fn exponentials<T: Real>(x: f64) -> Vec<f64> {
    sets().into_iter().map(|set| super::dispatch::exponential::<T>(set, T::of(x)).as_f64()).collect()
}

#[test]
fn the_exponential_is_right_from_end_to_end() {
    for k in -20_000..=20_000 {
        let x = f64::from(k) * 0.04;
        for (found, (least, greatest, epsilon)) in exponentials::<f32>(x)
            .into_iter()
            .map(|found| (found, (2.0_f64.powi(-126), 2.0_f64.powi(126), f64::from(f32::EPSILON))))
            .chain(
                exponentials::<f64>(x)
                    .into_iter()
                    .map(|found| (found, (2.0_f64.powi(-1022), 2.0_f64.powi(1022), f64::EPSILON))),
            )
        {
            // In f32 the argument has been rounded as well.
            let argument = if epsilon > 1e-10 { f64::from(x as f32) } else { x };
            let exact = argument.exp();
            let expected = exact.clamp(least, greatest);
            // At the ends it is the argument that is bounded, and rounded.
            let tolerance = if exact == expected { 2.0 } else { 1000.0 } * epsilon;
            assert!((found / expected - 1.0).abs() < tolerance, "e^{x} = {expected:e}, not {found:e}");
        }
    }
}
