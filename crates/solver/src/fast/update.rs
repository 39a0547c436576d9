//! Stages 6 to 9 for the particles of a batch: deformation, plastic flow, velocity, contact, position.

use super::grid::block_edge;
use super::particles::{Block, Label, Layout};
use super::simd::{CHUNK, InstructionSet, Lanes};
use super::strain::{
    Flow, Matrix, Moduli, YieldSurface, compose, exponential, flow, left_strain, stretch_factor,
    volume_change, yields,
};
use super::transfer::{BATCH, Scratch, TOLD_CHANGE, TOLD_FIRST, TOLD_SECOND, TOLD_STRIDE, TOLD_VELOCITY};
use crate::collision::{Collider, Interval, collide_particle};
use crate::error::RejectionReason;
use crate::geometry::Vector;
use crate::ledger::StepLedger;
use crate::material::{ConstitutiveModel, Lame, Material};
use crate::real::Real;
use crate::scene::{Advection, Scene};

/// What a chunk's particles are made of, lane by lane.
#[derive(Clone, Debug)]
pub(super) struct ChunkMaterial<T> {
    pub mu: [T; CHUNK],
    pub lambda: [T; CHUNK],
    /// 2 mu + D lambda.
    wave_modulus: [T; CHUNK],
    least: [T; CHUNK],
    greatest: [T; CHUNK],
    hardening: [T; CHUNK],
    ratio: [[T; CHUNK]; 2],
    /// Bits of the lanes that can flow, and of those whose modulus grows with stretch.
    flows: u32,
    stiffens: u32,
}

/// A material's numbers in the form that chunks want.
#[derive(Clone, Debug)]
pub(super) struct MaterialNumbers<T> {
    /// A chunk of nothing else.
    whole: ChunkMaterial<T>,
    lame: Lame<T>,
    wave_modulus: T,
    surface: [T; 5],
    flows: bool,
    stiffens: bool,
}

impl<T: Real> MaterialNumbers<T> {
    pub fn of<const D: usize>(material: &Material<T>) -> Self {
        let lame = ConstitutiveModel::<T, D>::lame(material);
        let (surface, flows, stiffens) = match material {
            Material::Snow(snow) => {
                let (lower, upper) = snow.plastic_ratio_bounds;
                // As in `Snow::wave_modulus`: infinite bounds are the greatest number here.
                let upper = upper.min(T::max_value().unwrap_or(upper));
                let surface =
                    [-snow.critical_compression, snow.critical_stretch, snow.hardening, lower, upper];
                (surface, true, !snow.stretch_is_covered())
            }
            Material::Elastic(_) => ([T::zero(); 5], false, true),
        };
        let (wave_modulus, whole) = (lame.wave_modulus::<D>(), ChunkMaterial::nothing());
        let mut numbers = MaterialNumbers { whole, lame, wave_modulus, surface, flows, stiffens };
        let mut whole = ChunkMaterial::nothing();
        (0..CHUNK).for_each(|lane| whole.put(lane, &numbers));
        numbers.whole = whole;
        numbers
    }
}

impl<T: Real> ChunkMaterial<T> {
    fn nothing() -> Self {
        let zero = [T::zero(); CHUNK];
        ChunkMaterial {
            mu: zero,
            lambda: zero,
            wave_modulus: zero,
            least: zero,
            greatest: zero,
            hardening: zero,
            ratio: [zero; 2],
            flows: 0,
            stiffens: 0,
        }
    }

    fn put(&mut self, lane: usize, material: &MaterialNumbers<T>) {
        (self.mu[lane], self.lambda[lane]) = (material.lame.mu, material.lame.lambda);
        self.wave_modulus[lane] = material.wave_modulus;
        let [least, greatest, hardening, lower, upper] = material.surface;
        (self.least[lane], self.greatest[lane], self.hardening[lane]) = (least, greatest, hardening);
        (self.ratio[0][lane], self.ratio[1][lane]) = (lower, upper);
        self.flows |= u32::from(material.flows) << lane;
        self.stiffens |= u32::from(material.stiffens) << lane;
    }

    /// Of the particles with `labels`; `mixed` has room for one that has to be put together.
    #[inline(always)]
    pub fn of<'a>(
        labels: &[Label; CHUNK],
        materials: &'a [MaterialNumbers<T>],
        mixed: &'a mut Option<Self>,
    ) -> &'a Self {
        let first = labels[0].material;
        if materials.len() == 1 || labels.iter().all(|label| label.material == first) {
            return &materials[first as usize].whole;
        }
        mixed.insert(Self::mix(labels, materials))
    }

    #[inline(never)]
    fn mix(labels: &[Label; CHUNK], materials: &[MaterialNumbers<T>]) -> Self {
        let mut chunk = Self::nothing();
        for (lane, label) in labels.iter().enumerate() {
            chunk.put(lane, &materials[label.material as usize]);
        }
        chunk
    }

    #[inline(always)]
    pub fn moduli<V: Lanes<T>>(&self, lane: usize) -> Moduli<V> {
        Moduli { mu: V::load(&self.mu[lane..]), lambda: V::load(&self.lambda[lane..]) }
    }

    #[inline(always)]
    fn surface<V: Lanes<T>>(&self, lane: usize) -> YieldSurface<V> {
        YieldSurface {
            least: V::load(&self.least[lane..]),
            greatest: V::load(&self.greatest[lane..]),
            hardening: V::load(&self.hardening[lane..]),
            ratio: [V::load(&self.ratio[0][lane..]), V::load(&self.ratio[1][lane..])],
        }
    }
}

