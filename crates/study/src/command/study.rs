//! plan, run, report, check.

use std::path::Path;

use snowlab_study::evaluate::assess_claims;
use snowlab_study::present::{Findings, Provenance, present, revision};
use snowlab_study::record::Outcome;
use snowlab_study::results::{Archive, CaseResult};
use snowlab_study::schedule::{Jobs, run_cases};
use snowlab_study::spec::{self, StudySpec};
use snowlab_study::sweep::Study;
use snowlab_study::table::{Table, dictionary};
use snowlab_study::{check as expectations, memory, tables, trade};

use super::progress::Bar;
use super::{Exit, StudyArguments, in_full};

struct Opened {
    study: Study,
    text: String,
}

fn open(arguments: &StudyArguments) -> anyhow::Result<Opened> {
    let (spec, text) = spec::read::<StudySpec>(&arguments.file)?;
    let study = Study::expand(spec, arguments.profile.as_deref())
        .map_err(|error| error.within(arguments.file.display()))?;
    Ok(Opened { study, text })
}

fn folder(arguments: &StudyArguments) -> &Path {
    arguments.file.parent().unwrap_or(Path::new("."))
}

/// Lists what would run.
pub fn plan(arguments: &StudyArguments) -> anyhow::Result<Exit> {
    let Opened { study, .. } = open(arguments)?;
    let archive = Archive::open(&study, &arguments.out, folder(arguments))?;
    let missing = archive.missing();
    for (index, case) in study.cases.iter().enumerate() {
        let state = if missing.binary_search(&index).is_ok() { "to run" } else { "finished" };
        let point: Vec<String> = case.axes.iter().map(|(name, value)| format!(" {name} = {value}")).collect();
        println!("{state}  {}  {}{} block {}", archive.key(index), case.arm, point.concat(), case.block);
    }
    if let Some(bytes) = largest(&study, &missing) {
        let free = memory::available().map(|free| format!(", {} are free", memory::in_words(free)));
        println!("memory: up to {} a case{}", memory::in_words(bytes), free.unwrap_or_default());
    }
    println!(
        "{} cases: {} finished, {} to run",
        study.cases.len(),
        study.cases.len() - missing.len(),
        missing.len()
    );
    Ok(Exit::Done)
}

/// Bytes of the largest of the cases of the given numbers.
fn largest(study: &Study, numbers: &[usize]) -> Option<f64> {
    numbers.iter().filter_map(|&index| memory::of_case(&study.cases[index].scene)).reduce(f64::max)
}

/// Runs what is missing and writes the tables. Cases that stopped, now or before, are told by the exit code.
pub fn run(arguments: &StudyArguments, jobs: Option<usize>) -> anyhow::Result<Exit> {
    let Opened { study, .. } = open(arguments)?;
    let archive = Archive::open(&study, &arguments.out, folder(arguments))?;
    let missing = archive.missing();
    eprintln!("{}: {} cases, {} to run", study.spec.name, study.cases.len(), missing.len());
    let cores = jobs.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let jobs = memory::side_by_side(largest(&study, &missing), missing.len(), cores);
    let jobs = Jobs { cores, side_by_side: jobs.map_err(anyhow::Error::msg)? };
    if jobs.side_by_side < cores.min(missing.len()) {
        eprintln!("memory is free for {} cases at a time", jobs.side_by_side);
    }
    let mut unstored = 0;
    let failures = match run_cases(&archive, &missing, jobs, &Bar::new(missing.len())) {
        Ok(()) => Vec::new(),
        Err(failures) => failures,
    };
    for (index, error) in failures {
        let case = &study.cases[index];
        eprintln!("failed: {} block {}: {}", case.arm, case.block, in_full(&error));
        unstored += 1;
    }
    let results = archive.results()?;
    write_tables(&archive, &results, &[])?;
    let stopped: Vec<_> = results.iter().filter_map(stopped).collect();
    stopped.iter().for_each(|line| eprintln!("{line}"));
    if !stopped.is_empty() {
        eprintln!("{} of {} cases stopped; they are rows of the tables", stopped.len(), results.len());
    }
    println!("{}", archive.store.root().join("cases.csv").display());
    Ok(if unstored == 0 && stopped.is_empty() { Exit::Done } else { Exit::CasesFailed })
}

/// Writes tables, figures and report.
pub fn report(arguments: &StudyArguments) -> anyhow::Result<Exit> {
    let Opened { study, text } = open(arguments)?;
    let archive = Archive::open(&study, &arguments.out, folder(arguments))?;
    let results = archive.results()?;
    let missing = study.cases.len() - results.len();
    anyhow::ensure!(
        !results.is_empty(),
        "{}: nothing has been run; run `snowlab run` first",
        study.spec.name
    );
    let (judged, gates) = assess_claims(&archive, &results)?;
    write_tables(&archive, &results, &[tables::claims(&judged)])?;
    for judged in &judged {
        println!("{}", judged.assessment);
        println!("  measured by {}; calibration by stretch {}", judged.primary, judged.calibration);
    }
    gates.words.iter().for_each(|line| println!("{line}"));
    if missing > 0 {
        eprintln!("{missing} cases have not been run; run `snowlab run` to complete the study");
    }
    let provenance = Provenance { study_text: text, revision: revision(folder(arguments)) };
    let findings = Findings { archive: &archive, results: &results, judged: &judged, gates: &gates };
    for name in present(findings, &provenance)? {
        println!("{}", archive.store.root().join(name).display());
    }
    Ok(Exit::Done)
}

/// Holds results against expectations.
pub fn check(arguments: &StudyArguments) -> anyhow::Result<Exit> {
    let Opened { study, .. } = open(arguments)?;
    let archive = Archive::open(&study, &arguments.out, folder(arguments))?;
    let results = (0..study.cases.len()).map(|index| archive.result(index)).collect::<Result<Vec<_>, _>>()?;
    let findings = expectations::check(&study, &results);
    for finding in &findings {
        println!("{}  {}", if finding.holds { "holds " } else { "FAILED" }, finding.line);
    }
    let failed = findings.iter().filter(|finding| !finding.holds).count();
    println!("{}: {} expectations, {failed} failed", study.spec.name, findings.len());
    Ok(if failed == 0 { Exit::Done } else { Exit::ExpectationFailed })
}

fn stopped(result: &CaseResult) -> Option<String> {
    match &result.record.outcome {
        Outcome::Stopped { message, .. } => {
            Some(format!("{} block {} stopped: {message}", result.case.arm, result.case.block))
        }
        _ => None,
    }
}

fn write_tables(archive: &Archive, results: &[CaseResult], more: &[Table]) -> anyhow::Result<()> {
    let own = [
        tables::cases(results),
        tables::fragments(results),
        tables::frames(results),
        tables::summary(results),
    ];
    let timings = tables::timings(archive, results)?;
    let trades = trade::trades(archive, results)?;
    let trades = (!trades.is_empty()).then(|| trade::table(&trades));
    let all: Vec<&Table> = own.iter().chain(more).chain([&timings]).chain(&trades).collect();
    for table in &all {
        table.write(archive.store.root())?;
    }
    dictionary(&all).write(archive.store.root())?;
    Ok(())
}
