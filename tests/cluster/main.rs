//! A study on a cluster: the scripts that are written, a pretended scheduler that does everything wrong, and a real Slurm with two nodes.
//!
//! The real one needs Slurm (`apt-get install --no-install-recommends slurm-wlm`); without it the test says so, and with `SNOWLAB_NEEDS_SLURM` set it fails.

#[path = "../desk/mod.rs"]
mod desk;
mod pretended;
mod real;
mod scale;
mod scripts;
mod slurm;

use std::collections::BTreeMap;
use std::path::PathBuf;

use desk::Desk;

/// The tables of a study that follow from it alone.
fn tables(desk: &Desk, folder: &str) -> BTreeMap<PathBuf, Vec<u8>> {
    let is_table = |path: &PathBuf| {
        path.extension().is_some_and(|ending| ending == "csv") && !path.ends_with("timings.csv")
    };
    desk.files(folder).into_iter().filter(|(path, _)| is_table(path)).collect()
}

/// Holds the tables in two folders against each other.
fn hold_tables(desk: &Desk, folder: &str, local: &str) {
    let (found, expected) = (tables(desk, folder), tables(desk, local));
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    assert!(expected.len() >= 5, "{:?}", expected.keys());
    for (path, bytes) in &expected {
        assert!(found[path] == *bytes, "{} differs from the local run's", path.display());
    }
}

/// The list of elements that a script reads.
fn list_of(desk: &Desk, script: &str) -> String {
    let name =
        script.split('/').find_map(|rest| rest.strip_prefix("elements-")).expect("the script names it");
    desk.read(&format!("results/tiny/slurm/elements-{}", &name[..16]))
}
