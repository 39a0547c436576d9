//! A drawing as a backend of plotters: what plotters draws becomes marks.
//!
//! plotters counts in whole pixels. The backend therefore claims to be [`FINE`] times wider and higher than the figure
//! and divides every length by it, so that nothing a reader can see snaps to a pixel. Text is set here with the
//! embedded fonts; plotters' own would drop the left bearing of every glyph.

use super::drawing::{Anchor, Drawing, Label, Mark};
use super::style::Ink;
use super::text::{self, Face};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontStyle,
    FontTransform, text_anchor::HPos, text_anchor::VPos,
};

/// Pixels of plotters per pixel of the figure (chosen: 1/64 of a pixel changes no channel by more than 4 of 255).
pub(super) const FINE: f64 = 64.0;
/// Sides of the polygon a hollow circle is stroked along (chosen: flat by 0.1 pixels at a radius of 100).
const SIDES: u32 = 72;

/// What this backend cannot draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BackendError {
    /// Text turned otherwise than to be read from below to above.
    #[error("text stands upright or is read from below to above; other turns are not drawn")]
    Turn,
}

type Outcome = Result<(), DrawingErrorKind<BackendError>>;

fn pixels((x, y): BackendCoord) -> [f64; 2] {
    [f64::from(x) / FINE, f64::from(y) / FINE]
}

fn ink(color: BackendColor) -> Ink {
    let (red, green, blue) = color.rgb;
    Ink { rgb: [red, green, blue], alpha: color.alpha as f32 }
}

fn face(style: FontStyle) -> Face {
    match style {
        FontStyle::Normal => Face::Regular,
        FontStyle::Bold => Face::Bold,
        FontStyle::Oblique | FontStyle::Italic => Face::Oblique,
    }
}

impl Drawing {
    /// Adds a mark unless nothing of it could be seen.
    fn mark(&mut self, color: BackendColor, mark: impl FnOnce(Ink) -> Mark) -> Outcome {
        if color.alpha > 0.0 {
            self.marks.push(mark(ink(color)));
        }
        Ok(())
    }
}

impl DrawingBackend for &mut Drawing {
    type ErrorType = BackendError;

    fn get_size(&self) -> (u32, u32) {
        (self.width * FINE as u32, self.height * FINE as u32)
    }

    fn ensure_prepared(&mut self) -> Outcome {
        Ok(())
    }

    fn present(&mut self) -> Outcome {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Outcome {
        self.draw_rect((x, y), (x + 1, y + 1), &color, true)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Outcome {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Outcome {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        if fill {
            self.fill_polygon(corners, style)
        } else {
            self.draw_path(corners.into_iter().chain([(left, top)]), style)
        }
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Outcome {
        let points = path.into_iter().map(pixels).collect();
        let width = f64::from(style.stroke_width()) / FINE;
        self.mark(style.color(), |ink| Mark::Line { points, width, ink })
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Outcome {
        let (centre, radius) = (pixels(center), f64::from(radius) / FINE);
        if fill {
            return self.mark(style.color(), |ink| Mark::Disc { centre, radius, ink });
        }
        let rim = |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(SIDES);
            [centre[0] + radius * libm::cos(angle), centre[1] + radius * libm::sin(angle)]
        };
        let width = f64::from(style.stroke_width()) / FINE;
        self.mark(style.color(), |ink| Mark::Line { points: (0..=SIDES).map(rim).collect(), width, ink })
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        vert: I,
        style: &S,
    ) -> Outcome {
        let points = vert.into_iter().map(pixels).collect();
        self.mark(style.color(), |ink| Mark::Polygon { points, ink })
    }

    /// The box of a text reaches from its base line to the height of a capital, so that text centred on a tick or a
    /// curve is centred for the eye, whatever hangs below the line.
    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, position: BackendCoord) -> Outcome {
        let upwards = match style.transform() {
            FontTransform::None => false,
            FontTransform::Rotate270 => true,
            FontTransform::Rotate90 | FontTransform::Rotate180 => {
                return Err(DrawingErrorKind::DrawingError(BackendError::Turn));
            }
        };
        let (size, face) = (style.size() / FINE, face(style.style()));
        let anchor = match style.anchor().h_pos {
            HPos::Left => Anchor::Start,
            HPos::Center => Anchor::Middle,
            HPos::Right => Anchor::End,
        };
        let drop = match style.anchor().v_pos {
            VPos::Top => 1.0,
            VPos::Center => 0.5,
            VPos::Bottom => 0.0,
        } * text::CAP_HEIGHT
            * size;
        let [x, y] = pixels(position);
        let position = if upwards { [x + drop, y] } else { [x, y + drop] };
        let text = text.to_owned();
        self.mark(style.color(), |ink| Mark::Text(Label { text, position, size, face, ink, anchor, upwards }))
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<BackendError>> {
        let wide = text::width(text, face(style.style()), style.size());
        Ok((wide.ceil() as u32, (text::CAP_HEIGHT * style.size()).ceil() as u32))
    }
}
