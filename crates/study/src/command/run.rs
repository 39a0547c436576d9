//! run: the cases of a study that have not been run, or some of them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::Context;
use clap::Args;
use serde::Serialize;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown};
use snowlab_study::cost::{Effort, costs};
use snowlab_study::keeper::{CHECKPOINT_INTERVAL, Limits};
use snowlab_study::manifest::Program;
use snowlab_study::plan::{Look, State, Status, statuses_of};
use snowlab_study::record::in_full;
use snowlab_study::results::Archive;
use snowlab_study::schedule::{Account, Orders, Task, run_cases, tidy};

use super::collect::collect_tables;
use super::opened::{Opened, StudyArguments, shares, use_study};
use super::preflight::warn_of_study;
use super::progress::Bar;
use super::{Exit, print_json};

/// What to run, and how.
#[derive(Debug, Args)]
pub struct RunArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Cases side by side; by default one for each core, fewer where memory is short
    #[arg(long)]
    jobs: Option<usize>,
    /// Threads of each case; by default the cores are shared among the cases. Their number shows in no result
    #[arg(long)]
    threads_per_case: Option<usize>,
    /// Begin no other case once one has failed or stopped
    #[arg(long, conflicts_with = "keep_going")]
    fail_fast: bool,
    /// Run all cases whatever becomes of some (the default)
    #[arg(long)]
    keep_going: bool,
    /// Run only those that have failed or stopped, and those again
    #[arg(long)]
    failed: bool,
    /// Look at every file of finished cases, and make damaged ones anew
    #[arg(long)]
    repair: bool,
    /// Only the case of this key, or whose key begins so; may be given several times. Writes no tables
    #[arg(long, value_name = "KEY")]
    case: Vec<String>,
    /// Only the case of this number, as `plan` lists them, from 0. Writes no tables
    #[arg(long, value_name = "I")]
    index: Option<usize>,
    /// Only part K of N of the cases, K from 1. Writes no tables
    #[arg(long, value_name = "K/N", value_parser = shard)]
    shard: Option<(usize, usize)>,
    /// Wall time that a case may take, such as 90min; it is put away when it has
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration)]
    time_limit: Option<Duration>,
    /// Steps that a case may take; it is put away when it has
    #[arg(long, value_name = "STEPS")]
    step_limit: Option<u64>,
    /// Stop after this time, with every case put away
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration)]
    stop_after: Option<Duration>,
    /// Time between the checkpoints of a case
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration)]
    checkpoint_every: Option<Duration>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The outcome as it is told by `--json`.
#[derive(Serialize)]
struct Outcome<'a> {
    study: &'a str,
    profile: &'a str,
    cases: usize,
    run: usize,
    stopped: Vec<String>,
    failed: Vec<String>,
    unstored: Vec<String>,
    interrupted: usize,
    left: usize,
    seconds: f64,
    tables: Option<String>,
    tables_failed: Option<String>,
}

/// Runs what is missing and writes the tables. Cases that stopped, now or before, are told by the exit code.
pub fn run(arguments: &RunArguments) -> anyhow::Result<Exit> {
    let began = Instant::now();
    let Opened { study, text } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let _lock = use_study(&archive)?;
    let chosen = arguments.chosen(&archive)?;
    let look = if arguments.repair { Look::Everything } else { Look::Records };
    let effort = if arguments.is_of_the_whole_study() { Effort::Table } else { Effort::Own };
    let statuses = statuses_of(&archive, &chosen, look);
    let costs = costs(&archive, &statuses, effort);
    let tasks = statuses.into_iter().zip(costs).map(|(status, cost)| Task { status, work: cost.seconds });
    let (tasks, rest): (Vec<Task>, Vec<Task>) = tasks.partition(|task| arguments.takes(&task.status.state));
    eprintln!("{}: {} cases, {} to run", study.spec.name, study.cases.len(), tasks.len());
    let done = rest.iter().filter(|task| task.status.state.is_done());
    done.map(|task| task.status.index).try_for_each(|index| tidy(&archive, index))?;
    tasks.iter().filter_map(|task| done_again(&archive, &task.status)).for_each(|line| eprintln!("{line}"));
    let numbers: Vec<usize> = tasks.iter().map(|task| task.status.index).collect();
    let orders = arguments.orders(&archive, &numbers)?;
    warn_of_study(&study, &numbers, arguments.study.folder());
    let account = run_cases(&archive, tasks, &orders, &Bar::new(&archive, numbers.len()));
    let interrupted = orders.limits.stop.load(Ordering::Relaxed);
    if interrupted {
        eprintln!(
            "interrupted: {} cases were put away, {} not begun; the same command goes on with them",
            account.interrupted, account.left
        );
    }
    let whole = arguments.is_of_the_whole_study() && !interrupted;
    let mut told = arguments.told(&archive, &account, began);
    if whole {
        match collect_tables(&archive, &text, &[]) {
            Ok(collected) => (told.stopped, told.tables) = (collected.stopped, Some(collected.path)),
            // What was run is told all the same.
            Err(error) => told.tables_failed = Some(format!("{error:#}")),
        }
    } else {
        told.stopped.extend(numbers.iter().filter(|&&i| archive.stopped(i)).map(|&i| archive.describe(i)));
    }
    match (arguments.json, &told.tables) {
        (true, _) => print_json(&told).map(|_| ())?,
        (false, Some(path)) => println!("{path}"),
        (false, None) => {}
    }
    if let Some(failure) = &told.tables_failed {
        eprintln!("the tables are not written: {failure}");
    }
    let Account { unstored, failed, .. } = account;
    Ok(if !unstored.is_empty() || told.tables_failed.is_some() {
        // Also where it was asked to stop: not all that was begun is put away.
        Exit::CasesFailed
    } else if interrupted {
        Exit::Interrupted
    } else if !failed.is_empty() || !told.stopped.is_empty() {
        Exit::CasesFailed
    } else {
        Exit::Done
    })
}

