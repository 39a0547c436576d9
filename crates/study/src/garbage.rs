//! What lies in a study's folder of cases and no case needs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::attempt::PASSING;
use crate::plan::folders_of;
use crate::results::Archive;
use crate::store::{StoreError, is_temporary};

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
    let study = archive.store.lock();
    found.extend(unfinished(study.parent().unwrap_or(&study), archive.store.cases()));
    found
}

/// Why a half-written file may go.
const UNFINISHED: &str = "left by a program that was killed while it wrote";

/// Half-written files in a folder and those in it, but for `except`.
fn unfinished(folder: &Path, except: &Path) -> Vec<Garbage> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    let of = |path: PathBuf| match () {
        () if path == except => Vec::new(),
        () if is_temporary(&path) => vec![Garbage { bytes: size(&path), path, why: UNFINISHED }],
        () if path.is_dir() => unfinished(&path, except),
        () => Vec::new(),
    };
    paths.into_iter().flat_map(of).collect()
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
                _ if is_temporary(&path) => UNFINISHED,
                name if finished && PASSING.contains(&name) => "of a case that is finished",
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
