//! A comparison as lines of words.

use std::fmt;

use super::identity::in_words;
use super::{ColumnDifference, Comparison, Difference, Missing, Side, TableComparison};
use crate::points::lines::shown;

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for table in &self.tables {
            table_lines(f, table)?;
        }
        let rules = &self.rules;
        let rows: usize = self.tables.iter().map(|table| table.rows).sum();
        let compared = format!("{} of {} tables", self.different(), self.tables.len());
        let verdict = if self.same { "the same" } else { "different" };
        write!(f, "{verdict}: {compared} differ, {rows} rows compared")?;
        write!(f, ", tolerances relative {:?} and absolute {:?}", rules.relative, rules.absolute)?;
        for (column, relative) in &rules.columns {
            write!(f, ", {column} relative {relative:?}")?;
        }
        if !rules.ignored.is_empty() {
            let ignored: Vec<&str> = rules.ignored.iter().map(String::as_str).collect();
            write!(f, ", without {}", ignored.join(", "))?;
        }
        Ok(())
    }
}

impl Comparison {
    fn different(&self) -> usize {
        self.tables.iter().filter(|table| !table.is_same()).count()
    }
}

fn table_lines(f: &mut fmt::Formatter<'_>, table: &TableComparison) -> fmt::Result {
    let name = &table.table;
    if let Some(side) = table.only_in {
        writeln!(f, "{name}: only in {}", letter(side))?;
    }
    if let Some([a, b]) = &table.keys_differ {
        let (a, b) = (a.join(", "), b.join(", "));
        writeln!(f, "{name}: rows are told apart by {a} in A, by {b} in B: not compared")?;
    }
    for Missing { side, first, .. } in &table.columns_missing {
        writeln!(f, "{name}: columns only in {}: {}", letter(*side), first.join(", "))?;
    }
    for Missing { side, count, first } in &table.rows_missing {
        let rows = if *count == 1 { "row" } else { "rows" };
        let more = if *count > first.len() { "; ..." } else { "" };
        writeln!(f, "{name}: {count} {rows} only in {}: {}{more}", letter(*side), first.join("; "))?;
    }
    for ColumnDifference { column, rows, of, greatest } in &table.differences {
        let Difference { key, a, b, .. } = greatest;
        let most = if *rows > 1 { "most" } else { "that" };
        write!(f, "{name}, {column}: {rows} of {of} rows differ, {most} of {}: ", in_words(key))?;
        write!(f, "{} in A, {} in B", entry(a), entry(b))?;
        if let (Some(absolute), Some(relative)) = (greatest.absolute, greatest.relative) {
            write!(f, " (by {absolute:.3e}, relative {relative:.3e})")?;
        }
        writeln!(f)?;
    }
    Ok(())
}

fn letter(side: Side) -> &'static str {
    match side {
        Side::A => "A",
        Side::B => "B",
    }
}

fn entry(text: &str) -> String {
    match text.parse::<f64>() {
        Ok(_) => text.into(),
        Err(_) if text.is_empty() => "nothing".into(),
        Err(_) => shown(text),
    }
}