/// What a step asks of the update.
pub(super) struct Update<'a, T: Real, const D: usize> {
    pub scene: &'a Scene<T, D>,
    pub materials: &'a [MaterialNumbers<T>],
    /// The FLIP share a; `None` for affine transfers.
    pub share: Option<T>,
    pub inverse_inertia: T,
    pub interval: Interval<T>,
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

/// A centre and a radius [m] of a ball round the tile of `block`.
pub(super) fn surroundings<T: Real, const D: usize>(first_node: [i32; D], spacing: T) -> (Vector<T, D>, T) {
    let half = T::of(0.5 * f64::from(block_edge::<D>()));
    let centre = Vector::from_fn(|k, _| (T::of_index(first_node[k]) + half) * spacing);
    // Half an edge, two cells' drift (one, and one in this step) and a node's distance from the stencil's middle.
    (centre, (half + T::of(4.0)) * spacing * T::of((D as f64).sqrt()))
}

/// Whether some obstacle of `colliders` reaches into the ball at `time` [s].
pub(super) fn is_near<T: Real, const D: usize>(
    colliders: &[Collider<T, D>],
    (centre, radius): &(Vector<T, D>, T),
    time: f64,
) -> bool {
    colliders.iter().any(|collider| {
        let place = centre - collider.velocity * T::of(time);
        collider.shape.surface(&place).distance <= *radius
    })
}

