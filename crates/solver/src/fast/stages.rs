//! The stages of a step over blocks, each on all threads.

use super::batch::Scratch;
use super::contact::{is_near, surroundings};
use super::gather::End;
use super::grid::{BLOCK_NODES, BlockGrid, add_run, block_edge, copy_run};
use super::nodes::{NodeEnergies, Push, collide_nodes};
use super::particles::Particles;
use super::pool::Shared;
use super::scatter::Terms;
use super::simd::CHANNELS;
use super::step::Fast;
use super::update::{BlockReport, Update};
use crate::collision::{Contact, Interval};
use crate::error::Rejection;
use crate::geometry::Vector;
use crate::ledger::StepLedger;
use crate::real::Real;
use crate::scene::{Integrator, Scene};
use crate::watchdog::StoredEnergy;

/// Blocks of nodes that a task takes at least (chosen: a thousand nodes are long beside the cost of handing out a task).
const LEAST_BLOCKS: usize = 16;

impl<T: Real, const D: usize> Fast<T, D> {
    /// Stages 1 and 2. The tiles of blocks are added up colour by colour, so that every node adds up in the same order however many threads
    /// there are.
    pub(super) fn particles_to_grid(&mut self, scene: &Scene<T, D>, dt: T, apart: bool) {
        self.grid.make_room(apart);
        self.grid.clear(&self.pool);
        let terms = Terms {
            spacing: scene.spacing,
            dt,
            inverse_inertia: T::of(scene.kernel.inverse_inertia()),
            apart,
        };
        let (mut sums, mut forces) =
            (std::mem::take(&mut self.grid.sums), std::mem::take(&mut self.grid.forces));
        let (shared_sums, shared_forces) = (Shared::new(&mut sums), Shared::new(&mut forces));
        let Fast { set, kernels, particles, materials, grid, .. } = &*self;
        let scatter = |scratch: &mut Scratch<T>, number: usize| {
            let home = grid.order[number].home as usize;
            (kernels.scatter_block)(*set, scene, particles, materials, home, &terms, scratch);
        };
        let add = |scratch: &mut Scratch<T>, number: usize| {
            #[expect(
                unsafe_code,
                reason = "tiles are added to nodes that other threads add to at other times"
            )]
            grid.for_tile_runs(grid.order[number].home as usize, &mut |tile, node, count| {
                // SAFETY: only tiles of one colour are added at the same time, which have no node in common.
                unsafe { add_run(&scratch.tile, tile, shared_sums.range(node, count)) };
                if apart {
                    // SAFETY: as above.
                    unsafe { add_run(&scratch.second_tile, tile, shared_forces.range(node, count)) };
                }
            });
        };
        let turn = |number: usize| grid.order[number].after as usize;
        self.pool.run_in_turns(grid.order.len(), turn, Scratch::new::<D>, scatter, add);
        (self.grid.sums, self.grid.forces) = (sums, forces);
        self.grid.needs_clearing = true;
    }

    /// Stages 3 to 5 but for mirrors; without contact where there is no `time` to look for obstacles at. Empties the nodes for the next
    /// step where nobody needs them any more.
    pub(super) fn push_nodes(
        &mut self,
        scene: &Scene<T, D>,
        time: Option<f64>,
        dt: T,
        apart: bool,
        ledger: &mut StepLedger<D>,
    ) {
        let push = Push { gravity: scene.gravity, dt, empty: self.empty, apart };
        let sums_are_done_with = time.is_some() && self.mirrors.is_empty();
        let time = time.filter(|_| scene.colliders.iter().any(|c| c.contact != Contact::Mirror));
        let BlockGrid { sums, forces, motion, change, .. } = &mut self.grid;
        let (mut sums, mut forces) = (std::mem::take(sums), std::mem::take(forces));
        let (mut motion, mut change) = (std::mem::take(motion), std::mem::take(change));
        let (shared_sums, shared_forces) = (Shared::new(&mut sums), Shared::new(&mut forces));
        let (shared_motion, shared_change) = (Shared::new(&mut motion), Shared::new(&mut change));
        let Fast { set, kernels, grid, .. } = &*self;
        let push_block = |block: usize| -> (NodeEnergies, Option<StepLedger<D>>) {
            let first = block * BLOCK_NODES;
            let nodes_if = |kept: bool| if kept { (first, BLOCK_NODES) } else { (0, 0) };
            let ((first_force, forces), (first_change, changes)) =
                (nodes_if(apart), nodes_if(apart && D == 3));
            #[expect(unsafe_code, reason = "tasks write to blocks of their own")]
            // SAFETY: every block belongs to one task.
            let (sums, forces, motion, change) = unsafe {
                (
                    shared_sums.range(first, BLOCK_NODES),
                    shared_forces.range(first_force, forces),
                    shared_motion.range(first, BLOCK_NODES),
                    shared_change.range(first_change, changes),
                )
            };
            let mut energies = (kernels.push_nodes)(*set, &push, sums, forces, motion, change);
            let corner = grid.first_node(block);
            let contact = time
                .filter(|&time| is_near(&scene.colliders, &surroundings(corner, scene.spacing), time))
                .map(|time| collide_nodes(scene, &push, corner, sums, motion, change, time));
            if sums_are_done_with {
                if apart {
                    energies.after = (kernels.kinetic_energy)(*set, sums, motion);
                }
                sums.fill([T::zero(); CHANNELS]);
                forces.fill([T::zero(); CHANNELS]);
            }
            (energies, contact)
        };
        let reports = self.pool.run(grid.blocks(), LEAST_BLOCKS, || (), |(), block| push_block(block));
        let grid = &mut self.grid;
        (grid.sums, grid.forces, grid.motion, grid.change) = (sums, forces, motion, change);
        grid.needs_clearing = !sums_are_done_with;
        for (energies, contact) in &reports {
            ledger.kinetic_grid_before += energies.before;
            ledger.kinetic_grid_after += energies.after;
            ledger.dropped_mass += energies.dropped_mass;
            if let Some(contact) = contact {
                ledger.add_contact(contact);
            }
        }
    }

    /// Kinetic energy of the nodes at the end of the step [J].
    pub(super) fn kinetic_of_motion(&self) -> f64 {
        let Fast { set, kernels, grid, .. } = self;
        let energy = |block: usize| {
            let nodes = block * BLOCK_NODES..(block + 1) * BLOCK_NODES;
            (kernels.kinetic_energy)(*set, &grid.sums[nodes.clone()], &grid.motion[nodes])
        };
        self.pool.run(grid.blocks(), LEAST_BLOCKS, || (), |(), block| energy(block)).iter().sum()
    }

    /// Stages 6 to 9.
    pub(super) fn grid_to_particles(
        &mut self,
        scene: &Scene<T, D>,
        share: Option<T>,
        interval: Interval<T>,
        ledger: &mut StepLedger<D>,
    ) -> Result<(), Rejection> {
        let inverse_inertia = T::of(scene.kernel.inverse_inertia());
        let midway = matches!(scene.integrator, Integrator::Trapezoidal { .. });
        if midway {
            self.grid.meet_midway(scene, interval.arrival - interval.dt.as_f64(), share);
            self.keep_end(scene, share.unwrap_or(T::zero()));
        }
        let share = share.filter(|_| !midway);
        let update = Update { scene, materials: &self.materials, share, inverse_inertia, interval, midway };
        let copies_change = share.is_some() && D == 3;
        let Particles { layout, fields, labels, blocks, .. } = &mut self.particles;
        let (layout, blocks) = (*layout, &*blocks);
        let (fields, labels) = (Shared::new(fields), Shared::new(labels));
        let (set, kernels, grid) = (self.set, self.kernels, &self.grid);
        let reports = self.pool.run(blocks.len(), 1, Scratch::new::<D>, |scratch, home| {
            let block = &blocks[home];
            let (first, chunks) = (block.first_chunk, block.chunks());
            #[expect(unsafe_code, reason = "tasks write to chunks of their own")]
            // SAFETY: every chunk belongs to one block, and every block to one task.
            let (fields, labels) = unsafe {
                (fields.range(first * layout.fields(), chunks * layout.fields()), labels.range(first, chunks))
            };
            grid.for_tile_runs(home, &mut |tile, node, count| {
                let first = if midway { &grid.middle } else { &grid.motion };
                copy_run(&first[node..node + count], tile, &mut scratch.tile);
                if copies_change {
                    copy_run(&grid.change[node..node + count], tile, &mut scratch.second_tile);
                }
            });
            let mut report = BlockReport::<T, D>::new();
            let first_node = block.corner.map(|n| n * block_edge::<D>());
            if is_near(&scene.colliders, &surroundings(first_node, scene.spacing), interval.arrival) {
                report.contact = Some(Box::new(StepLedger::new(scene.colliders.len())));
            }
            (kernels.gather_block)(set, &update, layout, block, fields, labels, scratch, &mut report);
            report
        });
        if let Some((particle, reason)) = reports.iter().find_map(|report| report.rejection) {
            return Err(Rejection { particle: Some(particle), reason });
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

    /// Has particles keep the end of a trapezoidal step, with the FLIP share `share`.
    fn keep_end(&mut self, scene: &Scene<T, D>, share: T) {
        let inverse_inertia = T::of(scene.kernel.inverse_inertia());
        let end = End { share, inverse_inertia, per_spacing: T::one() / scene.spacing };
        let Particles { layout, fields, blocks, .. } = &mut self.particles;
        let (layout, blocks) = (*layout, &*blocks);
        let fields = Shared::new(fields);
        let (set, kernels, grid) = (self.set, self.kernels, &self.grid);
        self.pool.run(blocks.len(), 1, Scratch::new::<D>, |scratch, home| {
            let chunks = blocks[home].chunk_range();
            #[expect(unsafe_code, reason = "tasks write to chunks of their own")]
            // SAFETY: every chunk belongs to one block, and every block to one task.
            let fields =
                unsafe { fields.range(chunks.start * layout.fields(), chunks.len() * layout.fields()) };
            grid.for_tile_runs(home, &mut |tile, node, count| {
                copy_run(&grid.ending[node..node + count], tile, &mut scratch.tile);
            });
            (kernels.keep_block)(set, scene, &end, layout, &blocks[home], fields, scratch);
        });
    }

    /// Elastic and potential energy, where `origin` is the world position of the local one.
    pub fn stored_energy(&self, scene: &Scene<T, D>, origin: &Vector<f64, D>) -> StoredEnergy {
        let Fast { set, kernels, materials, particles, .. } = self;
        let Particles { layout, fields, labels, blocks, .. } = particles;
        let energy = |home: usize| {
            let chunks = blocks[home].chunk_range();
            let fields = &fields[chunks.start * layout.fields()..chunks.end * layout.fields()];
            (kernels.stored_energy)(*set, fields, &labels[chunks], *layout, materials, &scene.gravity, origin)
        };
        let energies = self.pool.run(blocks.len(), 1, || (), |(), home| energy(home));
        energies.iter().fold(StoredEnergy::default(), |sum, part| StoredEnergy {
            elastic: sum.elastic + part.elastic,
            potential: sum.potential + part.potential,
        })
    }
}
