//! Two sets of tables held against each other with tolerances: results of now against earlier ones.
//!
//! Numbers a and b differ where |a - b| > absolute + relative max(|a|, |b|); all else differs where it is not the same text.

mod error;
mod identity;
mod pairs;
mod sheet;
mod table;
#[cfg(test)]
mod tests;
mod tolerance;
mod words;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Serialize;

pub use error::CompareError;
pub use pairs::Pair;
pub use sheet::Sheet;
pub use table::compare_pair;

use tolerance::Distance;

/// What counts as the same.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Rules {
    /// Relative tolerance, 0 or more.
    pub relative: f64,
    /// Absolute tolerance, 0 or more, in the unit of each column.
    pub absolute: f64,
    /// Relative tolerances of single columns, in place of `relative`.
    pub columns: BTreeMap<String, f64>,
    /// Columns that are not compared.
    pub ignored: BTreeSet<String>,
    /// Columns that tell the rows of two files apart, in place of those known of a study's tables.
    pub key: Option<Vec<String>>,
}

/// One of the two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The first.
    A,
    /// The second.
    B,
}

/// What tells a row apart: columns and their entries.
pub type Key = Vec<(String, String)>;

/// Rows or columns that one side alone has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Missing {
    /// The side that has them.
    pub side: Side,
    /// How many there are.
    pub count: usize,
    /// Which, the first few.
    pub first: Vec<String>,
}

/// A column with differences.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnDifference {
    /// The column.
    pub column: String,
    /// Rows in which it differs.
    pub rows: usize,
    /// Rows that were compared.
    pub of: usize,
    /// The greatest of the differences.
    pub greatest: Difference,
}

/// Two entries that differ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// The row.
    pub key: Key,
    /// Entry of the first side.
    pub a: String,
    /// Entry of the second side.
    pub b: String,
    /// |a - b|, where both are numbers.
    pub absolute: Option<f64>,
    /// |a - b| / max(|a|, |b|), where both are numbers. By it the greatest is found; all that is not two numbers is greater.
    pub relative: Option<f64>,
}

/// What was found of one table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableComparison {
    /// Name of the table, or of the two files.
    pub table: String,
    /// The side that alone has the table.
    pub only_in: Option<Side>,
    /// Columns that tell rows apart on either side, where they are not the same ones, so that nothing could be compared.
    pub keys_differ: Option<[Vec<String>; 2]>,
    /// Columns of one side.
    pub columns_missing: Vec<Missing>,
    /// Rows of one side.
    pub rows_missing: Vec<Missing>,
    /// Rows that were compared.
    pub rows: usize,
    /// Columns that differ.
    pub differences: Vec<ColumnDifference>,
}

impl Difference {
    fn new(key: Key, [a, b]: [&str; 2], distance: Distance) -> Self {
        let (absolute, relative) = match distance {
            Distance::Words => (None, None),
            Distance::Numbers { absolute, relative } => (Some(absolute), Some(relative)),
        };
        Difference { key, a: a.into(), b: b.into(), absolute, relative }
    }
}

impl TableComparison {
    fn of(table: &str) -> Self {
        TableComparison {
            table: table.into(),
            only_in: None,
            keys_differ: None,
            columns_missing: Vec::new(),
            rows_missing: Vec::new(),
            rows: 0,
            differences: Vec::new(),
        }
    }

    /// Whether nothing differs and nothing is missing.
    pub fn is_same(&self) -> bool {
        self.only_in.is_none()
            && self.keys_differ.is_none()
            && self.columns_missing.is_empty()
            && self.rows_missing.is_empty()
            && self.differences.is_empty()
    }
}

/// What was found of all tables.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Whether all is the same within the tolerances.
    pub same: bool,
    /// By what rules.
    pub rules: Rules,
    /// By table.
    pub tables: Vec<TableComparison>,
}

impl Comparison {
    /// Compares pairs of tables.
    ///
    /// # Errors
    /// [`CompareError::Name`] and [`CompareError::Format`]: rules that do not fit the tables, and rows that cannot be told apart.
    pub fn of(pairs: &[Pair], rules: Rules) -> Result<Self, CompareError> {
        pairs::hold_names(pairs, &rules)?;
        let tables =
            pairs.iter().map(|pair| compare_pair(pair, &rules)).collect::<Result<Vec<_>, CompareError>>()?;
        Ok(Comparison { same: tables.iter().all(TableComparison::is_same), rules, tables })
    }
}

/// Compares the tables of two folders, or two files.
///
/// # Errors
/// [`CompareError`]: files that cannot be read or are no tables, and what [`Comparison::of`] refuses.
pub fn compare(a: &Path, b: &Path, rules: Rules) -> Result<Comparison, CompareError> {
    if rules.key.is_some() && a.is_dir() {
        return Err(CompareError::KeyOfFolders);
    }
    Comparison::of(&pairs::read(a, b)?, rules)
}
