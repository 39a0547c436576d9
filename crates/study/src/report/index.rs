//! The index over the reports of several studies: one HTML page beside their folders.

use minijinja::value::Serde;
use serde::Serialize;

use super::page::{Policy, render};
use super::{ReportError, ReportOutcome};

const TEMPLATE: &str = include_str!("index.html.jinja");

/// What the index says.
#[derive(Clone, Debug, Default, Serialize)]
pub struct IndexData {
    /// Studies with tables.
    pub entries: Vec<IndexEntry>,
    /// Names of studies without any.
    pub without: Vec<String>,
}

/// A study, or a profile of one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct IndexEntry {
    /// Its name.
    pub title: String,
    /// Its profile; empty for the study as it stands.
    pub profile: String,
    /// The question, a paragraph each.
    pub question: Vec<String>,
    /// How many cases have a row in its tables.
    pub cases: usize,
    /// How many of them stopped.
    pub stopped: usize,
    /// How many claims ended how, in the order of [`ReportOutcome`]; none that no claim ended by.
    pub verdicts: Vec<IndexVerdicts>,
    /// Its report, from the folder of the index; empty where there is none.
    pub report: String,
    /// A figure; none where there is none.
    pub figure: Option<IndexFigure>,
    /// Its tables.
    pub tables: Vec<IndexTable>,
}

/// How many claims ended in one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct IndexVerdicts {
    /// Which.
    pub outcome: ReportOutcome,
    /// How many.
    pub count: usize,
}

/// A figure beside an entry.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct IndexFigure {
    /// Its file, from the folder of the index.
    pub path: String,
    /// What it shows.
    pub alternative: String,
}

/// A table of an entry.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct IndexTable {
    /// Its name.
    pub name: String,
    /// Its file, from the folder of the index.
    pub path: String,
}

/// Writes the index as one HTML page, which shows figures and leads to files beside it and fetches nothing else. Same data, same bytes.
///
/// # Errors
/// [`ReportError::NoAlternative`] for a figure without words.
pub fn index(data: &IndexData) -> Result<String, ReportError> {
    for (entry, figure) in data.entries.iter().filter_map(|e| Some((e, e.figure.as_ref()?))) {
        if figure.alternative.trim().is_empty() {
            return Err(ReportError::NoAlternative { image: format!("the figure of `{}`", entry.title) });
        }
    }
    // `file:` for who opens the page from a disk, where browsers do not agree on what the page itself is.
    let policy = Policy { images: "'self' file:", script: None };
    Ok(render("index.html", TEMPLATE, &policy, minijinja::context! { data => Serde(data) })?)
}
