//! The fast engine's step: the stages of `step.rs`, each over blocks on all threads.

use super::dispatch::{Kernels, Set};
use super::grid::{BLOCK_NODES, BlockGrid, Node, block_edge};
use super::nodes::{NodeEnergies, Push, node_position};
use super::particles::Particles;
use super::pool::{Pool, Shared};
use super::simd::CHANNELS;
use super::transfer::{Scratch, Terms};
use super::update::{BlockReport, MaterialNumbers, Update, is_near, surroundings};
use crate::collision::{Contact, Interval, MirrorPlane, collide_node};
use crate::diagnostics;
use crate::error::{Rejection, SceneError};
use crate::geometry::Vector;
use crate::grid::NodeMotion;
use crate::ledger::StepLedger;
use crate::mirror::{self, Fold};
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;
use crate::timestep::{fastest_particle_squared, fastest_wave_squared};
use crate::watchdog::StoredEnergy;

/// Particles are sorted anew after so many steps, or when one leaves what its block's tile allows for (chosen: a sort costs a few steps'
/// worth; in 16 steps most particles are still in their cells).
const SORT_INTERVAL: usize = 16;

/// All that there is to the particles between two steps.
#[derive(Clone, Debug)]
pub(crate) struct Saved<T: Real, const D: usize> {
    particles: Particles<T, D>,
    kinetic: f64,
    fastest: [T; 2],
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
    set: Set,
    kernels: &'static Kernels<T, D>,
    pool: Pool,
    /// Whether it holds the particles of a run.
    loaded: bool,
    materials: Vec<MaterialNumbers<T>>,
    mirrors: Vec<(usize, MirrorPlane)>,
    folds: Vec<Fold<T, D>>,
    empty: T,
    particles: Particles<T, D>,
    /// As they were before the last sort, and the steps since: to go back to where a refused step began, for steps write over what they
    /// read.
    before: Particles<T, D>,
    taken: Vec<Taken>,
    grid: BlockGrid<T, D>,
    strayed: bool,
    /// Kinetic energy of the particles [J].
    kinetic: f64,
    fastest_wave_squared: T,
    fastest_squared: T,
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
            grid: BlockGrid::default(),
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
        self.empty = T::of(if state.is_empty() { 0.0 } else { lightest * T::EMPTY_NODE_SHARE });
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
        self.taken.clear();
        true
    }

    /// A copy of the particles.
    pub fn save(&self) -> Saved<T, D> {
        Saved { particles: self.particles.clone(), kinetic: self.kinetic, fastest: self.fastest() }
    }

    /// Goes back to a copy.
    pub fn restore(&mut self, scene: &Scene<T, D>, saved: Saved<T, D>) {
        self.before = saved.particles;
        self.kinetic = saved.kinetic;
        [self.fastest_wave_squared, self.fastest_squared] = saved.fastest;
        self.settle(scene);
        self.loaded = true;
    }

    /// Elastic and potential energy, where `origin` is the world position of the local one.
    pub fn stored_energy(&self, scene: &Scene<T, D>, origin: &Vector<f64, D>) -> StoredEnergy {
        let Particles { layout, fields, labels, blocks } = &self.particles;
        let mut energies = vec![StoredEnergy::default(); blocks.len()];
        let shared = Shared::new(&mut energies);
        self.pool.run(
            blocks.len(),
            || (),
            |_, home| {
                let block = &blocks[home];
                let chunks = block.first_chunk..block.first_chunk + block.chunks();
                let fields = &fields[chunks.start * layout.fields()..chunks.end * layout.fields()];
                let (labels, materials, gravity) = (&labels[chunks], &self.materials, &scene.gravity);
                let energy = (self.kernels.stored_energy)(
                    self.set, fields, labels, *layout, materials, gravity, origin,
                );
                #[expect(unsafe_code, reason = "tasks write to numbers of their own")]
                // SAFETY: every block belongs to one task.
                unsafe {
                    shared.range(home, 1)[0] = energy;
                }
            },
        );
        energies.iter().fold(StoredEnergy::default(), |sum, part| StoredEnergy {
            elastic: sum.elastic + part.elastic,
            potential: sum.potential + part.potential,
        })
    }

    /// Bytes of particles and grid in store.
    pub fn bytes(&self) -> usize {
        self.particles.bytes() + self.before.bytes() + self.grid.bytes()
    }

    /// Sorts `before` into `particles` and places the grid round them.
    fn settle(&mut self, scene: &Scene<T, D>) {
        self.before.sort(scene, &mut self.particles, &self.pool);
        self.grid.place(&self.particles.blocks);
        self.strayed = false;
        self.taken.clear();
    }

    fn sort_if_due(&mut self, scene: &Scene<T, D>) {
        if self.strayed || self.taken.len() >= SORT_INTERVAL {
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
        self.sort_if_due(scene);
        let apart =
            energies || scene.energy_budget || !scene.transfer.keeps_affine() || !self.mirrors.is_empty();
        let step = Taken { time, dt, apart };
        match self.take(scene, step) {
            Ok(ledger) => {
                self.taken.push(step);
                Ok(ledger)
            }
            Err(rejection) => {
                self.go_back(scene);
                Err(rejection)
            }
        }
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
        self.push_nodes(scene, time, dt_t, apart, &mut ledger);
        mirror::unfold(&self.folds, &mut self.grid, &scene.gravity, dt_t, share_t, &mut ledger);
        if apart {
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
        self.push_nodes(&Scene { colliders: Vec::new(), ..scene.clone() }, 0.0, T::zero(), true, &mut ledger);
        ledger.kinetic_grid_before
    }

    /// Stages 1 and 2. Blocks whose tiles have no node in common go side by side, so that every node adds up in the same order however many
    /// threads there are.
    fn particles_to_grid(&mut self, scene: &Scene<T, D>, dt: T, apart: bool) {
        self.grid.make_room(apart);
        self.grid.clear(apart, &self.pool);
        let terms = Terms {
            spacing: scene.spacing,
            dt,
            inverse_inertia: T::of(scene.kernel.inverse_inertia()),
            apart,
        };
        let (mut sums, mut forces) =
            (std::mem::take(&mut self.grid.sums), std::mem::take(&mut self.grid.forces));
        let (shared_sums, shared_forces) = (Shared::new(&mut sums), Shared::new(&mut forces));
        for colour in &self.grid.colours {
            self.pool.run(colour.len(), Scratch::new::<D>, |scratch, number| {
                let home = colour[number] as usize;
                (self.kernels.scatter_block)(
                    self.set,
                    scene,
                    &self.particles,
                    &self.materials,
                    home,
                    &terms,
                    scratch,
                );
                #[expect(
                    unsafe_code,
                    reason = "tiles are added to nodes that other threads add to at other times"
                )]
                self.grid.for_tile_runs(home, &mut |tile, node, count| {
                    // SAFETY: the tiles of a colour have no node in common.
                    unsafe { add_run(&scratch.tile, tile, shared_sums.range(node, count)) };
                    if apart {
                        // SAFETY: as above.
                        unsafe { add_run(&scratch.second_tile, tile, shared_forces.range(node, count)) };
                    }
                });
            });
        }
        (self.grid.sums, self.grid.forces) = (sums, forces);
    }

    /// Stages 3 to 5 but for mirrors.
    fn push_nodes(&mut self, scene: &Scene<T, D>, time: f64, dt: T, apart: bool, ledger: &mut StepLedger<D>) {
        let push = Push { gravity: scene.gravity, dt, empty: self.empty, apart };
        let (set, kernels, grid) = (self.set, self.kernels, &mut self.grid);
        let blocks = grid.blocks();
        let mut reports: Vec<(NodeEnergies, Option<Box<StepLedger<D>>>)> =
            vec![(NodeEnergies::default(), None); blocks];
        let obstacles = scene.colliders.iter().any(|c| c.contact != Contact::Mirror);
        let mut motion = std::mem::take(&mut grid.motion);
        let mut change = std::mem::take(&mut grid.change);
        {
            let (motion, change, reports) =
                (Shared::new(&mut motion), Shared::new(&mut change), Shared::new(&mut reports));
            let grid = &*grid;
            // chosen: tasks of a thousand nodes.
            const BLOCKS: usize = 16;
            self.pool.run(
                blocks.div_ceil(BLOCKS),
                || (),
                |_, task| {
                    for block in task * BLOCKS..blocks.min((task + 1) * BLOCKS) {
                        let first = block * BLOCK_NODES;
                        let nodes = first..first + BLOCK_NODES;
                        let apart_nodes = if apart { nodes.clone() } else { 0..0 };
                        let changes = if apart && D == 3 { BLOCK_NODES } else { 0 };
                        #[expect(unsafe_code, reason = "tasks write to blocks of their own")]
                        // SAFETY: every block belongs to one task.
                        let (motion, change, report) = unsafe {
                            (
                                motion.range(first, BLOCK_NODES),
                                change.range(if changes == 0 { 0 } else { first }, changes),
                                &mut reports.range(block, 1)[0],
                            )
                        };
                        let sums = &grid.sums[nodes];
                        report.0 =
                            (kernels.push_nodes)(set, &push, sums, &grid.forces[apart_nodes], motion, change);
                        if !obstacles {
                            continue;
                        }
                        let corner = grid.first_node(block);
                        if !is_near(&scene.colliders, &surroundings(corner, scene.spacing), time) {
                            continue;
                        }
                        let mut contact = StepLedger::new(scene.colliders.len());
                        for local in 0..BLOCK_NODES {
                            let mass = sums[local][D];
                            if mass <= push.empty {
                                continue;
                            }
                            let x = node_position(corner, local, scene.spacing);
                            let mut node = read_motion::<T, D>(motion, change, local, apart);
                            collide_node(scene, &x, mass, &mut node, time, &mut contact);
                            write_motion(motion, change, local, apart, &node);
                        }
                        report.1 = Some(Box::new(contact));
                    }
                },
            );
        }
        (grid.motion, grid.change) = (motion, change);
        for (energies, contact) in &reports {
            ledger.kinetic_grid_before += energies.before;
            ledger.dropped_mass += energies.dropped_mass;
            if let Some(contact) = contact {
                ledger.add_contact(contact);
            }
        }
    }

    fn kinetic_of_motion(&self) -> f64 {
        let mut energies = vec![0.0; self.grid.blocks()];
        let shared = Shared::new(&mut energies);
        const BLOCKS: usize = 32;
        let blocks = self.grid.blocks();
        self.pool.run(
            blocks.div_ceil(BLOCKS),
            || (),
            |_, task| {
                for block in task * BLOCKS..blocks.min((task + 1) * BLOCKS) {
                    let nodes = block * BLOCK_NODES..(block + 1) * BLOCK_NODES;
                    let energy = (self.kernels.kinetic_energy)(
                        self.set,
                        &self.grid.sums[nodes.clone()],
                        &self.grid.motion[nodes],
                    );
                    #[expect(unsafe_code, reason = "tasks write to numbers of their own")]
                    // SAFETY: every block belongs to one task.
                    unsafe {
                        shared.range(block, 1)[0] = energy;
                    }
                }
            },
        );
        energies.iter().sum()
    }

    /// Stages 6 to 9.
    fn grid_to_particles(
        &mut self,
        scene: &Scene<T, D>,
        share: Option<T>,
        interval: Interval<T>,
        ledger: &mut StepLedger<D>,
    ) -> Result<(), Rejection> {
        let update = Update {
            scene,
            materials: &self.materials,
            share,
            inverse_inertia: T::of(scene.kernel.inverse_inertia()),
            interval,
        };
        let Particles { layout, fields, labels, blocks } = &mut self.particles;
        let (layout, blocks) = (*layout, &*blocks);
        let mut reports = vec![BlockReport::<T, D>::new(); blocks.len()];
        {
            let (fields, labels, reports) =
                (Shared::new(fields), Shared::new(labels), Shared::new(&mut reports));
            let (grid, set, kernels) = (&self.grid, self.set, self.kernels);
            let copies_change = share.is_some() && D == 3;
            self.pool.run(blocks.len(), Scratch::new::<D>, |scratch, home| {
                let block = &blocks[home];
                #[expect(unsafe_code, reason = "tasks write to chunks of their own")]
                // SAFETY: every chunk belongs to one block, and every block to one task.
                let (fields, labels, report) = unsafe {
                    (
                        fields.range(block.first_chunk * layout.fields(), block.chunks() * layout.fields()),
                        labels.range(block.first_chunk, block.chunks()),
                        &mut reports.range(home, 1)[0],
                    )
                };
                grid.for_tile_runs(home, &mut |tile, node, count| {
                    copy_run(&grid.motion[node..node + count], tile, &mut scratch.tile);
                    if copies_change {
                        copy_run(&grid.change[node..node + count], tile, &mut scratch.second_tile);
                    }
                });
                let first_node = block.corner.map(|n| n * block_edge::<D>());
                let reach = surroundings(first_node, scene.spacing);
                if is_near(&scene.colliders, &reach, interval.arrival) {
                    report.contact = Some(Box::new(StepLedger::new(scene.colliders.len())));
                }
                (kernels.gather_block)(set, &update, layout, block, fields, labels, scratch, report);
            });
        }
        if let Some((particle, reason)) = reports.iter().find_map(|report| report.rejection) {
            return Err(Rejection { particle, reason });
        }
        (self.fastest_wave_squared, self.fastest_squared, self.kinetic) = (T::zero(), T::zero(), 0.0);
        let grid_loss = ledger.contact_loss();
        for report in &reports {
            self.kinetic += report.kinetic;
            ledger.plastic_loss += report.plastic_loss;
            ledger.clamps += report.clamps;
            self.strayed |= report.strayed;
            if report.fastest_wave_squared > self.fastest_wave_squared {
                self.fastest_wave_squared = report.fastest_wave_squared;
            }
            if report.fastest_squared > self.fastest_squared {
                self.fastest_squared = report.fastest_squared;
            }
            if let Some(contact) = &report.contact {
                ledger.add_contact(contact);
            }
        }
        ledger.particle_contact_loss = ledger.contact_loss() - grid_loss;
        Ok(())
    }

    /// Mass [kg], momentum [kg m/s] and force [N] of all nodes, after [`Fast::kinetic_on_grid`].
    #[cfg(test)]
    pub fn grid_totals(&self) -> (f64, Vector<f64, D>, Vector<f64, D>) {
        let sum = |nodes: &[Node<T>], channel: usize| nodes.iter().map(|node| node[channel].as_f64()).sum();
        let (sums, forces) = (&self.grid.sums, &self.grid.forces);
        (sum(sums, D), Vector::from_fn(|k, _| sum(sums, k)), Vector::from_fn(|k, _| sum(forces, k)))
    }
}

