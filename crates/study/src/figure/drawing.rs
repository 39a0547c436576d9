//! A drawing: an ordered list of marks in pixels (x to the right, y down), painted by
//! [`Drawing::png`]. Coordinates are real numbers, so that nothing snaps to whole pixels. The figures fill it through
//! plotters, for which it is a backend (see the neighbour `backend`).

use super::style::Ink;
use super::text::Face;

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
    /// A filled disc.
    Disc {
        /// Centre.
        centre: [f64; 2],
        /// Radius.
        radius: f64,
        /// Colour.
        ink: Ink,
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

    /// A line of regular text with its base line at `position`.
    pub fn text(&mut self, text: &str, position: [f64; 2], size: f64, ink: Ink, anchor: Anchor) {
        let (text, face) = (text.to_owned(), Face::Regular);
        self.marks.push(Mark::Text(Label { text, position, size, face, ink, anchor, upwards: false }));
    }
}
