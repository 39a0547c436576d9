//! A sparse background grid: blocks of 4^D nodes, only where a particle's stencil reaches.
//!
//! Nodes lie at integer multiples of the spacing, relative to the state's origin. A particle belongs to the block of the
//! first node of its stencil and reaches at most into the blocks one further on each axis.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use crate::geometry::Vector;
use crate::real::Real;

/// Nodes along one edge of a block: at least the support of the widest kernel, so that a stencil reaches no
/// further than the next block.
pub const BLOCK_EDGE: usize = 4;
pub(crate) const EDGE_BITS: u32 = BLOCK_EDGE.trailing_zeros();
const ABSENT: u32 = u32::MAX;
/// 2^3: a block and its successors along each set of axes.
const MAX_SUCCESSORS: usize = 8;

/// What particles add up on a node.
#[derive(Clone, Copy, Debug)]
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

/// The place of a stencil in the grid's storage.
#[derive(Clone, Copy, Debug)]
pub struct Anchor<const D: usize> {
    /// Storage index of the first node of the block and of its successors, by the bits of the axes gone over.
    starts: [u32; MAX_SUCCESSORS],
    /// The stencil's first node within its block.
    local: [usize; D],
}

impl<const D: usize> Anchor<D> {
    /// Storage indices of a row's node 0 before and after the block's end on the last axis: node `k` of the row is
    /// `before + k` while `local + k < BLOCK_EDGE`, else `after + k`.
    #[inline(always)]
    pub fn row(&self, offset: &[usize; D]) -> RowPlace {
        let mut bits = 0;
        let mut node = 0;
        for k in 0..D - 1 {
            let n = self.local[k] + offset[k];
            bits = (bits << 1) | (n >> EDGE_BITS);
            node = (node << EDGE_BITS) | (n & (BLOCK_EDGE - 1));
        }
        let (bits, node) = (bits << 1, node << EDGE_BITS);
        let last = self.local[D - 1];
        RowPlace {
            before: self.starts[bits] as usize + node + last,
            after: (self.starts[bits | 1] as usize + node + last).wrapping_sub(BLOCK_EDGE),
            inside: BLOCK_EDGE - last,
        }
    }
}

/// Where the nodes of one row are stored.
#[derive(Clone, Copy, Debug)]
pub struct RowPlace {
    before: usize,
    after: usize,
    inside: usize,
}

impl RowPlace {
    /// Storage index of node `k` of the row.
    #[inline(always)]
    pub fn node(&self, k: usize) -> usize {
        if k < self.inside { self.before + k } else { self.after.wrapping_add(k) }
    }
}

/// The grid of one step. Nodes are addressed by their storage index; blocks are stored in the order in which particles first
/// touched them, which depends on nothing but the particles' order.
#[derive(Clone, Debug, Default)]
pub struct Grid<T: Real, const D: usize> {
    /// Distance of nodes [m].
    pub spacing: T,
    /// Sums from particles, per node.
    pub sums: Vec<NodeSums<T, D>>,
    /// Motion for particles, per node.
    pub motion: Vec<NodeMotion<T, D>>,
    blocks: Vec<[i32; D]>,
    directory: Directory<D>,
    starts: Vec<[u32; MAX_SUCCESSORS]>,
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
            starts: Vec::new(),
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
        self.link_successors();
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

    /// For every block in which a stencil begins, the storage of the blocks one further on each set of axes.
    fn link_successors(&mut self) {
        self.starts.clear();
        for home in 0..self.blocks.len() {
            let mut starts = [ABSENT; MAX_SUCCESSORS];
            for (bits, start) in starts.iter_mut().enumerate().take(1 << D) {
                let mut block = self.blocks[home];
                for (axis, coordinate) in block.iter_mut().enumerate() {
                    *coordinate += (bits >> (D - 1 - axis) & 1) as i32;
                }
                *start = self.touch(block) * Self::block_nodes() as u32;
            }
            self.starts.push(starts);
        }
    }

    /// The place of particle `p`'s stencil.
    #[inline(always)]
    pub fn anchor(&self, p: usize) -> Anchor<D> {
        let (block, local) = self.homes[p];
        Anchor { starts: self.starts[block as usize], local: local.map(usize::from) }
    }

    /// The number of nodes stored.
    pub fn node_count(&self) -> usize {
        self.sums.len()
    }

    /// Integer coordinates of the node stored at `index`.
    #[inline]
    pub fn coordinates(&self, index: usize) -> [i32; D] {
        let block = self.blocks[index / Self::block_nodes()];
        let mut rest = index % Self::block_nodes();
        let mut node = [0; D];
        for axis in (0..D).rev() {
            node[axis] = block[axis] * BLOCK_EDGE as i32 + (rest % BLOCK_EDGE) as i32;
            rest /= BLOCK_EDGE;
        }
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
        let block = self.directory.get(&coordinates.map(|n| n >> EDGE_BITS))?;
        let local =
            coordinates.iter().fold(0, |l, n| l * BLOCK_EDGE + (n & (BLOCK_EDGE as i32 - 1)) as usize);
        Some(*block as usize * Self::block_nodes() + local)
    }
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
