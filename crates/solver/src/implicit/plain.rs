//! The semi-implicit step of the reference engine.

use super::krylov::{Goal, LinearSystem, Solution, solve};
use super::operator::{apply_hessian, node_stiffness};
use super::{Coefficients, Held, Released, held_nodes, release, weighted};
use crate::geometry::{Vector, is_zero};
use crate::grid::Grid;
use crate::material::{ConstitutiveModel, Tangent};
use crate::mirror::{self, Fold};
use crate::particles::{ParticleConstants, ParticleMotion};
use crate::real::Real;
use crate::scene::{LinearSolve, Preconditioner, Scene};

/// Scratch memory of the solve.
#[derive(Clone, Debug, Default)]
pub(crate) struct Implicit<T: Real, const D: usize> {
    tangents: Vec<Tangent<T, D>>,
    stiffness: Vec<T>,
    scratch: Vec<Vector<T, D>>,
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

/// (M + c H) on the nodes that move freely.
struct System<'a, T: Real, const D: usize> {
    step: PlainStep<'a, T, D>,
    tangents: &'a [Tangent<T, D>],
    held: Vec<Held<T, D>>,
    /// Of every node: its mass, 0 where it counts as empty; and the preconditioner's entry.
    mass: Vec<T>,
    weight: Vec<T>,
    c: f64,
    /// u beyond the mirrors too.
    reflected: &'a mut Vec<Vector<T, D>>,
}

impl<T: Real, const D: usize> System<'_, T, D> {
    /// `out` = H u as the particles see it: nodes beyond mirrors have forces of their own.
    fn hessian(&mut self, u: &[Vector<T, D>], out: &mut [Vector<T, D>]) {
        self.reflected.clear();
        self.reflected.extend_from_slice(u);
        mirror::reflect_out(self.step.folds, self.reflected);
        let PlainStep { scene, motion, grid, .. } = self.step;
        apply_hessian(scene, motion, self.tangents, grid, self.reflected, out);
    }

    /// As [`System::hessian`], with what falls on nodes beyond mirrors folded back, and nothing on nodes that count as empty.
    fn folded_hessian(&mut self, u: &[Vector<T, D>], out: &mut [Vector<T, D>]) {
        self.hessian(u, out);
        mirror::fold_in(self.step.folds, out);
        for (out, &mass) in out.iter_mut().zip(&self.mass) {
            if mass == T::zero() {
                *out = Vector::zeros();
            }
        }
    }

    /// `out` = (M + c H) u.
    fn full(&mut self, u: &[Vector<T, D>], out: &mut [Vector<T, D>]) {
        self.folded_hessian(u, out);
        let c = T::of(self.c);
        for ((out, u), &mass) in out.iter_mut().zip(u).zip(&self.mass) {
            *out = *u * mass + *out * c;
        }
    }

    fn project(&self, u: &mut [Vector<T, D>]) {
        for held in &self.held {
            u[held.node] = held.free * u[held.node];
        }
    }
}

