//! A sparse background grid: blocks of 4^D nodes, only where a particle's stencil reaches.
//!
//! Nodes lie at integer multiples of the spacing, relative to the state's origin. A particle belongs to the block of the
//! first node of its stencil and reaches at most into the blocks one further on each axis. Blocks that follow one another along the last
//! axis are stored as one strip, row by row, so that the nodes of a stencil's row are neighbours in storage.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use crate::geometry::Vector;
use crate::real::Real;

/// Nodes along one edge of a block: at least the support of the widest kernel, so that a stencil reaches no
/// further than the next block.
pub const BLOCK_EDGE: usize = 4;
pub(crate) const EDGE_BITS: u32 = BLOCK_EDGE.trailing_zeros();
const ABSENT: u32 = u32::MAX;
/// 2^2: the strip of a block and the strips one further along each set of the axes but the last.
const MAX_STRIPS: usize = 4;

/// What particles add up on a node.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub struct NodeSums<T: Real, const D: usize> {
    /// sum w m [kg].
    pub mass: T,
    /// sum w m v [kg m/s].
    pub momentum: Vector<T, D>,
    /// - sum V P F^T grad w [N].
    pub force: Vector<T, D>,
}

/// What a node hands back to particles.
#[derive(Clone, Copy, Debug)]
pub struct NodeMotion<T: Real, const D: usize> {
    /// Velocity at the end of the step [m/s].
    pub velocity: Vector<T, D>,
    /// Velocity at the end less that at the beginning of the step [m/s].
    pub change: Vector<T, D>,
}

impl<T: Real, const D: usize> NodeSums<T, D> {
    /// A node nothing has reached.
    pub fn empty() -> Self {
        NodeSums { mass: T::zero(), momentum: Vector::zeros(), force: Vector::zeros() }
    }
}

impl<T: Real, const D: usize> NodeMotion<T, D> {
    /// A node at rest.
    pub fn still() -> Self {
        NodeMotion { velocity: Vector::zeros(), change: Vector::zeros() }
    }
}

/// The nodes of a grid, by their index in store, as contact and mirrors see them.
pub(crate) trait Nodes<T: Real, const D: usize> {
    /// The number of nodes stored.
    fn node_count(&self) -> usize;
    /// Integer coordinates of a node.
    fn coordinates(&self, index: usize) -> [i32; D];
    /// The node at `coordinates`, where it is stored.
    fn find(&self, coordinates: [i32; D]) -> Option<usize>;
    /// What particles gave a node.
    fn sums(&self, index: usize) -> NodeSums<T, D>;
    /// Sets what particles gave a node.
    fn set_sums(&mut self, index: usize, sums: &NodeSums<T, D>);
    /// What a node hands back.
    fn motion(&self, index: usize) -> NodeMotion<T, D>;
    /// Sets what a node hands back.
    fn set_motion(&mut self, index: usize, motion: &NodeMotion<T, D>);
}

impl<T: Real, const D: usize> Nodes<T, D> for Grid<T, D> {
    fn node_count(&self) -> usize {
        self.sums.len()
    }
    fn coordinates(&self, index: usize) -> [i32; D] {
        Grid::coordinates(self, index)
    }
    fn find(&self, coordinates: [i32; D]) -> Option<usize> {
        Grid::find(self, coordinates)
    }
    fn sums(&self, index: usize) -> NodeSums<T, D> {
        self.sums[index]
    }
    fn set_sums(&mut self, index: usize, sums: &NodeSums<T, D>) {
        self.sums[index] = *sums;
    }
    fn motion(&self, index: usize) -> NodeMotion<T, D> {
        self.motion[index]
    }
    fn set_motion(&mut self, index: usize, motion: &NodeMotion<T, D>) {
        self.motion[index] = *motion;
    }
}

/// Where a block is stored.
#[derive(Clone, Copy, Debug, Default)]
struct BlockPlace {
    /// Storage index of its first node.
    first: u32,
    /// Distance in storage of nodes that are neighbours on the last axis but one: the length of the strip.
    row: u32,
}

/// The place of a stencil in the grid's storage.
#[derive(Clone, Copy, Debug)]
pub struct Anchor<const D: usize> {
    /// The block and its successors on the axes but the last, by the bits of the axes gone over.
    blocks: [BlockPlace; MAX_STRIPS],
    /// The stencil's first node within its block.
    local: [usize; D],
}

