//! A panel: a plot area with two axes, its grid, ticks and labels.

use super::axis::{Axis, Tick};
use super::drawing::{Anchor, Drawing, Rect};
use super::style::{self, AXIS, GRID, HEADING, Ink, LABEL, MUTED, TEXT, TICK};
use super::text::{self, Face};

/// Length of a tick mark [pixels].
const TICK_LENGTH: f64 = 7.0;

/// A plot area with its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// The plot area, without labels.
    pub area: Rect,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
}

impl Panel {
    /// Column of a value [pixels]; `None` where it has no place on the axis.
    pub fn column(&self, x: f64) -> Option<f64> {
        self.x.share(x).map(|share| self.area.left + share * self.area.width())
    }

    /// Row of a value [pixels]; `None` where it has no place on the axis.
    pub fn row(&self, y: f64) -> Option<f64> {
        self.y.share(y).map(|share| self.area.bottom - share * self.area.height())
    }

    /// Point of a pair of values [pixels].
    pub fn point(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        Some([self.column(x)?, self.row(y)?])
    }

    /// Like [`Panel::point`], held to the plot area, so that a curve that leaves the panel ends at its edge.
    pub fn point_inside(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        let [column, row] = self.point(x, y)?;
        Some([column.clamp(self.area.left, self.area.right), row.clamp(self.area.top, self.area.bottom)])
    }

    /// Number of labelled ticks that fit the width and the height.
    fn tick_counts(&self) -> [usize; 2] {
        [(self.area.width() / 85.0) as usize, (self.area.height() / 48.0) as usize].map(|n| n.clamp(2, 9))
    }

    /// Grid lines at the labelled vertical ticks, and their labels at the left.
    pub fn draw_y(&self, drawing: &mut Drawing, label: &str) {
        let mut widest: f64 = 0.0;
        for tick in self.y.ticks(self.tick_counts()[1]) {
            let Some(row) = self.row(tick.value) else { continue };
            if !tick.label.is_empty() {
                drawing.line(vec![[self.area.left, row], [self.area.right, row]], 1.5, GRID);
                let position = [self.area.left - 10.0, row + 0.5 * text::CAP_HEIGHT * TICK];
                drawing.text(&tick.label, position, TICK, MUTED, Anchor::End);
                widest = widest.max(text::width(&tick.label, Face::Regular, TICK));
            }
        }
        let column = self.area.left - 10.0 - widest - 22.0;
        drawing.upwards(label, [column, self.area.centre()[1]], LABEL, TEXT);
    }

    /// Grid lines alone, for a panel whose labels stand at its left neighbour.
    pub fn draw_grid(&self, drawing: &mut Drawing) {
        for tick in self.y.ticks(self.tick_counts()[1]) {
            if let (Some(row), false) = (self.row(tick.value), tick.label.is_empty()) {
                drawing.line(vec![[self.area.left, row], [self.area.right, row]], 1.5, GRID);
            }
        }
    }

    /// The horizontal axis line with ticks, tick labels and the label of the axis below.
    pub fn draw_x(&self, drawing: &mut Drawing, label: &str) {
        self.draw_x_at(drawing, label, &self.x.ticks(self.tick_counts()[0]));
    }

    /// Like [`Panel::draw_x`] with the ticks given.
    pub fn draw_x_at(&self, drawing: &mut Drawing, label: &str, ticks: &[Tick]) {
        self.draw_x_line(drawing);
        for tick in ticks {
            let Some(column) = self.column(tick.value) else { continue };
            let length = if tick.label.is_empty() { 0.6 * TICK_LENGTH } else { TICK_LENGTH };
            let bottom = self.area.bottom;
            drawing.line(vec![[column, bottom], [column, bottom + length]], 1.5, AXIS);
            drawing.text(&tick.label, [column, bottom + 10.0 + TICK], TICK, MUTED, Anchor::Middle);
        }
        let below = self.area.bottom + 10.0 + TICK + 12.0 + LABEL;
        drawing.text(label, [self.area.centre()[0], below], LABEL, TEXT, Anchor::Middle);
    }

