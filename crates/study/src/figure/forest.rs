//! The claims as a forest plot: effect and interval of each, the smallest effect of interest, and the verdict.

use super::axis::{Axis, Scale};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::FigureError;
use super::panel::{Panel, draw_note, draw_patched, draw_title};
use super::style::{self, AXIS, CHART_WIDTH, GRID, Ink, LABEL, MARGIN, MARKER, MUTED, TEXT, TICK};
use super::text::{self, Face};

/// What became of a claim; it gives the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Supported.
    Supported,
    /// Refuted: not reproduced under these conditions.
    Refuted,
    /// Neither.
    Inconclusive,
    /// Too few blocks.
    NotRun,
}

impl Outcome {
    fn ink(self) -> Ink {
        match self {
            Self::Supported => style::OKABE_ITO[0],
            Self::Refuted => style::OKABE_ITO[3],
            Self::Inconclusive => MUTED,
            Self::NotRun => style::DUST,
        }
    }
}

/// One claim.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Name of the claim.
    pub claim: &'a str,
    /// The contrast, such as `5k - 30k`; may be empty.
    pub contrast: &'a str,
    /// Mean difference; `None` if it was not run.
    pub effect: Option<f64>,
    /// Simultaneous interval; `None` if it was not run.
    pub interval: Option<[f64; 2]>,
    /// The verdict as printed, such as `refuted (smaller than 1.25x)`.
    pub verdict: &'a str,
    /// Its kind.
    pub outcome: Outcome,
}

/// The figure.
#[derive(Clone, Copy, Debug)]
pub struct Forest<'a> {
    /// Title, may be empty.
    pub title: &'a str,
    /// Label of the axis of effects.
    pub label: &'a str,
    /// Smallest effect of interest, marked on both sides of 0.
    pub delta: f64,
    /// One row per claim, from above.
    pub rows: &'a [Row<'a>],
    /// Printed below the figure; may be empty.
    pub note: &'a str,
}

const ROW: f64 = 88.0;

/// Draws the figure; see [`Forest`]. An upper axis reads the effects, differences of logarithms, as ratios.
///
/// # Errors
/// [`FigureError`] if there is no claim or delta is not above 0.
pub fn forest(figure: &Forest<'_>) -> Result<Drawing, FigureError> {
    if figure.rows.is_empty() {
        return Err(FigureError::Nothing { what: "claim" });
    }
    if !(figure.delta > 0.0 && figure.delta.is_finite()) {
        return Err(FigureError::NotPositive { what: "delta", value: figure.delta });
    }
    let width = f64::from(CHART_WIDTH);
    let title = if figure.title.is_empty() { 0.0 } else { style::TITLE * text::LEADING + 12.0 };
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 20.0 };
    let top = MARGIN + title + 92.0;
    let bottom = top + figure.rows.len() as f64 * ROW;
    let mut drawing = Drawing::new(width, bottom + 92.0 + note);
    draw_title(&mut drawing, figure.title);
    let names = figure.rows.iter().flat_map(|row| {
        [text::width(row.claim, Face::Bold, LABEL), text::width(row.contrast, Face::Regular, TICK)]
    });
    let left = MARGIN + names.fold(160.0, f64::max).min(0.34 * width) + 34.0;
    let area = Rect { left, top, right: width - MARGIN - 400.0, bottom };
    let data =
        figure.rows.iter().flat_map(|row| row.effect.into_iter().chain(row.interval.into_iter().flatten()));
    let spread = data.chain([-1.6 * figure.delta, 1.6 * figure.delta]);
    let x = Axis::around(Scale::Linear, spread, 0.04);
    let panel = Panel { area, x, y: Axis { scale: Scale::Linear, low: 0.0, high: 1.0 } };
    draw_reference(&mut drawing, &panel, figure);
    for (index, row) in figure.rows.iter().enumerate() {
        draw_row(&mut drawing, &panel, row, top + (index as f64 + 0.5) * ROW);
    }
    panel.draw_x(&mut drawing, figure.label);
    draw_note(&mut drawing, figure.note);
    Ok(drawing)
}

