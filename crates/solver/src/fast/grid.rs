//! The grid as the fast engine keeps it: blocks of 64 nodes where particles reach, each node with four channels side by side. Blocks are
//! chosen when particles are sorted and serve until they are sorted again: a tile has a margin for particles that have moved on by a cell.

use std::collections::HashMap;
use std::hash::BuildHasherDefault;

use super::contact::{is_near, surroundings};
use super::particles::Block;
use super::pool::{Pool, Shared};
use super::simd::CHANNELS;
use crate::collision::keep_middle_out;
use crate::geometry::Vector;
use crate::grid::{BlockHasher, NodeMotion, NodeSums, Nodes};
use crate::kernel::MAX_SUPPORT;
use crate::real::Real;
use crate::scene::Scene;

/// Hashes block coordinates; looked up, never iterated.
pub(crate) type BlockHash = BuildHasherDefault<BlockHasher>;
/// A node's momentum or velocity, and its mass in channel D.
pub(crate) type Node<T> = [T; CHANNELS];

/// Nodes of a block.
pub(crate) const BLOCK_NODES: usize = 64;
/// Blocks around a block, itself included, in 3D.
pub(crate) const NEIGHBOURS: usize = 27;
/// How many cells a particle may move on an axis, either way, before it is sorted anew.
const DRIFT: usize = 1;

/// Nodes along an edge of a block: 8^2 = 4^3 = [`BLOCK_NODES`].
pub(crate) const fn block_edge<const D: usize>() -> i32 {
    if D == 2 { 8 } else { 4 }
}

/// Nodes along an edge of a tile, which holds all that particles of a block reach: the block's own, the drift on either side, and the rest of
/// the stencil.
pub(crate) const fn tile_edge<const D: usize>() -> usize {
    block_edge::<D>() as usize + 2 * DRIFT + MAX_SUPPORT - 1
}

/// Nodes of a tile.
pub(crate) const fn tile_nodes<const D: usize>() -> usize {
    tile_edge::<D>().pow(D as u32)
}

/// Blocks along an axis after which two blocks' tiles have no node in common.
const fn colours_along_an_axis<const D: usize>() -> i32 {
    if block_edge::<D>() as usize * 2 >= tile_edge::<D>() { 2 } else { 3 }
}

/// The blocks round the particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlockGrid<T: Real, const D: usize> {
    corners: Vec<[i32; D]>,
    directory: HashMap<[i32; D], u32, BlockHash>,
    /// Momentum and mass from particles; with the impulse of forces where a step does not keep them apart.
    pub sums: Vec<Node<T>>,
    /// Forces, where a step keeps them apart.
    pub forces: Vec<Node<T>>,
    /// Velocity at the end of the step; in 2D its change over the step in the two channels that follow.
    pub motion: Vec<Node<T>>,
    /// Change of velocity over the step in 3D.
    pub change: Vec<Node<T>>,
    /// Velocity in the middle of a trapezoidal step, and what particles keep of its end: the velocity, or with a FLIP share a the sum of 1 - a of it and a of
    /// its change.
    pub middle: Vec<Node<T>>,
    pub ending: Vec<Node<T>>,
    /// For each block of particles the blocks from -1 to +1 on each axis, the last axis fastest.
    neighbours: Vec<[u32; NEIGHBOURS]>,
    /// The blocks of particles in the order in which their tiles are added up: colour by colour, a colour being blocks whose tiles have no
    /// node in common. Each with the place in this order at which its colour begins.
    pub order: Vec<Turn>,
    /// Whether particles have added to nodes since they were emptied.
    pub needs_clearing: bool,
}

/// A block of particles whose tile is to be added to the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Turn {
    pub home: u32,
    /// How many must have been added before it.
    pub after: u32,
}

impl<T: Real, const D: usize> BlockGrid<T, D> {
    /// Places a block wherever a tile of `homes` reaches.
    pub fn place(&mut self, homes: &[Block<D>]) {
        self.directory.clear();
        self.corners.clear();
        for home in homes {
            for number in 0..3_usize.pow(D as u32) {
                let corner = neighbour(home.corner, number);
                let next = self.corners.len() as u32;
                if *self.directory.entry(corner).or_insert(next) == next {
                    self.corners.push(corner);
                }
            }
        }
        self.corners.sort_unstable();
        for (number, corner) in self.corners.iter().enumerate() {
            self.directory.insert(*corner, number as u32);
        }
        self.neighbours.clear();
        let period = colours_along_an_axis::<D>();
        let mut colours = vec![Vec::new(); (period as usize).pow(D as u32)];
        for (number, home) in homes.iter().enumerate() {
            let mut around = [0; NEIGHBOURS];
            for (k, place) in around.iter_mut().enumerate().take(3_usize.pow(D as u32)) {
                *place = self.directory[&neighbour(home.corner, k)];
            }
            self.neighbours.push(around);
            let colour = home.corner.iter().fold(0, |c, n| c * period + n.rem_euclid(period));
            colours[colour as usize].push(number as u32);
        }
        self.order.clear();
        for colour in colours {
            let after = self.order.len() as u32;
            self.order.extend(colour.into_iter().map(|home| Turn { home, after }));
        }
    }

