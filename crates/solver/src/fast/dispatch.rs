//! The kernels, compiled for each instruction set, and the choice among them.

use std::any::Any;
use std::sync::OnceLock;

use super::batch::Scratch;
use super::energy;
use super::gather::{self, End};
use super::grid::Node;
use super::hessian::{self, Linearisation};
use super::material::MaterialNumbers;
use super::nodes::{self, NodeEnergies, Push};
use super::particles::{Block, Label, Layout, Particles};
use super::scatter::{self, Terms};
#[cfg(test)]
use super::simd::Lanes;
use super::simd::{CHUNK, InstructionSet};
use super::sort::{self, Course};
use super::update::{BlockReport, Update};
use super::weights::LaneKernel;
use crate::geometry::Vector;
use crate::kernel::{Cubic, KernelKind, Quadratic};
use crate::real::Real;
use crate::scene::{Scene, Transfer};
use crate::watchdog::StoredEnergy;

/// An instruction set that the CPU has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Set {
    Avx2,
    Avx512,
}

impl Set {
    /// Those the CPU has, the widest last.
    pub fn all() -> Vec<Set> {
        let mut sets = Vec::new();
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            sets.push(Set::Avx2);
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512bw")
            {
                sets.push(Set::Avx512);
            }
        }
        sets
    }

    /// The widest that the CPU has. The environment variable `SNOWLAB_INSTRUCTIONS=avx2`, read once, makes it AVX2 on a wider CPU too, to
    /// measure or count it there; results have the same bits with both, and any other value has no effect.
    pub fn widest() -> Option<Set> {
        static NARROW: OnceLock<bool> = OnceLock::new();
        let narrow = *NARROW
            .get_or_init(|| std::env::var_os("SNOWLAB_INSTRUCTIONS").is_some_and(|value| value == "avx2"));
        let sets = Set::all();
        if narrow { sets.first().copied() } else { sets.last().copied() }
    }
}

/// Numbers with registers of their own in both sets.
pub trait HasRegisters: Sized {
    type Narrow: InstructionSet<Self>;
    type Wide: InstructionSet<Self>;
}

impl HasRegisters for f32 {
    type Narrow = super::x86::Avx2;
    type Wide = super::x86::Avx512;
}
impl HasRegisters for f64 {
    type Narrow = super::x86::Avx2;
    type Wide = super::x86::Avx512;
}

/// `$name(set, ...)` runs `$body::<I, ...>(...)`, compiled for the instruction set that `set` names.
macro_rules! for_each_set {
    (fn $name:ident[$($generic:tt)*][$($given:tt)*]($($argument:ident: $kind:ty),* $(,)?) -> $result:ty = $($body:ident)::+) => {
        #[allow(clippy::too_many_arguments, reason = "the parts of a stage")]
        fn $name<$($generic)*>(set: Set, $($argument: $kind),*) -> $result {
            #[target_feature(enable = "avx2,fma")]
            #[allow(clippy::too_many_arguments, reason = "the parts of a stage")]
            fn narrow<$($generic)*>($($argument: $kind),*) -> $result {
                $($body)::+::<<T as HasRegisters>::Narrow, $($given)*>($($argument),*)
            }
            #[target_feature(enable = "avx2,fma,avx512f,avx512dq,avx512vl,avx512bw")]
            #[allow(clippy::too_many_arguments, reason = "the parts of a stage")]
            fn wide<$($generic)*>($($argument: $kind),*) -> $result {
                $($body)::+::<<T as HasRegisters>::Wide, $($given)*>($($argument),*)
            }
            #[expect(unsafe_code, reason = "functions compiled for instructions that the CPU has")]
            // SAFETY: a set is made only where its instructions were found.
            unsafe {
                match set {
                    Set::Avx2 => narrow::<$($given)*>($($argument),*),
                    Set::Avx512 => wide::<$($given)*>($($argument),*),
                }
            }
        }
    };
}

