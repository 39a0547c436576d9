//! features: what they cost and what they do.

use std::cell::RefCell;
use std::path::Path;

use clap::Args;
use snowlab_study::features::{cost, counted_instructions, table};
use snowlab_study::pace::start;
use snowlab_study::spec::{self, SceneSpec};

use super::Exit;
use super::opened::{Opened, StudyArguments};

/// Which study, and how often.
#[derive(Debug, Args)]
pub struct FeaturesArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Runs of each arm, by turns
    #[arg(long, default_value_t = 7)]
    rounds: usize,
}

/// Measures the study's features and writes `features.csv` beside its tables; effects are those of the cases that have been run.
pub fn features(arguments: &FeaturesArguments) -> anyhow::Result<Exit> {
    let Opened { study, .. } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let file = arguments.study.file.display();
    anyhow::ensure!(!study.spec.feature.is_empty(), "{file}: has no [[feature]]; name pairs of arms");
    let results = archive.results()?;
    anyhow::ensure!(!results.is_empty(), "{file}: nothing has been run; run `snowlab run {file}` first");
    let folder = arguments.study.folder();
    let program = std::env::current_exe()?;
    let counted = RefCell::new(Vec::<(SceneSpec, Option<f64>)>::new());
    let instructions = |scene: &SceneSpec| {
        let known = counted.borrow().iter().find(|(known, _)| known == scene).map(|(_, count)| *count);
        known.unwrap_or_else(|| {
            let particles = scene.body.iter().map(|body| body.placement.count()).sum::<Option<usize>>();
            let count = particles.and_then(|n| counted_instructions(&program, scene, folder, n as f64));
            counted.borrow_mut().push((scene.clone(), count));
            count
        })
    };
    let mut costs = Vec::new();
    for feature in &study.spec.feature {
        costs.push(cost(&study, feature, folder, arguments.rounds, instructions)?);
        eprintln!("{}: measured", feature.name);
    }
    table(&study, &costs, &results).write(archive.store.root())?;
    println!("{}", archive.store.root().join("features.csv").display());
    Ok(Exit::Done)
}

/// Takes steps and writes nothing.
pub fn steps(path: &Path, count: u64, folder: &Path) -> anyhow::Result<Exit> {
    let (scene, text) = spec::read::<SceneSpec>(path)?;
    let started = start(&scene, folder, 1).map_err(|error| error.in_text(&text).within(path.display()));
    started?.run.take(count).map_err(|message| anyhow::anyhow!("{}: {message}", path.display()))?;
    Ok(Exit::Done)
}
