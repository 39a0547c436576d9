//! A few particles with the weights of their nodes, between a block's particles and its tile of nodes. Lengths are in units of the spacing.

use super::grid::{block_edge, tile_edge, tile_nodes};
use super::particles::{Block, Layout};
use super::simd::{CHANNELS, CHUNK, InstructionSet, Lanes, ROW_NODES};
use super::weights::{LaneKernel, Spline};
use crate::kernel::MAX_SUPPORT;
use crate::real::Real;

/// Particles of which weights and channels are held at once: few enough for the first-level cache.
pub(super) const BATCH: usize = 4 * CHUNK;
/// Groups of four channels that a particle gives: value, slopes or moments by axis, both by axis, and the value of forces.
const GROUPS: usize = 8;
/// Channels of a particle.
pub(super) const GIVEN: usize = GROUPS * CHANNELS;

/// Weights by axis but the last, node and particle.
type Weights<T> = [[[T; BATCH]; MAX_SUPPORT]; 2];

/// Memory of a task.
pub(super) struct Scratch<T> {
    pub tile: Vec<T>,
    pub second_tile: Vec<T>,
    pub batch: Box<Batch<T>>,
}

#[repr(align(64))]
pub(super) struct Batch<T> {
    /// The tile's number of the stencil's first node.
    pub start: [i32; BATCH],
    /// How far the particle is beyond a node on the last axis.
    pub beyond: [T; BATCH],
    pub weight: Weights<T>,
    pub slope: Weights<T>,
    pub moment: Weights<T>,
    /// What particles give to, or are told by, their nodes: groups of four channels.
    pub channels: [[T; GIVEN]; BATCH],
}

impl<T: Real> Scratch<T> {
    pub fn new<const D: usize>() -> Self {
        let tile = vec![T::zero(); tile_nodes::<D>() * CHANNELS];
        let weights = [[[T::zero(); BATCH]; MAX_SUPPORT]; 2];
        Scratch {
            second_tile: tile.clone(),
            tile,
            batch: Box::new(Batch {
                start: [0; BATCH],
                beyond: [T::zero(); BATCH],
                weight: weights,
                slope: weights,
                moment: weights,
                channels: [[T::zero(); GIVEN]; BATCH],
            }),
        }
    }
}

/// The fields of the next batch, to be fetched while the present one is worked on.
#[derive(Clone, Copy)]
pub(super) struct Next {
    first: *const u8,
    /// Bytes, per particle of the present batch.
    share: usize,
}

/// Bytes of a cache line.
const LINE: usize = 64;

impl Next {
    /// `fields` are those of all batches from the present one on, of which `present` are its own.
    #[inline(always)]
    pub fn of<T>(fields: &[[T; CHUNK]], present: usize) -> Self {
        let next = &fields[present.min(fields.len())..];
        let bytes = std::mem::size_of_val(&next[..next.len().min(present)]);
        Next { first: next.as_ptr().cast(), share: bytes.div_ceil(BATCH * LINE) * LINE }
    }

    /// Where nothing is to come.
    pub const NOTHING: Next = Next { first: std::ptr::null(), share: 0 };

    /// Fetches the share of particle `p`.
    #[inline(always)]
    pub fn fetch<I: InstructionSet<T>, T>(&self, p: usize) {
        let mut line = 0;
        while line < self.share {
            I::prefetch(self.first.wrapping_add(p * self.share + line));
            line += LINE;
        }
    }
}

/// Fills in weights, and where stencils begin in the tile, for `chunks` chunks.
#[inline(always)]
pub(super) fn weigh<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    batch: &mut Batch<T>,
    block: &Block<D>,
    fields: &[[T; CHUNK]],
    stride: usize,
    per_spacing: T,
) {
    let edge = block_edge::<D>();
    let per_spacing = I::Lanes::splat(per_spacing);
    for (number, chunk) in fields.chunks_exact(stride).enumerate() {
        let mut lane = 0;
        while lane < CHUNK {
            let p = number * CHUNK + lane;
            let mut start = I::Lanes::splat(T::zero());
            for axis in 0..D {
                let x = I::Lanes::load(&chunk[Layout::<D>::POSITION + axis][lane..]) * per_spacing;
                let place = K::place::<T, I::Lanes>(x);
                // The tile begins a node before the block, as the stencil does before the place's node.
                let local = place.node - I::Lanes::splat(T::of_index(block.corner[axis] * edge));
                start = start.mul_add(I::Lanes::splat(T::of_index(tile_edge::<D>() as i32)), local);
                if axis == D - 1 {
                    place.beyond.store(&mut batch.beyond[p..]);
                    continue;
                }
                let splines = K::splines::<T, I::Lanes>(place.beyond);
                for k in 0..K::SUPPORT {
                    let Spline { weight, slope } = splines[k];
                    weight.store(&mut batch.weight[axis][k][p..]);
                    if SLOPES {
                        slope.store(&mut batch.slope[axis][k][p..]);
                    }
                    if MOMENTS {
                        let arm = I::Lanes::splat(T::of_index(k as i32 - 1)) - place.beyond;
                        (weight * arm).store(&mut batch.moment[axis][k][p..]);
                    }
                }
            }
            start.store_integers(&mut batch.start[p..]);
            lane += I::Lanes::COUNT;
        }
    }
}

/// Rows of a stencil.
pub(super) const fn rows<K: LaneKernel, const D: usize>() -> usize {
    if D == 3 { K::SUPPORT * K::SUPPORT } else { K::SUPPORT }
}

/// Where a row of the stencil lies in the tile, from its first node.
#[inline(always)]
pub(super) fn row_offset<K: LaneKernel, const D: usize>(row: usize) -> usize {
    let width = tile_edge::<D>();
    let nodes = if D == 3 { (row / K::SUPPORT * width + row % K::SUPPORT) * width } else { row * width };
    nodes * CHANNELS
}

/// Numbers of the tile from the first to the last of a stencil.
#[inline(always)]
pub(super) fn span<K: LaneKernel, const D: usize>() -> usize {
    row_offset::<K, D>(rows::<K, D>() - 1) + ROW_NODES * CHANNELS
}
