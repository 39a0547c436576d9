//! verify.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use snowlab_study::store::write_whole;
use snowlab_study::verify::{self, EXPERIMENTS, Effort, Found, Setting};

use super::Exit;

/// What is verified, and where the evidence goes.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// Only these experiments; all when left out
    experiments: Vec<String>,
    /// The short form: coarse grids, few placements
    #[arg(long)]
    quick: bool,
    /// Folder for tables and figures
    #[arg(long, default_value = "results/verify")]
    out: PathBuf,
    /// Write the page, in Markdown, to this file as well
    #[arg(long)]
    page: Option<PathBuf>,
    /// List the experiments
    #[arg(long)]
    list: bool,
}

/// Carries out the experiments, writes their evidence, and tells which check does not hold.
pub fn verify(arguments: &VerifyArguments) -> anyhow::Result<Exit> {
    if arguments.list {
        for experiment in EXPERIMENTS {
            println!("{:16} {}", experiment.id, experiment.title);
        }
        return Ok(Exit::Done);
    }
    let effort = if arguments.quick { Effort::Quick } else { Effort::Full };
    let setting = Setting { effort, out: &arguments.out };
    let found = verify::verify(&arguments.experiments, &setting, tell)?;
    verify::write(&found, &arguments.out)?;
    if let Some(page) = &arguments.page {
        write_page(page, &arguments.out)?;
    }
    let checks: Vec<_> = found.iter().flat_map(|(_, evidence)| &evidence.checks).collect();
    let failed = checks.iter().filter(|check| !check.holds()).count();
    println!(
        "{} checks, {failed} outside their range; evidence in {}",
        checks.len(),
        arguments.out.display()
    );
    Ok(if failed == 0 { Exit::Done } else { Exit::ExpectationFailed })
}

fn tell((experiment, evidence): &Found) {
    let failing: Vec<_> = evidence.checks.iter().filter(|check| !check.holds()).collect();
    eprintln!("{}: {} checks, {} outside their range", experiment.id, evidence.checks.len(), failing.len());
    for check in failing {
        let [least, greatest] = check.allowed;
        eprintln!(
            "  {}: {} is not in [{least}, {greatest}] ({})",
            check.quantity, check.measured, check.theory
        );
    }
}

fn write_page(page: &Path, out: &Path) -> anyhow::Result<()> {
    let text = verify::page(out, &from_page(page, out))?;
    write_whole(page, text.as_bytes()).with_context(|| format!("cannot write {}", page.display()))
}

/// `out` as seen from the folder of `page`: both relative to the working folder.
fn from_page(page: &Path, out: &Path) -> String {
    let depth = page.parent().map_or(0, |folder| folder.components().count());
    let up = "../".repeat(if out.is_absolute() { 0 } else { depth });
    format!("{up}{}", out.display())
}
