//! The operator and the step's system against their definitions, inside a real step: random particles, deformed at will, on their grid.

use super::operator::apply_hessian;
use super::{Coefficients, Implicit, Method, PlainStep};
use crate::geometry::{Matrix, Shape, Vector, unit};
use crate::grid::Grid;
use crate::material::{ConstitutiveModel, Elastic, Lame, Material, Tangent};
use crate::math::determinant;
use crate::mirror;
use crate::scene::{Advection, Engine, FlipShare, Integrator, LinearSolve, Scene, TimeStepControl, Transfer};
use crate::state::{InitialParticle, State};
use crate::step::{Workspace, step};
use crate::transfer::{particles_to_grid, place_stencils};
use crate::{Collider, Contact, KernelKind};

const SPACING: f64 = 0.05;
const TRANSFERS: [Transfer; 3] = [Transfer::Flip(FlipShare::PerStep(1.0)), Transfer::Apic, Transfer::Mls];
const KERNELS: [KernelKind; 2] = [KernelKind::Cubic, KernelKind::Quadratic];

/// Numbers in (-1, 1) that look random.
fn number(k: usize) -> f64 {
    ((k as f64 * 12.9898 + 0.7).sin() * 43758.5453).fract()
}

fn scene<const D: usize>(kernel: KernelKind, transfer: Transfer) -> Scene<f64, D> {
    Scene {
        spacing: SPACING,
        kernel,
        transfer,
        integrator: Integrator::Explicit,
        engine: Engine::Reference,
        advection: Advection::Interpolated,
        materials: vec![Material::Elastic(Elastic { lame: Lame::from_young(1.4e5, 0.2) })],
        colliders: Vec::new(),
        gravity: unit::<f64, D>(1) * -9.81,
        time_step: TimeStepControl::default(),
        energy_budget: true,
    }
}

/// Four particles a cell in 3^D cells, each with a deformation and a velocity of its own; one of them is flat.
fn state<const D: usize>(scene: &Scene<f64, D>, strain: f64) -> State<f64, D> {
    let count = 4 * 3_usize.pow(D as u32);
    let particles: Vec<InitialParticle<D>> = (0..count)
        .map(|p| InitialParticle {
            position: Vector::from_fn(|k, _| (1.5 + 1.5 * number(p * 5 + k)) * SPACING),
            velocity: Vector::from_fn(|k, _| number(p * 7 + k + 1000)),
            mass: 400.0 * SPACING.powi(D as i32) / 4.0 * (1.5 + number(p + 2000)),
            volume: SPACING.powi(D as i32) / 4.0,
            stiffness_scale: 1.5 + number(p + 3000),
            material: 0,
            deformation: Matrix::identity(),
            plastic_ratio: 1.0,
        })
        .collect();
    let mut state = State::at_rest(scene, Vector::zeros(), &particles).unwrap();
    for (p, f) in state.motion.deformation.iter_mut().enumerate() {
        *f += Matrix::from_fn(|i, j| strain * number(p * 11 + i * 3 + j + 4000));
    }
    // Flattened: no volume is left.
    state.motion.deformation[7].column_mut(0).fill(0.0);
    state
}

/// A grid with the particles' masses, momenta and forces on it.
fn grid<const D: usize>(scene: &Scene<f64, D>, state: &State<f64, D>) -> Grid<f64, D> {
    let mut grid = Grid::new(scene.spacing);
    place_stencils(scene, &state.motion, &mut grid);
    particles_to_grid(scene, &state.motion, &state.constants, &stress(scene, state, None), &mut grid);
    grid
}

/// V_p P(F) F_E^T of every particle, where F = (I + grad u) F_E for a displacement with these gradients, or F_E itself.
fn stress<const D: usize>(
    scene: &Scene<f64, D>,
    state: &State<f64, D>,
    displaced: Option<&[Matrix<f64, D>]>,
) -> Vec<Matrix<f64, D>> {
    let State { motion, constants, .. } = state;
    (0..state.len())
        .map(|p| {
            let f = motion.deformation[p];
            let now = displaced.map_or(f, |gradients| (Matrix::identity() + gradients[p]) * f);
            let material = &scene.materials[0];
            material.first_piola(&now, motion.stiffness[p]) * f.transpose() * constants.volume[p]
        })
        .collect()
}

fn tangents<const D: usize>(scene: &Scene<f64, D>, state: &State<f64, D>) -> Vec<Tangent<f64, D>> {
    let State { motion, constants, .. } = state;
    let of = |p: usize| {
        let stiffness = motion.stiffness[p] * constants.volume[p];
        Tangent::new(&scene.materials[0], &motion.deformation[p], stiffness, false)
    };
    (0..state.len()).map(of).collect()
}

fn field<const D: usize>(grid: &Grid<f64, D>, seed: usize) -> Vec<Vector<f64, D>> {
    (0..grid.node_count()).map(|node| Vector::from_fn(|k, _| number(seed + node * 3 + k))).collect()
}

