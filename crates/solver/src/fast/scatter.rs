//! From particles to grid, block by block through a tile of nodes: stages 1 and 2 of a step.
//!
//! A particle's share of the four nodes of a row is one vector, four nodes by four channels.

use super::batch::{BATCH, Batch, GIVEN, Next, Scratch, row_offset, rows, span, weigh};
use super::material::{ChunkMaterial, MaterialNumbers};
use super::particles::{Label, Layout, Particles, load_matrix};
use super::simd::{CHANNELS, CHUNK, InstructionSet, Lanes, Row};
use super::strain::kirchhoff;
use super::weights::{LaneKernel, arms};
use crate::kernel::MAX_SUPPORT;
use crate::real::Real;

/// Group of a particle's values: momentum and mass.
const VALUE: usize = 0;
/// First groups of what goes with moments, and with slopes.
pub(super) const MOMENT: usize = 1;
pub(super) const SLOPE: usize = 4;
/// Group of its own force.
pub(super) const OWN_FORCE: usize = 7;

/// What a step asks of the transfers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms<T> {
    pub spacing: T,
    pub dt: T,
    /// h^2 D^-1 of the kernel: 3 (cubic) or 4 (quadratic).
    pub inverse_inertia: T,
    /// Whether nodes keep forces apart from momentum.
    pub apart: bool,
}

/// Fills in what the particles of `chunks` chunks give. With their impulse over the step where forces are not kept apart: MLS, which takes
/// moments for both, as one group; else forces go to the groups of slopes.
#[inline(always)]
fn give<I: InstructionSet<T>, T: Real, const D: usize, const MOMENTS: bool, const SLOPES: bool>(
    batch: &mut Batch<T>,
    fields: &[[T; CHUNK]],
    layout: Layout<D>,
    labels: &[[Label; CHUNK]],
    materials: &[MaterialNumbers<T>],
    terms: &Terms<T>,
) {
    let zero = I::Lanes::splat(T::zero());
    let joined = !terms.apart;
    for (number, chunk) in fields.chunks_exact(layout.fields()).enumerate() {
        let mut mixed = None;
        let material = ChunkMaterial::of(&labels[number], materials, &mut mixed);
        let mut lane = 0;
        while lane < CHUNK {
            let p = number * CHUNK + lane;
            let field = |f: usize| &chunk[f][lane..];
            let mass = I::Lanes::load(field(Layout::<D>::MASS));
            let h = load_matrix::<T, I::Lanes, D>(chunk, Layout::<D>::STRAIN, lane);
            let tau = kirchhoff::<T, I::Lanes, D>(&h, &material.moduli(lane));
            // Of force f = - V tau grad w, or of f dt; lengths are in units of h.
            let over = if SLOPES { T::one() } else { terms.inverse_inertia } / terms.spacing;
            let over = if joined { over * terms.dt } else { over };
            let pull = -(I::Lanes::load(field(Layout::<D>::VOLUME))
                * I::Lanes::load(field(Layout::<D>::STIFFNESS))
                * I::Lanes::splat(over));
            let given = &mut batch.channels.as_flattened_mut()[p * GIVEN..];
            let mut value = [zero; CHANNELS];
            let mut own = [zero; CHANNELS];
            for i in 0..D {
                value[i] = mass * I::Lanes::load(field(Layout::<D>::VELOCITY + i));
                if layout.forced() {
                    own[i] = mass * I::Lanes::load(field(layout.force() + i));
                    if joined {
                        value[i] = own[i].mul_add(I::Lanes::splat(terms.dt), value[i]);
                    }
                }
            }
            value[D] = mass;
            I::Lanes::store_channels(value, &mut given[VALUE * CHANNELS..], GIVEN);
            if terms.apart {
                I::Lanes::store_channels(own, &mut given[OWN_FORCE * CHANNELS..], GIVEN);
            }
            let spin = mass * I::Lanes::splat(terms.spacing);
            for k in 0..D {
                let (mut moment, mut slope) = ([zero; CHANNELS], [zero; CHANNELS]);
                for i in 0..D {
                    if MOMENTS {
                        moment[i] = spin * I::Lanes::load(field(Layout::<D>::AFFINE + i * D + k));
                    }
                    if SLOPES || terms.apart {
                        slope[i] = pull * tau[i][k];
                    } else {
                        moment[i] = pull.mul_add(tau[i][k], moment[i]);
                    }
                }
                if MOMENTS {
                    I::Lanes::store_channels(moment, &mut given[(MOMENT + k) * CHANNELS..], GIVEN);
                }
                if SLOPES || terms.apart {
                    I::Lanes::store_channels(slope, &mut given[(SLOPE + k) * CHANNELS..], GIVEN);
                }
            }
            lane += I::Lanes::COUNT;
        }
    }
}

