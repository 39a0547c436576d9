//! What a report says, as plain values.

use serde::Serialize;

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
    /// The smallest effect of interest, marked in the plots of the verdicts; none is marked where it is 0.
    pub smallest_effect: f64,
    /// The figures, in order.
    #[serde(skip)]
    pub figures: Vec<ReportFigure>,
    /// The arms through time.
    #[serde(skip)]
    pub motion: ReportMotion,
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
    /// The contrast in a few words, such as `5k - 30k`; may be empty.
    pub contrast: String,
    /// Mean effect, such as `0.62 (1.86x)`; may be empty.
    pub effect: String,
    /// Mean effect with its interval as numbers, for the plot.
    pub size: Option<EffectSize>,
    /// Its interval, such as `[0.41, 0.83], 99 %`; may be empty.
    pub interval: String,
    /// The verdict in words.
    pub verdict: String,
    /// Its kind.
    pub outcome: ReportOutcome,
    /// Conditions and checks printed with it, one each.
    pub conditions: Vec<String>,
}

/// An effect with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EffectSize {
    /// The mean.
    pub effect: f64,
    /// Lower end of the interval.
    pub lower: f64,
    /// Upper end of the interval.
    pub upper: f64,
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

/// Pictures of the arms at the same instants, which a slider goes through.
#[derive(Clone, Debug, Default)]
pub struct ReportMotion {
    /// What is shown and what is not, or why nothing is.
    pub note: String,
    /// Each instant in words, such as `3.0 R/v after contact`.
    pub steps: Vec<String>,
    /// The arms.
    pub strips: Vec<ReportStrip>,
}

/// The pictures of an arm.
#[derive(Clone, Debug, Default)]
pub struct ReportStrip {
    /// Name of the arm.
    pub name: String,
    /// Its pictures, in the order of time.
    pub pictures: Vec<ReportPicture>,
    /// For each instant the number of the picture that is shown, from 0.
    pub shown: Vec<usize>,
}

/// A picture.
#[derive(Clone, Debug, Default)]
pub struct ReportPicture {
    /// The image, a PNG file.
    pub png: Vec<u8>,
    /// What is printed below it.
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
