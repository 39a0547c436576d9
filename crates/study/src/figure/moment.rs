//! Particles at one time, to be shown with others of the same view: a picture of its own, or a panel of a frame of a film.

use super::axis::{Axis, Scale};
use super::drawing::{Drawing, Rect};
use super::error::{FigureError, same_length};
use super::panel::Panel;
use super::sheet::Sheet;
use super::snowballs::SPLAT;
use super::solids::{draw_solids, foot};
use super::splats::Splats;
use super::style::Ink;
use super::window::{inside, window};

/// The part of the plane that all pictures of a film show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Lower left corner [m].
    pub low: [f64; 2],
    /// Upper right corner [m].
    pub high: [f64; 2],
}

/// Particles at one time.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Positions [m], painted in their order.
    pub positions: &'a [[f64; 2]],
    /// Colour of each.
    pub inks: &'a [Ink],
    /// Mean spacing of the particles at rest [m].
    pub spacing: f64,
    /// Outlines of the obstacles [m].
    pub obstacles: &'a [Vec<[f64; 2]>],
    /// Whether the particles are painted over them, as before a wall in space; else the other way round, as above a floor in the plane.
    pub obstacles_behind: bool,
}

/// Space left free round the particles over the width of the view (chosen: as for the snowballs before and after).
const PAD: f64 = 0.04;
/// Least and most height of a view over its width (chosen: a lone piece thrown high or wide must not stretch the page).
const SHAPE: [f64; 2] = [0.4, 1.25];
/// Least radius of a splat [pixels] (chosen: a million particles are still painted).
const LEAST_RADIUS: f64 = 0.5;
/// Colour of empty space.
const AIR: Ink = Ink::hex(0xf6f7f9);

/// Lower left and upper right corner [m] of the box round all but one in a thousand of the positions; `None` without any.
pub fn bounds(positions: &[[f64; 2]]) -> Option<[[f64; 2]; 2]> {
    window(&[positions.to_vec()]).map(|(low, high)| [low, high])
}

impl View {
    /// The view that shows all the boxes, given by two corners each, and the obstacles they lie on, at least `least` wide [m]; `None` without any box.
    pub fn of(boxes: &[[[f64; 2]; 2]], obstacles: &[Vec<[f64; 2]>], least: f64) -> Option<Self> {
        let end = |corner: usize, k: usize, better: fn(f64, f64) -> f64| {
            boxes.iter().map(|corners| corners[corner][k]).reduce(better)
        };
        let [left, right] = [end(0, 0, f64::min)?, end(1, 0, f64::max)?];
        let [low, high] = [end(0, 1, f64::min)?, end(1, 1, f64::max)?];
        let pad = (PAD * (right - left).max(high - low)).max(0.5 * (least - (right - left)));
        let bottom =
            foot(obstacles.iter(), [left, right], low) - 2.0 * pad.min(PAD * (right - left + 2.0 * pad));
        let wide = right - left + 2.0 * pad;
        let height = (high + pad - bottom).clamp(SHAPE[0] * wide, SHAPE[1] * wide);
        Some(View { low: [left - pad, bottom], high: [right + pad, bottom + height] })
    }

    /// Height of a picture over its width.
    pub(super) fn shape(&self) -> Result<f64, FigureError> {
        let shape = (self.high[1] - self.low[1]) / (self.high[0] - self.low[0]);
        positive("height of the view over its width", shape)
    }
}

/// Draws a picture of `width` pixels.
///
/// # Errors
/// [`FigureError`] if there are not as many colours as positions, or the spacing or the view's size is not above 0.
pub fn moment(moment: &Moment<'_>, view: &View, width: u32) -> Result<Drawing, FigureError> {
    let (wide, shape) = (f64::from(width), view.shape()?);
    Sheet::drawn(wide, (wide * shape).round(), |sheet| {
        let area = Rect { left: 0.0, top: 0.0, right: sheet.width, bottom: sheet.height };
        moment.draw(sheet, area, view)
    })
}

impl Moment<'_> {
    /// Draws it into a part of a sheet, which has the shape of the view.
    pub(super) fn draw(&self, sheet: &Sheet<'_>, area: Rect, view: &View) -> Result<(), FigureError> {
        same_length("moment", ("positions", self.positions.len()), ("inks", self.inks.len()))?;
        positive("spacing", self.spacing)?;
        sheet.rectangle(area, AIR)?;
        let axis = |k: usize| Axis { scale: Scale::Linear, low: view.low[k], high: view.high[k] };
        let panel = Panel::new(sheet, area, axis(0), axis(1))?;
        let axes = [panel.x, panel.y];
        let splats = || {
            let shown = || (0..self.positions.len()).filter(|k| inside(&axes, self.positions[*k]));
            panel.plot().draw(&Splats {
                centres: shown().map(|k| self.positions[k].into()).collect(),
                inks: shown().map(|k| self.inks[k]).collect(),
                radius: (SPLAT * self.spacing * area.width() / (view.high[0] - view.low[0]))
                    .max(LEAST_RADIUS),
                clip: area,
            })
        };
        if self.obstacles_behind {
            draw_solids(&panel, self.obstacles)?;
            return Ok(splats()?);
        }
        splats()?;
        draw_solids(&panel, self.obstacles)
    }
}

fn positive(what: &'static str, value: f64) -> Result<f64, FigureError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(FigureError::NotPositive { what, value }) }
}
