//! The fast engine's step: the stages of `../step.rs` in their order, sorting, and going back. The stages themselves are in `stages.rs`.

use serde::{Deserialize, Serialize};

use super::dispatch::{Kernels, Set};
use super::grid::BlockGrid;
#[cfg(test)]
use super::grid::Node;
use super::material::MaterialNumbers;
use super::particles::{Layout, Particles};
use super::pool::Pool;
use super::simd::CHUNK;
use crate::collision::{Interval, MirrorPlane};
use crate::diagnostics;
use crate::error::{Rejection, SceneError};
use crate::geometry::Vector;
use crate::implicit::Coefficients;
use crate::ledger::StepLedger;
use crate::mirror::{self, Fold};
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;
use crate::timestep::{fastest_particle_squared, fastest_wave_squared};

/// Particles are sorted anew after so many steps, or when one leaves what its block's tile allows for (chosen: a sort costs a few steps'
/// worth; in 16 steps most particles are still in their cells).
const SORT_INTERVAL: usize = 16;

/// All that there is to the particles between two steps.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct Saved<T: Real, const D: usize> {
    particles: Particles<T, D>,
    kinetic: f64,
    fastest: [T; 2],
}

impl<T: Real, const D: usize> Saved<T, D> {
    /// The number of particles.
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// Whether the particles lie as the engine keeps those of `scene`.
    pub fn is_consistent(&self, scene: &Scene<T, D>) -> bool {
        self.particles.is_consistent(scene)
    }

    /// Writes the particles to `state`.
    pub fn write(&self, scene: &Scene<T, D>, state: &mut State<T, D>) {
        self.particles.write(scene, state);
    }
}

/// A step since the last sort, to be taken again.
#[derive(Clone, Copy, Debug)]
struct Taken {
    time: f64,
    dt: f64,
    apart: bool,
}

/// The particles of a run and all that a step needs beside them.
#[derive(Clone, Debug)]
pub(crate) struct Fast<T: Real, const D: usize> {
    pub(super) set: Set,
    pub(super) kernels: &'static Kernels<T, D>,
    pub(super) pool: Pool,
    /// Whether it holds the particles of a run.
    loaded: bool,
    pub(super) materials: Vec<MaterialNumbers<T>>,
    pub(super) mirrors: Vec<(usize, MirrorPlane)>,
    pub(super) folds: Vec<Fold<T, D>>,
    /// A node of no more mass counts as empty [kg].
    pub(super) empty: T,
    pub(super) particles: Particles<T, D>,
    /// As they were before the last sort, and the steps since: to go back to where a refused step began, for steps write over what they
    /// read.
    before: Particles<T, D>,
    taken: Vec<Taken>,
    /// Steps since the last sort that cannot be taken again.
    since_sort: usize,
    pub(super) grid: BlockGrid<T, D>,
    /// Of the particles in an implicit step, see `hessian.rs`.
    pub(super) tangents: Vec<[T; CHUNK]>,
    pub(super) strayed: bool,
    /// Kinetic energy of the particles [J].
    pub(super) kinetic: f64,
    pub(super) fastest_wave_squared: T,
    pub(super) fastest_squared: T,
}

impl<T: Real, const D: usize> Fast<T, D> {
    /// An engine without particles, where the CPU has what it takes.
    ///
    /// # Errors
    /// A mirror that is none.
    pub fn new(scene: &Scene<T, D>, threads: usize) -> Result<Option<Self>, SceneError> {
        let Some(set) = Set::widest() else { return Ok(None) };
        Ok(Some(Fast {
            set,
            kernels: Kernels::get(),
            pool: Pool::new(threads),
            loaded: false,
            materials: scene.materials.iter().map(MaterialNumbers::of::<D>).collect(),
            mirrors: mirror::planes(scene)?,
            folds: Vec::new(),
            empty: T::zero(),
            particles: Particles::default(),
            before: Particles::default(),
            taken: Vec::new(),
            since_sort: 0,
            grid: BlockGrid::default(),
            tangents: Vec::new(),
            strayed: false,
            kinetic: 0.0,
            fastest_wave_squared: T::zero(),
            fastest_squared: T::zero(),
        }))
    }

    /// Takes another instruction set than the widest.
    #[cfg(test)]
    pub fn set_instructions(&mut self, set: Set) {
        self.set = set;
    }

