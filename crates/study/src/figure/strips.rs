//! Every case as a point: a strip per arm for each endpoint, with mean and interval.

use super::axis::{Axis, Scale};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::FigureError;
use super::panel::{Panel, draw_note, draw_title};
use super::style::{self, CHART_WIDTH, LABEL, MARGIN, MUTED, TEXT, TICK};
use super::text::{self, Face};

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
    let title = if figure.title.is_empty() { 0.0 } else { style::TITLE * text::LEADING + 12.0 };
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 20.0 };
    let panels = figure.endpoints.len() as f64 * (HEIGHT + GAP);
    let total = MARGIN + title + panels + most * size * text::LEADING + note + 24.0;
    let mut drawing = Drawing::new(f64::from(CHART_WIDTH), total);
    draw_title(&mut drawing, figure.title);
    let mut top = MARGIN + title + 16.0;
    for endpoint in figure.endpoints {
        let area = Rect { left: LEFT, top, right: f64::from(CHART_WIDTH) - MARGIN, bottom: top + HEIGHT };
        draw_endpoint(&mut drawing, endpoint, area, slot);
        top += HEIGHT + GAP;
    }
    for (index, lines) in names.iter().enumerate() {
        let x = LEFT + (index as f64 + 0.5) * slot;
        drawing.lines(lines, [x, top - GAP + 14.0 + size], size, TEXT, Anchor::Middle);
    }
    draw_note(&mut drawing, figure.note);
    Ok(drawing)
}

fn draw_endpoint(drawing: &mut Drawing, endpoint: &Endpoint<'_>, area: Rect, slot: f64) {
    let ends = endpoint.strips.iter().filter_map(|s| s.summary).flat_map(|s| [s.low, s.high]);
    let values = endpoint.strips.iter().flat_map(|strip| strip.values).copied();
    let y = Axis::around(endpoint.scale, values.chain(ends), 0.07);
    let x = Axis { scale: Scale::Linear, low: 0.0, high: endpoint.strips.len() as f64 };
    let panel = Panel { area, x, y };
    panel.draw_y(drawing, endpoint.label);
    panel.draw_x_line(drawing);
    if endpoint.strips.iter().flat_map(|strip| strip.values).all(|v| panel.row(*v).is_none()) {
        panel.draw_empty(drawing, "no data");
        return;
    }
    let rows_of = |strip: &Strip<'_>| strip.values.iter().filter_map(|v| panel.row(*v)).collect::<Vec<f64>>();
    let reach = 0.36 * slot;
    let fits = |radius: &f64| endpoint.strips.iter().all(|s| swarm(0.0, &rows_of(s), *radius, reach).1);
    let radius = [POINT, 5.0, 4.5].into_iter().find(fits).unwrap_or(4.0);
    for (index, strip) in endpoint.strips.iter().enumerate() {
        let centre = area.left + (index as f64 + 0.42) * slot;
        let rows = rows_of(strip);
        let ink = style::category(index);
        for [x, row] in swarm(centre, &rows, radius, reach).0 {
            drawing.disc([x, row], radius, ink.with_alpha(0.62), None);
        }
        let missing = strip.values.len() - rows.len();
        if missing > 0 {
            let position = [area.left + (index as f64 + 0.5) * slot, area.top + 0.8 * TICK];
            drawing.label(
                &format!("{missing} missing"),
                position,
                18.0,
                Face::Oblique,
                MUTED,
                Anchor::Middle,
            );
        }
        if let Some(summary) = strip.summary {
            draw_summary(drawing, &panel, summary, area.left + (index as f64 + 0.88) * slot);
        }
    }
}

fn draw_summary(drawing: &mut Drawing, panel: &Panel, summary: Summary, column: f64) {
    if let [Some(low), Some(high)] = [summary.low, summary.high].map(|v| panel.row(v)) {
        drawing.line(vec![[column, low], [column, high]], 3.5, TEXT);
        for end in [low, high] {
            drawing.line(vec![[column - 6.0, end], [column + 6.0, end]], 3.0, TEXT);
        }
    }
    if let Some(mean) = panel.row(summary.mean) {
        drawing.disc([column, mean], 7.0, TEXT, None);
    }
}

/// Points set beside each other where they would overlap: each goes to the free place nearest the centre line, at
/// most `reach` pixels from it. Where none is free it goes where it covers least. The second value says whether all
/// points found a free place.
pub(super) fn swarm(centre: f64, rows: &[f64], radius: f64, reach: f64) -> (Vec<[f64; 2]>, bool) {
    let mut placed: Vec<[f64; 2]> = Vec::with_capacity(rows.len());
    let mut all_free = true;
    let steps = (2.0 * reach / (0.5 * radius)) as i32;
    for row in rows {
        let place = |k: i32| centre + f64::from((k + 1) / 2) * if k % 2 == 0 { 0.5 } else { -0.5 } * radius;
        let room =
            |x: f64| placed.iter().map(|p| libm::hypot(p[0] - x, p[1] - row)).fold(2.0 * radius, f64::min);
        let free = (0..=steps).map(place).find(|x| room(*x) >= 2.0 * radius);
        all_free &= free.is_some();
        // Of places with equal room the nearest, hence the search from outside.
        let widest = || (0..=steps).rev().map(place).max_by(|a, b| room(*a).total_cmp(&room(*b)));
        placed.push([free.or_else(widest).unwrap_or(centre), *row]);
    }
    (placed, all_free)
}
