//! tradeoff: what settings cost and how far they are off.

use std::collections::BTreeMap;

use anyhow::Context;
use clap::Args;
use snowlab_study::features::timed;
use snowlab_study::statistics::median;
use snowlab_study::sweep::Study;
use snowlab_study::template::{Record, records};
use snowlab_study::trade::settings;

use super::Exit;
use super::opened::{Opened, StudyArguments};

/// Which study, and how often.
#[derive(Debug, Args)]
pub struct TradeoffArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Runs of each setting, by turns
    #[arg(long, default_value_t = 3)]
    rounds: usize,
}

/// Times the study's settings alone, on one thread, and writes `settings.csv` and `reference.csv` beside its tables; errors are those of the cases
/// that have been run.
pub fn tradeoff(arguments: &TradeoffArguments) -> anyhow::Result<Exit> {
    let Opened { study, .. } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let file = arguments.study.file.display();
    let tradeoff = study.spec.tradeoff.as_ref();
    let tradeoff =
        tradeoff.with_context(|| format!("{file}: has no [tradeoff]; name the axis of its scenes"))?;
    let results = archive.results()?;
    anyhow::ensure!(!results.is_empty(), "{file}: nothing has been run; run `snowlab run {file}` first");
    let fragments = match &tradeoff.fragments {
        Some(name) => fragments(arguments, name)?,
        None => Vec::new(),
    };
    let is_setting = |arm: &str| {
        let trade = study.spec.arm.iter().find(|a| a.id == arm).and_then(|a| a.trade.as_ref());
        trade.is_some_and(|trade| trade.coarser.is_none())
    };
    let arms: Vec<&str> = study.arms().into_iter().filter(|arm| is_setting(arm)).collect();
    let mut times: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for round in 1..=arguments.rounds.max(1) {
        for &arm in &arms {
            if let Some(case) = study.cases.iter().find(|case| case.arm == arm) {
                times.entry(arm).or_default().push(timed(case, arguments.study.folder())?.0);
            }
        }
        eprintln!("round {round} of {}: timed", arguments.rounds.max(1));
    }
    let seconds = times.iter().filter_map(|(arm, times)| Some((arm.to_string(), median(times)?))).collect();
    for table in settings(&archive, &results, tradeoff, &seconds, &fragments)? {
        table.write(archive.store.root())?;
        println!("{}", archive.store.root().join(format!("{}.csv", table.name)).display());
    }
    Ok(Exit::Done)
}

/// The rows of the table `equivalence` of the study in the file `name`, beside this one's.
fn fragments(arguments: &TradeoffArguments, name: &str) -> anyhow::Result<Vec<Record>> {
    let file = arguments.study.folder().join(name);
    let (study, _) = Study::read(&file, None)?;
    let table = arguments.study.out.join(&study.spec.name).join("equivalence.csv");
    if !table.exists() {
        eprintln!(
            "{}: has no table `equivalence` yet; run and report it for what settings do to fragments",
            file.display()
        );
        return Ok(Vec::new());
    }
    records(&table)
}