    /// Takes over the particles of `state`.
    pub fn load(&mut self, scene: &Scene<T, D>, state: &State<T, D>) {
        let lightest = state.constants.mass.iter().fold(f64::INFINITY, |m, mass| m.min(mass.as_f64()));
        self.set_empty(if state.is_empty() { 0.0 } else { lightest });
        self.before = Particles::of(scene, state);
        self.kinetic = diagnostics::kinetic_energy(scene, &state.motion, &state.constants);
        self.fastest_wave_squared = fastest_wave_squared(scene, state);
        self.fastest_squared = fastest_particle_squared(&state.motion.velocity);
        self.settle(scene);
        self.loaded = true;
    }

    /// Whether it holds the particles of a run.
    pub fn is_loaded(&self) -> bool {
        self.loaded
    }

    /// Holds no particles any more.
    pub fn unload(&mut self) {
        self.loaded = false;
    }

    /// Writes the particles to `state`.
    pub fn write(&self, scene: &Scene<T, D>, state: &mut State<T, D>) {
        self.particles.write(scene, state);
    }

    /// max c_p^2 and max |v_p|^2 [m^2/s^2].
    pub fn fastest(&self) -> [T; 2] {
        [self.fastest_wave_squared, self.fastest_squared]
    }

    /// Gives each particle the acceleration that `of` tells for its id; `false` where the particles have no room for any.
    pub fn accelerate(&mut self, of: &impl Fn(u32) -> Vector<T, D>) -> bool {
        if !self.particles.accelerate(of) {
            return false;
        }
        // Steps with other forces cannot be taken again: a refused step comes back here.
        self.before.clone_from(&self.particles);
        self.since_sort += self.taken.len();
        self.taken.clear();
        true
    }

    /// A copy of the particles.
    pub fn save(&self) -> Saved<T, D> {
        Saved { particles: self.particles.clone(), kinetic: self.kinetic, fastest: self.fastest() }
    }

    /// Whether the next step begins by sorting, and with that forgets all but the particles.
    pub fn is_about_to_sort(&self) -> bool {
        self.loaded && (self.strayed || self.since_sort + self.taken.len() >= SORT_INTERVAL)
    }

    /// Takes up a run that was put away when it was about to sort.
    pub fn take_up(&mut self, saved: Saved<T, D>) {
        let masses = saved.particles.places().map(|(chunk, lane)| {
            saved.particles.fields[chunk * saved.particles.layout.fields() + Layout::<D>::MASS][lane].as_f64()
        });
        let lightest = masses.fold(f64::INFINITY, f64::min);
        self.set_empty(if saved.particles.len() == 0 { 0.0 } else { lightest });
        self.particles = saved.particles;
        // From wherever they are: the blocks of a file are not relied upon. The order is the same.
        self.particles.placed = false;
        self.kinetic = saved.kinetic;
        [self.fastest_wave_squared, self.fastest_squared] = saved.fastest;
        self.strayed = true;
        self.loaded = true;
    }

    fn set_empty(&mut self, lightest: f64) {
        self.empty = T::of(lightest * T::EMPTY_NODE_SHARE);
    }

    /// Goes back to a copy.
    pub fn restore(&mut self, scene: &Scene<T, D>, saved: Saved<T, D>) {
        self.before = saved.particles;
        self.kinetic = saved.kinetic;
        [self.fastest_wave_squared, self.fastest_squared] = saved.fastest;
        self.settle(scene);
        self.loaded = true;
    }

    /// Bytes of particles and grid in store.
    pub fn bytes(&self) -> usize {
        self.particles.bytes()
            + self.before.bytes()
            + self.grid.bytes()
            + std::mem::size_of_val(&self.tangents[..])
    }

    /// Sorts `before` into `particles` and places the grid round them.
    fn settle(&mut self, scene: &Scene<T, D>) {
        self.before.sort(scene, &mut self.particles, &self.pool, self.set, self.kernels);
        self.grid.place(&self.particles.blocks);
        self.strayed = false;
        self.since_sort = 0;
        self.taken.clear();
    }

    fn sort_if_due(&mut self, scene: &Scene<T, D>) {
        if self.is_about_to_sort() {
            std::mem::swap(&mut self.before, &mut self.particles);
            self.settle(scene);
        }
    }

