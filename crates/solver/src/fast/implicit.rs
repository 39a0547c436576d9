//! The fast engine's part of a semi-implicit step (`../implicit`): its system on the nodes of all blocks, each part on all threads.

use super::batch::Scratch;
use super::contact::{is_near, surroundings};
use super::grid::{BLOCK_NODES, Node, add_run, copy_run, node_coordinates};
use super::hessian::{Linearisation, tangent_fields};
use super::pool::Shared;
use super::simd::{CHANNELS, CHUNK};
use super::step::Fast;
use crate::error::Rejection;
use crate::geometry::Vector;
use crate::implicit::{
    Coefficients, Held, LinearSystem, Released, StepSystem, held_nodes, release, solve_step,
};
use crate::ledger::StepLedger;
use crate::mirror::{self, Fold};
use crate::real::Real;
use crate::scene::{LinearSolve, Scene, Transfer};

/// Blocks of nodes that a task takes at least when it does no more than add them up (chosen: a task of some microseconds).
const LEAST_BLOCKS: usize = 64;

/// The system of a step.
struct System<'a, T: Real, const D: usize> {
    fast: &'a Fast<T, D>,
    scene: &'a Scene<T, D>,
    /// Fields of all chunks' tangents.
    tangents: &'a [[T; CHUNK]],
    folds: &'a [Fold<T, D>],
    held: Vec<Held<T, D>>,
    /// Of every node: its mass, 0 where it counts as empty; one over it, 0 likewise; v^n; dt (f + m g).
    mass: Vec<T>,
    per_mass: Vec<T>,
    start: Vec<Node<T>>,
    pushed: Vec<Node<T>>,
    /// u beyond the mirrors too, where there are any.
    reflected: Vec<Node<T>>,
    c: f64,
    time: f64,
    dt: f64,
}

fn vector<T: Real, const D: usize>(node: &Node<T>) -> Vector<T, D> {
    Vector::from_fn(|k, _| node[k])
}

fn node<T: Real, const D: usize>(vector: &Vector<T, D>) -> Node<T> {
    std::array::from_fn(|k| if k < D { vector[k] } else { T::zero() })
}

impl<T: Real, const D: usize> System<'_, T, D> {
    /// Calls `task` for every block of nodes with its part of `out`.
    fn for_blocks<V: Send>(&self, out: &mut [V], task: impl Fn(usize, &mut [V]) + Sync + Send) {
        let blocks = out.len() / BLOCK_NODES;
        let shared = Shared::new(out);
        self.fast.pool.run(
            blocks,
            LEAST_BLOCKS,
            || (),
            |(), block| {
                #[expect(unsafe_code, reason = "tasks write to nodes of their own")]
                // SAFETY: every block belongs to one task.
                let part = unsafe { shared.range(block * BLOCK_NODES, BLOCK_NODES) };
                task(block * BLOCK_NODES, part);
            },
        );
    }

    /// The tiles' shares of H u, added up in the order of scattering.
    fn add_hessian(&self, u: &[Node<T>], out: &mut [Node<T>]) {
        let Fast { set, kernels, particles, grid, pool, .. } = self.fast;
        self.for_blocks(out, |_, part| part.fill([T::zero(); CHANNELS]));
        let shared = Shared::new(out);
        let work = |scratch: &mut Scratch<T>, number: usize| {
            let home = grid.order[number].home as usize;
            grid.for_tile_runs(home, &mut |tile, node, count| {
                copy_run(&u[node..node + count], tile, &mut scratch.tile);
            });
            (kernels.hessian_block)(*set, self.scene, particles, self.tangents, home, scratch);
        };
        let add = |scratch: &mut Scratch<T>, number: usize| {
            #[expect(
                unsafe_code,
                reason = "tiles are added to nodes that other threads add to at other times"
            )]
            grid.for_tile_runs(grid.order[number].home as usize, &mut |tile, node, count| {
                // SAFETY: only tiles of one colour are added at the same time, which have no node in common.
                unsafe { add_run(&scratch.second_tile, tile, shared.range(node, count)) };
            });
        };
        let turn = |number: usize| grid.order[number].after as usize;
        pool.run_in_turns(grid.order.len(), turn, Scratch::new::<D>, work, add);
    }
}