impl<const D: usize> Anchor<D> {
    /// Storage index of node 0 of the row at `offset`; the row's other nodes follow it.
    #[inline(always)]
    pub fn row(&self, offset: &[usize; D]) -> usize {
        let mut bits = 0;
        let mut row = 0;
        for k in 0..D - 1 {
            let n = self.local[k] + offset[k];
            bits = (bits << 1) | (n >> EDGE_BITS);
            row = (row << EDGE_BITS) | (n & (BLOCK_EDGE - 1));
        }
        let block = self.blocks[bits];
        block.first as usize + row * block.row as usize + self.local[D - 1]
    }
}

/// The grid of one step. Nodes are addressed by their storage index; strips are stored in the order of their coordinates.
#[derive(Clone, Debug, Default)]
pub struct Grid<T: Real, const D: usize> {
    /// Distance of nodes [m].
    pub spacing: T,
    /// Sums from particles, per node.
    pub sums: Vec<NodeSums<T, D>>,
    /// Motion for particles, per node.
    pub motion: Vec<NodeMotion<T, D>>,
    /// In the order in which particles first touched them; those in which stencils begin come before their successors.
    blocks: Vec<[i32; D]>,
    directory: Directory<D>,
    /// Per block.
    places: Vec<BlockPlace>,
    /// Per block in which stencils begin.
    neighbours: Vec<[BlockPlace; MAX_STRIPS]>,
    /// Coordinates of every fourth node in store; the next three follow it on the last axis.
    coordinates: Vec<[i32; D]>,
    /// Per particle: its block, and the first node of its stencil within it.
    homes: Vec<(u32, [u8; D])>,
}

type Directory<const D: usize> = HashMap<[i32; D], u32, BuildHasherDefault<BlockHasher>>;

impl<T: Real, const D: usize> Grid<T, D> {
    /// A grid without a node.
    pub fn new(spacing: T) -> Self {
        Grid {
            spacing,
            sums: Vec::new(),
            motion: Vec::new(),
            blocks: Vec::new(),
            directory: Directory::default(),
            places: Vec::new(),
            neighbours: Vec::new(),
            coordinates: Vec::new(),
            homes: Vec::new(),
        }
    }

    /// Nodes in one block.
    pub const fn block_nodes() -> usize {
        BLOCK_EDGE.pow(D as u32)
    }

    /// Makes room, empty, for stencils that begin at the nodes `first`, one a particle; forgets everything else.
    pub fn activate(&mut self, first: impl Iterator<Item = [i32; D]>) {
        self.blocks.clear();
        self.directory.clear();
        self.homes.clear();
        let mut latest = ([i32::MAX; D], ABSENT);
        for node in first {
            let block = node.map(|n| n >> EDGE_BITS);
            if block != latest.0 {
                latest = (block, self.touch(block));
            }
            let local = node.map(|n| (n & (BLOCK_EDGE as i32 - 1)) as u8);
            self.homes.push((latest.1, local));
        }
        let homes = self.blocks.len();
        self.touch_successors(homes);
        self.place_blocks();
        self.link_successors(homes);
        let nodes = self.blocks.len() * Self::block_nodes();
        self.sums.clear();
        self.sums.resize(nodes, NodeSums::empty());
        self.motion.resize(nodes, NodeMotion::still());
    }

    fn touch(&mut self, block: [i32; D]) -> u32 {
        *self.directory.entry(block).or_insert_with(|| {
            self.blocks.push(block);
            (self.blocks.len() - 1) as u32
        })
    }

    /// Adds the blocks one further on each set of axes than the first `homes`.
    fn touch_successors(&mut self, homes: usize) {
        for home in 0..homes {
            for bits in 1..1 << D {
                self.touch(successor(self.blocks[home], bits));
            }
        }
    }