    /// Makes room for the nodes of all blocks; `apart` if forces and changes of velocity have room of their own.
    pub fn make_room(&mut self, apart: bool) {
        let nodes = self.corners.len() * BLOCK_NODES;
        let zero = [T::zero(); CHANNELS];
        self.sums.resize(nodes, zero);
        self.motion.resize(nodes, zero);
        if apart {
            self.forces.resize(nodes, zero);
            self.change.resize(if D == 3 { nodes } else { 0 }, zero);
        }
    }

    /// Finds the velocities in the middle of the step, of nodes that keep its change, held by the obstacles of `time` [s]; and what particles keep
    /// with the FLIP share `share`.
    pub fn meet_midway(&mut self, scene: &Scene<T, D>, time: f64, share: Option<T>) {
        let (mut middle, mut ending) = (std::mem::take(&mut self.middle), std::mem::take(&mut self.ending));
        middle.clone_from(&self.motion);
        ending.clone_from(&self.motion);
        let half = T::of(0.5);
        for block in 0..self.blocks() {
            let first = self.first_node(block);
            let obstructed = is_near(&scene.colliders, &surroundings(first, scene.spacing), time);
            for local in 0..BLOCK_NODES {
                let index = block * BLOCK_NODES + local;
                let NodeMotion { velocity, change } =
                    read_motion::<T, D>(&self.motion, &self.change, index, true);
                let mut mean = velocity - change * half;
                if obstructed {
                    let node = node_coordinates(first, local);
                    let x = Vector::from_fn(|k, _| T::of_index(node[k]) * scene.spacing);
                    mean = keep_middle_out(scene, &x, mean, time);
                }
                middle[index][..D].copy_from_slice(mean.as_slice());
                if let Some(share) = share {
                    let kept = velocity * (T::one() - share) + change * share;
                    ending[index][..D].copy_from_slice(kept.as_slice());
                }
            }
        }
        (self.middle, self.ending) = (middle, ending);
    }

    /// Blocks in store.
    pub fn blocks(&self) -> usize {
        self.corners.len()
    }

    /// Coordinates of a block's least node.
    pub fn first_node(&self, block: usize) -> [i32; D] {
        self.corners[block].map(|n| n * block_edge::<D>())
    }

    /// Empties what particles add to, where it is not empty.
    pub fn clear(&mut self, pool: &Pool) {
        if !std::mem::take(&mut self.needs_clearing) {
            return;
        }
        // chosen: tasks of 64 kB and more.
        const LEAST_BLOCKS: usize = 64;
        let (blocks, blocks_of_forces) = (self.blocks(), self.forces.len() / BLOCK_NODES);
        let (sums, forces) = (Shared::new(&mut self.sums), Shared::new(&mut self.forces));
        pool.run(
            blocks.max(blocks_of_forces),
            LEAST_BLOCKS,
            || (),
            |(), block| {
                #[expect(unsafe_code, reason = "tasks write to nodes of their own")]
                // SAFETY: every block belongs to one task.
                unsafe {
                    if block < blocks {
                        sums.range(block * BLOCK_NODES, BLOCK_NODES).fill([T::zero(); CHANNELS]);
                    }
                    if block < blocks_of_forces {
                        forces.range(block * BLOCK_NODES, BLOCK_NODES).fill([T::zero(); CHANNELS]);
                    }
                }
            },
        );
    }

    /// Calls `copy(tile node, grid node, count)` for every run of nodes along the last axis that the tile of `home` and one block share.
    #[inline(always)]
    pub fn for_tile_runs(&self, home: usize, copy: &mut impl FnMut(usize, usize, usize)) {
        let (edge, width) = (block_edge::<D>() as usize, tile_edge::<D>());
        let around = &self.neighbours[home];
        // A tile begins DRIFT nodes before its block. Per axis: which of the three blocks, and where in it.
        let part = |n: usize| ((n + edge - DRIFT) / edge, (n + edge - DRIFT) % edge);
        let rows = if D == 2 { width } else { width * width };
        for row in 0..rows {
            let (mut block, mut local) = (0, 0);
            let mut digits = [row, 0];
            if D == 3 {
                digits = [row / width, row % width];
            }
            for k in 0..D - 1 {
                let (b, l) = part(digits[k]);
                (block, local) = (block * 3 + b, local * edge + l);
            }
            let (tile, node) = (row * width, local * edge);
            let mut run = |number: usize, tile: usize, offset: usize, count: usize| {
                let first = around[block * 3 + number] as usize * BLOCK_NODES;
                copy(tile, first + node + offset, count);
            };
            run(0, tile, edge - DRIFT, DRIFT);
            run(1, tile + DRIFT, 0, edge);
            run(2, tile + DRIFT + edge, 0, width - DRIFT - edge);
        }
    }

