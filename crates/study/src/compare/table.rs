//! One table of two sides: its rows and columns matched, and what is in both compared.

use std::collections::{BTreeSet, HashMap};

use super::identity::{Identity, RowKey, in_words, named};
use super::tolerance::{Distance, Tolerance};
use super::{ColumnDifference, CompareError, Difference, Missing, Pair, Rules, Sheet, Side, TableComparison};

/// The table of words, which no tolerance touches.
const DICTIONARY: &str = "dictionary";
/// Columns that know a clock, in tables that else do not.
const CLOCKED: [(&str, [&str; 3]); 1] = [("trade", ["seconds", "reference_seconds", "on_front"])];
/// Rows of one side that are named; of more there is the count.
const NAMED: usize = 3;

/// Compares a table of two sides.
///
/// # Errors
/// As [`super::Comparison::of`].
pub fn compare_pair(pair: &Pair, rules: &Rules) -> Result<TableComparison, CompareError> {
    let mut found = TableComparison::of(&pair.table);
    let (Some(a), Some(b)) = (&pair.a, &pair.b) else {
        found.only_in = Some(if pair.a.is_some() { Side::A } else { Side::B });
        return Ok(found);
    };
    let sides = [(Side::A, a), (Side::B, b)];
    // A table without rows is written without columns: each row of the other side is one that is missing.
    if a.columns.is_empty() || b.columns.is_empty() {
        for (side, sheet) in sides.into_iter().filter(|(_, sheet)| !sheet.columns.is_empty()) {
            let identity = Identity::of(&pair.table, sheet, rules)?;
            let keys = identity.keys(sheet)?;
            found.rows_missing.extend(rows_missing(side, &identity.names(sheet), keys.iter().collect()));
        }
        return Ok(found);
    }
    let identities = [Identity::of(&pair.table, a, rules)?, Identity::of(&pair.table, b, rules)?];
    let names = [identities[0].names(a), identities[1].names(b)];
    if names[0] != names[1] {
        found.keys_differ = Some(names);
        return Ok(found);
    }
    let ignored = ignored(pair, rules, &identities[0], a)?;
    for (side, sheet, other) in [(Side::A, a, b), (Side::B, b, a)] {
        let is_missing =
            |column: &&String| other.column(column).is_none() && !ignored.contains(column.as_str());
        let first: Vec<String> = sheet.columns.iter().filter(is_missing).cloned().collect();
        found.columns_missing.extend((!first.is_empty()).then_some(Missing {
            side,
            count: first.len(),
            first,
        }));
    }
    let keys = [identities[0].keys(a)?, identities[1].keys(b)?];
    let rows = keys.each_ref().map(|keys| numbered(keys));
    for (side, mine, other) in [(Side::A, &keys[0], &rows[1]), (Side::B, &keys[1], &rows[0])] {
        let only = mine.iter().filter(|key| !other.contains_key(key)).collect();
        found.rows_missing.extend(rows_missing(side, &names[0], only));
    }
    let matched = keys[0].iter().enumerate().filter_map(|(row, key)| Some((row, *rows[1].get(key)?)));
    let matched: Vec<(usize, usize)> = matched.collect();
    found.rows = matched.len();
    for (in_a, column) in a.columns.iter().enumerate() {
        let Some(in_b) = b.column(column) else { continue };
        if identities[0].has(in_a) || ignored.contains(column.as_str()) {
            continue;
        }
        let tolerance =
            if pair.table == DICTIONARY { Tolerance::Words } else { Tolerance::of(column, rules) };
        let entries = |(row_a, row_b): (usize, usize)| [&a.rows[row_a][in_a], &b.rows[row_b][in_b]];
        if let Some((count, row, distance)) = greatest(&matched, |row| tolerance.left(entries(row))) {
            let key = named(&names[0], &keys[0][row.0]);
            let greatest = Difference::new(key, entries(row), distance);
            let column = column.clone();
            found.differences.push(ColumnDifference { column, rows: count, of: matched.len(), greatest });
        }
    }
    Ok(found)
}

/// Columns that are not compared.
fn ignored<'a>(
    pair: &Pair,
    rules: &'a Rules,
    identity: &Identity,
    sheet: &Sheet,
) -> Result<BTreeSet<&'a str>, CompareError> {
    let clocked = CLOCKED.iter().filter(|(table, _)| *table == pair.table).flat_map(|(_, columns)| *columns);
    if let Some(column) = rules.ignored.iter().find(|c| sheet.column(c).is_some_and(|c| identity.has(c))) {
        let message =
            format!("by it rows of the table `{}` are told apart, so that it cannot be left out", pair.table);
        return Err(CompareError::Name { option: "--ignore", column: column.clone(), message });
    }
    Ok(rules.ignored.iter().map(String::as_str).chain(clocked).collect())
}

fn numbered<'a, 'b>(keys: &'b [RowKey<'a>]) -> HashMap<&'b RowKey<'a>, usize> {
    keys.iter().enumerate().map(|(row, key)| (key, row)).collect()
}

fn rows_missing(side: Side, names: &[String], keys: Vec<&RowKey>) -> Option<Missing> {
    let first = keys.iter().take(NAMED).map(|key| in_words(&named(names, key))).collect();
    (!keys.is_empty()).then_some(Missing { side, count: keys.len(), first })
}

/// How many of the rows differ, and the first of those that differ most.
fn greatest(
    rows: &[(usize, usize)],
    left: impl Fn((usize, usize)) -> Option<Distance>,
) -> Option<(usize, (usize, usize), Distance)> {
    let mut count = 0;
    let mut greatest: Option<((usize, usize), Distance)> = None;
    for &row in rows {
        let Some(distance) = left(row) else { continue };
        count += 1;
        if greatest.is_none_or(|(_, other)| distance.order() > other.order()) {
            greatest = Some((row, distance));
        }
    }
    greatest.map(|(row, distance)| (count, row, distance))
}
