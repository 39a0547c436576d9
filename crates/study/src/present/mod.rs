//! A study's figures and report, from its results. Nothing here simulates.

mod charts;
mod listing;
mod motion;
mod page;
mod pictures;

use crate::evaluate::{Gates, Judged, JudgedNoise};
use crate::figure::{Drawing, FigureError};
use crate::report::ReportFigure;
use crate::results::{Archive, CaseResult};
use crate::store::write_whole;

pub use listing::listing;
pub use page::Provenance;

/// All that a report is made of.
#[derive(Clone, Copy)]
pub struct Findings<'a> {
    /// The study and where its results are.
    pub archive: &'a Archive<'a>,
    /// Its results.
    pub results: &'a [CaseResult],
    /// Its claims, judged.
    pub judged: &'a [Judged],
    /// Paths of the control `density-noise`.
    pub noise: &'a [JudgedNoise],
    /// The gates that the claims had to pass.
    pub gates: &'a Gates,
}

/// Colours of a figure in the report (chosen: as many as a palette has; no difference is seen, and the page is half as long).
const COLOURS: usize = 256;

/// A figure with the words that belong to it.
struct Titled {
    /// File name without ending.
    name: String,
    title: String,
    caption: String,
    alternative: String,
    drawing: Drawing,
}

/// Draws all figures into `<results>/figures` and writes `report.html`. The names of the files written, relative to the
/// study's folder.
///
/// # Errors
/// Frames that cannot be read, a disk that cannot be written.
pub fn present(findings: Findings, provenance: &Provenance) -> anyhow::Result<Vec<String>> {
    let mut figures = pictures::snowballs(findings)?;
    figures.extend(charts::all(findings)?);
    let root = findings.archive.store.root();
    let mut written = Vec::new();
    let mut shown = Vec::new();
    for figure in figures {
        let image = figure.drawing.paint();
        let name = format!("figures/{}.png", figure.name);
        write_whole(&root.join(&name), &image.png())?;
        written.push(name);
        let png = image.indexed_png(COLOURS);
        let Titled { title, caption, alternative, .. } = figure;
        shown.push(ReportFigure { png, title, caption, alternative });
    }
    let html = page::page(findings, provenance, shown)?;
    write_whole(&root.join("report.html"), html.as_bytes())?;
    written.push("report.html".into());
    Ok(written)
}

/// A figure that has nothing to show is left out; any other mistake is passed on.
fn drawn(drawing: Result<Drawing, FigureError>) -> Result<Option<Drawing>, FigureError> {
    match drawing {
        Ok(drawing) => Ok(Some(drawing)),
        Err(FigureError::Nothing { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