    /// Bytes in store.
    pub fn bytes(&self) -> usize {
        [&self.sums, &self.forces, &self.motion, &self.change, &self.middle, &self.ending]
            .map(|nodes| std::mem::size_of_val(&nodes[..]))
            .iter()
            .sum()
    }
}

/// Block `number` of the 3^D round `corner`, the last axis fastest.
pub(crate) fn neighbour<const D: usize>(corner: [i32; D], number: usize) -> [i32; D] {
    let mut place = corner;
    let mut rest = number;
    for axis in (0..D).rev() {
        place[axis] += (rest % 3) as i32 - 1;
        rest /= 3;
    }
    place
}

fn vector<T: Real, const D: usize>(node: &Node<T>, first: usize) -> Vector<T, D> {
    Vector::from_fn(|k, _| node[first + k])
}

/// What the plain stages of contact and mirrors see of the grid; for steps that keep forces apart.
impl<T: Real, const D: usize> Nodes<T, D> for BlockGrid<T, D> {
    fn node_count(&self) -> usize {
        self.sums.len()
    }

    fn coordinates(&self, index: usize) -> [i32; D] {
        node_coordinates(self.first_node(index / BLOCK_NODES), index % BLOCK_NODES)
    }

    fn find(&self, coordinates: [i32; D]) -> Option<usize> {
        let edge = block_edge::<D>();
        let block = *self.directory.get(&coordinates.map(|n| n.div_euclid(edge)))? as usize;
        let local = coordinates.iter().fold(0, |local, n| local * edge + n.rem_euclid(edge));
        Some(block * BLOCK_NODES + local as usize)
    }

    fn sums(&self, index: usize) -> NodeSums<T, D> {
        let node = &self.sums[index];
        NodeSums { mass: node[D], momentum: vector(node, 0), force: vector(&self.forces[index], 0) }
    }

    fn set_sums(&mut self, index: usize, sums: &NodeSums<T, D>) {
        for k in 0..D {
            self.sums[index][k] = sums.momentum[k];
            self.forces[index][k] = sums.force[k];
        }
        self.sums[index][D] = sums.mass;
    }

    fn motion(&self, index: usize) -> NodeMotion<T, D> {
        read_motion(&self.motion, &self.change, index, true)
    }

    fn set_motion(&mut self, index: usize, motion: &NodeMotion<T, D>) {
        write_motion(&mut self.motion, &mut self.change, index, true, motion);
    }
}

/// Node `index`, whose change of velocity follows the velocity in 2D, is in `change` in 3D, and nowhere where it is not kept `apart`.
pub(crate) fn read_motion<T: Real, const D: usize>(
    motion: &[Node<T>],
    change: &[Node<T>],
    index: usize,
    apart: bool,
) -> NodeMotion<T, D> {
    let of_change = match (apart, D) {
        (false, _) => Vector::zeros(),
        (true, 2) => vector(&motion[index], 2),
        (true, _) => vector(&change[index], 0),
    };
    NodeMotion { velocity: vector(&motion[index], 0), change: of_change }
}

/// What [`read_motion`] reads.
pub(crate) fn write_motion<T: Real, const D: usize>(
    motion: &mut [Node<T>],
    change: &mut [Node<T>],
    index: usize,
    apart: bool,
    node: &NodeMotion<T, D>,
) {
    motion[index][..D].copy_from_slice(node.velocity.as_slice());
    match (apart, D) {
        (false, _) => {}
        (true, 2) => motion[index][2..].copy_from_slice(node.change.as_slice()),
        (true, _) => change[index][..D].copy_from_slice(node.change.as_slice()),
    }
}

/// Adds the nodes of the tile from `first` on to `nodes`.
#[inline(always)]
pub(crate) fn add_run<T: Real>(tile: &[T], first: usize, nodes: &mut [Node<T>]) {
    let tile = &tile[first * CHANNELS..];
    for (sum, value) in nodes.as_flattened_mut().iter_mut().zip(tile) {
        *sum += *value;
    }
}

/// Copies `nodes` to the tile, from `first` on.
#[inline(always)]
pub(crate) fn copy_run<T: Real>(nodes: &[Node<T>], first: usize, tile: &mut [T]) {
    let nodes = nodes.as_flattened();
    tile[first * CHANNELS..][..nodes.len()].copy_from_slice(nodes);
}

/// Coordinates of node `local` of a block that begins at `first`, the last axis fastest.
pub(crate) fn node_coordinates<const D: usize>(first: [i32; D], local: usize) -> [i32; D] {
    let edge = block_edge::<D>() as usize;
    let mut node = first;
    let mut rest = local;
    for axis in (0..D).rev() {
        node[axis] += (rest % edge) as i32;
        rest /= edge;
    }
    node
}