impl RunArguments {
    fn is_of_the_whole_study(&self) -> bool {
        self.case.is_empty() && self.index.is_none() && self.shard.is_none()
    }

    /// Numbers of the cases that are asked for, whatever there is of them.
    fn chosen(&self, archive: &Archive) -> anyhow::Result<Vec<usize>> {
        let count = archive.study.cases.len();
        let mut chosen: Vec<usize> = (0..count).collect();
        if !self.case.is_empty() {
            chosen = self.case.iter().map(|key| by_key(archive, key)).collect::<Result<_, _>>()?;
            chosen.sort_unstable();
            chosen.dedup();
        }
        if let Some(index) = self.index {
            anyhow::ensure!(index < count, "`--index` is {index}; allowed: 0 to {}", count.saturating_sub(1));
            chosen.retain(|&i| i == index);
        }
        if let Some((part, parts)) = self.shard {
            chosen.retain(|i| i % parts == part - 1);
        }
        Ok(chosen)
    }

    /// Whether a case of which there is that is to be run.
    fn takes(&self, state: &State) -> bool {
        if self.failed { state.has_failed() } else { !state.is_done() }
    }

    fn orders(&self, archive: &Archive, numbers: &[usize]) -> anyhow::Result<Orders> {
        let (side_by_side, threads) =
            shares(archive, numbers, self.jobs, self.threads_per_case).map_err(anyhow::Error::msg)?;
        if side_by_side < self.jobs.unwrap_or_else(super::cores).min(numbers.len()) {
            eprintln!("memory is free for {side_by_side} cases at a time");
        }
        let limits = Limits {
            checkpoint_interval: self.checkpoint_every.unwrap_or(CHECKPOINT_INTERVAL),
            time: self.time_limit,
            steps: self.step_limit,
            stop: stop_flag()?,
        };
        if let Some(time) = self.stop_after {
            let stop = limits.stop.clone();
            std::thread::spawn(move || {
                std::thread::sleep(time);
                stop.store(true, Ordering::Relaxed);
            });
        }
        Ok(Orders {
            side_by_side,
            threads,
            fail_fast: self.fail_fast,
            limits,
            program: Program::this(archive.folder),
        })
    }

    fn told<'a>(&self, archive: &Archive<'a>, account: &Account, began: Instant) -> Outcome<'a> {
        Outcome {
            study: &archive.study.spec.name,
            profile: &archive.study.profile,
            cases: archive.study.cases.len(),
            run: account.finished,
            stopped: Vec::new(),
            failed: account.failed.iter().map(|&index| archive.describe(index)).collect(),
            unstored: account
                .unstored
                .iter()
                .map(|(index, error)| format!("{}: {}", archive.describe(*index), in_full(error)))
                .collect(),
            interrupted: account.interrupted,
            left: account.left,
            seconds: began.elapsed().as_secs_f64(),
            tables: None,
            tables_failed: None,
        }
    }
}

/// What is told of a case that has been run before.
fn done_again(archive: &Archive, Status { index, state, .. }: &Status) -> Option<String> {
    let what = match state {
        State::Damaged { .. } => "is made anew",
        State::Stopped { .. } => "is run again",
        _ => return None,
    };
    Some(format!("{} {what}: {}", archive.describe(*index), state.why()))
}

/// The number of the one case whose key begins with `key`.
fn by_key(archive: &Archive, key: &str) -> anyhow::Result<usize> {
    let fits = |&index: &usize| archive.key(index).starts_with(key);
    let fitting: Vec<usize> = (0..archive.study.cases.len()).filter(fits).collect();
    match fitting[..] {
        [index] => Ok(index),
        [] => anyhow::bail!(
            "`--case` is {key:?}, which no case of the study begins with; `snowlab plan` lists them: has the study file or \
             the version of the solver changed?"
        ),
        _ => anyhow::bail!(
            "`--case` is {key:?}, which {} cases begin with; give more of the key",
            fitting.len()
        ),
    }
}

fn shard(text: &str) -> Result<(usize, usize), String> {
    let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    parts
        .filter(|&(part, parts): &(usize, usize)| (1..=parts).contains(&part))
        .ok_or_else(|| "allowed: K/N with 1 <= K <= N, such as 3/8".into())
}

/// Set by SIGINT and SIGTERM; a second one ends the program at once.
fn stop_flag() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        register_conditional_shutdown(signal, Exit::Interrupted as i32, stop.clone())
            .and_then(|_| register(signal, stop.clone()))
            .context("signals cannot be caught")?;
    }
    Ok(stop)
}
