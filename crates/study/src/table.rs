//! Tables with a dictionary of their columns, written as CSV by polars.

use polars::prelude::{Column, CsvWriter, DataFrame, NamedFrom, SerWriter, Series};

use crate::store::{StoreError, write_whole};

/// What a column means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// Name.
    pub name: String,
    /// Unit, `-` without one.
    pub unit: &'static str,
    /// Meaning.
    pub meaning: &'static str,
}

/// One entry.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number; one that is not finite is left empty.
    Number(f64),
    /// A count.
    Count(u64),
    /// Yes or no.
    Flag(bool),
    /// Nothing.
    Missing,
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Cell::Missing, Cell::Number)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.into())
    }
}

/// A row under construction: definitions and entries side by side.
#[derive(Clone, Debug, Default)]
pub struct Row {
    entries: Vec<(Definition, Cell)>,
}

impl Row {
    /// Adds an entry.
    pub fn put(
        &mut self,
        name: &str,
        unit: &'static str,
        meaning: &'static str,
        cell: impl Into<Cell>,
    ) -> &mut Self {
        self.entries.push((Definition { name: name.into(), unit, meaning }, cell.into()));
        self
    }

    /// Adds a number.
    pub fn number(&mut self, name: &str, unit: &'static str, meaning: &'static str, value: f64) -> &mut Self {
        self.put(name, unit, meaning, Cell::Number(value))
    }

    /// Adds a count.
    pub fn count(&mut self, name: &str, meaning: &'static str, value: u64) -> &mut Self {
        self.put(name, "-", meaning, Cell::Count(value))
    }

    /// The entry of the given name, as a number.
    pub fn value(&self, name: &str) -> Option<f64> {
        let (_, cell) = self.entries.iter().find(|(definition, _)| definition.name == name)?;
        match cell {
            Cell::Number(value) if value.is_finite() => Some(*value),
            Cell::Count(value) => Some(*value as f64),
            _ => None,
        }
    }

    /// The entries, in order.
    pub fn entries(&self) -> impl Iterator<Item = (&Definition, &Cell)> {
        self.entries.iter().map(|(definition, cell)| (definition, cell))
    }
}

/// A table: rows of the same columns.
#[derive(Clone, Debug)]
pub struct Table {
    /// Name of the table and of its file.
    pub name: &'static str,
    /// Rows.
    pub rows: Vec<Row>,
}

impl Table {
    /// The columns.
    pub fn columns(&self) -> Vec<&Definition> {
        self.rows
            .first()
            .map_or(Vec::new(), |row| row.entries.iter().map(|(definition, _)| definition).collect())
    }

    /// The table as CSV.
    ///
    /// # Panics
    /// Where rows have different columns: a mistake of the program.
    pub fn to_csv(&self) -> Vec<u8> {
        let mut columns = Vec::new();
        for (index, definition) in self.columns().into_iter().enumerate() {
            let cells: Vec<&Cell> = self
                .rows
                .iter()
                .map(|row| {
                    assert_eq!(
                        &row.entries[index].0, definition,
                        "table {}: rows differ in columns",
                        self.name
                    );
                    &row.entries[index].1
                })
                .collect();
            columns.push(column(&definition.name, &cells));
        }
        let mut frame = DataFrame::new(self.rows.len(), columns).expect("columns have the table's length");
        let mut bytes = Vec::new();
        CsvWriter::new(&mut bytes).finish(&mut frame).expect("memory can be written");
        bytes
    }

    /// Writes `<folder>/<name>.csv`.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write(&self, folder: &std::path::Path) -> Result<(), StoreError> {
        write_whole(&folder.join(format!("{}.csv", self.name)), &self.to_csv())
    }
}

fn column(name: &str, cells: &[&Cell]) -> Column {
    let text = cells.iter().any(|cell| matches!(cell, Cell::Text(_)));
    let number = cells.iter().any(|cell| matches!(cell, Cell::Number(_)));
    let flag = cells.iter().any(|cell| matches!(cell, Cell::Flag(_)));
    let series = if text {
        let values =
            cells.iter().map(|cell| if let Cell::Text(text) = cell { Some(text.as_str()) } else { None });
        Series::new(name.into(), values.collect::<Vec<_>>())
    } else if flag {
        let values = cells.iter().map(|cell| if let Cell::Flag(flag) = cell { Some(*flag) } else { None });
        Series::new(name.into(), values.collect::<Vec<_>>())
    } else if number {
        let values = cells.iter().map(|cell| match cell {
            Cell::Number(value) => value.is_finite().then_some(*value),
            Cell::Count(value) => Some(*value as f64),
            _ => None,
        });
        Series::new(name.into(), values.collect::<Vec<_>>())
    } else {
        let values = cells.iter().map(|cell| if let Cell::Count(value) = cell { Some(*value) } else { None });
        Series::new(name.into(), values.collect::<Vec<_>>())
    };
    series.into()
}

/// The data dictionary of several tables, itself a table.
pub fn dictionary(tables: &[&Table]) -> Table {
    let rows = tables.iter().flat_map(|table| {
        table.columns().into_iter().map(|definition| {
            let mut row = Row::default();
            row.put("table", "-", "file without `.csv`", table.name)
                .put("column", "-", "name of the column", definition.name.as_str())
                .put("unit", "-", "unit, `-` without one", definition.unit)
                .put("meaning", "-", "what it means", definition.meaning);
            row
        })
    });
    Table { name: "dictionary", rows: rows.collect() }
}