    /// The line along the bottom of the plot area.
    pub fn draw_x_line(&self, drawing: &mut Drawing) {
        let Rect { left, right, bottom, .. } = self.area;
        drawing.line(vec![[left, bottom], [right, bottom]], 1.5, AXIS);
    }

    /// A bold heading above the plot area, at its left.
    pub fn draw_heading(&self, drawing: &mut Drawing, heading: &str, ink: Ink) {
        let (lines, size) = text::shrink(heading, Face::Bold, HEADING, 18.0, self.area.width());
        let first = self.area.top - 12.0 - (lines.len() - 1) as f64 * size * text::LEADING;
        for (row, line) in lines.iter().enumerate() {
            let position = [self.area.left, first + row as f64 * size * text::LEADING];
            drawing.label(line, position, size, Face::Bold, ink, Anchor::Start);
        }
    }

    /// A note in the middle of an area that has nothing to show.
    pub fn draw_empty(&self, drawing: &mut Drawing, note: &str) {
        let [x, y] = self.area.centre();
        drawing.label(note, [x, y], LABEL, Face::Oblique, MUTED, Anchor::Middle);
    }

    /// A line through `points` in order. A point without a place interrupts it.
    pub fn draw_curve(
        &self,
        drawing: &mut Drawing,
        points: impl IntoIterator<Item = [f64; 2]>,
        width: f64,
        ink: Ink,
    ) {
        let mut piece = Vec::new();
        for [x, y] in points {
            match self.point_inside(x, y) {
                Some(point) => piece.push(point),
                None => drawing.line(std::mem::take(&mut piece), width, ink),
            }
        }
        drawing.line(piece, width, ink);
    }

    /// The area between two curves over the same `x`. Points without a place are passed over.
    pub fn draw_band(&self, drawing: &mut Drawing, x: &[f64], low: &[f64], high: &[f64], ink: Ink) {
        let place = |values: &[f64]| -> Vec<Option<[f64; 2]>> {
            x.iter().zip(values).map(|(x, y)| self.point_inside(*x, *y)).collect()
        };
        let pairs: Vec<_> =
            place(low).into_iter().zip(place(high)).filter_map(|(low, high)| low.zip(high)).collect();
        let lower = pairs.iter().map(|pair| pair.0);
        let upper = pairs.iter().rev().map(|pair| pair.1);
        drawing.polygon(lower.chain(upper).collect(), ink);
    }
}

/// The title of a figure at its upper left. Returns the height it takes, nothing for an empty title.
pub fn draw_title(drawing: &mut Drawing, title: &str) -> f64 {
    if title.is_empty() {
        return 0.0;
    }
    let limit = f64::from(drawing.width) - 2.0 * style::MARGIN;
    let (lines, size) = text::fit(title, Face::Bold, style::TITLE, 24.0, limit);
    for (row, line) in lines.iter().enumerate() {
        let position =
            [style::MARGIN, style::MARGIN + text::CAP_HEIGHT * size + row as f64 * size * text::LEADING];
        drawing.label(line, position, size, Face::Bold, TEXT, Anchor::Start);
    }
    lines.len() as f64 * size * text::LEADING + 12.0
}

/// Text on a patch of paper, so that what lies behind does not cross it out.
pub fn draw_patched(drawing: &mut Drawing, words: &str, [x, y]: [f64; 2], anchor: Anchor) {
    let wide = text::width(words, Face::Regular, TICK);
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - 0.5 * wide,
        Anchor::End => x - wide,
    };
    let patch =
        Rect { left: left - 4.0, top: y - 0.85 * TICK, right: left + wide + 4.0, bottom: y + 0.3 * TICK };
    drawing.rectangle(patch, style::PAPER.with_alpha(0.9));
    drawing.text(words, [x, y], TICK, MUTED, anchor);
}

/// Notes under a figure, at its lower left.
pub fn draw_note(drawing: &mut Drawing, note: &str) {
    let position = [style::MARGIN, f64::from(drawing.height) - 18.0];
    drawing.label(note, position, TICK, Face::Oblique, MUTED, Anchor::Start);
}
