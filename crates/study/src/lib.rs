//! The laboratory: sweeps, fragments, statistics, tables, figures and reports.

pub mod figure;
pub mod report;
