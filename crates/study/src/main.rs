//! The `snowlab` command line.

mod command;

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Parser;
use signal_hook::consts::SIGPIPE;
use signal_hook::flag::register_conditional_default;

use command::{Command, Exit};

/// Snow by the material point method: scenes, studies, fragments.
#[derive(Debug, Parser)]
#[command(name = "snowlab", version, about, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "Examples:
  snowlab plan studies/placement.toml              what would run
  snowlab run studies/placement.toml               run it; again, and only what is missing runs
  snowlab status studies/placement.toml            what there is of each case, and what failed
  snowlab submit studies/placement.toml            hand it to a Slurm cluster
  snowlab report studies/placement.toml            tables, figures and report from what has run
  snowlab compare earlier/placement results/placement --relative 1e-9
                                                   what has changed since
  snowlab simulate my-scene.toml --out my-scene    one scene, its frames as CSV
  snowlab fragments points.csv --link 0.0144       fragments of any set of points

Exit codes: 0 done, 1 an expectation failed or tables differ, 2 usage or bad input, 3 cases failed,
4 stopped on demand.";

fn main() -> ExitCode {
    // Who has read enough, such as `head`, ends the program without a word, as it ends others; where that cannot be asked for, printing panics.
    let _ = register_conditional_default(SIGPIPE, Arc::new(AtomicBool::new(true)));
    match Arguments::parse().command.run() {
        Ok(exit) => ExitCode::from(exit as u8),
        Err(error) => {
            eprintln!("snowlab: {error:#}");
            ExitCode::from(Exit::BadInput as u8)
        }
    }
}