for_each_set!(
    fn scatter[T: Real, K: LaneKernel, const D: usize, const MOMENTS: bool, const SLOPES: bool][T, K, D, MOMENTS, SLOPES](
        particles: &Particles<T, D>,
        materials: &[MaterialNumbers<T>],
        home: usize,
        terms: &Terms<T>,
        scratch: &mut Scratch<T>,
    ) -> () = scatter::scatter_block
);
for_each_set!(
    fn gather[T: Real, K: LaneKernel, const D: usize, const MOMENTS: bool, const SLOPES: bool][T, K, D, MOMENTS, SLOPES](
        update: &Update<T, D>,
        layout: Layout<D>,
        block: &Block<D>,
        fields: &mut [[T; CHUNK]],
        labels: &mut [[Label; CHUNK]],
        scratch: &mut Scratch<T>,
        report: &mut BlockReport<T, D>,
    ) -> () = gather::gather_block
);
for_each_set!(
    fn keep[T: Real, K: LaneKernel, const D: usize, const MOMENTS: bool][T, K, D, MOMENTS](
        end: &End<T>,
        layout: Layout<D>,
        block: &Block<D>,
        fields: &mut [[T; CHUNK]],
        scratch: &mut Scratch<T>,
    ) -> () = gather::keep_block
);
for_each_set!(
    fn hessian[T: Real, K: LaneKernel, const D: usize, const MOMENTS: bool, const SLOPES: bool][T, K, D, MOMENTS, SLOPES](
        particles: &Particles<T, D>,
        tangents: &[[T; CHUNK]],
        block: &Block<D>,
        per_spacing: T,
        scratch: &mut Scratch<T>,
    ) -> () = hessian::hessian_block
);
for_each_set!(
    fn linearise[T: Real, const D: usize][T, D](
        fields: &[[T; CHUNK]],
        labels: &[[Label; CHUNK]],
        layout: Layout<D>,
        materials: &[MaterialNumbers<T>],
        how: &Linearisation<T>,
        tangents: &mut [[T; CHUNK]],
    ) -> () = hessian::linearise
);
for_each_set!(
    fn locate_by[T: Real, K: LaneKernel, const D: usize][T, K, D](
        per_spacing: T,
        layout: Layout<D>,
        block: &Block<D>,
        fields: &[[T; CHUNK]],
        courses: &mut [[Course; CHUNK]],
    ) -> () = sort::locate
);
for_each_set!(
    fn push[T: Real, const D: usize][T, D](
        push: &Push<T, D>,
        sums: &[Node<T>],
        forces: &[Node<T>],
        motion: &mut [Node<T>],
        change: &mut [Node<T>],
    ) -> NodeEnergies = nodes::push_nodes
);
for_each_set!(
    fn kinetic[T: Real, const D: usize][T, D](sums: &[Node<T>], motion: &[Node<T>]) -> f64 = nodes::kinetic_energy
);
for_each_set!(
    fn energy[T: Real, const D: usize][T, D](
        fields: &[[T; CHUNK]],
        labels: &[[Label; CHUNK]],
        layout: Layout<D>,
        materials: &[MaterialNumbers<T>],
        gravity: &Vector<T, D>,
        origin: &Vector<f64, D>,
    ) -> StoredEnergy = energy::stored_energy
);
#[cfg(test)]
for_each_set!(
    fn exponential_of[T: Real][T](x: T) -> T = lane_exponential
);

#[cfg(test)]
#[inline(always)]
fn lane_exponential<I: InstructionSet<T>, T: Real>(x: T) -> T {
    let mut lanes = [T::zero(); CHUNK];
    super::strain::exponential::<T, I::Lanes>(I::Lanes::splat(x)).store(&mut lanes);
    lanes[0]
}

/// See [`super::strain::exponential`].
#[cfg(test)]
pub(super) fn exponential<T: Real>(set: Set, x: T) -> T {
    exponential_of::<T>(set, x)
}

