//! The claims as a forest plot: effect and interval of each, the smallest effect of interest, and the verdict.

use super::axis::{Axis, Scale, Tick};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::FigureError;
use super::panel::{Panel, draw_note, draw_patched, draw_title, title_height};
use super::sheet::{Sheet, filled, fine, stroked};
use super::style::{self, AXIS, CHART_WIDTH, GRID, Ink, LABEL, MARGIN, MARKER, MUTED, TEXT, TICK};
use super::text::{self, Face};
use plotters::chart::LabelAreaPosition;
use plotters::element::{EmptyElement, ErrorBar, PathElement, Polygon, Rectangle};

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
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 20.0 };
    let top = MARGIN + title_height(figure.title) + 92.0;
    let bottom = top + figure.rows.len() as f64 * ROW;
    let names = figure.rows.iter().flat_map(|row| {
        [text::width(row.claim, Face::Bold, LABEL), text::width(row.contrast, Face::Regular, TICK)]
    });
    let left = MARGIN + names.fold(160.0, f64::max).min(0.34 * width) + 34.0;
    let area = Rect { left, top, right: width - MARGIN - 400.0, bottom };
    let data =
        figure.rows.iter().flat_map(|row| row.effect.into_iter().chain(row.interval.into_iter().flatten()));
    let spread = data.chain([-1.6 * figure.delta, 1.6 * figure.delta]);
    let x = Axis::around(Scale::Linear, spread, 0.04);
    // Rows count downwards; each lies in the middle of its unit.
    let y = Axis { scale: Scale::Linear, low: figure.rows.len() as f64, high: 0.0 };
    Sheet::drawn(width, bottom + 92.0 + note, |sheet| {
        draw_title(sheet, figure.title)?;
        let mut panel = Panel::new(sheet, area, x, y)?;
        draw_reference(&panel, figure)?;
        draw_ratios(sheet, &panel)?;
        for (index, row) in figure.rows.iter().enumerate() {
            draw_row(sheet, &panel, row, index as f64 + 0.5)?;
        }
        panel.draw_x(figure.label)?;
        draw_note(sheet, figure.note)
    })
}

/// The zero line and the zone within delta.
fn draw_reference(panel: &Panel<'_>, figure: &Forest<'_>) -> Result<(), FigureError> {
    let (low, high) = (panel.y.low, panel.y.high);
    let zone = [(-figure.delta, low), (figure.delta, high)];
    panel.plot().draw(&Rectangle::new(zone, filled(Ink::hex(0xf1f3f5))))?;
    for edge in [-figure.delta, figure.delta] {
        panel.draw_dashed([(edge, low), (edge, high)], 6.0, stroked(2.0, AXIS))?;
    }
    Ok(panel.plot().draw(&PathElement::new([(0.0, low), (0.0, high)], stroked(2.0, MARKER)))?)
}

/// The upper axis: a difference of logarithms read as a ratio. Ratios whose labels would touch are left out.
fn draw_ratios(sheet: &Sheet<'_>, below: &Panel<'_>) -> Result<(), FigureError> {
    let area = below.area;
    let [low, high] = [below.x.low, below.x.high].map(libm::exp);
    let mut free = f64::NEG_INFINITY;
    let mut ticks = Vec::new();
    for value in [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8, 1.0, 1.25, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0] {
        let label = format!("{}\u{d7}", style::number(value, 2));
        let half = 0.5 * text::width(&label, Face::Regular, TICK);
        let Some(column) = below.column(libm::log(value)) else { continue };
        if value >= low && value <= high && column - half >= free + 10.0 {
            free = column + half;
            ticks.push(Tick { value, label });
        }
    }
    let x = Axis { scale: Scale::Logarithmic, low, high };
    Panel::with_ticks(sheet, area, [x, below.y], ticks, LabelAreaPosition::Top)?.draw_x("as a ratio")?;
    sheet.text("verdict", [area.right + 34.0, area.top - 14.0], TICK, MUTED, Anchor::Start)
}

/// A row `y` units below the top of the panel.
fn draw_row(sheet: &Sheet<'_>, panel: &Panel<'_>, row: &Row<'_>, y: f64) -> Result<(), FigureError> {
    let area = panel.area;
    let middle = area.top + y * ROW;
    let rule = [[MARGIN, middle + 0.5 * ROW], [sheet.width - MARGIN, middle + 0.5 * ROW]];
    sheet.line(rule, 1.0, GRID)?;
    let limit = area.left - MARGIN - 30.0;
    let base = middle + if row.contrast.is_empty() { 0.5 * text::CAP_HEIGHT * LABEL } else { -4.0 };
    let (name, size) = text::fit(row.claim, Face::Bold, LABEL, style::SMALLEST, limit);
    sheet.label(&name.join(" "), [MARGIN, base], size, Face::Bold, TEXT, Anchor::Start)?;
    let (contrast, size) = text::fit(row.contrast, Face::Regular, TICK, 14.0, limit);
    sheet.text(&contrast.join(" "), [MARGIN, middle + 6.0 + TICK], size, MUTED, Anchor::Start)?;
    let ink = row.outcome.ink();
    match row.effect.filter(|effect| panel.column(*effect).is_some()) {
        Some(effect) => {
            if let Some([low, high]) = row.interval
                && panel.column(low).and(panel.column(high)).is_some()
            {
                let (style, caps) = (stroked(4.0, ink), fine(16.0) as u32);
                panel.plot().draw(&ErrorBar::new_horizontal(y, low, effect, high, style, caps))?;
            }
            for (reach, ink) in [(13.0, style::PAPER), (10.0, ink)] {
                let r = fine(reach);
                let diamond = Polygon::new([(-r, 0), (0, -r), (r, 0), (0, r)], filled(ink));
                panel.plot().draw(&(EmptyElement::at((effect, y)) + diamond))?;
            }
        }
        None => {
            let position = [area.centre()[0], middle + 0.5 * text::CAP_HEIGHT * TICK];
            draw_patched(sheet, "no effect estimated", position, Anchor::Middle)?;
        }
    }
    let limit = sheet.width - MARGIN - area.right - 34.0;
    let (lines, size) = text::fit(row.verdict, Face::Bold, LABEL, 17.0, limit);
    let first =
        middle + 0.5 * text::CAP_HEIGHT * size - 0.5 * (lines.len() - 1) as f64 * size * text::LEADING;
    for (k, line) in lines.iter().enumerate() {
        let face = if k == 0 { Face::Bold } else { Face::Regular };
        let position = [area.right + 34.0, first + k as f64 * size * text::LEADING];
        sheet.label(line, position, size, face, ink, Anchor::Start)?;
    }
    Ok(())
}
