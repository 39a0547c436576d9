//! From grid to particles, block by block through a tile of nodes: stage 7 of a step, and the stages that follow it.

use super::batch::{BATCH, Batch, GIVEN, Next, Scratch, row_offset, rows, span, weigh};
use super::particles::{Block, Label, Layout, store_matrix};
use super::simd::{CHANNELS, CHUNK, InstructionSet, Lanes, Row};
use super::strain::Matrix;
use super::update::{BlockReport, Update, update_batch};
use super::weights::{LaneKernel, arms};
use crate::kernel::MAX_SUPPORT;
use crate::real::Real;

/// Groups in which a particle finds what it is told: velocity; by axis the velocity gradient; C; change of velocity in 3D (that of 2D
/// is in channels 2 and 3 of the velocity's group).
pub(super) const TOLD_VELOCITY: usize = 0;
pub(super) const TOLD_FIRST: usize = 1;
pub(super) const TOLD_SECOND: usize = 4;
pub(super) const TOLD_CHANGE: usize = 4;

/// What some particles of a batch, side by side, were told.
#[derive(Clone, Copy)]
pub(super) struct Told<'a, T>(&'a [T]);

impl<'a, T: Real> Told<'a, T> {
    /// From particle `p` of the batch on.
    #[inline(always)]
    pub fn from(batch: &'a Batch<T>, p: usize) -> Self {
        Told(&batch.channels.as_flattened()[p * GIVEN..])
    }

    /// The channels of group `number`.
    #[inline(always)]
    pub fn group<V: Lanes<T>>(self, number: usize) -> [V; CHANNELS] {
        V::load_channels(&self.0[number * CHANNELS..], GIVEN)
    }

    /// The matrix whose columns are the groups from `number` on, times `factor`.
    #[inline(always)]
    pub fn matrix<V: Lanes<T>, const D: usize>(self, number: usize, factor: V) -> Matrix<V, D> {
        let mut m = [[factor; D]; D];
        for j in 0..D {
            let column = self.group::<V>(number + j);
            for i in 0..D {
                m[i][j] = column[i] * factor;
            }
        }
        m
    }
}

/// Stages 6 to 9 for the particles of a block, from the nodes' motion in the tile (and its change over the step in the second tile, in 3D
/// FLIP).
#[inline(always)]
pub(super) fn gather_block<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    update: &Update<T, D>,
    layout: Layout<D>,
    block: &Block<D>,
    fields: &mut [[T; CHUNK]],
    labels: &mut [[Label; CHUNK]],
    scratch: &mut Scratch<T>,
    report: &mut BlockReport<T, D>,
) {
    let stride = layout.fields();
    let per_spacing = T::one() / update.scene.spacing;
    let chunks = labels.len();
    let mut first = 0;
    while first < chunks {
        let last = chunks.min(first + BATCH / CHUNK);
        let next = Next::of(&fields[first * stride..], (last - first) * stride);
        let (fields, labels) = (&mut fields[first * stride..last * stride], &mut labels[first..last]);
        first = last;
        let count = labels.len() * CHUNK;
        let Scratch { tile, second_tile, batch } = scratch;
        weigh::<I, T, K, D, MOMENTS, SLOPES>(batch, block, fields, stride, per_spacing);
        gather_batch::<I, T, K, D, MOMENTS, SLOPES>(batch, count, TOLD_VELOCITY, tile, next);
        if D == 3 && update.share.is_some() {
            gather_batch::<I, T, K, D, false, false>(batch, count, TOLD_CHANGE, second_tile, Next::NOTHING);
        }
        update_batch::<I, T, K, D, MOMENTS, SLOPES>(update, scratch, layout, block, fields, labels, report);
    }
}

/// Has the particles of a block keep what the nodes in the tile say of the end of a trapezoidal step: velocity, with FLIP its share of what
/// they had beside it, and C where `MOMENTS`. They move by the step's middle afterwards.
#[inline(always)]
pub(super) fn keep_block<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
>(
    end: &End<T>,
    layout: Layout<D>,
    block: &Block<D>,
    fields: &mut [[T; CHUNK]],
    scratch: &mut Scratch<T>,
) {
    let stride = layout.fields();
    let Scratch { tile, batch, .. } = scratch;
    let (share, to_affine) =
        (I::Lanes::splat(end.share), I::Lanes::splat(end.inverse_inertia * end.per_spacing));
    for fields in fields.chunks_mut(stride * BATCH / CHUNK) {
        let count = fields.len() / stride * CHUNK;
        weigh::<I, T, K, D, MOMENTS, false>(batch, block, fields, stride, end.per_spacing);
        gather_batch::<I, T, K, D, MOMENTS, false>(batch, count, TOLD_VELOCITY, tile, Next::NOTHING);
        for (number, chunk) in fields.chunks_exact_mut(stride).enumerate() {
            let mut lane = 0;
            while lane < CHUNK {
                let told = Told::from(batch, number * CHUNK + lane);
                let velocity = told.group::<I::Lanes>(TOLD_VELOCITY);
                for i in 0..D {
                    let place = &mut chunk[Layout::<D>::VELOCITY + i][lane..];
                    I::Lanes::load(place).mul_add(share, velocity[i]).store(place);
                }
                if MOMENTS {
                    let affine = told.matrix::<I::Lanes, D>(TOLD_FIRST, to_affine);
                    store_matrix(&affine, chunk, Layout::<D>::AFFINE, lane);
                }
                lane += I::Lanes::COUNT;
            }
        }
    }
}

