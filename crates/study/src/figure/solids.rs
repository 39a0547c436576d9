//! Obstacles among particles: floors, walls, wedges.

use super::axis::Axis;
use super::error::FigureError;
use super::panel::Panel;
use super::sheet::{filled, stroked};
use super::style::{Ink, TEXT};
use super::window::{window, within};
use plotters::element::{PathElement, Polygon};

/// How far down a view from `left` to `right` must reach to show the obstacles under its particles, the lowest of which lie at `lowest` [m]: to the
/// top of a floor; to the foot of what stands free, such as a wedge.
pub(super) fn foot<'a>(
    outlines: impl Iterator<Item = &'a Vec<[f64; 2]>>,
    [left, right]: [f64; 2],
    lowest: f64,
) -> f64 {
    let under = outlines.filter_map(|outline| {
        let ([x_low, y_low], [x_high, top]) = window(std::slice::from_ref(outline))?;
        let stands_free = left < x_low && x_high < right;
        (top <= lowest).then_some(if stands_free { y_low } else { top })
    });
    under.fold(lowest, f64::min)
}

/// The obstacles in a panel, filled, with a line round what the view does not cut.
pub(super) fn draw_solids(panel: &Panel<'_>, outlines: &[Vec<[f64; 2]>]) -> Result<(), FigureError> {
    for outline in outlines {
        let seen = within(&[panel.x, panel.y], outline);
        panel.plot().draw(&Polygon::new(seen.clone(), filled(Ink::hex(0xdfe3e7))))?;
        // The view cuts the solid, but has no edge of it: what lies along the view's border is not drawn.
        let cut = |a: f64, b: f64, axis: &Axis| a == b && (a == axis.low || a == axis.high);
        for (&a, &b) in seen.iter().zip(seen.iter().cycle().skip(1)) {
            if !cut(a.0, b.0, &panel.x) && !cut(a.1, b.1, &panel.y) {
                panel.plot().draw(&PathElement::new([a, b], stroked(2.5, TEXT)))?;
            }
        }
    }
    Ok(())
}
