//! Where the energy goes: stacked areas over time, one panel per arm.

use super::axis::{Axis, Scale};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::{FigureError, same_length};
use super::panel::{Panel, draw_note, draw_title, title_height};
use super::sheet::Sheet;
use super::style::{self, CHART_WIDTH, MARGIN, TEXT, TICK};
use super::text::{self, Face};

/// The energies of one case.
#[derive(Clone, Copy, Debug)]
pub struct EnergyCase<'a> {
    /// Name of the arm it stands for.
    pub arm: &'a str,
    /// Times, ascending.
    pub time: &'a [f64],
    /// For every part of the figure its value at each time, in the unit of the figure's label.
    pub parts: &'a [&'a [f64]],
}

/// The figure.
#[derive(Clone, Copy, Debug)]
pub struct Energy<'a> {
    /// Title, may be empty.
    pub title: &'a str,
    /// Label of the time axis, with unit.
    pub x_label: &'a str,
    /// Label of the energy axis, with unit.
    pub y_label: &'a str,
    /// Names of the parts from the bottom of the stack: kinetic, elastic, then the losses by cause.
    pub parts: &'a [&'a str],
    /// One panel each.
    pub cases: &'a [EnergyCase<'a>],
    /// Printed below the figure; may be empty.
    pub note: &'a str,
}

const LEFT: f64 = 140.0;
const HEIGHT: f64 = 320.0;
const GAP: [f64; 2] = [34.0, 66.0];
const BELOW: f64 = 84.0;

/// Draws the figure; see [`Energy`]. Parts are stacked; a part that is negative somewhere (a loss that gives energy
/// back) cannot be stacked, and all parts are then drawn as lines.
///
/// # Errors
/// [`FigureError`] if there is no case or part, or a column has the wrong length.
pub fn energy(figure: &Energy<'_>) -> Result<Drawing, FigureError> {
    if figure.cases.is_empty() {
        return Err(FigureError::Nothing { what: "case" });
    }
    if figure.parts.is_empty() {
        return Err(FigureError::Nothing { what: "part of the energy" });
    }
    for case in figure.cases {
        same_length(case.arm, ("names of parts", figure.parts.len()), ("parts", case.parts.len()))?;
        for part in case.parts {
            same_length(case.arm, ("time", case.time.len()), ("part", part.len()))?;
        }
    }
    let values = || figure.cases.iter().flat_map(|case| case.parts).flat_map(|part| part.iter()).copied();
    let largest = values().filter(|v| v.is_finite()).fold(0.0, f64::max);
    let stacked = values().all(|v| !(v < -1e-6 * largest));
    let layers: Vec<Vec<Vec<f64>>> = figure.cases.iter().map(|case| layers(case, stacked)).collect();
    let x = Axis::around(Scale::Linear, figure.cases.iter().flat_map(|case| case.time).copied(), 0.0);
    let y = Axis::around(Scale::Linear, layers.iter().flatten().flatten().copied().chain([0.0]), 0.04);
    let y = if stacked { Axis { low: 0.0, ..y } } else { y };

    let columns = figure.cases.len().min(if figure.cases.len() <= 4 { 2 } else { 3 });
    let rows = figure.cases.len().div_ceil(columns);
    let legend = legend_rows(figure);
    let top = MARGIN + title_height(figure.title) + legend.len() as f64 * 34.0 + 52.0;
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 20.0 };
    let total = top + rows as f64 * HEIGHT + (rows - 1) as f64 * GAP[1] + BELOW + note;
    let wide = f64::from(CHART_WIDTH) - LEFT - MARGIN;
    let width = (wide - (columns - 1) as f64 * GAP[0]) / columns as f64;
    Sheet::drawn(f64::from(CHART_WIDTH), total, |sheet| {
        draw_title(sheet, figure.title)?;
        draw_legend(sheet, &legend, MARGIN + title_height(figure.title))?;
        for (index, case) in figure.cases.iter().enumerate() {
            let (column, row) = (index % columns, index / columns);
            let left = LEFT + column as f64 * (width + GAP[0]);
            let above = top + row as f64 * (HEIGHT + GAP[1]);
            let area = Rect { left, top: above, right: left + width, bottom: above + HEIGHT };
            let mut panel = Panel::new(sheet, area, x, y)?;
            if column == 0 {
                panel.draw_y(figure.y_label)?
            } else {
                panel.draw_grid()?
            }
            draw_case(&mut panel, case, &layers[index], stacked)?;
            let last = index + columns >= figure.cases.len();
            if last {
                panel.draw_x(figure.x_label)?
            } else {
                panel.draw_x_line()?
            }
            panel.draw_heading(case.arm, 12.0, TEXT)?;
        }
        draw_note(sheet, figure.note)
    })
}

/// The upper edges of the stacked parts, or the parts themselves.
fn layers(case: &EnergyCase<'_>, stacked: bool) -> Vec<Vec<f64>> {
    let mut below = vec![0.0; case.time.len()];
    let mut edges = Vec::new();
    for part in case.parts {
        let edge: Vec<f64> = part.iter().zip(&below).map(|(v, b)| if stacked { v + b } else { *v }).collect();
        if stacked {
            below.clone_from(&edge);
        }
        edges.push(edge);
    }
    edges
}

fn draw_case(
    panel: &mut Panel<'_>,
    case: &EnergyCase<'_>,
    edges: &[Vec<f64>],
    stacked: bool,
) -> Result<(), FigureError> {
    if !edges.iter().flatten().any(|v| v.is_finite()) {
        return panel.draw_empty("no data");
    }
    let mut below = vec![0.0; case.time.len()];
    for (index, edge) in edges.iter().enumerate() {
        let ink = style::category(index);
        if stacked {
            panel.draw_band(case.time, &below, edge, ink.with_alpha(0.85))?;
            below.clone_from(edge);
        }
    }
    for (index, edge) in edges.iter().enumerate() {
        let (width, ink) = if stacked { (1.5, style::PAPER) } else { (3.0, style::category(index)) };
        panel.draw_curve(case.time.iter().zip(edge).map(|(x, y)| [*x, *y]), width, ink)?;
    }
    Ok(())
}

/// Names of the parts with their colours, broken into lines that fit.
fn legend_rows<'a>(figure: &Energy<'a>) -> Vec<Vec<(usize, &'a str, f64)>> {
    let mut rows = vec![Vec::new()];
    let mut x = LEFT;
    for (index, name) in figure.parts.iter().enumerate() {
        let wide = 34.0 + text::width(name, Face::Regular, TICK) + 30.0;
        if x + wide > f64::from(CHART_WIDTH) - MARGIN && x > LEFT {
            rows.push(Vec::new());
            x = LEFT;
        }
        let last = rows.len() - 1;
        rows[last].push((index, *name, x));
        x += wide;
    }
    rows
}

fn draw_legend(sheet: &Sheet<'_>, rows: &[Vec<(usize, &str, f64)>], top: f64) -> Result<(), FigureError> {
    for (row, entries) in rows.iter().enumerate() {
        let y = top + 4.0 + row as f64 * 34.0;
        for (index, name, x) in entries {
            let swatch = Rect { left: *x, top: y, right: x + 24.0, bottom: y + 20.0 };
            sheet.rectangle(swatch, style::category(*index).with_alpha(0.85))?;
            sheet.text(name, [x + 34.0, y + 17.0], TICK, TEXT, Anchor::Start)?;
        }
    }
    Ok(())
}
