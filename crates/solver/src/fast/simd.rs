//! Vectors of numbers, by instruction set: [`Lanes`] holds a number of each of several particles, [`Row`] the four channels of each of four
//! neighbouring nodes. One source is compiled for every set; each operation is exact by IEEE 754 and acts lane by lane, so that the width
//! of a register never shows in a result.

#![expect(unsafe_code, reason = "declarations of unchecked loads")]

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Particles in a chunk: the lanes of the widest register.
pub const CHUNK: usize = 16;
/// Channels of a node: momentum or velocity, and mass.
pub const CHANNELS: usize = 4;
/// Nodes in a [`Row`]: the support of the widest kernel.
pub const ROW_NODES: usize = 4;

/// One number of each of [`Lanes::COUNT`] particles.
///
/// The functions must be compiled for the instruction set of the type, which is why all callers are inlined into functions that are.
pub trait Lanes<T>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Particles side by side.
    const COUNT: usize;
    /// A yes or no for each particle.
    type Mask: Copy;

    /// The same number for all.
    fn splat(value: T) -> Self;
    /// From `from[0..COUNT]`.
    fn load(from: &[T]) -> Self;
    /// To `to[0..COUNT]`.
    fn store(self, to: &mut [T]);
    /// self * a + b, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// b - self * a, rounded once.
    fn neg_mul_add(self, a: Self, b: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// The greater; `other` where either is not a number.
    fn max(self, other: Self) -> Self;
    /// The lesser; `other` where either is not a number.
    fn min(self, other: Self) -> Self;
    /// The greatest integer not above.
    fn floor(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// self > other; no for what is not a number.
    fn above(self, other: Self) -> Self::Mask;
    /// `yes` where the mask says so, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The mask's yes as bits, the first particle's lowest.
    fn bits(mask: Self::Mask) -> u32;
    /// Whole numbers as integers to `to[0..COUNT]`.
    fn store_integers(self, to: &mut [i32]);
    /// 2^self for whole numbers of normal result.
    fn power_of_two(self) -> Self;
    /// Four channels of `COUNT` particles, each particle's `stride` numbers after the last one's.
    fn load_channels(from: &[T], stride: usize) -> [Self; CHANNELS];
    /// Back to where [`Lanes::load_channels`] takes them from.
    fn store_channels(channels: [Self; CHANNELS], to: &mut [T], stride: usize);
}

/// Four channels of four nodes, node after node: `ROW_NODES * CHANNELS` numbers in one to four registers.
pub trait Row<T>: Copy + Add<Output = Self> + Mul<Output = Self> {
    /// All zero.
    fn zero() -> Self;
    /// The same number in all places.
    fn splat(value: T) -> Self;
    /// The four channels at `from`, the same for every node.
    fn repeat(from: &[T]) -> Self;
    /// A number for each node, the same for all its channels.
    fn by_node(values: [T; ROW_NODES]) -> Self;
    /// From `from[0..16]`.
    fn load(from: &[T]) -> Self;
    /// To `to[0..16]`.
    fn store(self, to: &mut [T]);
    /// [`Row::load`] from `from[first..]`, unchecked.
    ///
    /// # Safety
    /// The slice has `first + 16` numbers.
    unsafe fn load_at(from: &[T], first: usize) -> Self;
    /// [`Row::store`] to `to[first..]`, unchecked.
    ///
    /// # Safety
    /// The slice has `first + 16` numbers.
    unsafe fn store_at(self, to: &mut [T], first: usize);
    /// self * a + b, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// self / other.
    fn over(self, other: Self) -> Self;
    /// Channel `MASS` of every node in all its channels.
    fn spread<const MASS: usize>(self) -> Self;
    /// self where `gauge` > `limit`, else zero.
    fn where_above(self, gauge: Self, limit: Self) -> Self;
    /// (n0 + n2) + (n1 + n3), the sum over the nodes, of four rows, one after the other.
    fn sums_over_nodes(rows: [Self; 4], to: &mut [T]);
}

/// An instruction set for numbers of type `T`.
pub trait InstructionSet<T> {
    type Lanes: Lanes<T>;
    type Row: Row<T>;

    /// Has the cache line of `place` fetched, whatever it is.
    fn prefetch(place: *const u8);
}
