//! An element of plotters for tens of thousands of particles: discs of one radius, clipped to a rectangle.

use super::backend::FINE;
use super::drawing::{Drawing, Mark, Rect};
use super::style::Ink;
use plotters::element::{Drawable, PointCollection};
use plotters_backend::{BackendCoord, DrawingBackend, DrawingErrorKind};

/// Discs in the coordinates of a chart, painted in their order. plotters would pull a centre outside the plot area
/// onto its edge: leave such discs out.
pub(super) struct Splats {
    /// Centres in the coordinates of the chart.
    pub centres: Vec<(f64, f64)>,
    /// Colour of each.
    pub inks: Vec<Ink>,
    /// Radius [pixels].
    pub radius: f64,
    /// What lies outside is not painted [pixels].
    pub clip: Rect,
}

impl<'a> PointCollection<'a, (f64, f64)> for &'a Splats {
    type Point = &'a (f64, f64);
    type IntoIter = &'a [(f64, f64)];

    fn point_iter(self) -> Self::IntoIter {
        &self.centres
    }
}

impl<'d> Drawable<&'d mut Drawing> for Splats {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        places: I,
        drawing: &mut &'d mut Drawing,
        _: (u32, u32),
    ) -> Result<(), DrawingErrorKind<<&'d mut Drawing as DrawingBackend>::ErrorType>> {
        let pixels = |(x, y): BackendCoord| [f64::from(x) / FINE, f64::from(y) / FINE];
        let points = places.map(pixels).zip(self.inks.iter().copied()).collect();
        drawing.marks.push(Mark::Splats { points, radius: self.radius, clip: self.clip });
        Ok(())
    }
}
