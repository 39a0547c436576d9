//! The fast engine: the same step with transfers that serve the four nodes of a stencil's row with one instruction.
//!
//! The plain transfers of `transfer.rs` are the definition; these are held against them by the tests. One source is compiled twice: on plain
//! arrays for every CPU, and on vector registers for those with AVX2. Both do the same operations in the same order, and nothing is
//! fused, so results do not depend on the CPU. This folder is the only place with `unsafe`.

mod lanes;
mod tile;
mod transfer;
mod weights;

pub use lanes::HasWide;
pub(crate) use transfer::{grid_to_particles, particles_to_grid};
