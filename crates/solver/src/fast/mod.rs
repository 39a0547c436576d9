//! The fast engine: the same step, over 16 particles, or four nodes of a row, at a time, on all threads.
//!
//! The plain stages beside this folder are the definition; the tests hold this engine against them. A step is `step.rs`, its stages over all
//! blocks are `stages.rs`. Particles (`particles.rs`) lie, sorted (`sort.rs`), by blocks of the grid (`grid.rs`); a block gives to its nodes (`scatter.rs`) and is
//! told by them (`gather.rs`) through a tile that fits the first-level cache, a batch of particles at a time (`batch.rs`), then moves on
//! (`update.rs`). Stress and flow are in `strain.rs`. Every kernel is written once, over the vectors of `simd.rs`, and compiled for AVX2 and
//! AVX-512 (`x86/`, `dispatch.rs`); results have the same bits with both, and with any number of threads, because the order of all sums is
//! fixed and every operation is exact. A CPU without AVX2 and FMA runs the plain engine (`absent.rs` where the architecture has neither). This
//! folder is the only place with `unsafe`.

mod batch;
mod contact;
mod dispatch;
mod energy;
mod gather;
mod grid;
mod hessian;
mod implicit;
mod material;
mod nodes;
mod particles;
mod pool;
mod scatter;
mod simd;
mod sort;
mod stages;
mod step;
mod strain;
#[cfg(test)]
mod tests;
mod update;
mod weights;
mod x86;

pub use dispatch::HasRegisters;
pub(crate) use step::{Fast, Saved};

/// Whether the CPU has what the engine takes.
pub(crate) fn is_available() -> bool {
    dispatch::Set::widest().is_some()
}

/// The name of the widest vectors that the CPU has.
pub(crate) fn vectors() -> &'static str {
    match dispatch::Set::widest() {
        Some(dispatch::Set::Avx512) => "avx512",
        Some(dispatch::Set::Avx2) => "avx2",
        None => "none",
    }
}