/// The zero line, the zone within delta, and the axis of ratios above.
fn draw_reference(drawing: &mut Drawing, panel: &Panel, figure: &Forest<'_>) {
    let area = panel.area;
    let column = |value: f64| panel.column(value).unwrap_or(area.left);
    let [low, high] = [column(-figure.delta), column(figure.delta)];
    drawing.rectangle(Rect { left: low, right: high, ..area }, Ink::hex(0xf1f3f5));
    for edge in [low, high] {
        drawing.dashed([edge, area.bottom], [edge, area.top], 2.0, AXIS, 6.0);
    }
    drawing.line(vec![[column(0.0), area.bottom], [column(0.0), area.top]], 2.0, MARKER);
    drawing.line(vec![[area.left, area.top], [area.right, area.top]], 1.5, AXIS);
    let mut free = f64::NEG_INFINITY;
    for ratio in [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8, 1.0, 1.25, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0] {
        let x = column(libm::log(ratio));
        let label = format!("{}\u{d7}", style::number(ratio, 2));
        let half = 0.5 * text::width(&label, Face::Regular, TICK);
        if x < area.left || x > area.right || x - half < free + 10.0 {
            continue;
        }
        free = x + half;
        drawing.line(vec![[x, area.top], [x, area.top - 7.0]], 1.5, AXIS);
        drawing.text(&label, [x, area.top - 14.0], TICK, MUTED, Anchor::Middle);
    }
    let heading = "as a ratio";
    drawing.text(heading, [area.centre()[0], area.top - 22.0 - TICK], TICK, TEXT, Anchor::Middle);
    drawing.label("verdict", [area.right + 34.0, area.top - 14.0], TICK, Face::Regular, MUTED, Anchor::Start);
}

fn draw_row(drawing: &mut Drawing, panel: &Panel, row: &Row<'_>, middle: f64) {
    let area = panel.area;
    let width = f64::from(drawing.width);
    drawing.line(vec![[MARGIN, middle + 0.5 * ROW], [width - MARGIN, middle + 0.5 * ROW]], 1.0, GRID);
    let limit = area.left - MARGIN - 30.0;
    let base = middle + if row.contrast.is_empty() { 0.5 * text::CAP_HEIGHT * LABEL } else { -4.0 };
    let (name, size) = text::fit(row.claim, Face::Bold, LABEL, style::SMALLEST, limit);
    drawing.label(&name.join(" "), [MARGIN, base], size, Face::Bold, TEXT, Anchor::Start);
    let (contrast, size) = text::fit(row.contrast, Face::Regular, TICK, 14.0, limit);
    drawing.text(&contrast.join(" "), [MARGIN, middle + 6.0 + TICK], size, MUTED, Anchor::Start);
    let ink = row.outcome.ink();
    let ends = row.interval.map(|ends| ends.map(|end| panel.column(end)));
    if let Some([Some(low), Some(high)]) = ends {
        drawing.line(vec![[low, middle], [high, middle]], 4.0, ink);
        for end in [low, high] {
            drawing.line(vec![[end, middle - 8.0], [end, middle + 8.0]], 3.0, ink);
        }
    }
    match row.effect.and_then(|effect| panel.column(effect)) {
        Some(x) => {
            let [r, rim] = [10.0, 13.0];
            for (r, ink) in [(rim, style::PAPER), (r, ink)] {
                let square = vec![[x - r, middle], [x, middle - r], [x + r, middle], [x, middle + r]];
                drawing.polygon(square, ink);
            }
        }
        None => {
            let position = [area.centre()[0], middle + 0.5 * text::CAP_HEIGHT * TICK];
            draw_patched(drawing, "no effect estimated", position, Anchor::Middle);
        }
    }
    let (lines, size) = text::fit(row.verdict, Face::Bold, LABEL, 17.0, width - MARGIN - area.right - 34.0);
    let first =
        middle + 0.5 * text::CAP_HEIGHT * size - 0.5 * (lines.len() - 1) as f64 * size * text::LEADING;
    for (k, line) in lines.iter().enumerate() {
        let face = if k == 0 { Face::Bold } else { Face::Regular };
        let position = [area.right + 34.0, first + k as f64 * size * text::LEADING];
        drawing.label(line, position, size, face, ink, Anchor::Start);
    }
}