fn dot<const D: usize>(a: &[Vector<f64, D>], b: &[Vector<f64, D>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn for_all_schemes<const D: usize>(check: impl Fn(Scene<f64, D>)) {
    for kernel in KERNELS {
        for transfer in TRANSFERS {
            check(scene::<D>(kernel, transfer));
        }
    }
}

/// f(u) of all nodes, for nodes displaced by `s` u.
fn forces<const D: usize>(
    scene: &Scene<f64, D>,
    state: &State<f64, D>,
    grid: &Grid<f64, D>,
    u: &[Vector<f64, D>],
    s: f64,
) -> Vec<Vector<f64, D>> {
    let mut moved = grid.clone();
    for (motion, u) in moved.motion.iter_mut().zip(u) {
        motion.velocity = u * s;
    }
    let mut gathered = crate::transfer::Gathered::default();
    crate::transfer::grid_to_particles(scene, &state.motion, &moved, &mut gathered);
    let stress = stress(scene, state, Some(&gathered.gradient));
    moved.sums.fill(crate::grid::NodeSums::empty());
    particles_to_grid(scene, &state.motion, &state.constants, &stress, &mut moved);
    moved.sums.iter().map(|sums| sums.force).collect()
}

fn the_hessian_is_minus_the_derivative_of_forces<const D: usize>(strain: f64) {
    for_all_schemes::<D>(|scene| {
        let state = state(&scene, strain);
        if strain > 0.8 {
            let inverted = state.motion.deformation.iter().filter(|f| determinant(f) < 0.0).count();
            assert!(inverted > 5, "the state has {inverted} particles turned inside out");
        }
        let (grid, tangents) = (grid(&scene, &state), tangents(&scene, &state));
        let u = field(&grid, 17);
        let mut found = vec![Vector::zeros(); u.len()];
        apply_hessian(&scene, &state.motion, &tangents, &grid, &u, &mut found);
        let step = 2e-6 * SPACING;
        let of = |s: f64| forces(&scene, &state, &grid, &u, s * step);
        let (one, minus_one, two, minus_two) = (of(1.0), of(-1.0), of(2.0), of(-2.0));
        let (mut error, mut size) = (0.0, 0.0);
        for node in 0..u.len() {
            let first = (one[node] - minus_one[node]) * 8.0 - (two[node] - minus_two[node]);
            let expected = -first / (12.0 * step);
            error += (found[node] - expected).norm_squared();
            size += expected.norm_squared();
        }
        let error = (error / size).sqrt();
        assert!(error < 1e-7, "{D}D {:?} {:?}: {error:e}", scene.kernel, scene.transfer);
    });
}

#[test]
fn the_operator_is_the_derivative_of_the_steps_forces() {
    the_hessian_is_minus_the_derivative_of_forces::<2>(0.3);
    the_hessian_is_minus_the_derivative_of_forces::<3>(0.3);
}

#[test]
fn also_where_particles_are_turned_inside_out() {
    the_hessian_is_minus_the_derivative_of_forces::<2>(1.2);
    the_hessian_is_minus_the_derivative_of_forces::<3>(1.2);
}

#[test]
fn the_operator_is_symmetric_to_round_off() {
    fn check<const D: usize>() {
        for_all_schemes::<D>(|scene| {
            let state = state(&scene, 0.5);
            let (grid, tangents) = (grid(&scene, &state), tangents(&scene, &state));
            let (u, v) = (field(&grid, 1), field(&grid, 2));
            let (mut hu, mut hv) = (u.clone(), v.clone());
            apply_hessian(&scene, &state.motion, &tangents, &grid, &u, &mut hu);
            apply_hessian(&scene, &state.motion, &tangents, &grid, &v, &mut hv);
            let (one, other) = (dot(&v, &hu), dot(&u, &hv));
            let size = dot(&hu, &hu).sqrt() * dot(&v, &v).sqrt();
            assert!((one - other).abs() < 1e-14 * size, "{one} {other} {size}");
        });
    }
    check::<2>();
    check::<3>();
}

#[test]
fn a_motion_of_the_whole_costs_nothing() {
    for_all_schemes::<3>(|scene| {
        let state = state(&scene, 0.5);
        let (grid, tangents) = (grid(&scene, &state), tangents(&scene, &state));
        let u = vec![Vector::from([1.0, -2.0, 3.0]); grid.node_count()];
        let mut hu = u.clone();
        apply_hessian(&scene, &state.motion, &tangents, &grid, &u, &mut hu);
        let mut shaken = u.clone();
        apply_hessian(&scene, &state.motion, &tangents, &grid, &field(&grid, 3), &mut shaken);
        assert!(dot(&hu, &hu).sqrt() < 1e-12 * dot(&shaken, &shaken).sqrt());
    });
}

/// The nodes' velocities at the end of a step from `state`.
fn velocities<const D: usize>(
    scene: &Scene<f64, D>,
    state: &State<f64, D>,
    dt: f64,
) -> (Vec<Vector<f64, D>>, Vec<f64>) {
    let mut state = state.clone();
    let mut workspace = Workspace::new(scene, &state).unwrap();
    step(scene, &mut state, &mut workspace, dt).unwrap();
    let grid = workspace.grid();
    (
        grid.motion.iter().map(|motion| motion.velocity).collect(),
        grid.sums.iter().map(|sums| sums.mass).collect(),
    )
}

fn exact(method: Method) -> LinearSolve {
    LinearSolve { method, tolerance: 1e-13, max_iterations: 1000, definite: false }
}

/// (v_implicit - v_explicit) / (beta dt^2) tends to - M^-1 H v*: a solver that leaves v* as it is would agree at any dt "to first order".
#[test]
fn a_short_step_differs_from_the_explicit_one_by_the_hessian() {
    fn check<const D: usize>() {
        for_all_schemes::<D>(|explicit| {
            let state = state(&explicit, 0.1);
            let (beta, dt) = (0.7, 2e-8);
            let solve = exact(Method::Minres);
            let scene = Scene { integrator: Integrator::SemiImplicit { beta, solve }, ..explicit.clone() };
            let ((start, mass), (end, _)) =
                (velocities(&explicit, &state, dt), velocities(&scene, &state, dt));
            let (grid, tangents) = (grid(&explicit, &state), tangents(&explicit, &state));
            let mut image = start.clone();
            apply_hessian(&explicit, &state.motion, &tangents, &grid, &start, &mut image);
            let (mut error, mut size) = (0.0, 0.0);
            for node in (0..start.len()).filter(|&node| mass[node] > 1e-6) {
                let expected = -image[node] / mass[node];
                let found = (end[node] - start[node]) / (beta * dt * dt);
                error += (found - expected).norm_squared();
                size += expected.norm_squared();
            }
            let error = (error / size).sqrt();
            assert!(error < 1e-6, "{D}D {:?} {:?}: {error:e}", explicit.kernel, explicit.transfer);
        });
    }
    check::<2>();
    check::<3>();
}

/// Ten times the explicit limit: the velocities solve S13's equation, (M + beta dt^2 H) v = M v*, also under a mirror, where those of the material
/// and of its image do together.
#[test]
fn velocities_solve_the_equation() {
    fn check<const D: usize>(mirrored: bool) {
        for_all_schemes::<D>(|mut explicit| {
            if mirrored {
                explicit.colliders.push(Collider {
                    shape: Shape::HalfSpace { point: Vector::zeros(), normal: unit(0) },
                    contact: Contact::Mirror,
                    friction: 0.0,
                    velocity: Vector::zeros(),
                });
            }
            let mut state = state(&explicit, 0.05);
            state.motion.velocity.iter_mut().for_each(|v| *v *= 0.01);
            let (beta, dt) = (1.0, 2e-3);
            for method in [Method::Minres, Method::ConjugateResiduals] {
                let solve = exact(method);
                let scene =
                    Scene { integrator: Integrator::SemiImplicit { beta, solve }, ..explicit.clone() };
                let (end, _) = velocities(&scene, &state, dt);
                let mut grid = grid(&explicit, &state);
                let (mut folds, planes) = (Vec::new(), mirror::planes(&explicit).unwrap());
                mirror::fold(&planes, &mut grid, &explicit.gravity, &mut folds);
                let mut image = end.clone();
                apply_hessian(
                    &explicit,
                    &state.motion,
                    &tangents(&explicit, &state),
                    &grid,
                    &end,
                    &mut image,
                );
                mirror::fold_in(&folds, &mut image);
                let (mut error, mut size) = (0.0, 0.0);
                for (node, sums) in grid.sums.iter().enumerate().filter(|(_, sums)| sums.mass > 0.0) {
                    let given = sums.momentum + (sums.force + explicit.gravity * sums.mass) * dt;
                    error += (end[node] * sums.mass + image[node] * (beta * dt * dt) - given).norm_squared();
                    size += given.norm_squared();
                }
                let error = (error / size).sqrt();
                assert!(error < 1e-9, "{D}D {:?} {:?}: {error:e}", scene.kernel, scene.transfer);
            }
        });
    }
    check::<2>(false);
    check::<3>(false);
    check::<2>(true);
    check::<3>(true);
}

/// A solve that is cut short gives forces all the same, which keep momentum to round-off.
#[test]
fn a_solve_that_fails_names_what_is_left() {
    let scene = scene::<2>(KernelKind::Cubic, Transfer::Mls);
    let state = state(&scene, 0.1);
    let grid = grid(&scene, &state);
    let how = LinearSolve { max_iterations: 2, tolerance: 1e-8, ..LinearSolve::default() };
    let step = PlainStep {
        scene: &scene,
        motion: &state.motion,
        constants: &state.constants,
        grid: &grid,
        folds: &[],
        empty: 0.0,
        time: 0.0,
        dt: 1e-2,
    };
    let coefficients = Coefficients::of(&Integrator::SemiImplicit { beta: 1.0, solve: how }, 1e-2).unwrap();
    let (forces, solution) = Implicit::default().force_change(step, coefficients, &how);
    assert!(!solution.converged && solution.iterations == 2 && solution.residual > 1e-8, "{solution:?}");
    let total = forces.iter().fold(Vector::zeros(), |sum: Vector<f64, 2>, f| sum + f);
    let size: f64 = forces.iter().map(|f| f.norm()).sum();
    assert!(total.norm() < 1e-13 * size);
}
