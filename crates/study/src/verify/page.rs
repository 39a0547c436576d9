//! `docs/verification.md`: sections with numbers from the tables that a verification has written, and from nothing else.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use minijinja::{Value, context};

use super::EXPERIMENTS;
use crate::template::{self, Record, engine, significant, values};

const PAGE: &str = include_str!("pages/page.md.jinja");
const PUBLISHED: &str = include_str!("pages/published.md.jinja");

/// The page of the tables in `folder`, which the page sees as `results`.
pub(super) fn page(folder: &Path, results: &str) -> anyhow::Result<String> {
    let engine = engine()?;
    let contents = records(folder, "contents")?;
    let named = |experiment: &str, kind: &str| -> Vec<&Record> {
        contents.iter().filter(|row| row["experiment"] == experiment && row["kind"] == kind).collect()
    };
    let mut tables = BTreeMap::new();
    for row in contents.iter().filter(|row| row["kind"] == "table") {
        let rows = records(folder, &row["name"])?;
        tables.insert(row["name"].clone(), rows.iter().map(values).collect::<Vec<_>>());
    }
    let tables = Value::from(tables);
    let checks = records(folder, "checks")?;
    let mut sections = Vec::new();
    for experiment in EXPERIMENTS.iter().filter(|e| contents.iter().any(|row| row["experiment"] == e.id)) {
        let text = engine
            .render_str(experiment.section, context! { tables => tables.clone() })
            .with_context(|| format!("section {}", experiment.id))?;
        let figure =
            |row: &&Record| context! { name => row["name"].as_str(), caption => row["caption"].as_str() };
        sections.push(context! {
            id => experiment.id,
            title => experiment.title,
            text,
            checks => checks.iter().filter(|row| row["experiment"] == experiment.id).map(check).collect::<Vec<_>>(),
            figures => named(experiment.id, "figure").iter().map(figure).collect::<Vec<_>>(),
            tables => named(experiment.id, "table").iter().map(|row| row["name"].clone()).collect::<Vec<_>>(),
        });
    }
    let failed = checks.iter().filter(|row| row["holds"] != "true").count();
    let whole = sections.len() == EXPERIMENTS.len();
    let published = if whole {
        engine.render_str(PUBLISHED, context! { tables => tables.clone() })?
    } else {
        String::new()
    };
    Ok(engine
        .render_str(PAGE, context! { sections, results, checks => checks.len(), failed, whole, published })?)
}

/// The rows of `<folder>/<name>.csv`.
fn records(folder: &Path, name: &str) -> anyhow::Result<Vec<Record>> {
    template::records(&folder.join(format!("{name}.csv")))
}

/// A row of the checks, numbers with four digits.
fn check(record: &Record) -> Value {
    let number = |column: &str| {
        record[column].parse().map_or_else(|_| "none".to_string(), |value| significant(value, 4))
    };
    context! {
        quantity => record["quantity"].as_str(),
        measured => number("measured"),
        theory => record["theory"].as_str(),
        least => number("least"),
        greatest => number("greatest"),
        holds => record["holds"] == "true",
        source => record["source"].as_str(),
    }
}
