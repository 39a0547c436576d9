//! What tells the rows of a table apart.

use std::collections::HashMap;

use super::{CompareError, Key, Rules, Sheet};

/// Where the leading columns that tell rows apart end. The axes of a sweep, of any name, stand among them.
enum End {
    /// With this column.
    With(&'static str),
    /// Before this column.
    Before(&'static str),
}

/// A table of a study.
struct Known {
    table: &'static str,
    end: End,
    /// What rows are that these columns do not tell apart: they are counted, in the order in which they stand.
    counted: Option<&'static str>,
}

const KNOWN: [Known; 7] = [
    Known { table: "cases", end: End::With("block"), counted: None },
    Known { table: "fragments", end: End::With("rank"), counted: None },
    // Not by their time, which begins with the contact and so is itself a result.
    Known { table: "frames", end: End::With("block"), counted: Some("frame") },
    Known { table: "summary", end: End::With("endpoint"), counted: None },
    Known { table: "claims", end: End::With("claim"), counted: None },
    Known { table: "trade", end: End::Before("blocks"), counted: None },
    Known { table: "dictionary", end: End::With("column"), counted: None },
];

/// Columns that tell the rows of a sheet apart, and what is counted beyond them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Identity {
    columns: Vec<usize>,
    counted: Option<&'static str>,
}

impl Identity {
    /// That of a sheet under the name of its table: by `--key`, by what is known of the table, or by the number of the row.
    pub(super) fn of(table: &str, sheet: &Sheet, rules: &Rules) -> Result<Self, CompareError> {
        if let Some(key) = &rules.key {
            let columns =
                key.iter().map(|name| sheet.column(name).ok_or(name)).collect::<Result<Vec<_>, _>>();
            return match columns {
                Ok(columns) => Ok(Identity { columns, counted: None }),
                Err(name) => {
                    let message = format!(
                        "there is no column `{name}`, which `--key` names; there are {}",
                        sheet.columns.join(", ")
                    );
                    Err(CompareError::format(&sheet.path, 1, message))
                }
            };
        }
        let known = KNOWN.iter().find(|known| known.table == table);
        let found = known.and_then(|known| {
            let count = match known.end {
                End::With(name) => sheet.column(name)? + 1,
                End::Before(name) => sheet.column(name)?,
            };
            Some(Identity { columns: (0..count).collect(), counted: known.counted })
        });
        Ok(found.unwrap_or(Identity { columns: Vec::new(), counted: Some("row") }))
    }

    /// Names of the columns.
    pub(super) fn names(&self, sheet: &Sheet) -> Vec<String> {
        let counted = self.counted.into_iter().map(Into::into);
        self.columns.iter().map(|&column| sheet.columns[column].clone()).chain(counted).collect()
    }

    /// Whether a column is one of them.
    pub(super) fn has(&self, column: usize) -> bool {
        self.columns.contains(&column)
    }

    /// The keys of all rows, in their order.
    ///
    /// # Errors
    /// [`CompareError::Format`] where two rows have the same.
    pub(super) fn keys<'a>(&self, sheet: &'a Sheet) -> Result<Vec<RowKey<'a>>, CompareError> {
        let mut seen: HashMap<Vec<&str>, usize> = HashMap::new();
        let mut keys = Vec::with_capacity(sheet.rows.len());
        for (row, record) in sheet.rows.iter().enumerate() {
            let entries: Vec<&str> = self.columns.iter().map(|&column| &record[column]).collect();
            if self.counted.is_some() {
                let number = seen.entry(entries.clone()).and_modify(|number| *number += 1).or_insert(1);
                keys.push(RowKey { entries, number: *number });
            } else {
                if let Some(first) = seen.insert(entries.clone(), row) {
                    let key = in_words(&named(&self.names(sheet), &RowKey { entries, number: 0 }));
                    let message = format!(
                        "{key} stands in line {} already; each row needs a key of its own: delete one, or compare the two files with \
                         other columns as `--key`",
                        sheet.line(first)
                    );
                    return Err(CompareError::format(&sheet.path, sheet.line(row), message));
                }
                keys.push(RowKey { entries, number: 0 });
            }
        }
        Ok(keys)
    }
}

/// The entries that tell a row apart, and its number among those that have the same.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct RowKey<'a> {
    entries: Vec<&'a str>,
    number: usize,
}

/// A key with the names of its columns.
pub(super) fn named(names: &[String], key: &RowKey) -> Key {
    let number = key.number.to_string();
    let entries = key.entries.iter().copied().chain([number.as_str()]);
    names.iter().zip(entries).map(|(name, entry)| (name.clone(), entry.into())).collect()
}

/// A key as it stands in a line.
pub(super) fn in_words(key: &Key) -> String {
    key.iter().map(|(name, entry)| format!("{name} {entry}")).collect::<Vec<_>>().join(", ")
}
