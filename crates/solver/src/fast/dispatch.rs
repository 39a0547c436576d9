//! The kernels, compiled for each instruction set, and the choice among them.

use super::energy;
use super::grid::Node;
use super::nodes::{self, NodeEnergies, Push};
use super::particles::{Block, Label, Layout, Particles};
#[cfg(test)]
use super::simd::Lanes;
use super::simd::{CHUNK, InstructionSet};
use super::transfer::{self, Scratch, Terms};
use super::update::{BlockReport, MaterialNumbers, Update};
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

    pub fn widest() -> Option<Set> {
        Set::all().pop()
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
    ) -> () = transfer::scatter_block
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
    ) -> () = transfer::gather_block
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

/// See [`transfer::scatter_block`].
pub(super) fn scatter_block<T: Real, const D: usize>(
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

/// See [`transfer::gather_block`].
#[expect(clippy::too_many_arguments, reason = "the parts of a stage")]
pub(super) fn gather_block<T: Real, const D: usize>(
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

/// See [`nodes::push_nodes`].
pub(super) fn push_nodes<T: Real, const D: usize>(
    set: Set,
    terms: &Push<T, D>,
    sums: &[Node<T>],
    forces: &[Node<T>],
    motion: &mut [Node<T>],
    change: &mut [Node<T>],
) -> NodeEnergies {
    push::<T, D>(set, terms, sums, forces, motion, change)
}

/// See [`nodes::kinetic_energy`].
pub(super) fn kinetic_energy<T: Real, const D: usize>(set: Set, sums: &[Node<T>], motion: &[Node<T>]) -> f64 {
    kinetic::<T, D>(set, sums, motion)
}

/// See [`energy::stored_energy`].
pub(super) fn stored_energy<T: Real, const D: usize>(
    set: Set,
    fields: &[[T; CHUNK]],
    labels: &[[Label; CHUNK]],
    layout: Layout<D>,
    materials: &[MaterialNumbers<T>],
    gravity: &Vector<T, D>,
    origin: &Vector<f64, D>,
) -> StoredEnergy {
    energy::<T, D>(set, fields, labels, layout, materials, gravity, origin)
}
