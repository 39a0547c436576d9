//! The tests of `fast.rs` on the reference engine.

const ENGINE: snowlab_solver::Engine = snowlab_solver::Engine::Reference;

mod body_forces;
mod colliders;
mod column;
mod conservation;
mod decompositions;
mod edge_cases;
mod energy;
mod equivariance;
mod implicit;
mod kernels;
mod material;
mod mirrors;
mod restart;
mod slab;
mod sparse_grid;
mod stability;
mod support;
mod validation;
mod volumes;
mod watchdog;
