//! gc: what no case of a study needs.

use std::collections::BTreeSet;

use clap::Args;
use serde::Serialize;
use snowlab_study::garbage::{Garbage, delete, garbage};
use snowlab_study::memory;
use snowlab_study::results::Archive;
use snowlab_study::store::{Hold, Lock};
use snowlab_study::sweep::Study;

use super::opened::{Opened, StudyArguments};
use super::{Exit, print_json};

/// Which study, and what may go.
#[derive(Debug, Args)]
pub struct GcArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// All cases, of all profiles; tables, figures and reports stay
    #[arg(long)]
    all: bool,
    /// Delete what is listed
    #[arg(long)]
    delete: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What was found, as it is told by `--json`.
#[derive(Serialize)]
struct Told<'a> {
    garbage: &'a [Garbage],
    bytes: u64,
    deleted: bool,
}

/// Lists, and with `--delete` deletes.
pub fn gc(arguments: &GcArguments) -> anyhow::Result<Exit> {
    let Opened { study, .. } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let mut wanted = BTreeSet::new();
    for profile in [None].into_iter().chain(study.spec.profile.keys().map(|name| Some(name.as_str()))) {
        let (study, _) = Study::read(&arguments.study.file, profile)?;
        let other = Archive::open(&study, &arguments.study.out, arguments.study.folder())?;
        wanted.extend((0..study.cases.len()).map(|index| other.key(index).to_string()));
    }
    // A list needs no lock, which would keep runners from beginning.
    let _lock = arguments.delete.then(|| alone(&archive)).transpose()?;
    let garbage = garbage(&archive, &wanted, arguments.all);
    if arguments.delete {
        garbage.iter().try_for_each(delete)?;
    }
    let bytes: u64 = garbage.iter().map(|garbage| garbage.bytes).sum();
    if arguments.json {
        return print_json(&Told { garbage: &garbage, bytes, deleted: arguments.delete });
    }
    for Garbage { path, bytes, why } in &garbage {
        println!("{}  {}  {why}", path.display(), memory::in_words(*bytes as f64));
    }
    let done = if arguments.delete { "deleted" } else { "may go; `--delete` deletes it" };
    println!("{} files and folders, {}: {done}", garbage.len(), memory::in_words(bytes as f64));
    Ok(Exit::Done)
}

/// Keeps runners out of the study.
fn alone(archive: &Archive) -> anyhow::Result<Lock> {
    let path = archive.store.lock();
    Lock::take(&path, Hold::Alone)?.ok_or_else(|| {
        let path = path.display();
        anyhow::anyhow!(
            "{path}: the study is in use; nothing is deleted: try again when its runners are done"
        )
    })
}