/// Adds `nodes.len()` nodes of the tile from `first` on.
#[inline(always)]
fn add_run<T: Real>(tile: &[T], first: usize, nodes: &mut [Node<T>]) {
    let tile = &tile[first * CHANNELS..];
    for (sum, value) in nodes.as_flattened_mut().iter_mut().zip(tile) {
        *sum += *value;
    }
}

#[inline(always)]
fn copy_run<T: Real>(nodes: &[Node<T>], first: usize, tile: &mut [T]) {
    let nodes = nodes.as_flattened();
    tile[first * CHANNELS..][..nodes.len()].copy_from_slice(nodes);
}

fn read_motion<T: Real, const D: usize>(
    motion: &[Node<T>],
    change: &[Node<T>],
    local: usize,
    apart: bool,
) -> NodeMotion<T, D> {
    let mut node = NodeMotion::still();
    for k in 0..D {
        node.velocity[k] = motion[local][k];
        if apart {
            node.change[k] = if D == 2 { motion[local][2 + k] } else { change[local][k] };
        }
    }
    node
}

fn write_motion<T: Real, const D: usize>(
    motion: &mut [Node<T>],
    change: &mut [Node<T>],
    local: usize,
    apart: bool,
    node: &NodeMotion<T, D>,
) {
    for k in 0..D {
        motion[local][k] = node.velocity[k];
        if apart {
            let place = if D == 2 { &mut motion[local][2 + k] } else { &mut change[local][k] };
            *place = node.change[k];
        }
    }
}
