//! `docs/verification.md`: sections with generated numbers.

use std::collections::BTreeMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, UndefinedBehavior, Value, context};

use super::evidence::{Check, Evidence};
use super::{EXPERIMENTS, Found};
use crate::table::{Cell, Table};

const PAGE: &str = include_str!("pages/page.md.jinja");
const PUBLISHED: &str = include_str!("pages/published.md.jinja");

pub(super) fn page(found: &[Found], results: &str) -> anyhow::Result<String> {
    let mut engine = Environment::new();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    engine.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    engine.add_filter("figures", |value: f64, digits: usize| significant(value, digits));
    engine.add_filter("fixed", |value: f64, digits: usize| format!("{value:.digits$}"));
    let tables = Value::from(tables(found));
    let mut sections = Vec::new();
    for (experiment, evidence) in found {
        let text = engine.render_str(experiment.section, context! { tables => tables.clone() })?;
        sections.push(context! {
            id => experiment.id,
            title => experiment.title,
            text,
            checks => evidence.checks.iter().map(check_row).collect::<Vec<_>>(),
            figures => figures(evidence),
            tables => evidence.tables.iter().map(|table| table.name).collect::<Vec<_>>(),
        });
    }
    let checks: Vec<&Check> = found.iter().flat_map(|(_, evidence)| &evidence.checks).collect();
    let failed = checks.iter().filter(|check| !check.holds()).count();
    let whole = found.len() == EXPERIMENTS.len();
    let published = if whole {
        engine.render_str(PUBLISHED, context! { tables => tables.clone() })?
    } else {
        String::new()
    };
    Ok(engine
        .render_str(PAGE, context! { sections, results, checks => checks.len(), failed, whole, published })?)
}

/// Rows of all tables by name, as maps from column to value.
fn tables(found: &[Found]) -> BTreeMap<&'static str, Vec<Value>> {
    let all = found.iter().flat_map(|(_, evidence)| &evidence.tables);
    all.map(|table| (table.name, rows(table))).collect()
}

fn rows(table: &Table) -> Vec<Value> {
    table
        .rows
        .iter()
        .map(|row| {
            row.entries()
                .map(|(definition, cell)| (definition.name.clone(), value(cell)))
                .collect::<BTreeMap<_, _>>()
        })
        .map(Value::from)
        .collect()
}

fn value(cell: &Cell) -> Value {
    match cell {
        Cell::Text(text) => Value::from(text.as_str()),
        Cell::Number(number) => Value::from(*number),
        Cell::Count(count) => Value::from(*count),
        Cell::Flag(flag) => Value::from(*flag),
        Cell::Missing => Value::from(()),
    }
}

fn check_row(check: &Check) -> Value {
    context! {
        quantity => check.quantity.as_str(),
        measured => significant(check.measured, 4),
        theory => check.theory.as_str(),
        least => significant(check.allowed[0], 4),
        greatest => significant(check.allowed[1], 4),
        holds => check.holds(),
        source => check.source,
    }
}

fn figures(evidence: &Evidence) -> Vec<Value> {
    evidence
        .figures
        .iter()
        .map(|figure| context! { name => figure.name, caption => figure.caption })
        .collect()
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