impl<T: Real, const D: usize> LinearSystem for System<'_, T, D> {
    type Vector = Vec<Node<T>>;

    fn apply(&mut self, x: &Self::Vector, out: &mut Self::Vector) {
        self.matrix(x, out);
        self.project(out);
    }

    fn precondition(&mut self, r: &Self::Vector, out: &mut Self::Vector) {
        self.for_blocks(out, |first, part| {
            for (k, out) in part.iter_mut().enumerate() {
                *out = r[first + k].map(|r| r * self.per_mass[first + k]);
            }
        });
    }

    /// Block by block, so that the number of threads does not show.
    fn dot(&mut self, a: &Self::Vector, b: &Self::Vector) -> f64 {
        let of_block = |block: usize| -> f64 {
            let nodes = block * BLOCK_NODES..(block + 1) * BLOCK_NODES;
            let mut sums = [0.0; CHANNELS];
            for (a, b) in a[nodes.clone()].iter().zip(&b[nodes]) {
                for k in 0..CHANNELS {
                    sums[k] += a[k].as_f64() * b[k].as_f64();
                }
            }
            sums.iter().sum()
        };
        let blocks = a.len() / BLOCK_NODES;
        self.fast.pool.run(blocks, LEAST_BLOCKS, || (), |(), block| of_block(block)).iter().sum()
    }

    fn combine(&mut self, a: f64, x: &Self::Vector, b: f64, y: &mut Self::Vector) {
        let (a, b) = (T::of(a), T::of(b));
        self.for_blocks(y, |first, part| {
            let x = x[first..first + BLOCK_NODES].as_flattened();
            for (y, &x) in part.as_flattened_mut().iter_mut().zip(x) {
                *y = if b == T::zero() { a * x } else { a * x + b * *y };
            }
        });
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
        if self.folds.is_empty() {
            self.add_hessian(u, out);
            return;
        }
        let mut reflected = std::mem::take(&mut self.reflected);
        reflected.clone_from(u);
        mirror::reflect_out::<_, T, D>(self.folds, &mut reflected[..]);
        self.add_hessian(&reflected, out);
        self.reflected = reflected;
    }

    fn folded_hessian(&mut self, u: &Self::Vector, out: &mut Self::Vector) {
        self.hessian(u, out);
        mirror::fold_in::<_, T, D>(self.folds, &mut out[..]);
        self.for_blocks(out, |first, part| {
            for (out, &mass) in part.iter_mut().zip(&self.mass[first..]) {
                if mass == T::zero() {
                    *out = [T::zero(); CHANNELS];
                }
            }
        });
    }

    fn matrix(&mut self, u: &Self::Vector, out: &mut Self::Vector) {
        self.hessian(u, out);
        mirror::fold_in::<_, T, D>(self.folds, &mut out[..]);
        let c = T::of(self.c);
        self.for_blocks(out, |first, part| {
            for (k, out) in part.iter_mut().enumerate() {
                let (u, mass) = (&u[first + k], self.mass[first + k]);
                let c = if mass > T::zero() { c } else { T::zero() };
                for k in 0..CHANNELS {
                    out[k] = out[k] * c + u[k] * mass;
                }
            }
        });
    }

    fn hold(&mut self, released: &Released) -> Option<Self::Vector> {
        let System { fast, scene, mass, start, pushed, time, .. } = &*self;
        let (grid, time) = (&fast.grid, *time);
        let near = (0..grid.blocks()).filter(|&block| {
            is_near(&scene.colliders, &surroundings(grid.first_node(block), scene.spacing), time)
        });
        let moving = near
            .flat_map(|block| block * BLOCK_NODES..(block + 1) * BLOCK_NODES)
            .filter(|&node| mass[node] > T::zero());
        let explicit = moving.map(|node| {
            let velocity = vector::<T, D>(&start[node]) + vector::<T, D>(&pushed[node]) / mass[node];
            (node, self.place(node), velocity)
        });
        let on_planes = mirror::nodes_on_planes(self.folds);
        let held = held_nodes(&scene.colliders, explicit, on_planes, time, released);
        let mut known = vec![[T::zero(); CHANNELS]; self.mass.len()];
        for held in &held {
            known[held.node] = node(&held.change_from(&vector(&self.start[held.node])));
        }
        let any = held.iter().any(|held| known[held.node] != [T::zero(); CHANNELS]);
        self.held = held;
        any.then_some(known)
    }

    fn project(&self, u: &mut Self::Vector) {
        for held in &self.held {
            u[held.node] = node(&(held.free * vector::<T, D>(&u[held.node])));
        }
    }

    fn release(&self, change: &Self::Vector, image: &Self::Vector, released: &mut Released) -> bool {
        let mut folded = image.clone();
        mirror::fold_in::<_, T, D>(self.folds, &mut folded[..]);
        let push = |node: usize| {
            let of = |field: &[Node<T>]| vector::<T, D>(&field[node]);
            of(change) + (of(&folded) - of(&self.pushed)) / self.mass[node]
        };
        release(self.scene, &self.held, |node| self.place(node), push, self.time, self.dt, released)
    }
}

