//! What there is of several studies, from their files and tables alone.

use std::path::Path;

use crate::report::ReportOutcome;
use crate::report::index::{IndexData, IndexEntry, IndexFigure, IndexTable, IndexVerdicts};
use crate::spec::StudySpec;
use crate::spec::study::DEFAULT_PROFILE;
use crate::store::Store;
use crate::template::records;

/// Tables that the index leads to, where they are there.
const TABLES: [&str; 4] = ["cases", "summary", "claims", "dictionary"];

/// How a verdict begins in `claims.csv`.
const VERDICTS: [(ReportOutcome, &str); 4] = [
    (ReportOutcome::Supported, "supported"),
    (ReportOutcome::Refuted, "refuted"),
    (ReportOutcome::Inconclusive, "inconclusive"),
    (ReportOutcome::NotRun, "not-run"),
];

/// The studies whose tables lie below `out`, each followed by its profiles, and the names of the others.
///
/// # Errors
/// A table or a folder that cannot be read.
pub fn listing(studies: &[StudySpec], out: &Path) -> anyhow::Result<IndexData> {
    let mut data = IndexData::default();
    for spec in studies {
        let named = spec.profile.keys().map(String::as_str).filter(|name| *name != DEFAULT_PROFILE);
        let profiles = [DEFAULT_PROFILE].into_iter().chain(named);
        let before = data.entries.len();
        for profile in profiles {
            data.entries.extend(entry(spec, profile, out)?);
        }
        if data.entries.len() == before {
            data.without.push(spec.name.clone());
        }
    }
    Ok(data)
}

/// A study under one of its profiles; `None` without `cases.csv`.
fn entry(spec: &StudySpec, profile: &str, out: &Path) -> anyhow::Result<Option<IndexEntry>> {
    let store = Store::new(out, &spec.name, profile);
    let root = store.root();
    if !root.join("cases.csv").exists() {
        return Ok(None);
    }
    let cases = records(&root.join("cases.csv"))?;
    let stopped = |case: &&crate::template::Record| {
        case.get("outcome").is_some_and(|outcome| outcome.starts_with("stopped"))
    };
    let from_index = match profile {
        DEFAULT_PROFILE => spec.name.clone(),
        profile => format!("{}/{profile}", spec.name),
    };
    let there = |name: &str| root.join(name).exists().then(|| format!("{from_index}/{name}"));
    let table = |name: &str| Some(IndexTable { name: name.into(), path: there(&format!("{name}.csv"))? });
    Ok(Some(IndexEntry {
        title: spec.name.clone(),
        profile: if profile == DEFAULT_PROFILE { String::new() } else { profile.into() },
        question: spec.question.trim().split("\n\n").map(str::to_string).collect(),
        cases: cases.len(),
        stopped: cases.iter().filter(stopped).count(),
        verdicts: verdicts(&root.join("claims.csv"))?,
        report: there("report.html").unwrap_or_default(),
        figure: figure(spec, root)?.map(|name| IndexFigure {
            path: format!("{from_index}/figures/{name}.png"),
            alternative: format!("Figure of {}: {}.", spec.name, name.replace('-', " ")),
        }),
        tables: TABLES.into_iter().filter_map(table).collect(),
    }))
}

/// How many claims ended how; none without the table.
fn verdicts(path: &Path) -> anyhow::Result<Vec<IndexVerdicts>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let claims = records(path)?;
    let ended = |word: &str| {
        claims.iter().filter(|claim| claim.get("verdict").is_some_and(|v| v.starts_with(word))).count()
    };
    let counts = VERDICTS.map(|(outcome, word)| IndexVerdicts { outcome, count: ended(word) });
    Ok(counts.into_iter().filter(|verdicts| verdicts.count > 0).collect())
}

/// Name of the figure that shows a study best: the balls themselves, then its claims, then its endpoints, then the first by name.
fn figure(spec: &StudySpec, root: &Path) -> anyhow::Result<Option<String>> {
    let folder = root.join("figures");
    if !folder.is_dir() {
        return Ok(None);
    }
    let mut names = Vec::new();
    for file in std::fs::read_dir(&folder)? {
        let path = file?.path();
        if path.extension().is_some_and(|ending| ending == "png") {
            names.extend(path.file_stem().map(|name| name.to_string_lossy().into_owned()));
        }
    }
    names.sort();
    let pictured = spec.arm.iter().filter_map(|arm| Some(format!("{}-fragments", arm.picture.as_ref()?)));
    let best = pictured.chain(["claims".into(), "endpoints".into()]).find(|name| names.contains(name));
    Ok(best.or_else(|| names.into_iter().next()))
}
