//! What the explicit step must do, against closed forms, identities and brute force: no test reads what the solver
//! computed to say what is right. This is the
//! fast engine; `reference.rs` takes the same tests through the reference.

const ENGINE: snowlab_solver::Engine = snowlab_solver::Engine::Fast;

mod body_forces;
mod clamps;
mod colliders;
mod column;
mod conservation;
mod decompositions;
mod edge_cases;
mod energy;
mod engines;
mod equivariance;
mod implicit;
mod kernels;
mod material;
mod mirrors;
mod restart;
mod slab;
mod stability;
mod support;
mod validation;
mod volumes;
mod watchdog;
