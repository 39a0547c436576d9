//! Panels of curves with bands, one curve per arm. Up to five arms share a panel and are named at their ends; more
//! arms get a small panel each, with the others in grey behind.

use super::axis::{Axis, Scale, Tick};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::{FigureError, same_length};
use super::panel::{Panel, draw_note, draw_patched, draw_title};
use super::style::{self, CHART_WIDTH, Ink, LABEL, MARGIN, MARKER, TICK};
use super::text::{self, Face};

/// A median curve with its band, one per arm.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    /// Name of the arm.
    pub arm: &'a str,
    /// Abscissae, ascending.
    pub x: &'a [f64],
    /// Median (or mean) at each abscissa.
    pub middle: &'a [f64],
    /// Lower edge of the band at each abscissa.
    pub low: &'a [f64],
    /// Upper edge of the band at each abscissa.
    pub high: &'a [f64],
}

/// How the uncertainty of a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// A shaded band: the abscissae sample a continuous quantity.
    Band,
    /// A bar at every point: the abscissae are settings.
    Bars,
}

/// What one panel shows of every arm.
#[derive(Clone, Copy, Debug)]
pub struct Quantity<'a> {
    /// Label of the vertical axis, with unit.
    pub label: &'a str,
    /// Its scale.
    pub scale: Scale,
    /// Values which the axis must hold besides the data, such as 0.
    pub hold: &'a [f64],
    /// A level marked by a dashed line, with its name.
    pub level: Option<(f64, &'a str)>,
    /// One curve per arm; the same arms in the same order in every panel of a figure.
    pub curves: &'a [Curve<'a>],
}

/// A figure of curves: quantities stacked above one common abscissa.
#[derive(Clone, Copy, Debug)]
pub struct Curves<'a> {
    /// Title, may be empty.
    pub title: &'a str,
    /// Label of the horizontal axis, with unit.
    pub x_label: &'a str,
    /// Its scale.
    pub x_scale: Scale,
    /// An abscissa marked by a dashed line, with its name.
    pub mark: Option<(f64, &'a str)>,
    /// Bands or bars.
    pub spread: Spread,
    /// What the band or bar is, printed below the figure; may be empty.
    pub note: &'a str,
    /// One panel each.
    pub quantities: &'a [Quantity<'a>],
}

/// Most arms in one panel (chosen: the bands of six can no longer be told apart).
const SHARED: usize = 5;
/// Distance of names below each other [pixels].
const NAME_STEP: f64 = 1.3 * LABEL;
const LEFT: f64 = 130.0;
const BELOW: f64 = 92.0;

/// Draws the figure; see [`Curves`].
///
/// # Errors
/// [`FigureError`] if there is no quantity, or a column has the wrong length.
pub fn curves(figure: &Curves<'_>) -> Result<Drawing, FigureError> {
    if figure.quantities.is_empty() {
        return Err(FigureError::Nothing { what: "quantity" });
    }
    for curve in figure.quantities.iter().flat_map(|quantity| quantity.curves) {
        for (column, values) in [("middle", curve.middle), ("low", curve.low), ("high", curve.high)] {
            same_length(curve.arm, ("x", curve.x.len()), (column, values.len()))?;
        }
    }
    let all = figure.quantities.iter().flat_map(|quantity| quantity.curves).flat_map(|curve| curve.x);
    let marked = figure.mark.map(|(x, _)| x);
    let pad = if figure.spread == Spread::Bars { 0.06 } else { 0.0 };
    let x = Axis::around(figure.x_scale, all.copied().chain(marked), pad);
    let heights: Vec<f64> = figure.quantities.iter().map(|quantity| height(figure, quantity)).collect();
    let title = if figure.title.is_empty() { 0.0 } else { style::TITLE * text::LEADING + 12.0 };
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 14.0 };
    let total = MARGIN + title + heights.iter().sum::<f64>() + note + 12.0;
    let mut drawing = Drawing::new(f64::from(CHART_WIDTH), total);
    draw_title(&mut drawing, figure.title);
    let mut top = MARGIN + title;
    for (quantity, height) in figure.quantities.iter().zip(heights) {
        let y = vertical(quantity);
        if quantity.curves.len() <= SHARED {
            shared(&mut drawing, figure, quantity, [x, y], top, top + height);
        } else {
            separate(&mut drawing, figure, quantity, [x, y], top);
        }
        top += height;
    }
    draw_note(&mut drawing, figure.note);
    Ok(drawing)
}

