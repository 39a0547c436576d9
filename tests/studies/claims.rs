//! The mechanical rule: every branch by constructed data, the claims as they stand in a study file, and the error
//! rates of the whole rule under simulation.

#[path = "claims/arms.rs"]
mod arms;
#[path = "claims/branches.rs"]
mod branches;
#[path = "claims/controls.rs"]
mod controls;
#[path = "claims/error_rates.rs"]
mod error_rates;
#[path = "claims/input.rs"]
mod input;
#[path = "claims/other_contrasts.rs"]
mod other_contrasts;