/// A function generic over kernel and terms, called with both as compile-time constants.
macro_rules! for_kernel_and_terms {
    ($scene:expr, $function:ident, $($argument:expr),*) => {
        match ($scene.kernel, $scene.transfer) {
            (KernelKind::Cubic, Transfer::Flip(_)) => $function::<T, Cubic, D, false, true>($($argument),*),
            (KernelKind::Cubic, Transfer::Apic) => $function::<T, Cubic, D, true, true>($($argument),*),
            (KernelKind::Cubic, Transfer::Mls) => $function::<T, Cubic, D, true, false>($($argument),*),
            (KernelKind::Quadratic, Transfer::Flip(_)) => $function::<T, Quadratic, D, false, true>($($argument),*),
            (KernelKind::Quadratic, Transfer::Apic) => $function::<T, Quadratic, D, true, true>($($argument),*),
            (KernelKind::Quadratic, Transfer::Mls) => $function::<T, Quadratic, D, true, false>($($argument),*),
        }
    };
}

/// The kernels of a precision and a dimension. Pointers, so that they are compiled with this crate and not with every program that uses it.
#[derive(Debug)]
#[expect(clippy::type_complexity, reason = "the signatures of the kernels")]
pub(super) struct Kernels<T: Real, const D: usize> {
    /// [`scatter::scatter_block`].
    pub scatter_block:
        fn(Set, &Scene<T, D>, &Particles<T, D>, &[MaterialNumbers<T>], usize, &Terms<T>, &mut Scratch<T>),
    /// [`gather::gather_block`].
    pub gather_block: fn(
        Set,
        &Update<T, D>,
        Layout<D>,
        &Block<D>,
        &mut [[T; CHUNK]],
        &mut [[Label; CHUNK]],
        &mut Scratch<T>,
        &mut BlockReport<T, D>,
    ),
    /// [`gather::keep_block`].
    pub keep_block: fn(Set, &Scene<T, D>, &End<T>, Layout<D>, &Block<D>, &mut [[T; CHUNK]], &mut Scratch<T>),
    /// [`sort::locate`].
    pub locate: fn(Set, &Scene<T, D>, Layout<D>, &Block<D>, &[[T; CHUNK]], &mut [[Course; CHUNK]]),
    /// [`hessian::hessian_block`].
    pub hessian_block: fn(Set, &Scene<T, D>, &Particles<T, D>, &[[T; CHUNK]], usize, &mut Scratch<T>),
    /// [`hessian::linearise`].
    pub linearise: fn(
        Set,
        &[[T; CHUNK]],
        &[[Label; CHUNK]],
        Layout<D>,
        &[MaterialNumbers<T>],
        &Linearisation<T>,
        &mut [[T; CHUNK]],
    ),
    /// [`nodes::push_nodes`].
    pub push_nodes:
        fn(Set, &Push<T, D>, &[Node<T>], &[Node<T>], &mut [Node<T>], &mut [Node<T>]) -> NodeEnergies,
    /// [`nodes::kinetic_energy`].
    pub kinetic_energy: fn(Set, &[Node<T>], &[Node<T>]) -> f64,
    /// [`energy::stored_energy`].
    pub stored_energy: fn(
        Set,
        &[[T; CHUNK]],
        &[[Label; CHUNK]],
        Layout<D>,
        &[MaterialNumbers<T>],
        &Vector<T, D>,
        &Vector<f64, D>,
    ) -> StoredEnergy,
}

impl<T: Real, const D: usize> Kernels<T, D> {
    const fn compiled() -> Self {
        Kernels {
            scatter_block: scatter_block::<T, D>,
            gather_block: gather_block::<T, D>,
            keep_block: keep_block::<T, D>,
            locate: locate::<T, D>,
            hessian_block: hessian_block::<T, D>,
            linearise: linearise::<T, D>,
            push_nodes: push::<T, D>,
            kinetic_energy: kinetic::<T, D>,
            stored_energy: energy::<T, D>,
        }
    }