fn vertical(quantity: &Quantity<'_>) -> Axis {
    let data = quantity.curves.iter().flat_map(|curve| [curve.middle, curve.low, curve.high]).flatten();
    let level = quantity.level.map(|(y, _)| y);
    let held = quantity.hold.iter().copied();
    let axis = Axis::around(quantity.scale, data.copied().chain(level).chain(held), 0.05);
    // A bound that is asked for, such as 0, is the edge itself unless data lie beyond.
    let lowest = quantity.hold.iter().copied().fold(f64::INFINITY, f64::min);
    let below = quantity.curves.iter().flat_map(|curve| curve.low).any(|v| *v < lowest);
    if below || lowest == f64::INFINITY { axis } else { Axis { low: lowest, ..axis } }
}

/// Columns and rows of the small panels.
fn grid(arms: usize) -> (usize, usize) {
    let columns = if arms <= 9 { 3 } else { 4 };
    (columns, arms.div_ceil(columns))
}

const SMALL_HEIGHT: f64 = 210.0;
const SMALL_GAP: [f64; 2] = [30.0, 72.0];

fn height(figure: &Curves<'_>, quantity: &Quantity<'_>) -> f64 {
    if quantity.curves.len() <= SHARED {
        let plot = if figure.quantities.len() == 1 { 620.0 } else { 400.0 };
        plot + BELOW + 34.0
    } else {
        let (_, rows) = grid(quantity.curves.len());
        rows as f64 * (SMALL_HEIGHT + SMALL_GAP[1]) + BELOW - 10.0
    }
}

/// All arms in one panel, named at the right.
fn shared(
    drawing: &mut Drawing,
    figure: &Curves<'_>,
    quantity: &Quantity<'_>,
    axes: [Axis; 2],
    top: f64,
    end: f64,
) {
    let names = quantity.curves.iter().map(|curve| text::width(curve.arm, Face::Bold, LABEL));
    let mut area = Rect { left: LEFT, top: top + 34.0, right: 0.0, bottom: end - BELOW };
    let above = ends_meet(&axes, quantity.curves, area.height());
    let right = if above { 12.0 } else { names.fold(120.0, f64::max) + 26.0 };
    area.right = f64::from(CHART_WIDTH) - MARGIN - right;
    let panel = Panel { area, x: axes[0], y: axes[1] };
    panel.draw_y(drawing, quantity.label);
    if figure.spread == Spread::Bars {
        panel.draw_x_at(drawing, figure.x_label, &settings(quantity.curves));
    } else {
        panel.draw_x(drawing, figure.x_label);
    }
    if quantity.curves.iter().all(|curve| !has_point(&panel, curve)) {
        panel.draw_empty(drawing, "no data");
        return;
    }
    marks(drawing, &panel, figure, quantity, true);
    for (index, curve) in quantity.curves.iter().enumerate() {
        spread(
            drawing,
            &panel,
            figure.spread,
            curve,
            style::category(index),
            dodge(index, quantity.curves.len()),
        );
    }
    for (index, curve) in quantity.curves.iter().enumerate() {
        let shift = dodge(index, quantity.curves.len());
        middle(drawing, &panel, figure.spread, curve, style::category(index), shift);
    }
    if above {
        name_above(drawing, &panel, quantity.curves);
    } else {
        name_ends(drawing, &panel, quantity.curves);
    }
}

