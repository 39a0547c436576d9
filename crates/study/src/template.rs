//! Pages whose numbers come from tables: Markdown with the markup of minijinja, in which what is not defined is an error.
//!
//! A page reads tables by `rows("results/extremes/cases.csv", arm="usual")`, all rows whose columns have these texts, or by `row(...)`, where
//! there is exactly one. Numbers are written by the filters `figures(n)`, significant digits, and `fixed(n)`, decimals. What words say of numbers is kept
//! true by `holds(condition, "what is said")`, which writes nothing and refuses the page where the tables say otherwise.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Kwargs;
use minijinja::{Environment, Error, ErrorKind, UndefinedBehavior, Value};

/// A row of a table as it stands in its file: column and text.
pub type Record = BTreeMap<String, String>;

/// What turns a page's source into the page, but for its tables.
///
/// # Errors
/// None that this markup gives.
pub fn engine() -> anyhow::Result<Environment<'static>> {
    let mut engine = Environment::new();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    engine.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    engine.add_filter("figures", significant);
    engine.add_filter("exp", |value: f64| libm::exp(value));
    engine.add_filter("fixed", |value: f64, digits: usize| format!("{value:.digits$}"));
    Ok(engine)
}

/// The page that `source` makes of the tables below `root`.
///
/// # Errors
/// Markup that is not understood, a table or column that is not there, a row that is not there once; with the source's line.
pub fn page(source: &str, root: &Path) -> anyhow::Result<String> {
    let mut engine = engine()?;
    let folder: PathBuf = root.into();
    let below = folder.clone();
    engine.add_function("rows", move |table: &str, wanted: Kwargs| {
        rows(&below, table, &wanted).map(Value::from)
    });
    engine.add_function("holds", |condition: bool, said: &str| {
        let refusal = || refused(format!("the tables do not bear out \"{said}\"; say what they do"));
        if condition { Ok("") } else { Err(refusal()) }
    });
    engine.add_function("row", move |table: &str, wanted: Kwargs| {
        match rows(&folder, table, &wanted)?.as_slice() {
            [row] => Ok(row.clone()),
            found => Err(refused(format!(
                "{table}: {} rows are asked for by {wanted:?}; allowed: one",
                found.len()
            ))),
        }
    });
    Ok(engine.render_str(source, ())?)
}

fn refused(message: String) -> Error {
    Error::new(ErrorKind::InvalidOperation, message)
}

/// The rows whose columns have the texts that are wanted.
fn rows(root: &Path, table: &str, wanted: &Kwargs) -> Result<Vec<Value>, Error> {
    let records = records(&root.join(table)).map_err(|error| refused(format!("{error:#}")))?;
    let columns: Vec<(&str, String)> = wanted
        .args()
        .map(|name| Ok((name, wanted.get::<Value>(name)?.to_string())))
        .collect::<Result<_, Error>>()?;
    if let (Some(first), Some((name, _))) = (
        records.first(),
        columns.iter().find(|(name, _)| !records.iter().any(|record| record.contains_key(*name))),
    ) {
        let known: Vec<&str> = first.keys().map(String::as_str).collect();
        return Err(refused(format!("{table} has no column `{name}`; it has: {}", known.join(", "))));
    }
    let fits = |record: &&Record| columns.iter().all(|(name, text)| record.get(*name) == Some(text));
    Ok(records.iter().filter(fits).map(values).collect())
}

/// The rows of a table.
///
/// # Errors
/// A file that cannot be read.
pub fn records(path: &Path) -> anyhow::Result<Vec<Record>> {
    let mut reader =
        csv::Reader::from_path(path).with_context(|| format!("cannot read {}", path.display()))?;
    let rows: Result<Vec<Record>, _> = reader.deserialize().collect();
    rows.with_context(|| format!("cannot read {}", path.display()))
}

/// Numbers as numbers, counts as counts, an empty field as none.
pub fn values(record: &Record) -> Value {
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

/// `value` with so many significant digits, in the shorter of plain and scientific notation.
pub fn significant(value: f64, digits: usize) -> String {
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

#[cfg(test)]
mod tests {
    use super::page;

    #[test]
    fn numbers_come_from_tables_and_from_nowhere_else() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("t.csv"), "arm,x\na,1.23456\nb,2\nb,3\n").unwrap();
        let made = |source: &str| page(source, folder.path()).map_err(|error| format!("{error:#}"));
        assert_eq!(made("{{ row('t.csv', arm='a').x | figures(3) }}"), Ok("1.23".into()));
        assert_eq!(made("{{ holds(row('t.csv', arm='a').x > 1, 'a is over 1') }}so"), Ok("so".into()));
        assert_eq!(made("{{ (row('t.csv', arm='a').x - 1.23456) | exp | fixed(2) }}"), Ok("1.00".into()));
        assert_eq!(made("{% for r in rows('t.csv', arm='b') %}{{ r.x }};{% endfor %}"), Ok("2;3;".into()));
        for (source, words) in [
            ("{{ row('t.csv', arm='b').x }}", "2 rows"),
            ("{{ row('t.csv', arm='c').x }}", "0 rows"),
            ("{{ row('t.csv', name='c').x }}", "no column `name`; it has: arm, x"),
            ("{{ row('t.csv', arm='a').y + 1 }}", "undefined"),
            ("{{ rows('u.csv') }}", "cannot read"),
            ("{{ holds(row('t.csv', arm='a').x > 2, 'a is large') }}", "do not bear out \"a is large\""),
        ] {
            let message = made(source).unwrap_err();
            assert!(message.contains(words), "{source}: {message}");
        }
    }
}