/// Stages 1 and 2 for the particles of block `home`: the tile holds their momentum, mass and forces, and the second tile the forces where
/// they are kept apart.
#[inline(always)]
pub(super) fn scatter_block<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    particles: &Particles<T, D>,
    materials: &[MaterialNumbers<T>],
    home: usize,
    terms: &Terms<T>,
    scratch: &mut Scratch<T>,
) {
    let block = &particles.blocks[home];
    let stride = particles.layout.fields();
    let Scratch { tile, second_tile, batch } = scratch;
    tile.fill(T::zero());
    if terms.apart {
        second_tile.fill(T::zero());
    }
    let mut done = 0;
    while done < block.particles {
        let count = (block.particles - done).min(BATCH);
        let first = block.first_chunk + done / CHUNK;
        let chunks = first..first + count.div_ceil(CHUNK);
        let fields = &particles.fields[chunks.start * stride..chunks.end * stride];
        let next = Next::of(&particles.fields[chunks.start * stride..], fields.len());
        weigh::<I, T, K, D, MOMENTS, SLOPES>(batch, block, fields, stride, T::one() / terms.spacing);
        give::<I, T, D, MOMENTS, SLOPES>(
            batch,
            fields,
            particles.layout,
            &particles.labels[chunks],
            materials,
            terms,
        );
        if !terms.apart {
            scatter_batch::<I, T, K, D, MOMENTS, SLOPES>(batch, count, [VALUE, MOMENT, SLOPE], tile, next);
        } else if D == 2 {
            let forced = particles.layout.forced();
            scatter_planar::<I, T, K, D, MOMENTS, SLOPES>(batch, count, forced, [tile, second_tile], next);
        } else {
            // Forces go with slopes, or with MLS's moments.
            scatter_batch::<I, T, K, D, MOMENTS, false>(batch, count, [VALUE, MOMENT, SLOPE], tile, next);
            if SLOPES {
                scatter_batch::<I, T, K, D, false, true>(
                    batch,
                    count,
                    [OWN_FORCE, MOMENT, SLOPE],
                    second_tile,
                    Next::NOTHING,
                );
            } else {
                scatter_batch::<I, T, K, D, true, false>(
                    batch,
                    count,
                    [OWN_FORCE, SLOPE, SLOPE],
                    second_tile,
                    Next::NOTHING,
                );
            }
        }
        done += count;
    }
}

/// Adds to the tile what the batch's particles give: at a node of weight w the channels of `value`, and for each axis those of its group
/// with w's factor of that axis replaced by its moment, or by its slope. Particles of one cell follow one another and are added up in
/// registers.
#[inline(always)]
pub(super) fn scatter_batch<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    batch: &Batch<T>,
    particles: usize,
    [value, moment, slope]: [usize; 3],
    tile: &mut [T],
    next: Next,
) {
    let mut sums = [I::Row::zero(); MAX_SUPPORT * MAX_SUPPORT];
    let mut start = batch.start[0];
    for p in 0..particles {
        next.fetch::<I, T>(p);
        if batch.start[p] != start {
            pour::<I, T, K, D>(&mut sums, start, tile);
            start = batch.start[p];
        }
        let given = &batch.channels[p];
        let beyond = I::Row::splat(batch.beyond[p]);
        let spline = K::row::<T, I::Row>(beyond);
        // By the last axis: `along` goes with the weights of all others, `first` and `second` with the other axes' moments or slopes.
        let mut along = group::<I, T>(given, value) * spline.weight;
        let (mut first, mut second) = ([I::Row::zero(); 2], [I::Row::zero(); 2]);
        if MOMENTS {
            along = group::<I, T>(given, moment + D - 1)
                .mul_add(spline.weight * arms::<T, I::Row>(beyond), along);
            for k in 0..D - 1 {
                first[k] = group::<I, T>(given, moment + k) * spline.weight;
            }
        }
        if SLOPES {
            along = group::<I, T>(given, slope + D - 1).mul_add(spline.slope, along);
            for k in 0..D - 1 {
                second[k] = group::<I, T>(given, slope + k) * spline.weight;
            }
        }
        for i in 0..K::SUPPORT {
            let weight = I::Row::splat(batch.weight[0][i][p]);
            if D == 2 && !MOMENTS && !SLOPES {
                sums[i] = along.mul_add(weight, sums[i]);
                continue;
            }
            let mut plane = along * weight;
            if MOMENTS {
                plane = first[0].mul_add(I::Row::splat(batch.moment[0][i][p]), plane);
            }
            if SLOPES {
                plane = second[0].mul_add(I::Row::splat(batch.slope[0][i][p]), plane);
            }
            if D == 2 {
                sums[i] = sums[i] + plane;
                continue;
            }
            let (moments, slopes) = (first[1] * weight, second[1] * weight);
            for j in 0..K::SUPPORT {
                let row = i * K::SUPPORT + j;
                sums[row] = plane.mul_add(I::Row::splat(batch.weight[1][j][p]), sums[row]);
                if MOMENTS {
                    sums[row] = moments.mul_add(I::Row::splat(batch.moment[1][j][p]), sums[row]);
                }
                if SLOPES {
                    sums[row] = slopes.mul_add(I::Row::splat(batch.slope[1][j][p]), sums[row]);
                }
            }
        }
    }
    pour::<I, T, K, D>(&mut sums, start, tile);
}