/// Updates `chunks` chunks of `block` in place from what the batch was told.
#[inline(always)]
pub(super) fn update_batch<
    I: InstructionSet<T>,
    T: Real,
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
            let told = scratch.told(number * CHUNK + lane);
            update_lanes::<I::Lanes, T, D, MOMENTS, SLOPES>(
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
pub(super) fn load_matrix<T: Real, V: Lanes<T>, const D: usize>(
    chunk: &[[T; CHUNK]],
    field: usize,
    lane: usize,
) -> Matrix<V, D> {
    let mut m = [[V::splat(T::zero()); D]; D];
    for i in 0..D {
        for j in 0..D {
            m[i][j] = V::load(&chunk[field + i * D + j][lane..]);
        }
    }
    m
}

#[inline(always)]
fn store_matrix<T: Real, V: Lanes<T>, const D: usize>(
    m: &Matrix<V, D>,
    chunk: &mut [[T; CHUNK]],
    field: usize,
    lane: usize,
) {
    for i in 0..D {
        for j in 0..D {
            m[i][j].store(&mut chunk[field + i * D + j][lane..]);
        }
    }
}

/// The matrix whose columns are the groups from `group` on of what particles are told, times `factor`.
#[inline(always)]
fn told_matrix<T: Real, V: Lanes<T>, const D: usize>(told: &[T], group: usize, factor: V) -> Matrix<V, D> {
    let mut m = [[factor; D]; D];
    for j in 0..D {
        let column = V::load_channels(&told[(group + j) * super::simd::CHANNELS..], TOLD_STRIDE);
        for i in 0..D {
            m[i][j] = column[i] * factor;
        }
    }
    m
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the parts of a chunk")]
fn update_lanes<V: Lanes<T>, T: Real, const D: usize, const MOMENTS: bool, const SLOPES: bool>(
    update: &Update<T, D>,
    told: &[T],
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
    let gradient = told_matrix::<T, V, D>(told, TOLD_FIRST, factor);
    let mut increment = gradient;
    for i in 0..D {
        for j in 0..D {
            increment[i][j] = gradient[i][j] * dt;
        }
    }
    let turned = one + volume_change::<T, V, D>(&increment);
    let upright = V::bits(turned.above(zero)) & (u32::MAX >> (32 - V::COUNT));
    if upright != u32::MAX >> (32 - V::COUNT) && report.rejection.is_none() {
        let first = (!upright).trailing_zeros() as usize;
        let mut values = [T::zero(); CHUNK];
        turned.store(&mut values);
        let reason = RejectionReason::Inverted { determinant: values[first].as_f64() };
        report.rejection = Some((labels[lane + first].id, reason));
    }
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
    let group = V::load_channels(&told[TOLD_VELOCITY * super::simd::CHANNELS..], TOLD_STRIDE);
    let mut interpolated = [zero; D];
    let mut kept = [zero; D];
    let mut squared = zero;
    interpolated.copy_from_slice(&group[..D]);
    kept.copy_from_slice(&group[..D]);
    if let Some(share) = update.share {
        let change = if D == 2 {
            [group[2], group[3], zero, zero]
        } else {
            V::load_channels(&told[TOLD_CHANGE * super::simd::CHANNELS..], TOLD_STRIDE)
        };
        let (flip, pic) = (V::splat(share), V::splat(T::one() - share));
        for i in 0..D {
            let before = V::load(&chunk[Layout::<D>::VELOCITY + i][lane..]);
            kept[i] = (before + change[i]).mul_add(flip, interpolated[i] * pic);
        }
    }
    let mut affine_squared = zero;
    if MOMENTS {
        let affine = if SLOPES { told_matrix::<T, V, D>(told, TOLD_SECOND, to_affine) } else { gradient };
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
        touch(update, V::COUNT, masses, &unpack::<V, T, D>(&x), [&mut numbers, &mut movers], ledger);
        pack::<V, T, D>(&numbers, &mut kept);
        pack::<V, T, D>(&movers, &mut advecting);
    }
    let mut moved_squared = zero;
    let edge = block_edge::<D>();
    let half_cell = if update.inverse_inertia == number(3.0) { T::zero() } else { number(0.5) };
    let mut strayed = zero;
    for i in 0..D {
        let step = advecting[i] * dt;
        moved_squared = step.mul_add(step, moved_squared);
        let place = x[i] + step;
        place.store(&mut chunk[Layout::<D>::POSITION + i][lane..]);
        kept[i].store(&mut chunk[Layout::<D>::VELOCITY + i][lane..]);
        squared = kept[i].mul_add(kept[i], squared);
        // How far the stencil's first node lies within what the tile allows for, from 0 to edge + 1.
        let cells = (place * per_spacing + V::splat(half_cell)).floor()
            - V::splat(T::of_index(block.corner[i] * edge));
        strayed = strayed.max(-cells).max(cells - V::splat(T::of_index(edge + 1)));
    }
    report.strayed |= V::bits(strayed.above(zero)) != 0;
    let too_far = V::bits(moved_squared.above(V::splat(spacing * spacing)));
    let whole = V::bits(V::splat(T::max_value().unwrap_or(spacing)).above(moved_squared));
    let refused = too_far | (!whole & (u32::MAX >> (32 - V::COUNT)));
    if refused != 0 && report.rejection.is_none() {
        let first = refused.trailing_zeros() as usize;
        let mut values = [T::zero(); CHUNK];
        moved_squared.store(&mut values);
        let cells = values[first].as_f64().sqrt() / spacing.as_f64();
        report.rejection = Some((labels[lane + first].id, RejectionReason::TooFar { cells }));
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
    let hardened = scale * exponential::<T, V>(surface.hardening * (one - bounded));
    let volume = V::load(&chunk[Layout::<D>::VOLUME][lane..]);
    let released = (energies[0] * stiffness - energies[1] * hardened) * volume;
    V::select(mask, released, zero).store(&mut sums.plastic_loss[lane..]);
    V::select(mask, bounded, before).store(&mut chunk[Layout::<D>::RATIO][lane..]);
    V::select(mask, hardened, stiffness).store(&mut chunk[Layout::<D>::STIFFNESS][lane..]);
}

/// Lanes as numbers, by component.
type Unpacked<T, const D: usize> = [[T; CHUNK]; D];

#[inline(always)]
fn unpack<V: Lanes<T>, T: Real, const D: usize>(lanes: &[V; D]) -> Unpacked<T, D> {
    let mut numbers = [[T::zero(); CHUNK]; D];
    for i in 0..D {
        lanes[i].store(&mut numbers[i]);
    }
    numbers
}

#[inline(always)]
fn pack<V: Lanes<T>, T: Real, const D: usize>(numbers: &Unpacked<T, D>, lanes: &mut [V; D]) {
    for i in 0..D {
        lanes[i] = V::load(&numbers[i]);
    }
}

/// Contact of `count` particles, one by one: of the velocities they keep and of those that move them.
#[inline(never)]
fn touch<T: Real, const D: usize>(
    update: &Update<T, D>,
    count: usize,
    masses: &[T],
    places: &Unpacked<T, D>,
    [kept, movers]: [&mut Unpacked<T, D>; 2],
    ledger: &mut StepLedger<D>,
) {
    for lane in 0..count {
        let of = |numbers: &Unpacked<T, D>| Vector::<T, D>::from_fn(|i, _| numbers[i][lane]);
        let (place, mut velocity, mut mover) = (of(places), of(kept), of(movers));
        let mass = masses[lane];
        collide_particle(update.scene, mass, &place, &mut velocity, &mut mover, update.interval, ledger);
        for i in 0..D {
            (kept[i][lane], movers[i][lane]) = (velocity[i], mover[i]);
        }
    }
}
