//! status: what there is of each case.

use std::collections::BTreeMap;

use clap::Args;
use serde::Serialize;
use snowlab_study::plan::{Look, State, Status, statuses};
use snowlab_study::results::Archive;
use snowlab_study::slurm::{Queued, Submission};

use super::opened::{Opened, StudyArguments};
use super::{Exit, print_json};

/// Which study, and how much to look at.
#[derive(Debug, Args)]
pub struct StatusArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Read the records only, not every file with its checksum
    #[arg(long)]
    quick: bool,
    /// List all cases that are not finished, however many
    #[arg(long)]
    all: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Cases that are listed where there are more (chosen: a screen).
const LISTED: usize = 30;

/// A case as it is told by `--json`.
#[derive(Serialize)]
struct Told<'a> {
    key: &'a str,
    arm: &'a str,
    block: u64,
    #[serde(flatten)]
    status: &'a Status,
    why: String,
}

/// The study as it is told by `--json`.
#[derive(Serialize)]
struct Summary<'a> {
    study: &'a str,
    profile: &'a str,
    counts: BTreeMap<&'static str, usize>,
    queued: Option<Vec<Queued>>,
    cases: Vec<Told<'a>>,
}

/// Tells what there is; exit code 3 where a case has failed, stopped or is damaged.
pub fn status(arguments: &StatusArguments) -> anyhow::Result<Exit> {
    let Opened { study, .. } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let statuses = statuses(&archive, if arguments.quick { Look::Records } else { Look::Everything });
    let mut counts = BTreeMap::new();
    statuses.iter().for_each(|status| *counts.entry(status.state.name()).or_default() += 1);
    let queued = Submission::of(&archive).queued();
    if arguments.json {
        let told = statuses.iter().map(|status| {
            let (case, key) = (&study.cases[status.index], archive.key(status.index));
            Told { key, arm: &case.arm, block: case.block, status, why: status.state.why() }
        });
        let cases = told.collect();
        print_json(&Summary { study: &study.spec.name, profile: &study.profile, counts, queued, cases })?;
    } else {
        list(&archive, &statuses, arguments.all);
        for Queued { job, state, reason } in queued.iter().flatten() {
            println!("queued       {job}  {state} {reason}");
        }
        let words = State::NAMES.iter().filter_map(|name| Some(format!("{} {name}", counts.get(name)?)));
        println!("{}: {} cases: {}", study.spec.name, statuses.len(), words.collect::<Vec<_>>().join(", "));
        advice(&arguments.study, &statuses);
    }
    let bad = statuses.iter().any(|status| status.state.has_failed());
    Ok(if bad { Exit::CasesFailed } else { Exit::Done })
}

fn list(archive: &Archive, statuses: &[Status], all: bool) {
    let worth_telling = |status: &&Status| !matches!(status.state, State::Finished | State::New);
    let told: Vec<&Status> = statuses.iter().filter(worth_telling).collect();
    let shown = if all { told.len() } else { told.len().min(LISTED) };
    for status in &told[..shown] {
        let share = status.checkpoint.map(|share| format!(", {:.0} % are kept", 100.0 * share));
        println!(
            "{:<11}  {}  {}: {}{}",
            status.state.name(),
            archive.key(status.index),
            archive.describe(status.index),
            status.state.why(),
            share.unwrap_or_default()
        );
        if status.state.has_failed() {
            println!(
                "             see {}",
                archive.case_folder(status.index).path().join("log.txt").display()
            );
        }
    }
    if shown < told.len() {
        println!("and {} more; `--all` lists them", told.len() - shown);
    }
}

/// What to do next.
fn advice(study: &StudyArguments, statuses: &[Status]) {
    let any = |pick: fn(&State) -> bool| statuses.iter().any(|status| pick(&status.state));
    let words = study.words().join(" ");
    if any(|state| matches!(state, State::Damaged { .. })) {
        println!("`snowlab run {words} --repair` makes damaged results anew");
    }
    if any(|state| !state.is_done() && !matches!(state, State::Running { .. } | State::Damaged { .. })) {
        println!("`snowlab run {words}` runs what is missing");
    }
    if any(|state| matches!(state, State::Stopped { .. })) {
        println!("`snowlab run {words} --failed` tries again those that stopped or failed");
    }
}
