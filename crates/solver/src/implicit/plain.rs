//! The semi-implicit step of the reference engine.

use super::krylov::{LinearSystem, Solution};
use super::operator::apply_hessian;
use super::{Coefficients, Held, Released, StepSystem, held_nodes, release, solve_step};
use crate::collision::MirrorPlane;
use crate::error::Rejection;
use crate::geometry::{Vector, is_zero};
use crate::grid::{Grid, NodeSums};
use crate::ledger::StepLedger;
use crate::material::Tangent;
use crate::mirror::{self, Fold};
use crate::particles::{ParticleConstants, ParticleMotion};
use crate::real::Real;
use crate::scene::{LinearSolve, Scene};

/// Scratch memory of the solve.
#[derive(Clone, Debug, Default)]
pub(crate) struct Implicit<T: Real, const D: usize> {
    tangents: Vec<Tangent<T, D>>,
    reflected: Vec<Vector<T, D>>,
}

/// What a solve sees of its step.
#[derive(Clone, Copy)]
pub(crate) struct PlainStep<'a, T: Real, const D: usize> {
    pub scene: &'a Scene<T, D>,
    pub motion: &'a ParticleMotion<T, D>,
    pub constants: &'a ParticleConstants<T>,
    /// With sums folded.
    pub grid: &'a Grid<T, D>,
    pub folds: &'a [Fold<T, D>],
    /// A node of no more mass counts as empty [kg].
    pub empty: T,
    /// When it begins, and its length [s].
    pub time: f64,
    pub dt: f64,
}

/// What an implicit step needs beside the grid.
#[derive(Clone, Copy)]
pub(crate) struct ImplicitStep<'a, T: Real, const D: usize> {
    pub scene: &'a Scene<T, D>,
    pub motion: &'a ParticleMotion<T, D>,
    pub constants: &'a ParticleConstants<T>,
    pub mirrors: &'a [(usize, MirrorPlane)],
    /// A node of no more mass counts as empty [kg].
    pub empty: T,
}

/// The system on the nodes of the reference engine's grid.
struct System<'a, T: Real, const D: usize> {
    step: PlainStep<'a, T, D>,
    tangents: &'a [Tangent<T, D>],
    held: Vec<Held<T, D>>,
    /// Of every node: its mass, 0 where it counts as empty; v^n; dt (f + m g).
    mass: Vec<T>,
    start: Vec<Vector<T, D>>,
    pushed: Vec<Vector<T, D>>,
    c: f64,
    /// u beyond the mirrors too.
    reflected: &'a mut Vec<Vector<T, D>>,
}

impl<'a, T: Real, const D: usize> System<'a, T, D> {
    fn new(
        step: PlainStep<'a, T, D>,
        tangents: &'a [Tangent<T, D>],
        c: f64,
        reflected: &'a mut Vec<Vector<T, D>>,
    ) -> Self {
        let PlainStep { scene, grid, empty, dt, .. } = step;
        let (still, dt) = (Vector::zeros(), T::of(dt));
        let mass: Vec<T> =
            grid.sums.iter().map(|sums| if sums.mass > empty { sums.mass } else { T::zero() }).collect();
        let holding = |of: &dyn Fn(&NodeSums<T, D>) -> Vector<T, D>| {
            grid.sums.iter().map(|sums| if sums.mass > empty { of(sums) } else { still }).collect()
        };
        let start = holding(&|sums| sums.momentum / sums.mass);
        let pushed = holding(&|sums| (sums.force + scene.gravity * sums.mass) * dt);
        System { step, tangents, held: Vec::new(), mass, start, pushed, c, reflected }
    }
}

impl<T: Real, const D: usize> LinearSystem for System<'_, T, D> {
    type Vector = Vec<Vector<T, D>>;

    fn apply(&mut self, x: &Self::Vector, out: &mut Self::Vector) {
        self.matrix(x, out);
        self.project(out);
    }

    fn precondition(&mut self, r: &Self::Vector, out: &mut Self::Vector) {
        for ((out, r), &mass) in out.iter_mut().zip(r).zip(&self.mass) {
            *out = if mass > T::zero() { *r / mass } else { Vector::zeros() };
        }
    }

    fn dot(&mut self, a: &Self::Vector, b: &Self::Vector) -> f64 {
        a.iter().zip(b).map(|(a, b)| a.dot(b).as_f64()).sum()
    }

    fn combine(&mut self, a: f64, x: &Self::Vector, b: f64, y: &mut Self::Vector) {
        let (a, b) = (T::of(a), T::of(b));
        for (y, x) in y.iter_mut().zip(x) {
            *y = if b == T::zero() { *x * a } else { *x * a + *y * b };
        }
    }
}

