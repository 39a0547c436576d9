//! What lies in a study's folder of cases and no case needs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::attempt::MARK;
use crate::checkpoint::CheckpointFile;
use crate::plan::folders_of;
use crate::results::Archive;
use crate::store::{FAILURE, StoreError, TEMPORARY};

/// A file or folder that may go.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Garbage {
    /// Where.
    pub path: PathBuf,
    /// Bytes in it.
    pub bytes: u64,
    /// Why it may go.
    pub why: &'static str,
}

/// What no case needs. `wanted` are the keys of all profiles' cases; with `all` nothing is wanted.
pub fn garbage(archive: &Archive, wanted: &BTreeSet<String>, all: bool) -> Vec<Garbage> {
    let mut found = Vec::new();
    for name in folders_of(archive) {
        // What has not the name of a case is none of ours.
        let is_key = name.len() == 20 && name.bytes().all(|byte| byte.is_ascii_hexdigit());
        let path = archive.store.cases().join(&name);
        if !is_key || !path.is_dir() {
            continue;
        }
        if all || !wanted.contains(&name) {
            let why = if all { "a case" } else { "of no case of the study's profiles as they are now" };
            found.push(Garbage { bytes: size(&path), path, why });
        } else {
            found.extend(leftovers(&path));
        }
    }
    found
}

/// Files in a case's folder that nobody will read.
fn leftovers(folder: &Path) -> Vec<Garbage> {
    let finished = folder.join(crate::store::RUN).is_file();
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut found: Vec<Garbage> = entries
        .filter_map(|entry| {
            let path = entry.ok()?.path();
            let name = path.file_name()?.to_str()?;
            let why = match name {
                _ if name.starts_with(TEMPORARY) => "left by a runner that was killed while it wrote",
                CheckpointFile::NAME | FAILURE | MARK if finished => "of a case that is finished",
                _ => return None,
            };
            Some(Garbage { bytes: size(&path), path, why })
        })
        .collect();
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

/// Deletes it.
///
/// # Errors
/// [`StoreError::Io`].
pub fn delete(garbage: &Garbage) -> Result<(), StoreError> {
    let path = &garbage.path;
    let deleted = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    deleted.map_err(|source| StoreError::Io { path: path.clone(), source })
}

fn size(path: &Path) -> u64 {
    match std::fs::read_dir(path) {
        Ok(entries) => entries.filter_map(|entry| Some(size(&entry.ok()?.path()))).sum(),
        Err(_) => path.symlink_metadata().map_or(0, |file| file.len()),
    }
}