/// What the particles of a trapezoidal step keep of its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct End<T> {
    /// Of their own velocity: the FLIP share, 0 for others.
    pub share: T,
    pub inverse_inertia: T,
    pub per_spacing: T,
}

/// Tells the batch's particles what their nodes in the tile say: group 0 the sum of w times the channels, then for each axis that sum with
/// w's factor of the axis replaced by its slope, and then by its moment.
#[inline(always)]
pub(super) fn gather_batch<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    batch: &mut Batch<T>,
    particles: usize,
    first_group: usize,
    tile: &[T],
    next: Next,
) {
    let mut nodes = [I::Row::zero(); MAX_SUPPORT * MAX_SUPPORT];
    let mut start = i32::MIN;
    let zero = I::Row::zero();
    for p in 0..particles {
        next.fetch::<I, T>(p);
        if batch.start[p] != start {
            start = batch.start[p];
            // A start that is none lies beyond any tile.
            let first = start as u32 as usize * CHANNELS;
            assert!(tile.len() >= first + span::<K, D>());
            for row in 0..rows::<K, D>() {
                #[expect(unsafe_code, reason = "16 rows in registers leave no room for checks")]
                // SAFETY: the whole stencil lies in the tile.
                unsafe {
                    nodes[row] = I::Row::load_at(tile, first + row_offset::<K, D>(row));
                }
            }
        }
        let beyond = I::Row::splat(batch.beyond[p]);
        let spline = K::row::<T, I::Row>(beyond);
        // Sums over the axes but the last: with all weights, and with the slope or moment of one axis.
        let mut value = zero;
        let (mut slopes, mut moments) = ([zero; 2], [zero; 2]);
        for i in 0..K::SUPPORT {
            let weight = I::Row::splat(batch.weight[0][i][p]);
            let mut plane = nodes[i];
            if D == 3 {
                plane = nodes[i * K::SUPPORT] * I::Row::splat(batch.weight[1][0][p]);
                for j in 1..K::SUPPORT {
                    plane = nodes[i * K::SUPPORT + j].mul_add(I::Row::splat(batch.weight[1][j][p]), plane);
                }
                if SLOPES {
                    let mut sum = nodes[i * K::SUPPORT] * I::Row::splat(batch.slope[1][0][p]);
                    for j in 1..K::SUPPORT {
                        sum = nodes[i * K::SUPPORT + j].mul_add(I::Row::splat(batch.slope[1][j][p]), sum);
                    }
                    slopes[1] = sum.mul_add(weight, slopes[1]);
                }
                if MOMENTS {
                    let mut sum = nodes[i * K::SUPPORT] * I::Row::splat(batch.moment[1][0][p]);
                    for j in 1..K::SUPPORT {
                        sum = nodes[i * K::SUPPORT + j].mul_add(I::Row::splat(batch.moment[1][j][p]), sum);
                    }
                    moments[1] = sum.mul_add(weight, moments[1]);
                }
            }
            value = plane.mul_add(weight, value);
            if SLOPES {
                slopes[0] = plane.mul_add(I::Row::splat(batch.slope[0][i][p]), slopes[0]);
            }
            if MOMENTS {
                moments[0] = plane.mul_add(I::Row::splat(batch.moment[0][i][p]), moments[0]);
            }
        }
        let told = &mut batch.channels[p][first_group * CHANNELS..];
        let sum = value * spline.weight;
        let moment_weight = spline.weight * arms::<T, I::Row>(beyond);
        if !MOMENTS && !SLOPES {
            I::Row::sums_over_nodes([sum; 4], told);
            continue;
        }
        let moments = by_axis::<I, T, D>(moments, spline.weight, value * moment_weight);
        if SLOPES {
            let [x, y, z] = by_axis::<I, T, D>(slopes, spline.weight, value * spline.slope);
            I::Row::sums_over_nodes([sum, x, y, z], told);
            if MOMENTS {
                let [x, y, z] = moments;
                I::Row::sums_over_nodes([x, y, z, z], &mut told[4 * CHANNELS..]);
            }
        } else {
            let [x, y, z] = moments;
            I::Row::sums_over_nodes([sum, x, y, z], told);
        }
    }
}

/// The sums of each axis, those of the axes but the last with the weights of the last.
#[inline(always)]
fn by_axis<I: InstructionSet<T>, T: Real, const D: usize>(
    inner: [I::Row; 2],
    weight: I::Row,
    last: I::Row,
) -> [I::Row; 3] {
    if D == 2 { [inner[0] * weight, last, last] } else { [inner[0] * weight, inner[1] * weight, last] }
}
