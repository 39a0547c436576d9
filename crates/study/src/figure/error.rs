//! What can be wrong with the data given to a figure.

use plotters::drawing::DrawingAreaErrorKind;

/// A figure that cannot be drawn. Missing data is no error: it leaves an empty panel with a note.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FigureError {
    /// Two columns that belong together differ in length.
    #[error(
        "figure: `{column}` of `{name}` has {found} values, {expected} are needed: one for each `{other}`"
    )]
    LengthMismatch {
        /// Which arm, case or curve.
        name: String,
        /// The column of the wrong length.
        column: &'static str,
        /// The column it belongs to.
        other: &'static str,
        /// Length of `other`.
        expected: usize,
        /// Length of `column`.
        found: usize,
    },
    /// Nothing at all was given.
    #[error("figure: no {what} given; at least one is needed")]
    Nothing {
        /// What is missing.
        what: &'static str,
    },
    /// A number that must be finite and positive is not.
    #[error("figure: {what} is {value}; a finite number above 0 is needed")]
    NotPositive {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// plotters could not draw it.
    #[error("figure: plotters gave up: {reason}")]
    Plotters {
        /// In its words.
        reason: String,
    },
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for FigureError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Plotters { reason: error.to_string() }
    }
}

/// Checks that `column` of `name` is as long as `other`.
///
/// # Errors
/// [`FigureError::LengthMismatch`] if not.
pub(super) fn same_length(
    name: &str,
    (other, expected): (&'static str, usize),
    (column, found): (&'static str, usize),
) -> Result<(), FigureError> {
    if expected == found {
        return Ok(());
    }
    Err(FigureError::LengthMismatch { name: name.to_owned(), column, other, expected, found })
}
