//! Fragments of any set of points.

use std::path::Path;

use snowlab_study::fragments_command::fragments_of_file;

use super::Exit;

/// Prints the fragments of the points in `file`.
pub fn fragments(file: &Path, link: f64, min_mass_share: f64, json: bool) -> anyhow::Result<Exit> {
    let report = fragments_of_file(file, link, min_mass_share)?;
    if json {
        println!("{}", serde_json::to_string_pretty(&report)?);
    } else {
        println!("{report}");
    }
    Ok(Exit::Done)
}
