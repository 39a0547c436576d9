//! Stages 6 to 9 for the particles of a batch: deformation, plastic flow, velocity, contact, position.

use super::batch::{BATCH, Scratch};
use super::contact::{collide_lanes, pack, unpack};
use super::gather::{TOLD_CHANGE, TOLD_FIRST, TOLD_SECOND, TOLD_VELOCITY, Told};
use super::grid::block_edge;
use super::material::{ChunkMaterial, MaterialNumbers};
use super::particles::{Block, Label, Layout, load_matrix, store_matrix};
use super::simd::{CHUNK, InstructionSet, Lanes};
use super::strain::{
    Flow, Matrix, compose, exponential, flow, left_strain, stretch_factor, volume_change, yields,
};
use super::weights::LaneKernel;
use crate::collision::Interval;
use crate::error::RejectionReason;
use crate::ledger::StepLedger;
use crate::real::Real;
use crate::scene::{Advection, Scene};

/// What a step asks of the update.
pub(super) struct Update<'a, T: Real, const D: usize> {
    pub scene: &'a Scene<T, D>,
    pub materials: &'a [MaterialNumbers<T>],
    /// The FLIP share a; `None` for affine transfers.
    pub share: Option<T>,
    pub inverse_inertia: T,
    pub interval: Interval<T>,
    /// Whether particles have kept the end of the step, a trapezoidal one, and are told of its middle, by which they move and deform.
    pub midway: bool,
}

/// What became of the particles of a block.
#[derive(Clone, Debug)]
pub(super) struct BlockReport<T, const D: usize> {
    /// Kinetic energy [J].
    pub kinetic: f64,
    /// Energy lost to plastic flow [J].
    pub plastic_loss: f64,
    pub clamps: u64,
    /// The greatest c_p^2 and |v_p|^2 [m^2/s^2].
    pub fastest_wave_squared: T,
    pub fastest_squared: T,
    /// Whether a particle has left what the block's tile allows for.
    pub strayed: bool,
    /// The first particle that stands against the step.
    pub rejection: Option<(u32, RejectionReason)>,
    /// What obstacles did, where one is near.
    pub contact: Option<Box<StepLedger<D>>>,
}

impl<T: Real, const D: usize> BlockReport<T, D> {
    pub fn new() -> Self {
        BlockReport {
            kinetic: 0.0,
            plastic_loss: 0.0,
            clamps: 0,
            fastest_wave_squared: T::zero(),
            fastest_squared: T::zero(),
            strayed: false,
            rejection: None,
            contact: None,
        }
    }
}

/// Updates `chunks` chunks of `block` in place from what the batch was told.
#[inline(always)]
pub(super) fn update_batch<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    update: &Update<T, D>,
    scratch: &Scratch<T>,
    layout: Layout<D>,
    block: &Block<D>,
    fields: &mut [[T; CHUNK]],
    labels: &mut [[Label; CHUNK]],
    report: &mut BlockReport<T, D>,
) {
    debug_assert!(labels.len() * CHUNK <= BATCH);
    for (number, (chunk, labels)) in fields.chunks_exact_mut(layout.fields()).zip(labels).enumerate() {
        let mut mixed = None;
        let material = ChunkMaterial::of(labels, update.materials, &mut mixed);
        let mut sums = ChunkSums { kinetic: [T::zero(); CHUNK], plastic_loss: [T::zero(); CHUNK] };
        let mut lane = 0;
        while lane < CHUNK {
            let told = Told::from(&scratch.batch, number * CHUNK + lane);
            update_lanes::<I::Lanes, T, K, D, MOMENTS, SLOPES>(
                update, told, block, chunk, labels, lane, material, &mut sums, report,
            );
            lane += I::Lanes::COUNT;
        }
        for lane in 0..CHUNK {
            report.kinetic += sums.kinetic[lane].as_f64();
            report.plastic_loss += sums.plastic_loss[lane].as_f64();
        }
    }
}

