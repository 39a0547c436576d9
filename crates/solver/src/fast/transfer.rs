//! Between particles and grid, block by block through a tile of nodes: stages 1, 2 and 7 of a step.
//!
//! A particle's share of the four nodes of a row is one vector, four nodes by four channels. Lengths are in units of the spacing here.

use super::grid::{block_edge, tile_edge, tile_nodes};
use super::particles::{Block, Label, Layout, Particles};
use super::simd::{CHANNELS, CHUNK, InstructionSet, Lanes, ROW_NODES, Row};
use super::strain::kirchhoff;
use super::update::{BlockReport, ChunkMaterial, MaterialNumbers, Update, update_batch};
use super::weights::{LaneKernel, Spline, arms};
use crate::kernel::MAX_SUPPORT;
use crate::real::Real;

/// Particles of which weights and channels are held at once: few enough for the first-level cache.
pub(super) const BATCH: usize = 4 * CHUNK;
/// Groups of four channels that a particle gives: value, slopes or moments by axis, both by axis, and the value of forces.
const GROUPS: usize = 8;
const GIVEN: usize = GROUPS * CHANNELS;
/// Group of a particle's values: momentum and mass.
const VALUE: usize = 0;
/// First groups of what goes with moments, and with slopes.
const MOMENT: usize = 1;
const SLOPE: usize = 4;
/// Group of its own force.
const OWN_FORCE: usize = 7;

/// Weights by axis but the last, node and particle.
type Weights<T> = [[[T; BATCH]; MAX_SUPPORT]; 2];

/// Memory of a task.
pub(super) struct Scratch<T> {
    pub tile: Vec<T>,
    pub second_tile: Vec<T>,
    batch: Box<Batch<T>>,
}

#[repr(align(64))]
struct Batch<T> {
    /// The tile's number of the stencil's first node.
    start: [i32; BATCH],
    /// How far the particle is beyond a node on the last axis.
    beyond: [T; BATCH],
    weight: Weights<T>,
    slope: Weights<T>,
    moment: Weights<T>,
    /// What particles give to, or are told by, their nodes: groups of four channels.
    channels: [[T; GIVEN]; BATCH],
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

    /// Channels of particle `p` of the batch, as many as lanes need that begin there.
    #[inline(always)]
    pub(super) fn told(&self, p: usize) -> &[T] {
        &self.batch.channels.as_flattened()[p * GIVEN..]
    }
}

/// Numbers from one told particle to the next.
pub(super) const TOLD_STRIDE: usize = GIVEN;

/// What a step asks of the transfers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms<T> {
    pub spacing: T,
    pub dt: T,
    /// h^2 / D of the kernel.
    pub inverse_inertia: T,
    /// Whether nodes keep forces apart from momentum.
    pub apart: bool,
}

/// The fields of the next batch, to be fetched while the present one is worked on.
#[derive(Clone, Copy)]
struct Next {
    first: *const u8,
    /// Bytes, per particle of the present batch.
    share: usize,
}

/// Bytes of a cache line.
const LINE: usize = 64;

impl Next {
    /// `fields` are those of all batches from the present one on, of which `present` are its own.
    #[inline(always)]
    fn of<T>(fields: &[[T; CHUNK]], present: usize) -> Self {
        let next = &fields[present.min(fields.len())..];
        let bytes = std::mem::size_of_val(&next[..next.len().min(present)]);
        Next { first: next.as_ptr().cast(), share: bytes.div_ceil(BATCH * LINE) * LINE }
    }

    const NOTHING: Next = Next { first: std::ptr::null(), share: 0 };

    #[inline(always)]
    fn fetch<I: InstructionSet<T>, T>(&self, p: usize) {
        let mut line = 0;
        while line < self.share {
            I::prefetch(self.first.wrapping_add(p * self.share + line));
            line += LINE;
        }
    }
}

/// Fills in weights, and where stencils begin in the tile, for `chunks` chunks.
#[inline(always)]
fn weigh<
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
const fn rows<K: LaneKernel, const D: usize>() -> usize {
    if D == 3 { K::SUPPORT * K::SUPPORT } else { K::SUPPORT }
}

/// Where a row of the stencil lies in the tile, from its first node.
#[inline(always)]
fn row_offset<K: LaneKernel, const D: usize>(row: usize) -> usize {
    let width = tile_edge::<D>();
    let nodes = if D == 3 { (row / K::SUPPORT * width + row % K::SUPPORT) * width } else { row * width };
    nodes * CHANNELS
}

/// Numbers of the tile from the first to the last of a stencil.
#[inline(always)]
fn span<K: LaneKernel, const D: usize>() -> usize {
    row_offset::<K, D>(rows::<K, D>() - 1) + ROW_NODES * CHANNELS
}

/// Adds to the tile what the batch's particles give: at a node of weight w the channels of `value`, and for each axis those of its group
/// with w's factor of that axis replaced by its moment, or by its slope. Particles of one cell follow one another and are added up in
/// registers.
#[inline(always)]
fn scatter_batch<
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
    let first = start as usize * CHANNELS;
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

/// Tells the batch's particles what their nodes in the tile say: group 0 the sum of w times the channels, then for each axis that sum with
/// w's factor of the axis replaced by its slope, and then by its moment.
#[inline(always)]
fn gather_batch<
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
    let mut start = -1;
    let zero = I::Row::zero();
    for p in 0..particles {
        next.fetch::<I, T>(p);
        if batch.start[p] != start {
            start = batch.start[p];
            let first = start as usize * CHANNELS;
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

/// Groups in which a particle finds what it is told: velocity; by axis the velocity gradient; C; change of velocity in 3D (that of 2D
/// is in channels 2 and 3 of the velocity's group).
pub(super) const TOLD_VELOCITY: usize = 0;
pub(super) const TOLD_FIRST: usize = 1;
pub(super) const TOLD_SECOND: usize = 4;
pub(super) const TOLD_CHANGE: usize = 4;

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
            let mut h = [[zero; D]; D];
            for i in 0..D {
                for j in 0..D {
                    h[i][j] = I::Lanes::load(field(Layout::<D>::STRAIN + i * D + j));
                }
            }
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
        let batch = &mut scratch.batch;
        weigh::<I, T, K, D, MOMENTS, SLOPES>(batch, block, fields, stride, per_spacing);
        gather_batch::<I, T, K, D, MOMENTS, SLOPES>(batch, count, TOLD_VELOCITY, &scratch.tile, next);
        if D == 3 && update.share.is_some() {
            gather_batch::<I, T, K, D, false, false>(
                batch,
                count,
                TOLD_CHANGE,
                &scratch.second_tile,
                Next::NOTHING,
            );
        }
        update_batch::<I, T, D, MOMENTS, SLOPES>(update, scratch, layout, block, fields, labels, report);
    }
}