impl<T: Real, const D: usize> System<'_, T, D> {
    /// Where a node is [m].
    fn place(&self, node: usize) -> Vector<T, D> {
        let first = self.fast.grid.first_node(node / BLOCK_NODES);
        let coordinates = node_coordinates(first, node % BLOCK_NODES);
        Vector::from_fn(|k, _| T::of_index(coordinates[k]) * self.scene.spacing)
    }
}

impl<T: Real, const D: usize> Fast<T, D> {
    /// Adds to the nodes' forces what they change by over an implicit step of `dt` [s] from `time` [s]; sums are folded before and after.
    ///
    /// # Errors
    /// A solve that has not converged.
    pub(super) fn add_implicit_forces(
        &mut self,
        scene: &Scene<T, D>,
        coefficients: Coefficients,
        how: &LinearSolve,
        [time, dt]: [f64; 2],
        ledger: &mut StepLedger<D>,
    ) -> Result<(), Rejection> {
        let mut tangents = std::mem::take(&mut self.tangents);
        self.linearise(scene, how, &mut tangents);
        let c = coefficients.of_change;
        let (gravity, dt_t) = (node(&scene.gravity), T::of(dt));
        let nodes = || self.grid.sums.iter().zip(&self.grid.forces);
        let mass: Vec<T> =
            nodes().map(|(sums, _)| if sums[D] > self.empty { sums[D] } else { T::zero() }).collect();
        let held = |holds: bool, of: &dyn Fn(usize) -> T| -> Node<T> {
            std::array::from_fn(|k| if k < D && holds { of(k) } else { T::zero() })
        };
        let of_start = |(sums, _): (&Node<T>, _)| held(sums[D] > self.empty, &|k| sums[k] / sums[D]);
        let start = nodes().map(of_start).collect();
        let of_push = |(sums, force): (&Node<T>, &Node<T>)| {
            held(sums[D] > self.empty, &|k| (force[k] + gravity[k] * sums[D]) * dt_t)
        };
        let pushed = nodes().map(of_push).collect();
        let per_mass = |&m: &T| if m > T::zero() { T::one() / m } else { T::zero() };
        let per_mass = mass.iter().map(per_mass).collect();
        let mut system = System {
            fast: self,
            scene,
            tangents: &tangents,
            folds: &self.folds,
            held: Vec::new(),
            mass,
            per_mass,
            start,
            pushed,
            reflected: Vec::new(),
            c,
            time,
            dt,
        };
        let (image, solution) = solve_step(&mut system, coefficients, how);
        self.tangents = tangents;
        solution.accept(how, ledger)?;
        mirror::restore_sums(&self.folds, &mut self.grid);
        let per_step = T::of(-1.0 / dt);
        for (force, image) in self.grid.forces.iter_mut().zip(&image) {
            for k in 0..D {
                force[k] += image[k] * per_step;
            }
        }
        mirror::fold(&self.mirrors, &mut self.grid, &scene.gravity, &mut self.folds);
        Ok(())
    }

    /// The tangents of all particles, times V_p.
    fn linearise(&self, scene: &Scene<T, D>, how: &LinearSolve, tangents: &mut Vec<[T; CHUNK]>) {
        let Fast { set, kernels, particles, materials, pool, .. } = self;
        let over =
            if scene.transfer == Transfer::Mls { T::of(scene.kernel.inverse_inertia()) } else { T::one() };
        let over = over / scene.spacing;
        let linearisation = Linearisation { per_spacing_squared: over * over, definite: how.definite };
        let (stride, width) = (particles.layout.fields(), tangent_fields::<D>());
        tangents.resize(particles.labels.len() * width, [T::zero(); CHUNK]);
        let shared = Shared::new(tangents);
        pool.run(
            particles.blocks.len(),
            1,
            || (),
            |(), home| {
                let chunks = particles.blocks[home].chunk_range();
                let fields = &particles.fields[chunks.start * stride..chunks.end * stride];
                #[expect(unsafe_code, reason = "tasks write to chunks of their own")]
                // SAFETY: every chunk belongs to one block, and every block to one task.
                let tangents = unsafe { shared.range(chunks.start * width, chunks.len() * width) };
                let labels = &particles.labels[chunks];
                (kernels.linearise)(
                    *set,
                    fields,
                    labels,
                    particles.layout,
                    materials,
                    &linearisation,
                    tangents,
                );
            },
        );
    }
}