/// Whether the curves end so close to each other (within half the height their names take) that names at the ends
/// would not tell them apart.
fn ends_meet(axes: &[Axis; 2], curves: &[Curve<'_>], height: f64) -> bool {
    let placed = |[x, y]: [f64; 2]| axes[0].share(x).and(axes[1].share(y));
    let ends: Vec<f64> = curves.iter().filter_map(|curve| points(curve).filter_map(placed).last()).collect();
    let low = ends.iter().copied().fold(f64::INFINITY, f64::min);
    let high = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    ends.len() > 1 && (high - low) * height < 0.5 * NAME_STEP * (ends.len() - 1) as f64
}

/// Ticks at the settings themselves.
fn settings(curves: &[Curve<'_>]) -> Vec<Tick> {
    let mut values: Vec<f64> = curves.iter().flat_map(|curve| curve.x).copied().collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values.into_iter().map(|value| Tick { value, label: style::number(value, 3) }).collect()
}

/// One small panel per arm.
fn separate(drawing: &mut Drawing, figure: &Curves<'_>, quantity: &Quantity<'_>, axes: [Axis; 2], top: f64) {
    let (columns, rows) = grid(quantity.curves.len());
    let wide = f64::from(CHART_WIDTH) - LEFT - MARGIN;
    let width = (wide - (columns - 1) as f64 * SMALL_GAP[0]) / columns as f64;
    for (index, curve) in quantity.curves.iter().enumerate() {
        let (column, row) = (index % columns, index / columns);
        let left = LEFT + column as f64 * (width + SMALL_GAP[0]);
        let above = top + 46.0 + row as f64 * (SMALL_HEIGHT + SMALL_GAP[1]);
        let area = Rect { left, top: above, right: left + width, bottom: above + SMALL_HEIGHT };
        let panel = Panel { area, x: axes[0], y: axes[1] };
        let last = index + columns >= quantity.curves.len();
        if column == 0 {
            panel.draw_y(drawing, if row == rows / 2 { quantity.label } else { "" });
        } else {
            panel.draw_grid(drawing);
        }
        if last {
            panel.draw_x(drawing, figure.x_label)
        } else {
            panel.draw_x_line(drawing)
        }
        panel.draw_heading(drawing, curve.arm, style::readable(style::category(index)));
        for other in quantity.curves {
            panel.draw_curve(drawing, points(other), 1.5, Ink::hex(0xc6ccd2));
        }
        marks(drawing, &panel, figure, quantity, index == 0);
        if has_point(&panel, curve) {
            spread(drawing, &panel, figure.spread, curve, style::category(index), 0.0);
            middle(drawing, &panel, figure.spread, curve, style::category(index), 0.0);
        } else {
            panel.draw_empty(drawing, "no data");
        }
    }
}

fn points<'a>(curve: &Curve<'a>) -> impl Iterator<Item = [f64; 2]> + 'a {
    curve.x.iter().zip(curve.middle).map(|(x, y)| [*x, *y])
}

fn has_point(panel: &Panel, curve: &Curve<'_>) -> bool {
    points(curve).any(|[x, y]| panel.point(x, y).is_some())
}

/// Shift of an arm's bars [pixels], so that the bars of several arms at one setting stand beside each other.
fn dodge(index: usize, arms: usize) -> f64 {
    14.0 * (index as f64 - 0.5 * (arms as f64 - 1.0))
}

fn spread(drawing: &mut Drawing, panel: &Panel, spread: Spread, curve: &Curve<'_>, ink: Ink, shift: f64) {
    if spread == Spread::Band {
        panel.draw_band(drawing, curve.x, curve.low, curve.high, ink.with_alpha(0.18));
        return;
    }
    for k in 0..curve.x.len() {
        let ends = [curve.low[k], curve.high[k]].map(|y| panel.point_inside(curve.x[k], y));
        if let [Some(low), Some(high)] = ends {
            drawing.line(vec![[low[0] + shift, low[1]], [high[0] + shift, high[1]]], 3.0, ink);
        }
    }
}

fn middle(drawing: &mut Drawing, panel: &Panel, spread: Spread, curve: &Curve<'_>, ink: Ink, shift: f64) {
    let places: Vec<[f64; 2]> = points(curve).filter_map(|[x, y]| panel.point_inside(x, y)).collect();
    if spread == Spread::Bars {
        let shifted: Vec<[f64; 2]> = places.iter().map(|p| [p[0] + shift, p[1]]).collect();
        drawing.line(shifted.clone(), 1.5, ink.with_alpha(0.6));
        for place in shifted {
            drawing.disc(place, 8.0, ink, Some((2.0, style::PAPER)));
        }
        return;
    }
    panel.draw_curve(drawing, points(curve), 3.5, ink);
    if places.len() == 1 {
        drawing.disc(places[0], 6.0, ink, None);
    }
}

