//! The fast engine against the reference: what it computes is the same to round-off.

use snowlab_solver::collision::Contact;
use snowlab_solver::geometry::Vector;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{
    Engine, Integrator, LinearSolve, Material, Real, Scene, Simulation, Snow, State, Transfer,
};

use crate::support::{KERNELS, Random, fixed, flip, floor, lattice, scene, snow, state};

const STEPS: usize = 60;

/// A block of snow, its particles shaken off their lattice, that falls on a rough floor and is in the midst of the impact after
/// [`STEPS`] steps.
fn falling<T: Real, const D: usize>(scene: &Scene<T, D>) -> State<T, D> {
    let h = scene.spacing.as_f64();
    let mut random = Random(7);
    let mut velocity = [1.0; D];
    velocity[1] = -8.0;
    let mut first = [-3; D];
    first[1] = 1;
    let mut body = lattice(h, first, [6; D], 2, velocity);
    body.iter_mut().for_each(|p| p.position += random.vector::<f64, D>(0.25 * h));
    state(scene, &body)
}

/// Positions by id after [`STEPS`] steps, and how often J_P met a bound.
fn end<T: Real, const D: usize>(scene: &Scene<T, D>) -> (Vec<Vector<f64, D>>, u64) {
    let mut simulation = Simulation::new(scene.clone(), falling(scene)).expect("a valid scene");
    for _ in 0..STEPS {
        simulation.advance_one(f64::INFINITY).expect("a stable step");
    }
    let state = simulation.state();
    assert!(state.ledger.plastic_loss > 0.0, "the snow has yielded");
    (state.by_id().into_iter().map(|p| state.world_position(p)).collect(), state.ledger.clamps)
}

/// The greatest distance between the same particles [m].
fn apart<const D: usize>(one: &[Vector<f64, D>], other: &[Vector<f64, D>]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Implicit steps, solved so closely that it does not show where a solve stops.
fn implicit(is_double: bool) -> [Integrator; 3] {
    let solve = LinearSolve { tolerance: if is_double { 1e-12 } else { 1e-6 }, ..LinearSolve::default() };
    let definite = LinearSolve { definite: true, ..solve };
    [
        Integrator::SemiImplicit { beta: 0.5, solve },
        Integrator::SemiImplicit { beta: 1.0, solve: definite },
        Integrator::Trapezoidal { solve },
    ]
}

fn check<T: Real, const D: usize>(cells: f64) {
    if !Engine::Fast.is_available() {
        println!("this CPU runs the reference engine alone: there is nothing to compare");
        return;
    }
    for kernel in KERNELS {
        for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
            let mut scene = Scene { kernel, transfer, ..scene::<T, D>(0.0125) };
            // Bounds on J_P that many particles meet. Which of them do is beyond f32: there the bounds stay wide.
            let is_double = T::default_epsilon().as_f64() < 1e-10;
            if is_double {
                let bounds = (T::of(0.999), T::of(1.001));
                let packed = Snow { plastic_ratio_bounds: bounds, hardening_limit: T::of(1.005), ..snow() };
                scene.materials = vec![Material::Snow(packed)];
            }
            scene.colliders = vec![floor(0.0, Contact::Separate, 0.5)];
            let by = |engine, energy_budget| end(&Scene { engine, energy_budget, ..scene.clone() });
            let (reference, met) = by(Engine::Reference, true);
            assert_eq!(met > 0, is_double, "J_P met a bound {met} times");
            let time_step = fixed(2.0 * step_length(&scene, &falling(&scene)));
            for integrator in implicit(is_double) {
                let by = |engine| end(&Scene { engine, integrator, time_step, ..scene.clone() });
                let ((reference, met), (fast, fast_met)) = (by(Engine::Reference), by(Engine::Fast));
                let what = format!("{D}D {kernel:?} {transfer:?} {integrator:?}");
                let off = apart(&fast, &reference) / scene.spacing.as_f64();
                // In steps twice as long the material goes twice as far.
                assert!(off <= 2.0 * cells && off > 0.0, "{what}: {off:e} cells apart");
                assert_eq!(fast_met, met, "{what}: how often J_P met a bound");
            }
            // With the budget, nodes keep forces apart from momentum; without it affine transfers give both as one.
            for budget in [true, false] {
                let (fast, fast_met) = by(Engine::Fast, budget);
                let what = format!("{D}D {kernel:?} {transfer:?}, energy budget {budget}");
                let off = apart(&fast, &reference) / scene.spacing.as_f64();
                assert!(off <= cells, "{what}: {off:e} cells apart");
                assert!(off > 0.0, "{what}: the same engine ran twice");
                assert_eq!(fast_met, met, "{what}: how often J_P met a bound");
            }
        }
    }
}

#[test]
fn positions_agree_to_1e_8_cells_in_f64() {
    check::<f64, 2>(1e-8);
    check::<f64, 3>(1e-8);
}

/// 60 steps of motion of some 0.01 cells each, rounded to 2^-24 of a position of some cells.
#[test]
fn positions_agree_to_2e_5_cells_in_f32() {
    check::<f32, 2>(2e-5);
    check::<f32, 3>(2e-5);
}
