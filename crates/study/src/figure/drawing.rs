//! A drawing: an ordered list of marks in pixels (x to the right, y down), painted by
//! [`Drawing::png`]. Coordinates are real numbers, so that nothing snaps to whole pixels.

use super::style::Ink;
use super::text::{self, Face};

/// A rectangle [pixels].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub left: f64,
    /// Top edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Bottom edge.
    pub bottom: f64,
}

impl Rect {
    /// Width [pixels].
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    /// Height [pixels].
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// The middle.
    pub fn centre(&self) -> [f64; 2] {
        [0.5 * (self.left + self.right), 0.5 * (self.top + self.bottom)]
    }
}

/// Which end of the text its position names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The left end.
    Start,
    /// The middle.
    Middle,
    /// The right end.
    End,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The text, with the markup of [`super::text`].
    pub text: String,
    /// Point on the base line.
    pub position: [f64; 2],
    /// Pixels per em.
    pub size: f64,
    /// Weight and slant.
    pub face: Face,
    /// Colour.
    pub ink: Ink,
    /// Which end `position` names.
    pub anchor: Anchor,
    /// Turned a quarter to the left, to be read from below to above.
    pub upwards: bool,
}

/// Something drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A filled polygon.
    Polygon {
        /// Corners.
        points: Vec<[f64; 2]>,
        /// Colour.
        ink: Ink,
    },
    /// A stroked open line with round joins.
    Line {
        /// Points.
        points: Vec<[f64; 2]>,
        /// Width [pixels].
        width: f64,
        /// Colour.
        ink: Ink,
    },
    /// A filled disc, with a rim of paper or ink where `rim` is given as (width, colour).
    Disc {
        /// Centre.
        centre: [f64; 2],
        /// Radius with the rim.
        radius: f64,
        /// Colour.
        ink: Ink,
        /// Width and colour of the rim, inside the radius.
        rim: Option<(f64, Ink)>,
    },
    /// Many small discs of one radius, clipped to a rectangle.
    Splats {
        /// Centres with colours, painted in this order.
        points: Vec<([f64; 2], Ink)>,
        /// Radius.
        radius: f64,
        /// What lies outside is not painted.
        clip: Rect,
    },
    /// A line of text.
    Text(Label),
}

/// A figure as a value: its size in pixels and its marks, painted in order on white paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width [pixels].
    pub width: u32,
    /// Height [pixels].
    pub height: u32,
    /// The marks, first painted first.
    pub marks: Vec<Mark>,
}

impl Drawing {
    /// Empty paper of the given size, rounded up to whole pixels.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width: width.ceil().max(1.0) as u32, height: height.ceil().max(1.0) as u32, marks: Vec::new() }
    }

    /// A filled rectangle.
    pub fn rectangle(&mut self, rect: Rect, ink: Ink) {
        let Rect { left, top, right, bottom } = rect;
        self.polygon(vec![[left, top], [right, top], [right, bottom], [left, bottom]], ink);
    }

    /// A filled polygon; fewer than three corners draw nothing.
    pub fn polygon(&mut self, points: Vec<[f64; 2]>, ink: Ink) {
        self.marks.push(Mark::Polygon { points, ink });
    }

    /// A stroked line; fewer than two points draw nothing.
    pub fn line(&mut self, points: Vec<[f64; 2]>, width: f64, ink: Ink) {
        self.marks.push(Mark::Line { points, width, ink });
    }

    /// A straight line in dashes of `dash` pixels with gaps of the same length.
    pub fn dashed(&mut self, from: [f64; 2], to: [f64; 2], width: f64, ink: Ink, dash: f64) {
        let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
        let point = |s: f64| [0, 1].map(|k| from[k] + (to[k] - from[k]) * (s / length).min(1.0));
        let mut start = 0.0;
        while start < length {
            self.line(vec![point(start), point(start + dash)], width, ink);
            start += 2.0 * dash;
        }
    }

    /// A filled disc.
    pub fn disc(&mut self, centre: [f64; 2], radius: f64, ink: Ink, rim: Option<(f64, Ink)>) {
        self.marks.push(Mark::Disc { centre, radius, ink, rim });
    }

    /// A line of regular text with its base line at `position`.
    pub fn text(&mut self, text: &str, position: [f64; 2], size: f64, ink: Ink, anchor: Anchor) {
        self.label(text, position, size, Face::Regular, ink, anchor);
    }

    /// A line of text in a given face.
    pub fn label(&mut self, text: &str, position: [f64; 2], size: f64, face: Face, ink: Ink, anchor: Anchor) {
        let text = text.to_owned();
        self.marks.push(Mark::Text(Label { text, position, size, face, ink, anchor, upwards: false }));
    }

    /// A line of regular text read from below to above, its middle at `position`.
    pub fn upwards(&mut self, text: &str, position: [f64; 2], size: f64, ink: Ink) {
        let (text, face, anchor) = (text.to_owned(), Face::Regular, Anchor::Middle);
        self.marks.push(Mark::Text(Label { text, position, size, face, ink, anchor, upwards: true }));
    }

    /// Lines of text one below the other; `position` is on the base line of the first.
    pub fn lines(&mut self, lines: &[String], position: [f64; 2], size: f64, ink: Ink, anchor: Anchor) {
        for (row, line) in lines.iter().enumerate() {
            let y = position[1] + row as f64 * size * text::LEADING;
            self.text(line, [position[0], y], size, ink, anchor);
        }
    }
}
