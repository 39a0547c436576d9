//! collect, report, check: tables from the files of the cases alone, and what is made of them. Nothing here simulates.

use std::io::ErrorKind;
use std::path::Path;

use anyhow::Context;
use clap::Args;
use serde::Serialize;
use snowlab_study::check as expectations;
use snowlab_study::evaluate::{Judgement, judge};
use snowlab_study::manifest::{Program, StudyManifest, revision};
use snowlab_study::present::{Findings, Provenance, present};
use snowlab_study::response::{self, Data, Metric, Surface, sampled_arms};
use snowlab_study::results::{Archive, CaseResult};
use snowlab_study::table::{Table, dictionary};
use snowlab_study::{outcome_map, tables, trade};

use super::opened::{Opened, StudyArguments, stopped, use_study};
use super::{Exit, print_json};

/// Which study, and how to tell.
#[derive(Debug, Args)]
pub struct CollectArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What was collected.
#[derive(Serialize)]
pub struct Collected {
    /// Cases of the study.
    pub cases: usize,
    /// Rows of `cases.csv`.
    pub rows: usize,
    /// Cases that stopped, each with its reason.
    pub stopped: Vec<String>,
    /// `cases.csv`.
    pub path: String,
}

/// Writes the tables.
pub fn collect(arguments: &CollectArguments) -> anyhow::Result<Exit> {
    let Opened { study, text } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let _lock = use_study(&archive)?;
    let collected = collect_tables(&archive, &text, &[])?;
    let missing = collected.cases - collected.rows;
    if arguments.json {
        print_json(&collected)?;
    } else {
        println!("{}", collected.path);
        println!("{} cases: {} in the tables, {missing} have not been run", collected.cases, collected.rows);
    }
    Ok(if missing == 0 && collected.stopped.is_empty() { Exit::Done } else { Exit::CasesFailed })
}

/// Writes the tables of what there is, with `more` of them, and says what has stopped.
pub fn collect_tables(archive: &Archive, text: &str, more: &[Table]) -> anyhow::Result<Collected> {
    let results = some_results(archive)?;
    write_tables(archive, &results, text, more)?;
    let stopped: Vec<String> = results.iter().filter_map(stopped).collect();
    stopped.iter().for_each(|line| eprintln!("{line}"));
    if !stopped.is_empty() {
        eprintln!("{} of {} cases stopped; they are rows of the tables", stopped.len(), results.len());
    }
    Ok(Collected {
        cases: archive.study.cases.len(),
        rows: results.len(),
        stopped,
        path: archive.store.root().join("cases.csv").display().to_string(),
    })
}

/// The results there are; tables of none would take the place of those of before.
fn some_results(archive: &Archive) -> anyhow::Result<Vec<CaseResult>> {
    let (results, name) = (archive.results()?, &archive.study.spec.name);
    anyhow::ensure!(!results.is_empty(), "{name}: nothing has been run; run `snowlab run` first");
    Ok(results)
}

/// Writes tables, figures and report.
pub fn report(arguments: &StudyArguments) -> anyhow::Result<Exit> {
    let Opened { study, text } = arguments.open()?;
    let archive = arguments.archive(&study)?;
    let _lock = use_study(&archive)?;
    let results = some_results(&archive)?;
    let missing = study.cases.len() - results.len();
    let Judgement { judged, noise, gates } = judge(&archive, &results)?;
    let mut verdicts = vec![tables::claims(&judged)];
    if !judged.is_empty() {
        verdicts.extend([tables::robustness(&judged), tables::replicates(&judged)]);
    }
    if !noise.is_empty() {
        verdicts.push(tables::density_noise(&noise));
    }
    if let Some(spec) = &study.spec.equivalence {
        verdicts.push(trade::equivalence(&archive, &results, &spec.reference)?);
    }
    verdicts.extend(responses(&archive, &results)?);
    write_tables(&archive, &results, &text, &verdicts)?;
    for judged in &judged {
        println!("{}", judged.assessment);
        println!("  measured by {}; calibration by stretch {}", judged.primary, judged.calibration);
    }
    for judged in &noise {
        let (arm, assessment) = (&judged.arms.noisy, &judged.assessment);
        let ratio = assessment.ratio.map_or("-".into(), |ratio| format!("{ratio:.2}"));
        println!("density-noise, {arm}: {}; n = {}, q = {ratio}", assessment.verdict, assessment.blocks);
    }
    gates.words.iter().for_each(|line| println!("{line}"));
    if missing > 0 {
        eprintln!("{missing} cases have not been run; run `snowlab run` to complete the study");
    }
    let provenance = Provenance { study_text: text, revision: revision(arguments.folder()) };
    let findings =
        Findings { archive: &archive, results: &results, judged: &judged, noise: &noise, gates: &gates };
    for name in present(findings, &provenance)? {
        println!("{}", archive.store.root().join(name).display());
    }
    Ok(Exit::Done)
}

