//! What an experiment of the verification leaves: tables, figures, and checks of measured against known values.

use serde::Serialize;

use super::Found;
use crate::figure::Drawing;
use crate::table::{Row, Table};

/// How thorough a verification is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A minute or two in all, for continuous integration: coarse grids, few placements.
    Quick,
    /// What `docs/verification.md` is made from.
    Full,
}

impl Effort {
    /// The one or the other.
    pub fn choose<V>(self, quick: V, full: V) -> V {
        match self {
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }
}

/// A measured value beside what theory says, and the range in which it must lie.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// What is measured, such as `order of the L2 error, 2D, cubic, mls, lattice`.
    pub quantity: String,
    /// The measured value; NaN where there is none, which fails.
    pub measured: f64,
    /// What theory says, such as `2` or `g t^2 / 2 (sin - mu cos) = 0.41 m`.
    pub theory: String,
    /// Least and greatest value allowed.
    pub allowed: [f64; 2],
    /// Where theory and range come from.
    pub source: &'static str,
}

impl Check {
    /// Whether the measured value lies in its range.
    pub fn holds(&self) -> bool {
        self.allowed[0] <= self.measured && self.measured <= self.allowed[1]
    }
}

/// A figure with the name of its file and a caption.
#[derive(Clone, Debug)]
pub struct EvidenceFigure {
    /// File without `.png`.
    pub name: &'static str,
    /// What it shows, in a sentence.
    pub caption: &'static str,
    /// The figure.
    pub drawing: Drawing,
}

/// What one experiment found.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    /// Tables, each `results/verify/<name>.csv`.
    pub tables: Vec<Table>,
    /// Figures, each `results/verify/figures/<name>.png`.
    pub figures: Vec<EvidenceFigure>,
    /// Checks; the command fails where one does not hold.
    pub checks: Vec<Check>,
}

/// The checks of all experiments as a table, `results/verify/checks.csv`.
pub(super) fn checks_table<'a>(checks: impl Iterator<Item = (&'static str, &'a Check)>) -> Table {
    let row = |(experiment, check): (&'static str, &Check)| {
        let mut row = Row::default();
        row.put("experiment", "-", "section of docs/verification.md", experiment)
            .put("quantity", "-", "what is measured", check.quantity.as_str())
            .number("measured", "as the quantity", "measured value", check.measured)
            .put("theory", "-", "what theory says", check.theory.as_str())
            .number("least", "as the quantity", "least value allowed", check.allowed[0])
            .number("greatest", "as the quantity", "greatest value allowed", check.allowed[1])
            .put("holds", "-", "whether it lies in between", crate::table::Cell::Flag(check.holds()))
            .put("source", "-", "where theory and range come from", check.source);
        row
    };
    Table { name: "checks", rows: checks.map(row).collect() }
}

/// What each experiment left, `results/verify/contents.csv`: from it, the tables and the checks the page is made.
pub(super) fn contents_table(found: &[Found]) -> Table {
    let row = |experiment: &str, kind: &str, name: &str, caption: &str| {
        let mut row = Row::default();
        row.put("experiment", "-", "section of docs/verification.md", experiment)
            .put("kind", "-", "table or figure", kind)
            .put("name", "-", "file without ending", name)
            .put("caption", "-", "of a figure", caption);
        row
    };
    let rows = found.iter().flat_map(|(experiment, evidence)| {
        let tables = evidence.tables.iter().map(|table| row(experiment.id, "table", table.name, ""));
        let figures =
            evidence.figures.iter().map(|figure| row(experiment.id, "figure", figure.name, figure.caption));
        tables.chain(figures).collect::<Vec<_>>()
    });
    Table { name: "contents", rows: rows.collect() }
}
