//! The laboratory: sweeps, fragments, statistics, tables, figures and reports.
//!
//! ```text
//! spec -> sweep -> [Case] -> run (assemble, solver) -> frames, record -> measure -> tables -> evaluate, check -> report
//! ```

pub mod animate;
pub mod assemble;
pub mod attempt;
pub mod case_run;
pub mod check;
pub mod checkpoint;
pub mod claims;
pub mod compare;
pub mod cost;
pub mod evaluate;
pub mod export;
pub mod features;
pub mod figure;
pub mod film;
pub mod fragments_command;
pub mod frames;
pub mod garbage;
pub mod keeper;
pub mod manifest;
pub mod measure;
pub mod memory;
pub mod meshes;
pub mod metrics;
pub mod outcome_map;
pub mod pace;
pub mod plan;
pub mod points;
pub mod preflight;
pub mod present;
pub mod record;
pub mod render;
pub mod report;
pub mod response;
pub mod results;
pub mod run;
pub mod schedule;
pub mod slurm;
pub mod spec;
pub mod statistics;
pub mod stop;
pub mod store;
pub mod sweep;
pub mod table;
pub mod tables;
pub mod template;
pub mod trade;
pub mod verify;
pub mod view;
