//! The report of a study: one HTML file that needs nothing else.
//!
//! Figures are inlined, nothing is fetched, and no script runs: the page forbids it itself by its
//! content-security policy. All text is escaped by the template engine.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Serde, Value};
use serde::Serialize;

/// The page. `report.css` is put into it as it stands.
const TEMPLATE: &str = include_str!("report.html.jinja");
const STYLE: &str = include_str!("report.css");

/// What a report says. Numbers come formatted, with their units.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReportData {
    /// Title of the study.
    pub title: String,
    /// One sentence below the title; may be empty.
    pub subtitle: String,
    /// The question, a paragraph each.
    pub question: Vec<String>,
    /// What a reader must know before the verdicts, such as which conditions are not given by the paper.
    pub caveats: Vec<String>,
    /// The arms compared.
    pub arms: Vec<ReportArm>,
    /// The claims with their verdicts.
    pub verdicts: Vec<ReportVerdict>,
    /// The figures, in order.
    #[serde(skip)]
    pub figures: Vec<ReportFigure>,
    /// Tables of results, the summary first.
    pub tables: Vec<ReportTable>,
    /// Cases that did not end `ok`.
    pub failures: Vec<ReportFailure>,
    /// Where the numbers come from: git revision, compiler, digest of the study, seeds.
    pub provenance: Vec<ReportFact>,
}

/// An arm.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReportArm {
    /// Its name.
    pub name: String,
    /// What it is.
    pub description: String,
    /// How many cases ended, such as `24 of 24`.
    pub cases: String,
}

/// Kind of a verdict; it gives the colour and the sign of its badge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReportOutcome {
    /// Supported.
    Supported,
    /// Refuted: not reproduced under these conditions.
    Refuted,
    /// Neither.
    #[default]
    Inconclusive,
    /// Too few blocks.
    NotRun,
}

/// A claim and what became of it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReportVerdict {
    /// Name of the claim.
    pub claim: String,
    /// The sentence of the paper.
    pub sentence: String,
    /// Mean effect, such as `0.62 (1.86x)`; may be empty.
    pub effect: String,
    /// Its interval, such as `[0.41, 0.83], 99 %`; may be empty.
    pub interval: String,
    /// The verdict in words.
    pub verdict: String,
    /// Its kind.
    pub outcome: ReportOutcome,
    /// Conditions and checks printed with it, one each.
    pub conditions: Vec<String>,
}

/// A figure.
#[derive(Clone, Debug, Default)]
pub struct ReportFigure {
    /// The image, a PNG file.
    pub png: Vec<u8>,
    /// Short name.
    pub title: String,
    /// What it shows and how to read it.
    pub caption: String,
    /// What a reader who cannot see it must know; must not be empty.
    pub alternative: String,
}

/// A table.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReportTable {
    /// Its heading.
    pub title: String,
    /// A sentence below the heading; may be empty.
    pub note: String,
    /// Names of the columns, with units.
    pub columns: Vec<String>,
    /// Cells, row by row. The first column is set as text, the others as numbers.
    pub rows: Vec<Vec<String>>,
}

/// A case that failed.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReportFailure {
    /// Name or key of the case.
    pub case: String,
    /// How it ended, such as `stopped` or `ok-with-clamps`.
    pub status: String,
    /// The reason, with its numbers.
    pub reason: String,
}

/// A fact of the provenance.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReportFact {
    /// What.
    pub name: String,
    /// Its value.
    pub value: String,
}

/// A report that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A figure without the text that stands for it.
    #[error("report: figure {number} (`{title}`) has no alternative text; say in words what it shows")]
    NoAlternative {
        /// Number of the figure, from 1.
        number: usize,
        /// Its title.
        title: String,
    },
    /// A figure which is not a PNG file.
    #[error("report: figure {number} (`{title}`) is not a PNG file ({length} bytes)")]
    NotPng {
        /// Number of the figure, from 1.
        number: usize,
        /// Its title.
        title: String,
        /// Its length in bytes.
        length: usize,
    },
    /// A row of a table of the wrong length.
    #[error("report: row {row} of table `{table}` has {found} cells, the table has {expected} columns")]
    RaggedTable {
        /// The table.
        table: String,
        /// Number of the row, from 1.
        row: usize,
        /// Columns of the table.
        expected: usize,
        /// Cells of the row.
        found: usize,
    },
    /// The template failed.
    #[error("report: the template could not be filled in")]
    Template(#[from] minijinja::Error),
}

/// The first eight bytes of every PNG file (PNG specification, 5.2).
const PNG_SIGNATURE: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];

/// A figure as the template sees it.
#[derive(Serialize)]
struct InlineFigure<'a> {
    title: &'a str,
    caption: &'a str,
    alternative: &'a str,
    base64: String,
    width: u32,
    height: u32,
}

/// Writes the report as one HTML page. Same data, same bytes.
///
/// # Errors
/// [`ReportError`] if a figure has no alternative text or is no PNG file, or a table is ragged.
pub fn html(data: &ReportData) -> Result<String, ReportError> {
    for table in &data.tables {
        for (row, cells) in table.rows.iter().enumerate() {
            if cells.len() != table.columns.len() {
                let (expected, found) = (table.columns.len(), cells.len());
                return Err(ReportError::RaggedTable {
                    table: table.title.clone(),
                    row: row + 1,
                    expected,
                    found,
                });
            }
        }
    }
    let figures =
        data.figures.iter().enumerate().map(|(k, f)| inline(k + 1, f)).collect::<Result<Vec<_>, _>>()?;
    let mut environment = minijinja::Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    // The name ends in .html, which turns escaping on.
    environment.add_template("report.html", TEMPLATE)?;
    let style = Value::from_safe_string(STYLE.to_owned());
    let context = minijinja::context! { data => Serde(ReportView { data, figures }), style };
    Ok(environment.get_template("report.html")?.render(context)?)
}

/// The data with the figures encoded.
#[derive(Serialize)]
struct ReportView<'a> {
    #[serde(flatten)]
    data: &'a ReportData,
    figures: Vec<InlineFigure<'a>>,
}

fn inline(number: usize, figure: &ReportFigure) -> Result<InlineFigure<'_>, ReportError> {
    let title = || figure.title.clone();
    if figure.alternative.trim().is_empty() {
        return Err(ReportError::NoAlternative { number, title: title() });
    }
    // Width and height are the first two numbers of the header chunk (PNG specification, 11.2.2).
    if figure.png.len() < 24 || figure.png[..8] != PNG_SIGNATURE {
        return Err(ReportError::NotPng { number, title: title(), length: figure.png.len() });
    }
    let word = |start: usize| {
        figure.png[start..start + 4].iter().fold(0, |word, byte| (word << 8) | u32::from(*byte))
    };
    Ok(InlineFigure {
        title: &figure.title,
        caption: &figure.caption,
        alternative: &figure.alternative,
        base64: STANDARD.encode(&figure.png),
        width: word(16),
        height: word(20),
    })
}
