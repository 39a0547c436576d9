//! Studies from file to report: what is read, run, tested, judged, drawn and written; and the pages against the code.

mod claims;
mod clamps;
mod figures;
mod heterogeneity;
mod input_page;
mod measure;
mod memory;
mod meshes;
mod notation;
mod pages;
mod panics;
mod particle_files;
mod preflight;
mod report;
mod reproducibility_page;
mod rollback;
mod runner;
mod statistics;
mod verify;

#[path = "../meshes/mod.rs"]
mod made;
