//! Every case as a point: a strip per arm for each endpoint, with mean and interval.

use super::axis::{Axis, Scale};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::FigureError;
use super::panel::{Panel, draw_note, draw_title, title_height};
use super::sheet::{Sheet, filled, fine, stroked};
use super::style::{self, CHART_WIDTH, Ink, LABEL, MARGIN, MUTED, TEXT, TICK};
use super::text::{self, Face};
use plotters::element::{Circle, EmptyElement, ErrorBar};

/// Mean and interval of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Mean.
    pub mean: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// The values of one arm.
#[derive(Clone, Copy, Debug)]
pub struct Strip<'a> {
    /// One value per case.
    pub values: &'a [f64],
    /// Mean and interval, if there are any.
    pub summary: Option<Summary>,
}

/// One endpoint: a panel.
#[derive(Clone, Copy, Debug)]
pub struct Endpoint<'a> {
    /// Label of the vertical axis, with unit.
    pub label: &'a str,
    /// Scale of the vertical axis.
    pub scale: Scale,
    /// Values which the axis must hold besides the data.
    pub hold: &'a [f64],
    /// One strip per arm, in the order of the arms.
    pub strips: &'a [Strip<'a>],
}

/// The figure: endpoints stacked above common arms.
#[derive(Clone, Copy, Debug)]
pub struct Strips<'a> {
    /// Title, may be empty.
    pub title: &'a str,
    /// Names of the arms, from the left.
    pub arms: &'a [&'a str],
    /// One panel each.
    pub endpoints: &'a [Endpoint<'a>],
    /// What the bar shows, printed below the figure; may be empty.
    pub note: &'a str,
}

const LEFT: f64 = 150.0;
const HEIGHT: f64 = 300.0;
const GAP: f64 = 44.0;
/// Radius of a point [pixels].
const POINT: f64 = 6.0;

/// Draws the figure; see [`Strips`]. Values that are not finite are counted in the panel.
///
/// # Errors
/// [`FigureError`] if there is no arm or endpoint, or an endpoint has not one strip per arm.
pub fn strips(figure: &Strips<'_>) -> Result<Drawing, FigureError> {
    if figure.arms.is_empty() {
        return Err(FigureError::Nothing { what: "arm" });
    }
    if figure.endpoints.is_empty() {
        return Err(FigureError::Nothing { what: "endpoint" });
    }
    for endpoint in figure.endpoints {
        let arms = ("arms", figure.arms.len());
        super::error::same_length(endpoint.label, arms, ("strips", endpoint.strips.len()))?;
    }
    let slot = (f64::from(CHART_WIDTH) - LEFT - MARGIN) / figure.arms.len() as f64;
    let names: Vec<_> = figure
        .arms
        .iter()
        .map(|arm| text::fit(arm, Face::Regular, LABEL, style::SMALLEST, slot - 10.0))
        .collect();
    let size = names.iter().map(|(_, size)| *size).fold(LABEL, f64::min);
    let names: Vec<_> =
        figure.arms.iter().map(|arm| text::wrap(arm, Face::Regular, size, slot - 10.0)).collect();
    let most = names.iter().map(Vec::len).max().unwrap_or(1) as f64;
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 20.0 };
    let panels = figure.endpoints.len() as f64 * (HEIGHT + GAP);
    let first = MARGIN + title_height(figure.title);
    let total = first + panels + most * size * text::LEADING + note + 24.0;
    Sheet::drawn(f64::from(CHART_WIDTH), total, |sheet| {
        draw_title(sheet, figure.title)?;
        let mut top = first + 16.0;
        for endpoint in figure.endpoints {
            let area = Rect { left: LEFT, top, right: sheet.width - MARGIN, bottom: top + HEIGHT };
            draw_endpoint(sheet, endpoint, area)?;
            top += HEIGHT + GAP;
        }
        for (index, lines) in names.iter().enumerate() {
            let position = [LEFT + (index as f64 + 0.5) * slot, top - GAP + 14.0 + size];
            sheet.lines(lines, position, size, Face::Regular, TEXT, Anchor::Middle)?;
        }
        draw_note(sheet, figure.note)
    })
}