/// Sums of a chunk, lane by lane.
struct ChunkSums<T> {
    kinetic: [T; CHUNK],
    plastic_loss: [T; CHUNK],
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the parts of a chunk")]
fn update_lanes<
    V: Lanes<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    update: &Update<T, D>,
    told: Told<T>,
    block: &Block<D>,
    chunk: &mut [[T; CHUNK]],
    labels: &mut [Label; CHUNK],
    lane: usize,
    material: &ChunkMaterial<T>,
    sums: &mut ChunkSums<T>,
    report: &mut BlockReport<T, D>,
) {
    let number = |x: f64| T::of(x);
    let (zero, one) = (V::splat(T::zero()), V::splat(T::one()));
    let spacing = update.scene.spacing;
    let per_spacing = V::splat(T::one() / spacing);
    let dt = V::splat(update.interval.dt);
    let to_affine = V::splat(update.inverse_inertia / spacing);
    let mass = V::load(&chunk[Layout::<D>::MASS][lane..]);

    // Stage 6.
    let factor = if SLOPES { per_spacing } else { to_affine };
    let gradient = told.matrix::<V, D>(TOLD_FIRST, factor);
    let mut increment = gradient;
    for i in 0..D {
        for j in 0..D {
            increment[i][j] = gradient[i][j] * dt;
        }
    }
    let turned = one + volume_change::<T, V, D>(&increment);
    let all = u32::MAX >> (32 - V::COUNT);
    let inverted = !V::bits(turned.above(zero)) & all;
    let strain = load_matrix::<T, V, D>(chunk, Layout::<D>::STRAIN, lane);
    let mut strain = compose::<T, V, D>(&increment, &strain);
    if material.flows != 0 {
        flow_lanes::<V, T, D>(&mut strain, chunk, labels, lane, material, sums, report);
    }
    store_matrix(&strain, chunk, Layout::<D>::STRAIN, lane);
    let stiffness = V::load(&chunk[Layout::<D>::STIFFNESS][lane..]);
    let volume = V::load(&chunk[Layout::<D>::VOLUME][lane..]);
    let mut modulus = V::load(&material.wave_modulus[lane..]);
    if material.stiffens != 0 {
        let mut stiffens = [T::zero(); CHUNK];
        for k in 0..CHUNK {
            stiffens[k] = T::of_index((material.stiffens >> k & 1) as i32);
        }
        let mask = V::load(&stiffens[lane..]).above(zero);
        modulus = V::select(mask, modulus * stretch_factor::<T, V, D>(&strain), modulus);
    }
    let wave = modulus * stiffness * volume / mass;

    // Stage 7.
    let group = told.group::<V>(TOLD_VELOCITY);
    let mut interpolated = [zero; D];
    let mut kept = [zero; D];
    let mut squared = zero;
    interpolated.copy_from_slice(&group[..D]);
    kept.copy_from_slice(&group[..D]);
    if update.midway {
        for i in 0..D {
            kept[i] = V::load(&chunk[Layout::<D>::VELOCITY + i][lane..]);
        }
    }
    if let Some(share) = update.share {
        let (flip, pic) = (V::splat(share), V::splat(T::one() - share));
        let change = if D == 2 { [group[2], group[3], zero, zero] } else { told.group::<V>(TOLD_CHANGE) };
        for i in 0..D {
            let before = V::load(&chunk[Layout::<D>::VELOCITY + i][lane..]);
            kept[i] = (before + change[i]).mul_add(flip, interpolated[i] * pic);
        }
    }
    let mut affine_squared = zero;
    if MOMENTS {
        let affine = if update.midway {
            load_matrix::<T, V, D>(chunk, Layout::<D>::AFFINE, lane)
        } else if SLOPES {
            told.matrix::<V, D>(TOLD_SECOND, to_affine)
        } else {
            gradient
        };
        for i in 0..D {
            for j in 0..D {
                affine_squared = affine[i][j].mul_add(affine[i][j], affine_squared);
            }
        }
        store_matrix(&affine, chunk, Layout::<D>::AFFINE, lane);
    }

    // Stages 8 and 9.
    let mut advecting = if update.scene.advection == Advection::Blended { kept } else { interpolated };
    let mut x = [zero; D];
    for i in 0..D {
        x[i] = V::load(&chunk[Layout::<D>::POSITION + i][lane..]);
    }
    if let Some(ledger) = report.contact.as_deref_mut() {
        let (mut numbers, mut movers) = (unpack::<V, T, D>(&kept), unpack::<V, T, D>(&advecting));
        let masses = &chunk[Layout::<D>::MASS][lane..];
        collide_lanes(update, V::COUNT, masses, &unpack::<V, T, D>(&x), [&mut numbers, &mut movers], ledger);
        pack::<V, T, D>(&numbers, &mut kept);
        pack::<V, T, D>(&movers, &mut advecting);
    }
    let mut moved_squared = zero;
    let edge = block_edge::<D>();
    let mut strayed = zero;
    for i in 0..D {
        let step = advecting[i] * dt;
        moved_squared = step.mul_add(step, moved_squared);
        let place = x[i] + step;
        place.store(&mut chunk[Layout::<D>::POSITION + i][lane..]);
        kept[i].store(&mut chunk[Layout::<D>::VELOCITY + i][lane..]);
        squared = kept[i].mul_add(kept[i], squared);
        // How far the stencil's first node lies within what the tile allows for, from 0 to edge + 1.
        let cells =
            K::place::<T, V>(place * per_spacing).node - V::splat(T::of_index(block.corner[i] * edge));
        strayed = strayed.max(-cells).max(cells - V::splat(T::of_index(edge + 1)));
    }
    report.strayed |= V::bits(strayed.above(zero)) != 0;
    let too_far = V::bits(moved_squared.above(V::splat(spacing * spacing)));
    let whole = V::bits(V::splat(T::max_value().unwrap_or(spacing)).above(moved_squared));
    let refused = inverted | too_far | (!whole & all);
    if refused != 0 && report.rejection.is_none() {
        // The first particle's reason, however many stand side by side.
        let first = refused.trailing_zeros() as usize;
        let mut values = [T::zero(); CHUNK];
        let reason = if inverted >> first & 1 != 0 {
            turned.store(&mut values);
            RejectionReason::Inverted { determinant: values[first].as_f64() }
        } else {
            moved_squared.store(&mut values);
            RejectionReason::TooFar { cells: values[first].as_f64().sqrt() / spacing.as_f64() }
        };
        report.rejection = Some((labels[lane + first].id, reason));
    }
    let inertia = V::splat(spacing * spacing / update.inverse_inertia);
    let kinetic = V::splat(number(0.5)) * mass * affine_squared.mul_add(inertia, squared);
    kinetic.store(&mut sums.kinetic[lane..]);
    report.fastest_wave_squared = greatest(wave, report.fastest_wave_squared);
    report.fastest_squared = greatest(squared, report.fastest_squared);
}

