//! The command on tiny studies and scenes: 2D, a few hundred particles, a few dozen steps.

#[path = "../desk/mod.rs"]
pub mod desk;

mod broken_results;
mod compare;
mod design;
mod exit_codes;
mod features;
mod harness;
mod makefile;
mod maps;
mod repairing;
mod reports;
mod resuming;
mod sampled;
mod scenes;
mod tables;
mod tradeoff;
mod verdicts;

use desk::{ARMS, Desk, SCENE, STOPPING_ARM, rows, study};