/// How the arms of a sampled axis respond, and how well that is predicted; nothing where there is none.
fn responses(archive: &Archive, results: &[CaseResult]) -> anyhow::Result<Vec<Table>> {
    let spec = &archive.study.spec;
    let arms = sampled_arms(spec);
    if arms.is_empty() {
        return Ok(Vec::new());
    }
    // What is learnt is what stands in the table.
    tables::cases(results).write(archive.store.root())?;
    let mut surfaces = Vec::new();
    for (arm, metric) in arms.iter().flat_map(|arm| Metric::ALL.map(|metric| (arm, metric))) {
        let fitted = Data::read(spec, arm, metric, archive.store.root()).map_err(|error| error.to_string());
        match fitted.and_then(Surface::fit) {
            Ok(surface) => surfaces.push(surface),
            Err(message) => eprintln!("{arm}: no response surface of {}: {message}", metric.words()),
        }
    }
    Ok(vec![response::models(&surfaces), response::effects(&surfaces)])
}

/// A finding as it is told by `--json`.
#[derive(Serialize)]
struct Held<'a> {
    holds: bool,
    line: &'a str,
}

/// Holds results against expectations.
pub fn check(arguments: &CollectArguments) -> anyhow::Result<Exit> {
    let Opened { study, .. } = arguments.study.open()?;
    let archive = arguments.study.archive(&study)?;
    let results = (0..study.cases.len()).map(|index| archive.result(index)).collect::<Result<Vec<_>, _>>()?;
    let findings = expectations::check(&study, &results);
    let failed = findings.iter().filter(|finding| !finding.holds).count();
    if arguments.json {
        let held: Vec<_> = findings.iter().map(|f| Held { holds: f.holds, line: &f.line }).collect();
        print_json(&held)?;
    } else {
        for finding in &findings {
            println!("{}  {}", if finding.holds { "holds " } else { "FAILED" }, finding.line);
        }
        println!("{}: {} expectations, {failed} failed", study.spec.name, findings.len());
    }
    Ok(if failed == 0 { Exit::Done } else { Exit::ExpectationFailed })
}

fn write_tables(archive: &Archive, results: &[CaseResult], text: &str, more: &[Table]) -> anyhow::Result<()> {
    let own = [
        tables::cases(results),
        tables::fragments(results),
        tables::frames(results),
        tables::summary(results),
    ];
    let timings = tables::timings(results);
    let trades = trade::trades(archive, results)?;
    let trades = (!trades.is_empty()).then(|| trade::table(&trades));
    let maps = outcome_map::maps(archive.study, results);
    let maps = (!maps.is_empty()).then(|| outcome_map::table(&maps));
    let all: Vec<&Table> = own.iter().chain(more).chain([&timings]).chain(&trades).chain(&maps).collect();
    let root = archive.store.root();
    // A table without rows has no columns either: a study without claims has none of claims.
    let (all, empty): (Vec<&Table>, Vec<&Table>) = all.into_iter().partition(|table| !table.rows.is_empty());
    for table in &all {
        table.write(root)?;
    }
    for table in empty {
        remove(&root.join(format!("{}.csv", table.name)))?;
    }
    dictionary(&all).write(root)?;
    let manifest = StudyManifest::of(archive, text, Program::this(archive.folder), results);
    if let Some(warning) = manifest.warning() {
        eprintln!("{warning}");
    }
    Ok(manifest.write(root)?)
}

/// Removes the file of an earlier report, if there is one.
fn remove(file: &Path) -> anyhow::Result<()> {
    match std::fs::remove_file(file) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| file.display().to_string())
        }
        _ => Ok(()),
    }
}