impl<T: Real, const D: usize> LinearSystem for System<'_, T, D> {
    type Vector = Vec<Vector<T, D>>;

    fn apply(&mut self, x: &Self::Vector, out: &mut Self::Vector) {
        self.full(x, out);
        self.project(out);
    }

    fn precondition(&mut self, r: &Self::Vector, out: &mut Self::Vector) {
        for ((out, r), &weight) in out.iter_mut().zip(r).zip(&self.weight) {
            *out = if weight > T::zero() { *r / weight } else { Vector::zeros() };
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

impl<T: Real, const D: usize> Implicit<T, D> {
    /// What the forces of `step` change by, node by node: - (s H v^n + c H D) / dt [N]; and how the solve ended.
    pub fn force_change(
        &mut self,
        step: PlainStep<'_, T, D>,
        coefficients: Coefficients,
        how: &LinearSolve,
    ) -> (Vec<Vector<T, D>>, Solution) {
        let PlainStep { scene, motion, constants, grid, empty, time, dt, .. } = step;
        let Coefficients { of_change: c, of_start: s } = coefficients;
        self.linearise(&step, how);
        let nodes = grid.node_count();
        let mass: Vec<T> =
            grid.sums.iter().map(|sums| if sums.mass > empty { sums.mass } else { T::zero() }).collect();
        let start: Vec<Vector<T, D>> = grid
            .sums
            .iter()
            .zip(&mass)
            .map(|(sums, &mass)| if mass > T::zero() { sums.momentum / mass } else { Vector::zeros() })
            .collect();
        let dt_t = T::of(dt);
        let push = |node: usize| grid.sums[node].force * dt_t + scene.gravity * (mass[node] * dt_t);
        let weight = match how.preconditioner {
            Preconditioner::Mass => mass.clone(),
            Preconditioner::Stiffness => {
                self.stiffness.resize(nodes, T::zero());
                let modulus = |p: usize| {
                    let lame =
                        ConstitutiveModel::<T, D>::lame(&scene.materials[constants.material[p] as usize]);
                    (lame.lambda + lame.mu + lame.mu) * motion.stiffness[p] * constants.volume[p]
                };
                node_stiffness(scene, motion, modulus, grid, &mut self.stiffness);
                mirror::fold_numbers(step.folds, &mut self.stiffness);
                let with = |(m, k): (&T, &T)| {
                    if *m > T::zero() { weighted(*m, *k, c, scene.spacing) } else { T::zero() }
                };
                mass.iter().zip(&self.stiffness).map(with).collect()
            }
        };
        let pushed: Vec<Vector<T, D>> = (0..nodes)
            .map(|node| if mass[node] > T::zero() { push(node) } else { Vector::zeros() })
            .collect();
        let explicit = || {
            let moving = (0..nodes).filter(|&node| mass[node] > T::zero());
            moving.map(|node| (node, grid.position(node), start[node] + push(node) / mass[node]))
        };
        let goal = Goal { tolerance: how.tolerance, max_iterations: how.max_iterations };
        let mut system = System {
            step,
            tangents: &self.tangents,
            held: Vec::new(),
            mass: mass.clone(),
            weight,
            c,
            reflected: &mut self.scratch,
        };
        let mut image = vec![Vector::zeros(); nodes];
        // dt (f + M g) - s H v^n
        let mut asked = pushed.clone();
        system.folded_hessian(&start, &mut image);
        system.combine(-s, &image, 1.0, &mut asked);

        let mut released = Released::new();
        let mut total = Solution::default();
        loop {
            let on_planes = mirror::nodes_on_planes(step.folds);
            system.held = held_nodes(&scene.colliders, explicit(), on_planes, time, &released);
            // The right side, less what the known part of the change takes.
            let mut known = vec![Vector::zeros(); nodes];
            for held in &system.held {
                known[held.node] = held.velocity - (start[held.node] - held.free * start[held.node]);
            }
            let mut right = asked.clone();
            if !known.iter().all(is_zero) {
                system.full(&known, &mut image);
                system.combine(-1.0, &image, 1.0, &mut right);
            }
            system.project(&mut right);
            let (mut change, solution) = solve(&mut system, how.method, &right, goal, |_| ());
            total = Solution { iterations: total.iterations + solution.iterations, ..solution };
            system.combine(1.0, &known, 1.0, &mut change);

            // s v^n + c D, and its image as particles see it.
            let mut moved = start.clone();
            system.combine(c, &change, s, &mut moved);
            system.hessian(&moved, &mut image);
            let mut reaction = image.clone();
            mirror::fold_in(step.folds, &mut reaction);
            let push_of_obstacles = |node: usize| change[node] + (reaction[node] - pushed[node]) / mass[node];
            let place = |node| grid.position(node);
            if !release(scene, &system.held, place, push_of_obstacles, time, dt, &mut released) {
                break;
            }
        }
        let per_step = -T::one() / dt_t;
        image.iter_mut().for_each(|force| *force *= per_step);
        (image, total)
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
