//! The report of a study: one HTML file that needs nothing else.
//!
//! Figures are inlined and nothing is fetched: the page forbids it itself by its content-security policy, which lets one style and one script be, by
//! their hashes. The script sorts tables and moves a slider; without it all is there to be read. All text is escaped by the template engine.

mod data;
mod forest;
pub mod index;
mod page;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::value::Serde;
use serde::Serialize;

use forest::Plot;
use page::{Policy, render};

pub use data::{
    EffectSize, ReportArm, ReportData, ReportFact, ReportFailure, ReportFigure, ReportMotion, ReportOutcome,
    ReportPicture, ReportStrip, ReportTable, ReportVerdict,
};

const TEMPLATE: &str = include_str!("report.html.jinja");
const SCRIPT: &str = include_str!("report.js");

/// A report that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// An image without the text that stands for it.
    #[error("report: {image} has no alternative text; say in words what it shows")]
    NoAlternative {
        /// Which one.
        image: String,
    },
    /// An image which is not a PNG file.
    #[error("report: {image} is not a PNG file ({length} bytes)")]
    NotPng {
        /// Which one.
        image: String,
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
    /// An arm that does not say which of its pictures is shown at each instant.
    #[error(
        "report: arm `{arm}` must name one of its {pictures} pictures for each of {steps} instants, and names {shown:?}"
    )]
    Instants {
        /// The arm.
        arm: String,
        /// Its pictures.
        pictures: usize,
        /// Instants of the slider.
        steps: usize,
        /// What it names.
        shown: Vec<usize>,
    },
    /// The template failed.
    #[error("report: the template could not be filled in")]
    Template(#[from] minijinja::Error),
}

/// The first eight bytes of every PNG file (PNG specification, 5.2).
const PNG_SIGNATURE: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];

/// Writes the report as one HTML page. Same data, same bytes.
///
/// # Errors
/// [`ReportError`] if an image has no alternative text or is no PNG file, a table is ragged, or an arm has not one picture for each instant.
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
    let figures = data.figures.iter().enumerate().map(|(k, f)| InlineFigure::of(k + 1, f));
    let view = ReportView {
        data,
        plots: forest::plots(data),
        smallest_ratio: format!("{:.2}", libm::exp(data.smallest_effect)),
        figures: figures.collect::<Result<_, _>>()?,
        motion: InlineMotion::of(&data.motion)?,
    };
    let policy = Policy { images: "data:", script: Some(SCRIPT) };
    Ok(render("report.html", TEMPLATE, &policy, minijinja::context! { data => Serde(view) })?)
}

/// The data with the images encoded.
#[derive(Serialize)]
struct ReportView<'a> {
    #[serde(flatten)]
    data: &'a ReportData,
    plots: Vec<Option<Plot>>,
    /// The smallest effect of interest, a difference of logarithms, as a ratio.
    smallest_ratio: String,
    figures: Vec<InlineFigure<'a>>,
    motion: InlineMotion<'a>,
}

/// A figure as the template sees it.
#[derive(Serialize)]
struct InlineFigure<'a> {
    title: &'a str,
    caption: &'a str,
    image: InlineImage<'a>,
}

impl<'a> InlineFigure<'a> {
    fn of(number: usize, figure: &'a ReportFigure) -> Result<Self, ReportError> {
        let name = || format!("figure {number} (`{}`)", figure.title);
        let image = InlineImage::of(&figure.png, &figure.alternative, name)?;
        Ok(InlineFigure { title: &figure.title, caption: &figure.caption, image })
    }
}

/// The pictures as the template sees them.
#[derive(Serialize)]
struct InlineMotion<'a> {
    note: &'a str,
    steps: &'a [String],
    /// The same as JSON, for the script.
    steps_json: String,
    strips: Vec<InlineStrip<'a>>,
}

#[derive(Serialize)]
struct InlineStrip<'a> {
    name: &'a str,
    shown: &'a [usize],
    /// The same as JSON, for the script.
    shown_json: String,
    pictures: Vec<InlinePicture<'a>>,
}

#[derive(Serialize)]
struct InlinePicture<'a> {
    caption: &'a str,
    image: InlineImage<'a>,
}

impl<'a> InlineMotion<'a> {
    fn of(motion: &'a ReportMotion) -> Result<Self, ReportError> {
        let strip = |strip: &'a ReportStrip| {
            let (pictures, steps) = (strip.pictures.len(), motion.steps.len());
            if strip.shown.len() != steps || strip.shown.iter().any(|&number| number >= pictures) {
                let (arm, shown) = (strip.name.clone(), strip.shown.clone());
                return Err(ReportError::Instants { arm, pictures, steps, shown });
            }
            let picture = |(number, picture): (usize, &'a ReportPicture)| {
                let name = || format!("picture {} of arm `{}`", number + 1, strip.name);
                let image = InlineImage::of(&picture.png, &picture.alternative, name)?;
                Ok::<_, ReportError>(InlinePicture { caption: &picture.caption, image })
            };
            let pictures = strip.pictures.iter().enumerate().map(picture).collect::<Result<_, _>>()?;
            Ok(InlineStrip {
                name: &strip.name,
                shown: &strip.shown,
                shown_json: json(&strip.shown),
                pictures,
            })
        };
        let strips = motion.strips.iter().map(strip).collect::<Result<_, _>>()?;
        Ok(InlineMotion { note: &motion.note, steps: &motion.steps, steps_json: json(&motion.steps), strips })
    }
}

fn json(list: &impl Serialize) -> String {
    serde_json::to_string(list).expect("plain data")
}

/// An image as the template sees it.
#[derive(Serialize)]
struct InlineImage<'a> {
    alternative: &'a str,
    base64: String,
    width: u32,
    height: u32,
}

impl<'a> InlineImage<'a> {
    fn of(png: &[u8], alternative: &'a str, name: impl Fn() -> String) -> Result<Self, ReportError> {
        if alternative.trim().is_empty() {
            return Err(ReportError::NoAlternative { image: name() });
        }
        // Width and height are the first two numbers of the header chunk (PNG specification, 11.2.2).
        if png.len() < 24 || png[..8] != PNG_SIGNATURE {
            return Err(ReportError::NotPng { image: name(), length: png.len() });
        }
        let word =
            |start: usize| png[start..start + 4].iter().fold(0, |word, byte| (word << 8) | u32::from(*byte));
        Ok(InlineImage { alternative, base64: STANDARD.encode(png), width: word(16), height: word(20) })
    }
}
