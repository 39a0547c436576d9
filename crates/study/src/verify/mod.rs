//! What the solver has been shown to do: experiments with known answers, and the page that tells of them.
//!
//! An experiment is a file that returns its [`Evidence`]; [`EXPERIMENTS`] lists them in the order of the page. To add one: the
//! file, its line in the list, and its section `pages/<id>.md.jinja`, which sees the tables of all.

pub(crate) mod chart;
mod column;
mod convergence;
mod discs;
mod dispersion;
mod energy_budget;
mod engines;
mod evidence;
mod implicit;
mod incline;
mod manufactured;
mod moving;
mod page;
mod scenes;
mod spin;
mod stability;
mod strain_path;
mod vibration;

use std::path::Path;

use anyhow::Context;
use rayon::prelude::*;

pub use evidence::{Check, Effort, Evidence, EvidenceFigure};

use crate::store::write_whole;

/// How experiments are carried out.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    /// How thorough.
    pub effort: Effort,
    /// Where the cases of a study that an experiment runs are kept, and found again.
    pub out: &'a Path,
}

/// One experiment.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Its name on the command line, and that of its section.
    pub id: &'static str,
    /// Heading of its section.
    pub title: &'static str,
    /// Carries it out.
    pub run: fn(&Setting) -> anyhow::Result<Evidence>,
    /// Its section of the page, a template.
    section: &'static str,
}

/// All experiments, in the order of the page.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        id: "manufactured",
        title: "Manufactured solutions",
        run: manufactured::run,
        section: include_str!("pages/manufactured.md.jinja"),
    },
    Experiment {
        id: "vibration",
        title: "A vibrating bar",
        run: vibration::run,
        section: include_str!("pages/vibration.md.jinja"),
    },
    Experiment {
        id: "column",
        title: "A column under its own weight",
        run: column::run,
        section: include_str!("pages/column.md.jinja"),
    },
    Experiment {
        id: "discs",
        title: "Two elastic discs that meet",
        run: discs::run,
        section: include_str!("pages/discs.md.jinja"),
    },
    Experiment {
        id: "incline",
        title: "A block on an inclined plane",
        run: incline::run,
        section: include_str!("pages/incline.md.jinja"),
    },
    Experiment {
        id: "spin",
        title: "A spinning block",
        run: spin::run,
        section: include_str!("pages/spin.md.jinja"),
    },
    Experiment {
        id: "moving",
        title: "Obstacles that move",
        run: moving::run,
        section: include_str!("pages/moving.md.jinja"),
    },
    Experiment {
        id: "strain-path",
        title: "A strain path through both yield limits",
        run: strain_path::run,
        section: include_str!("pages/strain-path.md.jinja"),
    },
    Experiment {
        id: "energy-budget",
        title: "Where the energy of an impact goes",
        run: energy_budget::run,
        section: include_str!("pages/energy-budget.md.jinja"),
    },
    Experiment {
        id: "engines",
        title: "Two engines, one step",
        run: engines::run,
        section: include_str!("pages/engines.md.jinja"),
    },
    Experiment {
        id: "implicit",
        title: "Implicit steps",
        run: implicit::run,
        section: include_str!("pages/implicit.md.jinja"),
    },
    Experiment {
        id: "stability",
        title: "Where a step becomes unstable",
        run: stability::run,
        section: include_str!("pages/stability.md.jinja"),
    },
    Experiment {
        id: "convergence",
        title: "Do the fragment statistics converge?",
        run: convergence::run,
        section: include_str!("pages/convergence.md.jinja"),
    },
];

/// An experiment with what it found.
pub type Found = (&'static Experiment, Evidence);

/// Carries out the experiments named, or all; side by side.
///
/// # Errors
/// A name that is none, and what keeps an experiment from being carried out. A check that does not hold is no error.
pub fn verify(
    only: &[String],
    setting: &Setting,
    done: impl Fn(&Found) + Sync,
) -> anyhow::Result<Vec<Found>> {
    for name in only {
        anyhow::ensure!(
            EXPERIMENTS.iter().any(|experiment| experiment.id == name),
            "there is no experiment {name:?}; there are: {}",
            EXPERIMENTS.iter().map(|experiment| experiment.id).collect::<Vec<_>>().join(", ")
        );
    }
    let chosen: Vec<_> = EXPERIMENTS
        .iter()
        .filter(|experiment| only.is_empty() || only.iter().any(|name| name == experiment.id))
        .collect();
    chosen
        .into_par_iter()
        .map(|experiment| {
            let evidence = (experiment.run)(setting).with_context(|| experiment.id)?;
            let found = (experiment, evidence);
            done(&found);
            Ok(found)
        })
        .collect()
}

/// Writes tables and figures below `folder`.
///
/// # Errors
/// A folder or file that cannot be written.
pub fn write(found: &[Found], folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder.join("figures"))
        .with_context(|| format!("cannot make {}", folder.display()))?;
    let checks = found
        .iter()
        .flat_map(|(experiment, evidence)| evidence.checks.iter().map(|check| (experiment.id, check)));
    evidence::checks_table(checks).write(folder)?;
    evidence::contents_table(found).write(folder)?;
    for (_, evidence) in found {
        for table in &evidence.tables {
            table.write(folder)?;
        }
        for figure in &evidence.figures {
            write_whole(&folder.join(format!("figures/{}.png", figure.name)), &figure.drawing.png())?;
        }
    }
    let tables: Vec<_> = found.iter().flat_map(|(_, evidence)| &evidence.tables).collect();
    crate::table::dictionary(&tables).write(folder)?;
    Ok(())
}

/// The page of the tables that [`write`] left in `folder`, in Markdown. `results` is that folder as seen from the page.
///
/// # Errors
/// A table that is not there or cannot be read, and a section that names a table or column that is not there.
pub fn page(folder: &Path, results: &str) -> anyhow::Result<String> {
    page::page(folder, results)
}
