//! What the explicit step must do, against closed forms, identities and brute force: no test reads what the solver
//! computed to say what is right.

mod decompositions;
mod kernels;
mod material;
mod support;
