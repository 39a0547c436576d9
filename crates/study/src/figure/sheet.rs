//! The sheet a figure is drawn on: a drawing area of plotters over a whole [`Drawing`], addressed in pixels of the
//! figure.

use super::backend::FINE;
use super::drawing::{Anchor, Drawing, Rect};
use super::error::FigureError;
use super::style::Ink;
use super::text::{self, Face};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontDesc, FontFamily, FontStyle, FontTransform, RGBAColor, ShapeStyle, TextStyle};
use plotters_backend::{BackendColor, BackendCoord};

/// A length of the figure in pixels of plotters.
pub(super) fn fine(pixels: f64) -> i32 {
    (pixels * FINE).round() as i32
}

/// A point of the figure in pixels of plotters.
pub(super) fn place([x, y]: [f64; 2]) -> BackendCoord {
    (fine(x), fine(y))
}

fn colour(ink: Ink) -> RGBAColor {
    let [red, green, blue] = ink.rgb;
    RGBAColor(red, green, blue, f64::from(ink.alpha))
}

/// A filled shape.
pub(super) fn filled(ink: Ink) -> ShapeStyle {
    ShapeStyle { color: colour(ink), filled: true, stroke_width: 0 }
}

/// A line (and the filled part of an error bar) of the given width [pixels].
pub(super) fn stroked(width: f64, ink: Ink) -> ShapeStyle {
    ShapeStyle { color: colour(ink), filled: true, stroke_width: fine(width) as u32 }
}

/// Text whose position is the given end of its base line.
pub(super) fn lettering(size: f64, face: Face, ink: Ink, anchor: Anchor) -> TextStyle<'static> {
    let style = match face {
        Face::Regular => FontStyle::Normal,
        Face::Bold => FontStyle::Bold,
        Face::Oblique => FontStyle::Oblique,
    };
    let end = match anchor {
        Anchor::Start => HPos::Left,
        Anchor::Middle => HPos::Center,
        Anchor::End => HPos::Right,
    };
    let [red, green, blue] = ink.rgb;
    TextStyle {
        font: FontDesc::new(FontFamily::SansSerif, size * FINE, style),
        color: BackendColor { alpha: f64::from(ink.alpha), rgb: (red, green, blue) },
        pos: Pos::new(end, VPos::Bottom),
    }
}

/// A drawing under the pen.
#[derive(Clone)]
pub(super) struct Sheet<'a> {
    /// The whole of it, in pixels of plotters.
    pub area: DrawingArea<&'a mut Drawing, Shift>,
    /// Width of the figure [pixels].
    pub width: f64,
    /// Height of the figure [pixels].
    pub height: f64,
}

type Drawn = Result<(), FigureError>;

impl Sheet<'_> {
    /// A drawing of the given size, rounded up to whole pixels, with what `draw` puts on it.
    ///
    /// # Errors
    /// Those of `draw`.
    pub fn drawn(
        width: f64,
        height: f64,
        draw: impl FnOnce(&Sheet<'_>) -> Drawn,
    ) -> Result<Drawing, FigureError> {
        let mut drawing = Drawing::new(width, height);
        let (width, height) = (f64::from(drawing.width), f64::from(drawing.height));
        draw(&Sheet { area: (&mut drawing).into_drawing_area(), width, height })?;
        Ok(drawing)
    }

    /// A filled rectangle.
    pub fn rectangle(&self, rect: Rect, ink: Ink) -> Drawn {
        let Rect { left, top, right, bottom } = rect;
        self.polygon(&[[left, top], [right, top], [right, bottom], [left, bottom]], ink)
    }

    /// A filled polygon.
    pub fn polygon(&self, points: &[[f64; 2]], ink: Ink) -> Drawn {
        let points: Vec<_> = points.iter().copied().map(place).collect();
        Ok(self.area.draw(&Polygon::new(points, filled(ink)))?)
    }

    /// A straight line.
    pub fn line(&self, ends: [[f64; 2]; 2], width: f64, ink: Ink) -> Drawn {
        Ok(self.area.draw(&PathElement::new(ends.map(place).to_vec(), stroked(width, ink)))?)
    }

    /// A filled disc.
    pub fn disc(&self, centre: [f64; 2], radius: f64, ink: Ink) -> Drawn {
        Ok(self.area.draw(&Circle::new(place(centre), fine(radius), filled(ink)))?)
    }

    /// A line of regular text with its base line at `position`.
    pub fn text(&self, text: &str, position: [f64; 2], size: f64, ink: Ink, anchor: Anchor) -> Drawn {
        self.label(text, position, size, Face::Regular, ink, anchor)
    }

    /// A line of text in a given face.
    pub fn label(
        &self,
        text: &str,
        position: [f64; 2],
        size: f64,
        face: Face,
        ink: Ink,
        anchor: Anchor,
    ) -> Drawn {
        Ok(self.area.draw_text(text, &lettering(size, face, ink, anchor), place(position))?)
    }

    /// A line of regular text read from below to above, its middle at `position`.
    pub fn upwards(&self, text: &str, position: [f64; 2], size: f64, ink: Ink) -> Drawn {
        let style = lettering(size, Face::Regular, ink, Anchor::Middle).transform(FontTransform::Rotate270);
        Ok(self.area.draw_text(text, &style, place(position))?)
    }

    /// Lines of text one below the other; `position` is on the base line of the first.
    pub fn lines(
        &self,
        lines: &[String],
        [x, y]: [f64; 2],
        size: f64,
        face: Face,
        ink: Ink,
        anchor: Anchor,
    ) -> Drawn {
        for (row, line) in lines.iter().enumerate() {
            self.label(line, [x, y + row as f64 * size * text::LEADING], size, face, ink, anchor)?;
        }
        Ok(())
    }
}