/// One panel; arm k has the abscissae from k to k + 1: points round k + 0.42, mean and interval at k + 0.88.
fn draw_endpoint(sheet: &Sheet<'_>, endpoint: &Endpoint<'_>, area: Rect) -> Result<(), FigureError> {
    let ends = endpoint.strips.iter().filter_map(|s| s.summary).flat_map(|s| [s.low, s.high]);
    let values = endpoint.strips.iter().flat_map(|strip| strip.values).copied();
    let held = endpoint.hold.iter().copied();
    let y = Axis::around(endpoint.scale, values.chain(ends).chain(held), 0.07);
    let x = Axis { scale: Scale::Linear, low: 0.0, high: endpoint.strips.len() as f64 };
    let mut panel = Panel::new(sheet, area, x, y)?;
    panel.draw_y(endpoint.label)?;
    panel.draw_x_line()?;
    let placed = |strip: &Strip<'_>| -> Vec<f64> {
        strip.values.iter().copied().filter(|v| panel.row(*v).is_some()).collect()
    };
    if endpoint.strips.iter().all(|strip| placed(strip).is_empty()) {
        return panel.draw_empty("no data");
    }
    let rows = |strip: &Strip<'_>| strip.values.iter().filter_map(|v| panel.row(*v)).collect::<Vec<f64>>();
    let reach = 0.36 * area.width() / x.high;
    let fits = |radius: &f64| endpoint.strips.iter().all(|strip| swarm(&rows(strip), *radius, reach).1);
    let radius = [POINT, 5.0, 4.5].into_iter().find(fits).unwrap_or(4.0);
    for (index, strip) in endpoint.strips.iter().enumerate() {
        let left = index as f64;
        let (values, ink) = (placed(strip), style::category(index).with_alpha(0.62));
        draw_swarm(&panel, left + 0.42, &values, radius, reach, ink)?;
        let missing = strip.values.len() - values.len();
        if let (1.., Some(column)) = (missing, panel.column(left + 0.5)) {
            let (note, position) = (format!("{missing} missing"), [column, area.top + 0.8 * TICK]);
            sheet.label(&note, position, 18.0, Face::Oblique, MUTED, Anchor::Middle)?;
        }
        if let Some(summary) = strip.summary {
            draw_summary(&panel, summary, left + 0.88)?;
        }
    }
    Ok(())
}

fn draw_summary(panel: &Panel<'_>, summary: Summary, x: f64) -> Result<(), FigureError> {
    let Summary { mean, low, high } = summary;
    let placed = |v: f64| panel.row(v).is_some();
    let style = stroked(3.5, TEXT);
    if placed(mean) && placed(low) && placed(high) {
        panel.plot().draw(&ErrorBar::new_vertical(x, low, mean, high, style, fine(14.0) as u32))?;
    } else if placed(mean) {
        panel.plot().draw(&Circle::new((x, mean), fine(7.0), style))?;
    }
    Ok(())
}

/// Points beside each other round the abscissa `x`; see [`swarm`].
pub(super) fn draw_swarm(
    panel: &Panel<'_>,
    x: f64,
    values: &[f64],
    radius: f64,
    reach: f64,
    ink: Ink,
) -> Result<(), FigureError> {
    let placed: Vec<(f64, f64)> = values.iter().filter_map(|v| Some((*v, panel.row(*v)?))).collect();
    let rows: Vec<f64> = placed.iter().map(|(_, row)| *row).collect();
    for ((value, _), shift) in placed.iter().zip(swarm(&rows, radius, reach).0) {
        let point = Circle::new((fine(shift), 0), fine(radius), filled(ink));
        panel.plot().draw(&(EmptyElement::at((x, *value)) + point))?;
    }
    Ok(())
}

/// Shifts of points [pixels] that set them beside each other where they would overlap: each goes to the free place
/// nearest the centre line, at most `reach` pixels from it. Where none is free it goes where it covers least. The
/// second value says whether all points found a free place.
fn swarm(rows: &[f64], radius: f64, reach: f64) -> (Vec<f64>, bool) {
    let mut placed: Vec<[f64; 2]> = Vec::with_capacity(rows.len());
    let mut all_free = true;
    let steps = (2.0 * reach / (0.5 * radius)) as i32;
    for row in rows {
        let place = |k: i32| f64::from((k + 1) / 2) * if k % 2 == 0 { 0.5 } else { -0.5 } * radius;
        let room =
            |x: f64| placed.iter().map(|p| libm::hypot(p[0] - x, p[1] - row)).fold(2.0 * radius, f64::min);
        let free = (0..=steps).map(place).find(|x| room(*x) >= 2.0 * radius);
        all_free &= free.is_some();
        // Of places with equal room the nearest, hence the search from outside.
        let widest = || (0..=steps).rev().map(place).max_by(|a, b| room(*a).total_cmp(&room(*b)));
        placed.push([free.or_else(widest).unwrap_or(0.0), *row]);
    }
    (placed.iter().map(|p| p[0]).collect(), all_free)
}