    /// Advances by `dt` [s] from `time` [s]. With `energies` transfer losses are booked; a FLIP step books them anyhow.
    ///
    /// # Errors
    /// A step that inverts an element or moves a particle more than a cell; the particles are then what they were.
    pub fn step(
        &mut self,
        scene: &Scene<T, D>,
        time: f64,
        dt: f64,
        energies: bool,
    ) -> Result<StepLedger<D>, Rejection> {
        let apart = energies
            || scene.energy_budget
            || !scene.transfer.keeps_affine()
            || !self.mirrors.is_empty()
            || Coefficients::of(&scene.integrator, dt).is_some();
        let step = Taken { time, dt, apart };
        self.pool.clone().enter(|| {
            self.sort_if_due(scene);
            let result = self.take(scene, step);
            match result {
                Ok(_) => self.taken.push(step),
                Err(_) => self.go_back(scene),
            }
            result
        })
    }

    /// Takes the steps since the last sort again, bit by bit as they were.
    fn go_back(&mut self, scene: &Scene<T, D>) {
        let taken = std::mem::take(&mut self.taken);
        self.settle(scene);
        for &step in &taken {
            self.take(scene, step).expect("a step that was accepted before");
        }
        self.taken = taken;
    }

    fn take(&mut self, scene: &Scene<T, D>, step: Taken) -> Result<StepLedger<D>, Rejection> {
        let Taken { time, dt, apart } = step;
        let mut ledger = StepLedger::new(scene.colliders.len());
        let share = scene.transfer.flip_share(dt);
        let (dt_t, share_t) = (T::of(dt), T::of(share.unwrap_or(0.0)));
        ledger.damping = share.map_or(0.0, |a| 1.0 - a);
        ledger.kinetic_particles_before = self.kinetic;

        self.particles_to_grid(scene, dt_t, apart);
        mirror::fold(&self.mirrors, &mut self.grid, &scene.gravity, &mut self.folds);
        if let Some((coefficients, how)) = Coefficients::and_solve(&scene.integrator, dt) {
            self.add_implicit_forces(scene, coefficients, how, [time, dt], &mut ledger)?;
        }
        self.push_nodes(scene, Some(time), dt_t, apart, &mut ledger);
        mirror::unfold(&self.folds, &mut self.grid, &scene.gravity, dt_t, share_t, &mut ledger);
        if apart && !self.mirrors.is_empty() {
            ledger.kinetic_grid_after = self.kinetic_of_motion();
        }
        self.grid_to_particles(
            scene,
            share.map(T::of),
            Interval { arrival: time + dt, dt: dt_t },
            &mut ledger,
        )?;
        ledger.kinetic_particles_after = self.kinetic;
        Ok(ledger)
    }

    /// Kinetic energy as the grid sees it after particles to grid [J].
    pub fn kinetic_on_grid(&mut self, scene: &Scene<T, D>) -> f64 {
        self.sort_if_due(scene);
        self.particles_to_grid(scene, T::zero(), true);
        mirror::fold(&self.mirrors, &mut self.grid, &scene.gravity, &mut self.folds);
        let mut ledger = StepLedger::new(scene.colliders.len());
        self.push_nodes(scene, None, T::zero(), true, &mut ledger);
        ledger.kinetic_grid_before
    }

    /// The ids in the order in which the particles would be sorted now; from wherever they are, or block by block.
    #[cfg(test)]
    pub fn sorted_ids(&self, scene: &Scene<T, D>, from_anywhere: bool) -> Vec<Vec<u32>> {
        let (mut now, mut sorted) = (self.particles.clone(), Particles::default());
        now.placed = !from_anywhere;
        now.sort(scene, &mut sorted, &self.pool, self.set, self.kernels);
        let ids = |block: &super::particles::Block<D>| {
            let labels = sorted.labels[block.first_chunk..block.first_chunk + block.chunks()].as_flattened();
            labels[..block.particles].iter().map(|label| label.id).collect()
        };
        sorted.blocks.iter().map(ids).collect()
    }

    /// Mass [kg], momentum [kg m/s] and force [N] of all nodes, after [`Fast::kinetic_on_grid`].
    #[cfg(test)]
    pub fn grid_totals(&self) -> (f64, Vector<f64, D>, Vector<f64, D>) {
        let sum = |nodes: &[Node<T>], channel: usize| nodes.iter().map(|node| node[channel].as_f64()).sum();
        let (sums, forces) = (&self.grid.sums, &self.grid.forces);
        (sum(sums, D), Vector::from_fn(|k, _| sum(sums, k)), Vector::from_fn(|k, _| sum(forces, k)))
    }
}
