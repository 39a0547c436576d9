//! The laboratory: sweeps, fragments, statistics, tables, figures and reports.
pub mod metrics;

pub mod claims;
pub mod statistics;