/// The greatest of the lanes and `least`; lanes that are no number do not count.
#[inline(always)]
fn greatest<T: Real, V: Lanes<T>>(lanes: V, least: T) -> T {
    let mut values = [T::zero(); CHUNK];
    lanes.max(V::splat(least)).store(&mut values);
    let mut greatest = least;
    for value in &values[..V::COUNT] {
        if *value > greatest {
            greatest = *value;
        }
    }
    greatest
}

/// The return map where a trial state lies outside the yield surface.
#[inline(always)]
fn flow_lanes<V: Lanes<T>, T: Real, const D: usize>(
    strain: &mut Matrix<V, D>,
    chunk: &mut [[T; CHUNK]],
    labels: &mut [Label; CHUNK],
    lane: usize,
    material: &ChunkMaterial<T>,
    sums: &mut ChunkSums<T>,
    report: &mut BlockReport<T, D>,
) {
    let e = left_strain::<T, V, D>(strain);
    let surface = material.surface::<V>(lane);
    let flowing = yields::<T, V, D>(&e, &surface) & (material.flows >> lane);
    if flowing == 0 {
        return;
    }
    let mut flags = [T::zero(); CHUNK];
    for k in 0..V::COUNT {
        flags[k] = T::of_index((flowing >> k & 1) as i32);
    }
    let zero = V::splat(T::zero());
    let one = V::splat(T::one());
    let mask = V::load(&flags).above(zero);
    let moduli = material.moduli::<V>(lane);
    let before = V::load(&chunk[Layout::<D>::RATIO][lane..]);
    let stiffness = V::load(&chunk[Layout::<D>::STIFFNESS][lane..]);
    let Flow { h, ratio, energies } = flow::<T, V, D>(strain, &e, before, &moduli, &surface);
    for i in 0..D {
        for j in 0..D {
            strain[i][j] = V::select(mask, h[i][j], strain[i][j]);
        }
    }
    let [lower, upper] = surface.ratio;
    let bounded = ratio.max(lower).min(upper);
    let met = (V::bits(bounded.above(ratio)) | V::bits(ratio.above(bounded))) & flowing;
    if met != 0 {
        for k in 0..V::COUNT {
            labels[lane + k].clamped |= met >> k & 1 != 0;
        }
        // Lanes that only fill up the chunk have no mass and do not count.
        let particles = V::bits(V::load(&chunk[Layout::<D>::MASS][lane..]).above(zero));
        report.clamps += u64::from((met & particles).count_ones());
    }
    let scale = V::load(&chunk[Layout::<D>::SCALE][lane..]);
    let hardened = scale * exponential::<T, V>(surface.hardening * (one - bounded)).min(surface.limit);
    let volume = V::load(&chunk[Layout::<D>::VOLUME][lane..]);
    let released = (energies[0] * stiffness - energies[1] * hardened) * volume;
    V::select(mask, released, zero).store(&mut sums.plastic_loss[lane..]);
    V::select(mask, bounded, before).store(&mut chunk[Layout::<D>::RATIO][lane..]);
    V::select(mask, hardened, stiffness).store(&mut chunk[Layout::<D>::STIFFNESS][lane..]);
}
