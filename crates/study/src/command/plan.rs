//! plan: what would run, why, and how long it would take.

use clap::Args;
use serde::Serialize;
use snowlab_study::cost::{Basis, Cost, Effort, costs, wall_time};
use snowlab_study::memory;
use snowlab_study::plan::{Look, Status, statuses};
use snowlab_study::results::Archive;

use super::Exit;
use super::opened::{Opened, StudyArguments, duration, largest, shares};
use super::print_json;

/// What to plan, and how to tell.
#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Cases side by side; by default one for each core, fewer where memory is short
    #[arg(long)]
    jobs: Option<usize>,
    /// Threads of each case; by default the cores are shared among the cases
    #[arg(long)]
    threads_per_case: Option<usize>,
    /// Try no scene: where nothing is known of an arm, its time is a guess
    #[arg(long)]
    no_trials: bool,
    /// Print only the keys of the cases to run, one a line, for `run --case`
    #[arg(long, conflicts_with = "json")]
    keys: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// A case as it is told by `--json`.
#[derive(Serialize)]
struct PlannedCase<'a> {
    key: &'a str,
    arm: &'a str,
    axes: &'a [(String, Option<f64>)],
    block: u64,
    #[serde(flatten)]
    status: &'a Status,
    why: String,
    #[serde(flatten)]
    cost: Option<&'a Cost>,
}

/// The plan as it is told by `--json`.
#[derive(Serialize)]
struct Plan<'a> {
    study: &'a str,
    profile: &'a str,
    cases: Vec<PlannedCase<'a>>,
    to_run: usize,
    jobs: usize,
    threads: usize,
    predicted_seconds: f64,
    predicted_particle_steps: f64,
    memory_of_a_case: Option<f64>,
    memory_free: Option<f64>,
}

/// Lists what would run.
pub fn plan(arguments: &PlanArguments) -> anyhow::Result<Exit> {
    let Opened { study, .. } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let statuses = statuses(&archive, Look::Records);
    let to_run: Vec<usize> = statuses.iter().filter(|s| !s.state.is_done()).map(|s| s.index).collect();
    if arguments.keys {
        to_run.iter().for_each(|&index| println!("{}", archive.key(index)));
        return Ok(Exit::Done);
    }
    let effort = if arguments.no_trials { Effort::Table } else { Effort::Trials };
    let costs = costs(&archive, &statuses, effort);
    let (jobs, threads) = match shares(&archive, &to_run, arguments.jobs, arguments.threads_per_case) {
        Ok(shares) => shares,
        Err(message) => {
            eprintln!("{message}");
            (1, arguments.threads_per_case.unwrap_or(1))
        }
    };
    let seconds = wall_time(to_run.iter().map(|&index| &costs[index]), jobs, threads);
    if arguments.json {
        let told = statuses.iter().map(|status| {
            let case = &study.cases[status.index];
            PlannedCase {
                key: archive.key(status.index),
                arm: &case.arm,
                axes: &case.axes,
                block: case.block,
                status,
                why: status.state.why(),
                cost: (!status.state.is_done()).then(|| &costs[status.index]),
            }
        });
        return print_json(&Plan {
            study: &study.spec.name,
            profile: &study.profile,
            cases: told.collect(),
            to_run: to_run.len(),
            jobs,
            threads,
            predicted_seconds: seconds,
            predicted_particle_steps: to_run.iter().map(|&index| costs[index].particle_steps).sum(),
            memory_of_a_case: largest(&archive, &to_run),
            memory_free: memory::available(),
        });
    }
    statuses.iter().for_each(|status| println!("{}", line(&archive, status, &costs[status.index])));
    summary(&archive, &to_run, &costs);
    if !to_run.is_empty() {
        println!("time: about {} with {jobs} at a time on {threads} threads each", duration(seconds));
    }
    println!("{} cases: {} finished, {} to run", statuses.len(), statuses.len() - to_run.len(), to_run.len());
    Ok(Exit::Done)
}

fn line(archive: &Archive, status: &Status, cost: &Cost) -> String {
    let head = format!(
        "{:<11}  {}  {}",
        status.state.name(),
        archive.key(status.index),
        archive.describe(status.index)
    );
    if status.state.is_done() {
        return head;
    }
    let from = status.checkpoint.map(|share| format!(", goes on at {:.0} %", 100.0 * share));
    format!("{head}: {}{}, about {}", status.state.why(), from.unwrap_or_default(), duration(cost.seconds))
}

fn summary(archive: &Archive, to_run: &[usize], costs: &[Cost]) {
    if to_run.is_empty() {
        return;
    }
    if let Some(bytes) = largest(archive, to_run) {
        let free = memory::available().map(|free| format!(", {} are free", memory::in_words(free)));
        println!("memory: up to {} a case{}", memory::in_words(bytes), free.unwrap_or_default());
    }
    let steps: f64 = to_run.iter().map(|&index| costs[index].particle_steps).sum();
    let guessed = to_run.iter().filter(|&&index| costs[index].basis == Basis::FirstStep).count();
    println!("work: {steps:.1e} particle-steps");
    if guessed > 0 {
        println!(
            "  of {guessed} cases nothing like them has been run: their steps are taken to be as long as the first one, and snow that \
             hardens takes several times as many"
        );
    }
}
