//! The fast engine: the same step, over 16 particles, or four nodes of a row, at a time, on all threads.
//!
//! The plain stages beside this folder are the definition; the tests hold this engine against them. Particles lie by blocks of the grid
//! (`particles.rs`), which gather and scatter through a tile that fits the first-level cache (`transfer.rs`); deformation, stress and flow
//! are in `strain.rs`, the step in `step.rs`. Every kernel is written once, over the vectors of `simd.rs`, and compiled for AVX2 and AVX-512
//! (`dispatch.rs`); results have the same bits with both, and with any number of threads, because the order of all sums is fixed and
//! every operation is exact. A CPU without AVX2 and FMA runs the plain engine. This folder is the only place with `unsafe`.

#[cfg(target_arch = "x86_64")]
mod dispatch;
#[cfg(target_arch = "x86_64")]
mod energy;
#[cfg(target_arch = "x86_64")]
mod grid;
#[cfg(target_arch = "x86_64")]
mod nodes;
#[cfg(target_arch = "x86_64")]
mod particles;
#[cfg(target_arch = "x86_64")]
mod pool;
#[cfg(target_arch = "x86_64")]
mod simd;
#[cfg(target_arch = "x86_64")]
mod step;
#[cfg(target_arch = "x86_64")]
mod strain;
#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
#[cfg(target_arch = "x86_64")]
mod transfer;
#[cfg(target_arch = "x86_64")]
mod update;
#[cfg(target_arch = "x86_64")]
mod weights;
#[cfg(target_arch = "x86_64")]
mod x86;

#[cfg(target_arch = "x86_64")]
pub use dispatch::HasRegisters;
#[cfg(target_arch = "x86_64")]
pub(crate) use step::{Fast, Saved};

#[cfg(not(target_arch = "x86_64"))]
mod absent;
#[cfg(not(target_arch = "x86_64"))]
pub use absent::HasRegisters;
#[cfg(not(target_arch = "x86_64"))]
pub(crate) use absent::{Fast, Saved};
