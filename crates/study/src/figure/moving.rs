//! Runs side by side, in sync: the particles of each at one moment.

use super::drawing::{Anchor, Drawing, Rect};
use super::error::FigureError;
use super::moment::{Moment, View};
use super::sheet::Sheet;
use super::style::{MUTED, TEXT};
use super::text::Face;

/// A run.
#[derive(Clone, Debug)]
pub struct Track<'a> {
    /// Its name, above the panel.
    pub name: &'a str,
    /// Its moments, each with what is said of it below the panel, such as `12 fragments`.
    pub moments: Vec<(Moment<'a>, String)>,
}

/// Runs that are shown together.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    /// The runs, of as many moments each.
    pub tracks: &'a [Track<'a>],
    /// What each moment is called, such as `6.0 R/v after contact`.
    pub times: &'a [String],
    /// What all panels show.
    pub view: &'a View,
    /// Width [pixels].
    pub width: u32,
    /// Panels beside each other.
    pub columns: usize,
}

// Lengths of the layout [pixels] (chosen: the lines of text stand clear of the panels).

/// Between panels.
const GAP: f64 = 10.0;
/// For the name above a panel.
const HEAD: f64 = 22.0;
/// From the panel up to the base line of its name.
const NAME: f64 = 6.0;
/// For what is said below a panel.
const FOOT: f64 = 20.0;
/// From the panel down to the base line of what is said.
const SAID: f64 = 14.0;
/// For the time above all.
const CLOCK: f64 = 24.0;
/// From the upper edge to the base line of the time.
const TIME: f64 = 16.0;
/// Size of text.
const SIZE: f64 = 13.0;

/// One drawing a moment.
///
/// # Errors
/// [`FigureError`] as of [`super::moment::moment`].
pub fn drawings(moving: &Moving<'_>) -> Result<Vec<Drawing>, FigureError> {
    let count = moving.tracks.iter().map(|track| track.moments.len()).min().unwrap_or(0);
    (0..count).map(|number| moving.drawing(number)).collect()
}

impl Moving<'_> {
    fn drawing(&self, number: usize) -> Result<Drawing, FigureError> {
        let columns = self.columns.clamp(1, self.tracks.len().max(1));
        let rows = self.tracks.len().div_ceil(columns);
        let width = f64::from(self.width);
        let panel = ((width - GAP * (columns as f64 + 1.0)) / columns as f64).floor();
        let tall = (panel * self.view.shape()?).ceil();
        let row = HEAD + tall + FOOT;
        Sheet::drawn(width, CLOCK + rows as f64 * row + GAP, |sheet| {
            for (k, track) in self.tracks.iter().enumerate() {
                let left = GAP + (k % columns) as f64 * (panel + GAP);
                let top = CLOCK + HEAD + (k / columns) as f64 * row;
                let (moment, said) = &track.moments[number];
                moment.draw(sheet, Rect { left, top, right: left + panel, bottom: top + tall }, self.view)?;
                sheet.label(track.name, [left, top - NAME], SIZE, Face::Bold, TEXT, Anchor::Start)?;
                sheet.text(said, [left, top + tall + SAID], SIZE, MUTED, Anchor::Start)?;
            }
            let time = self.times.get(number).map_or("", String::as_str);
            sheet.text(time, [sheet.width - GAP, TIME], SIZE, MUTED, Anchor::End)
        })
    }
}
