//! What the explicit step must do, against closed forms, identities and brute force: no test reads what the solver
//! computed to say what is right.

mod clamps;
mod colliders;
mod column;
mod conservation;
mod decompositions;
mod edge_cases;
mod energy;
mod equivariance;
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