impl<T: Real, const D: usize> StepSystem for System<'_, T, D> {
    fn start(&self) -> Self::Vector {
        self.start.clone()
    }

    fn pushed(&self) -> Self::Vector {
        self.pushed.clone()
    }

    fn hessian(&mut self, u: &Self::Vector, out: &mut Self::Vector) {
        self.reflected.clone_from(u);
        mirror::reflect_out(self.step.folds, self.reflected);
        let PlainStep { scene, motion, grid, .. } = self.step;
        apply_hessian(scene, motion, self.tangents, grid, self.reflected, out);
    }

    fn folded_hessian(&mut self, u: &Self::Vector, out: &mut Self::Vector) {
        self.hessian(u, out);
        mirror::fold_in(self.step.folds, out);
        for (out, &mass) in out.iter_mut().zip(&self.mass) {
            if mass == T::zero() {
                *out = Vector::zeros();
            }
        }
    }

    fn matrix(&mut self, u: &Self::Vector, out: &mut Self::Vector) {
        self.folded_hessian(u, out);
        let c = T::of(self.c);
        for ((out, u), &mass) in out.iter_mut().zip(u).zip(&self.mass) {
            *out = *u * mass + *out * c;
        }
    }

    fn hold(&mut self, released: &Released) -> Option<Self::Vector> {
        let PlainStep { scene, grid, folds, time, .. } = self.step;
        let System { mass, start, pushed, .. } = self;
        let moving = (0..mass.len()).filter(|&node| mass[node] > T::zero());
        let explicit =
            moving.map(|node| (node, grid.position(node), start[node] + pushed[node] / mass[node]));
        self.held = held_nodes(&scene.colliders, explicit, mirror::nodes_on_planes(folds), time, released);
        let mut known = vec![Vector::zeros(); self.mass.len()];
        for held in &self.held {
            known[held.node] = held.change_from(&self.start[held.node]);
        }
        (!known.iter().all(is_zero)).then_some(known)
    }

    fn project(&self, u: &mut Self::Vector) {
        for held in &self.held {
            u[held.node] = held.free * u[held.node];
        }
    }

    fn release(&self, change: &Self::Vector, image: &Self::Vector, released: &mut Released) -> bool {
        let PlainStep { scene, grid, folds, time, dt, .. } = self.step;
        let mut folded = image.clone();
        mirror::fold_in(folds, &mut folded);
        let push = |node: usize| change[node] + (folded[node] - self.pushed[node]) / self.mass[node];
        release(scene, &self.held, |node| grid.position(node), push, time, dt, released)
    }
}

/// Adds to the nodes' forces what they change by over an implicit step of `dt` [s] from `time` [s]; sums are folded before and after.
///
/// # Errors
/// A solve that has not converged.
pub(crate) fn add_implicit_forces<T: Real, const D: usize>(
    step: ImplicitStep<'_, T, D>,
    [time, dt]: [f64; 2],
    grid: &mut Grid<T, D>,
    folds: &mut Vec<Fold<T, D>>,
    scratch: &mut Implicit<T, D>,
    ledger: &mut StepLedger<D>,
) -> Result<(), Rejection> {
    let ImplicitStep { scene, motion, constants, mirrors, empty } = step;
    let Some((coefficients, how)) = Coefficients::and_solve(&scene.integrator, dt) else { return Ok(()) };
    let step = PlainStep { scene, motion, constants, grid, folds, empty, time, dt };
    let (forces, solution) = scratch.force_change(step, coefficients, how);
    solution.accept(how, ledger)?;
    mirror::restore_sums(folds, grid);
    grid.sums.iter_mut().zip(&forces).for_each(|(sums, force)| sums.force += force);
    mirror::fold(mirrors, grid, &scene.gravity, folds);
    Ok(())
}

impl<T: Real, const D: usize> Implicit<T, D> {
    /// What the forces of `step` change by, node by node: - (s H v^n + c H D) / dt [N]; and how the solve ended.
    pub fn force_change(
        &mut self,
        step: PlainStep<'_, T, D>,
        coefficients: Coefficients,
        how: &LinearSolve,
    ) -> (Vec<Vector<T, D>>, Solution) {
        self.linearise(&step, how);
        let Implicit { tangents, reflected } = self;
        let c = coefficients.of_change;
        let mut system = System::new(step, tangents, c, reflected);
        let (mut forces, solution) = solve_step(&mut system, coefficients, how);
        let per_step = T::of(-1.0 / step.dt);
        forces.iter_mut().for_each(|force| *force *= per_step);
        (forces, solution)
    }

    /// The tangents of all particles, times V_p.
    fn linearise(&mut self, step: &PlainStep<'_, T, D>, how: &LinearSolve) {
        let PlainStep { scene, motion, constants, .. } = step;
        self.tangents.clear();
        self.tangents.extend((0..motion.len()).map(|p| {
            let material = &scene.materials[constants.material[p] as usize];
            let stiffness = motion.stiffness[p] * constants.volume[p];
            Tangent::new(material, &motion.deformation[p], stiffness, how.definite)
        }));
    }
}