    /// Those of `T` and `D`.
    pub fn get() -> &'static Self {
        static PLANE_F32: Kernels<f32, 2> = Kernels::compiled();
        static PLANE_F64: Kernels<f64, 2> = Kernels::compiled();
        static SPACE_F32: Kernels<f32, 3> = Kernels::compiled();
        static SPACE_F64: Kernels<f64, 3> = Kernels::compiled();
        let all: [&'static dyn Any; 4] = [&PLANE_F32, &PLANE_F64, &SPACE_F32, &SPACE_F64];
        all.into_iter().find_map(|kernels| kernels.downcast_ref()).expect("D is 2 or 3, T f32 or f64")
    }
}

fn scatter_block<T: Real, const D: usize>(
    set: Set,
    scene: &Scene<T, D>,
    particles: &Particles<T, D>,
    materials: &[MaterialNumbers<T>],
    home: usize,
    terms: &Terms<T>,
    scratch: &mut Scratch<T>,
) {
    for_kernel_and_terms!(scene, scatter, set, particles, materials, home, terms, scratch)
}

#[expect(clippy::too_many_arguments, reason = "the parts of a stage")]
fn gather_block<T: Real, const D: usize>(
    set: Set,
    update: &Update<T, D>,
    layout: Layout<D>,
    block: &Block<D>,
    fields: &mut [[T; CHUNK]],
    labels: &mut [[Label; CHUNK]],
    scratch: &mut Scratch<T>,
    report: &mut BlockReport<T, D>,
) {
    for_kernel_and_terms!(update.scene, gather, set, update, layout, block, fields, labels, scratch, report)
}

fn keep_block<T: Real, const D: usize>(
    set: Set,
    scene: &Scene<T, D>,
    end: &End<T>,
    layout: Layout<D>,
    block: &Block<D>,
    fields: &mut [[T; CHUNK]],
    scratch: &mut Scratch<T>,
) {
    match (scene.kernel, scene.transfer.keeps_affine()) {
        (KernelKind::Cubic, true) => keep::<T, Cubic, D, true>(set, end, layout, block, fields, scratch),
        (KernelKind::Cubic, false) => keep::<T, Cubic, D, false>(set, end, layout, block, fields, scratch),
        (KernelKind::Quadratic, true) => {
            keep::<T, Quadratic, D, true>(set, end, layout, block, fields, scratch)
        }
        (KernelKind::Quadratic, false) => {
            keep::<T, Quadratic, D, false>(set, end, layout, block, fields, scratch)
        }
    }
}

fn hessian_block<T: Real, const D: usize>(
    set: Set,
    scene: &Scene<T, D>,
    particles: &Particles<T, D>,
    tangents: &[[T; CHUNK]],
    home: usize,
    scratch: &mut Scratch<T>,
) {
    let (block, per_spacing) = (&particles.blocks[home], T::one() / scene.spacing);
    match (scene.kernel, scene.transfer) {
        (KernelKind::Cubic, Transfer::Mls) => {
            hessian::<T, Cubic, D, true, false>(set, particles, tangents, block, per_spacing, scratch)
        }
        (KernelKind::Cubic, _) => {
            hessian::<T, Cubic, D, false, true>(set, particles, tangents, block, per_spacing, scratch)
        }
        (KernelKind::Quadratic, Transfer::Mls) => {
            hessian::<T, Quadratic, D, true, false>(set, particles, tangents, block, per_spacing, scratch)
        }
        (KernelKind::Quadratic, _) => {
            hessian::<T, Quadratic, D, false, true>(set, particles, tangents, block, per_spacing, scratch)
        }
    }
}

fn locate<T: Real, const D: usize>(
    set: Set,
    scene: &Scene<T, D>,
    layout: Layout<D>,
    block: &Block<D>,
    fields: &[[T; CHUNK]],
    courses: &mut [[Course; CHUNK]],
) {
    let per_spacing = T::one() / scene.spacing;
    match scene.kernel {
        KernelKind::Cubic => locate_by::<T, Cubic, D>(set, per_spacing, layout, block, fields, courses),
        KernelKind::Quadratic => {
            locate_by::<T, Quadratic, D>(set, per_spacing, layout, block, fields, courses)
        }
    }
}
