//! `docs/verification.md`: sections with numbers from the tables that a verification has written, and from nothing else.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, UndefinedBehavior, Value, context};

use super::EXPERIMENTS;

const PAGE: &str = include_str!("pages/page.md.jinja");
const PUBLISHED: &str = include_str!("pages/published.md.jinja");

/// A row of a table as it stands in its file: column and text.
type Record = BTreeMap<String, String>;

/// The page of the tables in `folder`, which the page sees as `results`.
pub(super) fn page(folder: &Path, results: &str) -> anyhow::Result<String> {
    let mut engine = Environment::new();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    engine.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    engine.add_filter("figures", |value: f64, digits: usize| significant(value, digits));
    engine.add_filter("fixed", |value: f64, digits: usize| format!("{value:.digits$}"));
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
    let path = folder.join(format!("{name}.csv"));
    let mut reader =
        csv::Reader::from_path(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let rows: Result<Vec<Record>, _> = reader.deserialize().collect();
    rows.with_context(|| format!("cannot read {}", path.display()))
}

/// Numbers as numbers, counts as counts, an empty field as none.
fn values(record: &Record) -> Value {
    let value = |text: &String| match text.as_str() {
        "" => Value::from(()),
        text => match (text.parse::<u64>(), text.parse::<f64>()) {
            (Ok(count), _) => Value::from(count),
            (_, Ok(number)) => Value::from(number),
            _ => Value::from(text),
        },
    };
    Value::from(
        record.iter().map(|(name, text)| (name.clone(), value(text))).collect::<BTreeMap<String, Value>>(),
    )
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

/// `value` with so many significant digits, in the shorter of plain and scientific notation.
fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = libm::floor(libm::log10(value.abs())) as i32;
    if !(-4..6).contains(&exponent) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}
