//! The mechanical rule: every branch by constructed data, the claims as they stand in a study file, and the error
//! rates of the whole rule under simulation.

mod arms;
mod branches;
mod controls;
mod error_rates;
mod input;
mod other_contrasts;
