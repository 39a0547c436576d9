//! The subcommands: what they read and what they print.

mod compare;
mod fragments;
mod progress;
mod sample;
mod simulate;
mod study;
mod verify;

use std::path::PathBuf;

use clap::{Args, Subcommand};

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
}

/// A subcommand.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the cases of a study: how many, which are there, what would run
    Plan(StudyArguments),
    /// Run the cases of a study that have not been run, and write its tables; exit code 3 where a case has stopped
    Run {
        #[command(flatten)]
        study: StudyArguments,
        /// Cases side by side; by default one for each core
        #[arg(long)]
        jobs: Option<usize>,
    },
    /// Write tables, figures and report of a study that has been run
    Report(StudyArguments),
    /// Hold a study's results against the ranges it expects; exit code 1 where one is left
    Check(StudyArguments),
    /// Hold two sets of tables against each other, within tolerances; exit code 1 where they differ
    Compare(compare::CompareArguments),
    /// Run one scene and write its frames as CSV
    Simulate {
        /// Scene file
        scene: PathBuf,
        /// Folder for the frames
        #[arg(long)]
        out: PathBuf,
        /// Threads; all cores if not told. Their number shows in no result
        #[arg(long)]
        threads: Option<usize>,
    },
    /// Place the particles of a scene and write them, without running it
    Sample {
        /// Scene file
        scene: PathBuf,
        /// Output file, .csv or .ply
        #[arg(short, long)]
        output: PathBuf,
    },
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

/// An error with its causes.
fn in_full(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}

/// Which study, and where its results are.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Study file
    file: PathBuf,
    /// A named variation of the study
    #[arg(long)]
    profile: Option<String>,
    /// Folder of results
    #[arg(long, default_value = "results")]
    out: PathBuf,
}

impl Command {
    /// Carries it out.
    ///
    /// # Errors
    /// Usage and bad input.
    pub fn run(self) -> anyhow::Result<Exit> {
        match self {
            Command::Plan(study) => study::plan(&study),
            Command::Run { study, jobs } => study::run(&study, jobs),
            Command::Report(study) => study::report(&study),
            Command::Check(study) => study::check(&study),
            Command::Compare(arguments) => compare::compare(arguments),
            Command::Simulate { scene, out, threads } => simulate::simulate(&scene, &out, threads),
            Command::Sample { scene, output } => sample::sample(&scene, &output),
            Command::Verify(arguments) => verify::verify(&arguments),
            Command::Fragments { file, link, min_mass_share, json } => {
                fragments::fragments(&file, link, min_mass_share, json)
            }
        }
    }
}
