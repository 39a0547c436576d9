//! What the explicit step must do, against closed forms, identities and brute force: no test reads what the solver
//! computed to say what is right.

mod conservation;
mod decompositions;
mod edge_cases;
mod equivariance;
mod kernels;
mod material;
mod mirrors;
mod restart;
mod sparse_grid;
mod support;