/// [`scatter_batch`] in 2D for momentum and, apart from it, forces at once.
#[inline(always)]
fn scatter_planar<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    batch: &Batch<T>,
    particles: usize,
    forced: bool,
    [tile, force_tile]: [&mut [T]; 2],
    next: Next,
) {
    let mut sums = [I::Row::zero(); MAX_SUPPORT * MAX_SUPPORT];
    let mut forces = [I::Row::zero(); MAX_SUPPORT * MAX_SUPPORT];
    let mut start = batch.start[0];
    for p in 0..particles {
        next.fetch::<I, T>(p);
        if batch.start[p] != start {
            pour::<I, T, K, D>(&mut sums, start, tile);
            pour::<I, T, K, D>(&mut forces, start, force_tile);
            start = batch.start[p];
        }
        let given = &batch.channels[p];
        let beyond = I::Row::splat(batch.beyond[p]);
        let spline = K::row::<T, I::Row>(beyond);
        let moment = spline.weight * arms::<T, I::Row>(beyond);
        // Along the last axis; `across` goes with the other axis's moments or slopes.
        let mut along = group::<I, T>(given, VALUE) * spline.weight;
        let mut across = I::Row::zero();
        if MOMENTS {
            along = group::<I, T>(given, MOMENT + 1).mul_add(moment, along);
            across = group::<I, T>(given, MOMENT) * spline.weight;
        }
        let last = if SLOPES { spline.slope } else { moment };
        let mut force_along = group::<I, T>(given, SLOPE + 1) * last;
        if forced {
            force_along = group::<I, T>(given, OWN_FORCE).mul_add(spline.weight, force_along);
        }
        let force_across = group::<I, T>(given, SLOPE) * spline.weight;
        for i in 0..K::SUPPORT {
            let weight = I::Row::splat(batch.weight[0][i][p]);
            sums[i] = along.mul_add(weight, sums[i]);
            if MOMENTS {
                sums[i] = across.mul_add(I::Row::splat(batch.moment[0][i][p]), sums[i]);
            }
            let last = if SLOPES { batch.slope[0][i][p] } else { batch.moment[0][i][p] };
            forces[i] = force_across.mul_add(I::Row::splat(last), force_along.mul_add(weight, forces[i]));
        }
    }
    pour::<I, T, K, D>(&mut sums, start, tile);
    pour::<I, T, K, D>(&mut forces, start, force_tile);
}

/// The four channels of a group, for each node of a row.
#[inline(always)]
fn group<I: InstructionSet<T>, T: Real>(given: &[T; GIVEN], number: usize) -> I::Row {
    I::Row::repeat(&given[number * CHANNELS..])
}

/// Adds a cell's sums to the tile and empties them.
#[inline(always)]
fn pour<I: InstructionSet<T>, T: Real, K: LaneKernel, const D: usize>(
    sums: &mut [I::Row; MAX_SUPPORT * MAX_SUPPORT],
    start: i32,
    tile: &mut [T],
) {
    // A start that is none lies beyond any tile.
    let first = start as u32 as usize * CHANNELS;
    assert!(tile.len() >= first + span::<K, D>());
    for row in 0..rows::<K, D>() {
        let place = first + row_offset::<K, D>(row);
        #[expect(unsafe_code, reason = "16 rows in registers leave no room for checks")]
        // SAFETY: the whole stencil lies in the tile.
        unsafe {
            (I::Row::load_at(tile, place) + sums[row]).store_at(tile, place);
        }
        sums[row] = I::Row::zero();
    }
}
