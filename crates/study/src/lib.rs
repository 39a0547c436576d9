//! The laboratory: sweeps, fragments, statistics, tables, figures and reports.
pub mod fragments_command;
pub mod metrics;
pub mod points;

pub mod statistics;