/// The dashed lines of the marked abscissa and level.
fn marks(drawing: &mut Drawing, panel: &Panel, figure: &Curves<'_>, quantity: &Quantity<'_>, named: bool) {
    let area = panel.area;
    if let Some((value, name)) = figure.mark
        && let Some(column) = panel.column(value)
    {
        drawing.dashed([column, area.bottom], [column, area.top], 2.0, MARKER, 7.0);
        if named {
            let wide = text::width(name, Face::Regular, TICK);
            let fits = column + 8.0 + wide <= area.right;
            let (x, anchor) = if fits { (column + 8.0, Anchor::Start) } else { (column - 8.0, Anchor::End) };
            draw_patched(drawing, name, [x, area.top + TICK], anchor);
        }
    }
    if let Some((value, name)) = quantity.level
        && let Some(row) = panel.row(value)
    {
        drawing.dashed([area.left, row], [area.right, row], 2.0, MARKER, 7.0);
        if named {
            draw_patched(drawing, name, [area.right - 6.0, row - 8.0], Anchor::End);
        }
    }
}

/// Names in one line above the panel, each with a stroke of its colour.
fn name_above(drawing: &mut Drawing, panel: &Panel, curves: &[Curve<'_>]) {
    let width = |curve: &Curve<'_>| text::width(curve.arm, Face::Bold, LABEL) + 44.0;
    let total: f64 = curves.iter().map(|curve| width(curve) + 30.0).sum();
    let scale = (panel.area.width() / total).min(1.0);
    let (size, y) = (LABEL * scale, panel.area.top - 20.0);
    let mut x = panel.area.left;
    for (index, curve) in curves.iter().enumerate() {
        let ink = style::category(index);
        drawing.line(vec![[x, y], [x + 34.0 * scale, y]], 4.0, ink);
        let position = [x + 44.0 * scale, y + 0.5 * text::CAP_HEIGHT * size];
        drawing.label(curve.arm, position, size, Face::Bold, style::readable(ink), Anchor::Start);
        x += (width(curve) + 30.0) * scale;
    }
}

/// Names at the right of the panel, each at the height where its curve ends, pushed apart where they would touch,
/// and joined to its end by a thin line.
fn name_ends(drawing: &mut Drawing, panel: &Panel, curves: &[Curve<'_>]) {
    let last = |curve: &Curve<'_>| points(curve).filter_map(|[x, y]| panel.point_inside(x, y)).last();
    let mut ends: Vec<(usize, [f64; 2])> =
        curves.iter().enumerate().filter_map(|(k, curve)| Some((k, last(curve)?))).collect();
    ends.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]).then(a.0.cmp(&b.0)));
    let rows = spaced(&ends.iter().map(|end| end.1[1]).collect::<Vec<_>>(), NAME_STEP, panel.area);
    for ((index, end), row) in ends.into_iter().zip(rows) {
        let start = panel.area.right + 26.0;
        let ink = style::category(index);
        drawing.line(vec![[end[0] + 4.0, end[1]], [start - 6.0, row]], 1.5, ink.with_alpha(0.55));
        let base = row + 0.5 * text::CAP_HEIGHT * LABEL;
        drawing.label(
            curves[index].arm,
            [start, base],
            LABEL,
            Face::Bold,
            style::readable(ink),
            Anchor::Start,
        );
    }
}

/// Rows (ascending) moved as little as needed to stand at least `step` apart inside the area.
fn spaced(wanted: &[f64], step: f64, area: Rect) -> Vec<f64> {
    let mut rows = wanted.to_vec();
    for k in 0..rows.len() {
        let least = if k == 0 { area.top + 0.4 * step } else { rows[k - 1] + step };
        rows[k] = rows[k].max(least);
    }
    let mut most = area.bottom - 0.2 * step;
    for row in rows.iter_mut().rev() {
        *row = row.min(most);
        most = *row - step;
    }
    rows
}
