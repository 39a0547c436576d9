//! The subcommands: what they read and what they print.

mod animate;
mod collect;
mod compare;
mod design;
mod export;
mod features;
mod fragments;
mod gc;
mod index;
mod opened;
mod page;
mod plan;
mod preflight;
mod progress;
mod recommend;
mod render;
mod run;
mod sample;
mod simulate;
mod status;
mod subject;
mod submit;
mod tradeoff;
mod verify;

use std::path::PathBuf;

use clap::{CommandFactory, Subcommand};
use serde::Serialize;

use opened::StudyArguments;

/// Exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All done.
    Done = 0,
    /// An expectation failed, or what was compared differs.
    ExpectationFailed = 1,
    /// Usage or bad input.
    BadInput = 2,
    /// Cases stopped or could not be stored.
    CasesFailed = 3,
    /// Asked to stop; what was begun is put away.
    Interrupted = 4,
}

/// A subcommand.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the cases of a study: what is there of each, what would run and why, and how long it would take
    Plan(plan::PlanArguments),
    /// Run the cases of a study that have not been run, and write its tables; exit code 3 where a case has stopped
    Run(run::RunArguments),
    /// Say what there is of each case: finished, failed and why, running, interrupted, damaged
    Status(status::StatusArguments),
    /// Write the tables of a study from the files of its cases alone, wherever they were run
    Collect(collect::CollectArguments),
    /// Write tables, figures and report of a study that has been run
    Report(StudyArguments),
    /// Write `index.html` into the folder of results: every study with its question, verdicts and report
    Index(index::IndexArguments),
    /// Hold a study's results against the ranges it expects; exit code 1 where one is left
    Check(collect::CollectArguments),
    /// Hold two sets of tables against each other, within tolerances; exit code 1 where they differ
    Compare(compare::CompareArguments),
    /// Hand the missing cases of a study to a cluster
    Submit(submit::SubmitArguments),
    /// List what no case of a study needs, and delete it if told so
    Gc(gc::GcArguments),
    /// Print the completions of a shell: `snowlab completions bash > ~/.local/share/bash-completion/completions/snowlab`
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
    /// Tell what a scene will meet, take and not need, before it is run
    Preflight(preflight::PreflightArguments),
    /// Run one scene and write its frames, for this program and for others
    Simulate(simulate::SimulateArguments),
    /// Write frames in the formats of other programs
    Convert(export::ConvertArguments),
    /// Draw runs side by side as an animated GIF, every fragment in a colour of its own
    Animate(animate::AnimateArguments),
    /// Draw frames of a run in space with Mitsuba 3
    Render(render::RenderArguments),
    /// Place the particles of a scene and write them, without running it
    Sample {
        /// Scene file
        scene: PathBuf,
        /// Output file, .csv or .ply
        #[arg(short, long)]
        output: PathBuf,
    },
    /// Measure what the features of a study cost and what they do
    Features(features::FeaturesArguments),
    /// Measure what the settings of a study cost and how far they are off
    Tradeoff(tradeoff::TradeoffArguments),
    /// Tell the cheapest setting that is close enough, for a scene of one's own
    Recommend(recommend::RecommendArguments),
    /// Take steps of a scene on one thread and write nothing, for those who count instructions
    #[command(hide = true)]
    Steps {
        /// Scene file
        scene: PathBuf,
        /// How many
        #[arg(long)]
        count: u64,
        /// Folder that paths in the scene are relative to
        #[arg(long, default_value = ".")]
        folder: PathBuf,
    },
    /// Propose a placement for a wanted fragmentation
    Design(design::DesignArguments),
    /// Write a page of text whose numbers come from tables
    Page(page::PageArguments),
    /// Carry out experiments with known answers: what the solver has been shown to do
    Verify(verify::VerifyArguments),
    /// Count the fragments of a file of points by friends-of-friends
    Fragments {
        /// Points: CSV or PLY with columns x, y[, z]
        file: PathBuf,
        /// Linking length, in the unit of the points
        #[arg(long, allow_negative_numbers = true)]
        link: f64,
        /// Fragments lighter than this share of the whole count as dust
        #[arg(long, allow_negative_numbers = true, default_value_t = snowlab_study::fragments_command::DEFAULT_MIN_MASS_SHARE)]
        min_mass_share: f64,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
}

/// Prints a value as JSON.
fn print_json(value: &impl Serialize) -> anyhow::Result<Exit> {
    println!("{}", serde_json::to_string_pretty(value)?);
    Ok(Exit::Done)
}

/// Cores of the machine that the program may use.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

impl Command {
    /// Carries it out.
    ///
    /// # Errors
    /// Usage and bad input.
    pub fn run(self) -> anyhow::Result<Exit> {
        match self {
            Command::Plan(arguments) => plan::plan(&arguments),
            Command::Run(arguments) => run::run(&arguments),
            Command::Status(arguments) => status::status(&arguments),
            Command::Collect(arguments) => collect::collect(&arguments),
            Command::Report(study) => collect::report(&study),
            Command::Index(arguments) => index::write(&arguments),
            Command::Check(arguments) => collect::check(&arguments),
            Command::Submit(arguments) => submit::submit(&arguments),
            Command::Gc(arguments) => gc::gc(&arguments),
            Command::Completions { shell } => {
                let mut command = crate::Arguments::command();
                clap_complete::generate(shell, &mut command, "snowlab", &mut std::io::stdout());
                Ok(Exit::Done)
            }
            Command::Compare(arguments) => compare::compare(arguments),
            Command::Features(arguments) => features::features(&arguments),
            Command::Tradeoff(arguments) => tradeoff::tradeoff(&arguments),
            Command::Recommend(arguments) => recommend::recommend(&arguments),
            Command::Steps { scene, count, folder } => features::steps(&scene, count, &folder),
            Command::Design(arguments) => design::design(&arguments),
            Command::Page(arguments) => page::page(&arguments),
            Command::Preflight(arguments) => preflight::look(&arguments),
            Command::Simulate(arguments) => simulate::simulate(&arguments),
            Command::Animate(arguments) => animate::animate(&arguments),
            Command::Render(arguments) => render::render(&arguments),
            Command::Convert(arguments) => export::convert(&arguments),
            Command::Sample { scene, output } => sample::sample(&scene, &output),
            Command::Verify(arguments) => verify::verify(&arguments),
            Command::Fragments { file, link, min_mass_share, json } => {
                fragments::fragments(&file, link, min_mass_share, json)
            }
        }
    }
}
