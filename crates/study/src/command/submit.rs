//! submit: the missing cases of a study, handed to a cluster.

use std::time::Duration;

use clap::{Args, ValueEnum};
use serde::Serialize;
use snowlab_study::attempt::now;
use snowlab_study::cost::{Effort, costs};
use snowlab_study::memory;
use snowlab_study::plan::{Look, State, Status, statuses};
use snowlab_study::results::Archive;
use snowlab_study::slurm::{ArrayJob, Submission, Submitted, chunks, most_elements};

use super::opened::{Opened, StudyArguments, duration, use_study};
use super::{Exit, print_json};

/// What runs the cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Executor {
    /// A Slurm job array.
    Slurm,
}

/// What to submit, and how.
#[derive(Debug, Args)]
pub struct SubmitArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// What runs the cases
    #[arg(long, value_enum, default_value = "slurm")]
    executor: Executor,
    /// Write the scripts and submit nothing
    #[arg(long)]
    dry_run: bool,
    /// Predicted time of an element of the array: short cases share one
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration, default_value = "15min")]
    element_time: Duration,
    /// The most elements of an array; by default what the cluster says, or 1000
    #[arg(long)]
    most_elements: Option<usize>,
    /// Threads of a case, and cores of an element
    #[arg(long, default_value_t = 1)]
    threads_per_case: usize,
    /// The program, where it lies elsewhere on the cluster
    #[arg(long)]
    program: Option<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Flags for sbatch, such as `--partition=long`; they win over those in the scripts
    #[arg(last = true)]
    sbatch: Vec<String>,
}

/// Elements are allowed so many times what they are predicted to take, and some time for a slow start (chosen: predictions are within a quarter on
/// one machine, and machines differ by two; a limit ends nothing that cannot be gone on with).
const TIME_FACTOR: f64 = 3.0;
const TIME_START: f64 = 600.0;
/// Memory over its prediction, which is within 1.5 (docs/performance.md).
const MEMORY_FACTOR: f64 = 1.5;
/// Of a case whose particles a file has [bytes] (chosen: plenty for a million particles).
const USUAL_MEMORY: f64 = 4e9;
/// Elements of an array where the cluster does not tell: Slurm's own default is 1001, which it counts from 0.
const MOST_ELEMENTS: usize = 1000;

/// What was submitted, as it is told by `--json`.
#[derive(Default, Serialize)]
struct Told {
    cases: usize,
    elements: usize,
    predicted_seconds_of_the_longest: f64,
    scripts: Vec<String>,
    submitted: Option<Submitted>,
}

/// Writes the scripts and hands them to the cluster.
pub fn submit(arguments: &SubmitArguments) -> anyhow::Result<Exit> {
    let Executor::Slurm = arguments.executor;
    let Opened { study, .. } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let _lock = use_study(&archive)?;
    let statuses = statuses(&archive, Look::Records);
    let submission = Submission::of(&archive);
    let numbers = missing(&archive, &statuses, &submission);
    if numbers.is_empty() {
        if arguments.json {
            return print_json(&Told::default());
        }
        println!("{}: {} cases, none to submit", study.spec.name, study.cases.len());
        return Ok(Exit::Done);
    }
    let costs = costs(&archive, &statuses, Effort::Trials);
    let seconds = |index: usize| costs[index].seconds / arguments.threads_per_case.max(1) as f64;
    let most = arguments.most_elements.or_else(|| most_elements().map(|n| n.saturating_sub(1)));
    let most = most.unwrap_or(MOST_ELEMENTS).max(1);
    let chunks = chunks(&numbers, seconds, arguments.element_time.as_secs_f64(), most);
    let of_chunk = |chunk: &Vec<usize>| chunk.iter().map(|&index| seconds(index)).sum::<f64>();
    let longest = chunks.iter().map(of_chunk).fold(0.0, f64::max);
    let elements: Vec<Vec<String>> = chunks
        .iter()
        .map(|chunk| chunk.iter().map(|&index| archive.key(index).to_string()).collect())
        .collect();
    let h_max = Some(study.measure.largest_spacing);
    let memory_of = |index: usize| {
        memory::of_case(&study.cases[index].scene, archive.folder, h_max).unwrap_or(USUAL_MEMORY)
    };
    let directory = std::env::current_dir()?;
    let program = match &arguments.program {
        Some(program) => program.clone(),
        None => std::env::current_exe()?.display().to_string(),
    };
    let job = ArrayJob {
        name: &format!("snowlab-{}", study.spec.name),
        directory: &directory,
        folder: &directory.join(submission.folder()),
        program: &program,
        study: &arguments.study.words(),
        elements: &elements,
        threads: arguments.threads_per_case.max(1),
        seconds: TIME_FACTOR * longest + TIME_START,
        collect_memory: MEMORY_FACTOR
            * memory::of_tables(study.cases.iter().map(|case| memory::frames(&case.scene))),
        memory: MEMORY_FACTOR * numbers.iter().map(|&index| memory_of(index)).fold(0.0, f64::max),
    };
    let scripts = submission.write(&job)?;
    let submitted = match arguments.dry_run {
        true => None,
        false => Some(submission.submit(&job, &arguments.sbatch, now()).map_err(anyhow::Error::msg)?),
    };
    let told = Told {
        cases: numbers.len(),
        elements: elements.len(),
        predicted_seconds_of_the_longest: longest,
        scripts: scripts.iter().map(|path| path.display().to_string()).collect(),
        submitted,
    };
    if arguments.json {
        return print_json(&told);
    }
    tell(&told, job.memory);
    Ok(Exit::Done)
}

/// Numbers of the cases that nobody has run, runs or is to run.
fn missing(archive: &Archive, statuses: &[Status], submission: &Submission) -> Vec<usize> {
    let queued = submission.keys_queued();
    let is_missing = |state: &State| !state.is_done() && !matches!(state, State::Running { .. });
    let missing = statuses.iter().filter(|status| is_missing(&status.state)).map(|status| status.index);
    let (waiting, missing): (Vec<usize>, Vec<usize>) =
        missing.partition(|&index| queued.contains(archive.key(index)));
    if !waiting.is_empty() {
        let count = waiting.len();
        eprintln!("{count} cases are left to elements that wait or run; `scancel` takes those back");
    }
    missing
}

fn tell(told: &Told, memory: f64) {
    println!(
        "{} cases in {} elements, the longest of about {}, {} each",
        told.cases,
        told.elements,
        duration(told.predicted_seconds_of_the_longest),
        memory::in_words(memory)
    );
    told.scripts.iter().for_each(|path| println!("{path}"));
    match &told.submitted {
        Some(Submitted { array, collect, .. }) => {
            println!(
                "submitted: array {array}, tables by job {collect} when it has ended; `snowlab status` tells how it goes"
            );
        }
        None => println!("nothing is submitted; `sbatch {}` does it by hand", told.scripts[1]),
    }
}