    /// Gives every block its place: strips of blocks in the order of their coordinates.
    fn place_blocks(&mut self) {
        let blocks = &self.blocks;
        let mut order: Vec<u32> = (0..blocks.len() as u32).collect();
        order.sort_unstable_by_key(|&b| blocks[b as usize]);
        self.places.resize(blocks.len(), BlockPlace::default());
        self.coordinates.clear();
        let follows = |a: &u32, b: &u32| successor(blocks[*a as usize], 1) == blocks[*b as usize];
        for strip in order.chunk_by(follows) {
            let row = strip.len() * BLOCK_EDGE;
            let first = self.coordinates.len() * BLOCK_EDGE;
            for (number, &block) in strip.iter().enumerate() {
                let first = first + number * BLOCK_EDGE;
                self.places[block as usize] = BlockPlace { first: first as u32, row: row as u32 };
            }
            for local in (0..Self::block_nodes()).step_by(BLOCK_EDGE) {
                let rows = strip.iter().map(|&b| Self::node_of(blocks[b as usize], local));
                self.coordinates.extend(rows);
            }
        }
    }

    /// For every block in which a stencil begins, the places of the blocks one further on each set of axes but the last.
    fn link_successors(&mut self, homes: usize) {
        self.neighbours.clear();
        for home in 0..homes {
            let mut places = [BlockPlace::default(); MAX_STRIPS];
            for (bits, place) in places.iter_mut().enumerate().take(1 << (D - 1)) {
                *place = self.places[self.directory[&successor(self.blocks[home], bits << 1)] as usize];
            }
            self.neighbours.push(places);
        }
    }

    /// Coordinates of node `local` of a block, counted with the last axis fastest.
    fn node_of(block: [i32; D], local: usize) -> [i32; D] {
        let mut node = block.map(|n| n << EDGE_BITS);
        for axis in 0..D {
            node[axis] += (local >> (EDGE_BITS as usize * (D - 1 - axis)) & (BLOCK_EDGE - 1)) as i32;
        }
        node
    }

    /// The place of particle `p`'s stencil.
    #[inline(always)]
    pub fn anchor(&self, p: usize) -> Anchor<D> {
        let (block, local) = self.homes[p];
        Anchor { blocks: self.neighbours[block as usize], local: local.map(usize::from) }
    }

    /// The number of nodes stored.
    pub fn node_count(&self) -> usize {
        self.sums.len()
    }

    /// Integer coordinates of the node stored at `index`.
    #[inline]
    pub fn coordinates(&self, index: usize) -> [i32; D] {
        let mut node = self.coordinates[index / BLOCK_EDGE];
        node[D - 1] += (index % BLOCK_EDGE) as i32;
        node
    }

    /// Position of the node stored at `index` [m].
    #[inline]
    pub fn position(&self, index: usize) -> Vector<T, D> {
        let node = self.coordinates(index);
        Vector::from_fn(|k, _| T::of_index(node[k]) * self.spacing)
    }

    /// Storage index of the node at integer `coordinates`, where it is stored.
    pub fn find(&self, coordinates: [i32; D]) -> Option<usize> {
        let block = *self.directory.get(&coordinates.map(|n| n >> EDGE_BITS))?;
        let place = self.places[block as usize];
        let local = coordinates.map(|n| (n & (BLOCK_EDGE as i32 - 1)) as usize);
        let row = local[..D - 1].iter().fold(0, |row, n| row * BLOCK_EDGE + n);
        Some(place.first as usize + row * place.row as usize + local[D - 1])
    }
}

/// The block one further on the axes of the set bits; bit 0 is the last axis.
fn successor<const D: usize>(mut block: [i32; D], bits: usize) -> [i32; D] {
    for (axis, coordinate) in block.iter_mut().enumerate() {
        *coordinate += (bits >> (D - 1 - axis) & 1) as i32;
    }
    block
}

/// Mixes integer coordinates by multiplication with 2^64 / golden ratio (Knuth, TAOCP 3, section 6.4). The directory is
/// only ever looked up, never iterated, so the hash has no say in results.
#[derive(Clone, Copy, Debug, Default)]
pub struct BlockHasher(u64);

impl Hasher for BlockHasher {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(4) {
            let mut word = [0; 4];
            word[..chunk.len()].copy_from_slice(chunk);
            self.0 = (self.0.rotate_left(21) ^ u64::from(u32::from_le_bytes(word)))
                .wrapping_mul(0x9E37_79B9_7F4A_7C15);
        }
    }
    fn write_usize(&mut self, _length: usize) {}
}
