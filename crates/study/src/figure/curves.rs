//! Panels of curves with bands, one curve per arm. Up to five arms share a panel and are named at their ends; more
//! arms get a small panel each, with the others in grey behind.

use super::axis::{Axis, Scale, Tick};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::{FigureError, same_length};
use super::panel::{Panel, draw_note, draw_patched, draw_title, title_height};
use super::sheet::{Sheet, filled, fine, stroked};
use super::style::{self, CHART_WIDTH, Ink, LABEL, MARGIN, MARKER, TICK};
use super::text::{self, Face};
use plotters::chart::LabelAreaPosition;
use plotters::element::{Circle, DashedPathElement, ErrorBar};

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

/// A dashed line to compare with, such as what theory says.
#[derive(Clone, Copy, Debug)]
pub struct Guide<'a> {
    /// The arm beside whose curve it stands; none: all.
    pub arm: Option<&'a str>,
    /// Its name, written at its end; may be empty.
    pub name: &'a str,
    /// Abscissae, towards the end with the name.
    pub x: &'a [f64],
    /// Ordinates.
    pub y: &'a [f64],
}

/// How the uncertainty of a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// A shaded band: the abscissae sample a continuous quantity.
    Band,
    /// The same, every curve in a small panel: what their abscissae stand for differs.
    BandsApart,
    /// A bar at every point, those of several arms beside each other: the abscissae are settings.
    Bars,
    /// A point at every setting, without any uncertainty: equal curves lie on each other, the later smaller.
    Points,
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
    /// Dashed lines to compare with.
    pub guides: &'a [Guide<'a>],
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
/// Distance of the bars of neighbouring arms at one setting [pixels].
const DODGE: f64 = 14.0;
/// Radius of a point, one pixel less for each later arm [pixels].
const LARGEST: f64 = 6.0;
const LEFT: f64 = 130.0;
const BELOW: f64 = 92.0;

/// Draws the figure; see [`Curves`].
///
/// # Errors
/// [`FigureError`] if there is no quantity or no curve, or a column has the wrong length.
pub fn curves(figure: &Curves<'_>) -> Result<Drawing, FigureError> {
    if figure.quantities.is_empty() {
        return Err(FigureError::Nothing { what: "quantity" });
    }
    if figure.quantities.iter().all(|quantity| quantity.curves.is_empty()) {
        return Err(FigureError::Nothing { what: "curve" });
    }
    for curve in figure.quantities.iter().flat_map(|quantity| quantity.curves) {
        for (column, values) in [("middle", curve.middle), ("low", curve.low), ("high", curve.high)] {
            same_length(curve.arm, ("x", curve.x.len()), (column, values.len()))?;
        }
    }
    let all = figure.quantities.iter().flat_map(|quantity| quantity.curves).flat_map(|curve| curve.x);
    let marked = figure.mark.map(|(x, _)| x);
    let pad = if figure.spread.is_band() { 0.0 } else { 0.06 };
    let x = Axis::around(figure.x_scale, all.copied().chain(marked), pad);
    let heights: Vec<f64> = figure.quantities.iter().map(|quantity| height(figure, quantity)).collect();
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 14.0 };
    let first = MARGIN + title_height(figure.title);
    let total = first + heights.iter().sum::<f64>() + note + 12.0;
    Sheet::drawn(f64::from(CHART_WIDTH), total, |sheet| {
        draw_title(sheet, figure.title)?;
        let mut top = first;
        for (quantity, height) in figure.quantities.iter().zip(heights) {
            let axes = [x, vertical(quantity)];
            if share_a_panel(figure, quantity) {
                shared(sheet, figure, quantity, axes, [top, top + height])?;
            } else {
                separate(sheet, figure, quantity, axes, top)?;
            }
            top += height;
        }
        draw_note(sheet, figure.note)
    })
}

fn vertical(quantity: &Quantity<'_>) -> Axis {
    let data = quantity.curves.iter().flat_map(|curve| [curve.middle, curve.low, curve.high]).flatten();
    let level = quantity.level.map(|(y, _)| y);
    let held = quantity.hold.iter().copied();
    let guides = quantity.guides.iter().flat_map(|guide| guide.y).copied();
    let axis = Axis::around(quantity.scale, data.copied().chain(level).chain(held).chain(guides), 0.05);
    // A bound that is asked for, such as 0, is the edge itself unless data lie beyond.
    let lowest = quantity.hold.iter().copied().fold(f64::INFINITY, f64::min);
    let below = quantity.curves.iter().flat_map(|curve| curve.low).any(|v| *v < lowest);
    if below || lowest == f64::INFINITY { axis } else { Axis { low: lowest, ..axis } }
}

impl Spread {
    fn is_band(self) -> bool {
        matches!(self, Spread::Band | Spread::BandsApart)
    }
}

fn share_a_panel(figure: &Curves<'_>, quantity: &Quantity<'_>) -> bool {
    quantity.curves.len() <= SHARED && figure.spread != Spread::BandsApart
}

/// Columns and rows of the small panels.
fn grid(arms: usize) -> (usize, usize) {
    let columns = if arms <= 9 { 3 } else { 4 };
    (columns, arms.div_ceil(columns))
}

const SMALL_HEIGHT: f64 = 210.0;
/// Between small panels [pixels]: the last number of one axis and the first of the next stand apart.
const SMALL_GAP: [f64; 2] = [50.0, 72.0];

fn height(figure: &Curves<'_>, quantity: &Quantity<'_>) -> f64 {
    if share_a_panel(figure, quantity) {
        let plot = if figure.quantities.len() == 1 { 620.0 } else { 400.0 };
        plot + BELOW + 34.0
    } else {
        let (_, rows) = grid(quantity.curves.len());
        rows as f64 * (SMALL_HEIGHT + SMALL_GAP[1]) + BELOW - 10.0
    }
}

/// All arms in one panel, named at the right.
fn shared(
    sheet: &Sheet<'_>,
    figure: &Curves<'_>,
    quantity: &Quantity<'_>,
    [x, y]: [Axis; 2],
    [top, end]: [f64; 2],
) -> Result<(), FigureError> {
    let curves = quantity.curves;
    let names = curves.iter().map(|curve| text::width(curve.arm, Face::Bold, LABEL));
    let mut area = Rect { left: LEFT, top: top + 34.0, right: 0.0, bottom: end - BELOW };
    let above = ends_meet(&[x, y], curves, area.height());
    let right = if above { 12.0 } else { names.fold(120.0, f64::max) + 26.0 };
    area.right = sheet.width - MARGIN - right;
    let mut panel = match figure.spread {
        Spread::Band | Spread::BandsApart => Panel::new(sheet, area, x, y)?,
        Spread::Bars | Spread::Points => {
            let ticks = settings(curves);
            let ticks = if ticks.len() > MOST_SETTINGS { x.ticks(MOST_SETTINGS) } else { ticks };
            Panel::with_ticks(sheet, area, [x, y], ticks, LabelAreaPosition::Bottom)?
        }
    };
    panel.draw_y(quantity.label)?;
    panel.draw_x(figure.x_label)?;
    if curves.iter().all(|curve| !has_point(&panel, curve)) {
        return panel.draw_empty("no data");
    }
    marks(sheet, &panel, figure, quantity, true)?;
    if figure.spread.is_band() {
        for (index, curve) in curves.iter().enumerate() {
            band(&panel, curve, style::category(index))?;
        }
    }
    for (index, curve) in curves.iter().enumerate() {
        // The arms' bars at one setting stand beside each other, each on an area of its own that is shifted.
        let shift = DODGE * (index as f64 - 0.5 * (curves.len() as f64 - 1.0));
        match figure.spread {
            Spread::Band | Spread::BandsApart => middle(&mut panel, curve, style::category(index))?,
            Spread::Points => settings_joined(&mut panel, curve, style::category(index), index)?,
            Spread::Bars => {
                let area = Rect { left: area.left + shift, right: area.right + shift, ..area };
                bars(&mut Panel::new(sheet, area, x, y)?, curve, style::category(index))?;
            }
        }
    }
    // Above the curves, which may lie on them.
    for (number, guide) in quantity.guides.iter().enumerate() {
        let first = quantity.guides.iter().position(|other| other.name == guide.name) == Some(number);
        draw_guide(sheet, &mut panel, guide, first)?;
    }
    if above { name_above(sheet, &panel, curves) } else { name_ends(sheet, &panel, curves) }
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

/// More settings than this are measured quantities: their axis has ticks of its own (chosen: as many labels stand side by side).
const MOST_SETTINGS: usize = 10;

/// Ticks at the settings themselves.
fn settings(curves: &[Curve<'_>]) -> Vec<Tick> {
    let mut values: Vec<f64> = curves.iter().flat_map(|curve| curve.x).copied().collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values.into_iter().map(|value| Tick { value, label: style::number(value, digits(value)) }).collect()
}

/// Digits after the point of a setting: three, or as many as show two of those that count.
fn digits(value: f64) -> usize {
    let leading = if value == 0.0 { 0.0 } else { -libm::log10(value.abs()).floor() };
    (leading + 1.0).max(3.0) as usize
}

/// One small panel per arm.
fn separate(
    sheet: &Sheet<'_>,
    figure: &Curves<'_>,
    quantity: &Quantity<'_>,
    [x, y]: [Axis; 2],
    top: f64,
) -> Result<(), FigureError> {
    let (columns, rows) = grid(quantity.curves.len());
    let wide = sheet.width - LEFT - MARGIN;
    let width = (wide - (columns - 1) as f64 * SMALL_GAP[0]) / columns as f64;
    for (index, curve) in quantity.curves.iter().enumerate() {
        let (column, row) = (index % columns, index / columns);
        let left = LEFT + column as f64 * (width + SMALL_GAP[0]);
        let above = top + 46.0 + row as f64 * (SMALL_HEIGHT + SMALL_GAP[1]);
        let area = Rect { left, top: above, right: left + width, bottom: above + SMALL_HEIGHT };
        let mut panel = Panel::new(sheet, area, x, y)?;
        let last = index + columns >= quantity.curves.len();
        match column {
            0 => panel.draw_y(if row == rows / 2 { quantity.label } else { "" })?,
            _ => panel.draw_grid()?,
        }
        if last {
            panel.draw_x(figure.x_label)?
        } else {
            panel.draw_x_line()?
        }
        let ink = style::category(index);
        panel.draw_heading(curve.arm, 12.0, style::readable(ink))?;
        for other in quantity.curves {
            panel.draw_curve(points(other), 1.5, Ink::hex(0xc6ccd2))?;
        }
        marks(sheet, &panel, figure, quantity, index == 0)?;
        for guide in quantity.guides.iter().filter(|guide| guide.arm.is_none_or(|arm| arm == curve.arm)) {
            draw_guide(sheet, &mut panel, guide, index == 0)?;
        }
        match figure.spread {
            _ if !has_point(&panel, curve) => panel.draw_empty("no data")?,
            Spread::Points => settings_joined(&mut panel, curve, ink, 0)?,
            Spread::Bars => bars(&mut panel, curve, ink)?,
            Spread::Band | Spread::BandsApart => {
                band(&panel, curve, ink)?;
                middle(&mut panel, curve, ink)?;
            }
        }
    }
    Ok(())
}

fn points<'a>(curve: &Curve<'a>) -> impl Iterator<Item = [f64; 2]> + 'a {
    curve.x.iter().zip(curve.middle).map(|(x, y)| [*x, *y])
}

fn has_point(panel: &Panel<'_>, curve: &Curve<'_>) -> bool {
    points(curve).any(|[x, y]| panel.point(x, y).is_some())
}

fn band(panel: &Panel<'_>, curve: &Curve<'_>, ink: Ink) -> Result<(), FigureError> {
    panel.draw_band(curve.x, curve.low, curve.high, ink.with_alpha(0.18))
}

/// The curve itself; a lone point becomes a disc.
fn middle(panel: &mut Panel<'_>, curve: &Curve<'_>, ink: Ink) -> Result<(), FigureError> {
    panel.draw_curve(points(curve), 3.5, ink)?;
    let mut places = points(curve).filter(|[x, y]| panel.point(*x, *y).is_some());
    if let (Some([x, y]), None) = (places.next(), places.next()) {
        panel.plot().draw(&Circle::new((x, y), fine(6.0), filled(ink)))?;
    }
    Ok(())
}

/// A bar with a point at every setting, joined by a thin line.
fn bars(panel: &mut Panel<'_>, curve: &Curve<'_>, ink: Ink) -> Result<(), FigureError> {
    let placed = |panel: &Panel<'_>, k: usize, y: f64| panel.point(curve.x[k], y).is_some();
    for k in 0..curve.x.len() {
        let [low, middle, high] = [curve.low[k], curve.middle[k], curve.high[k]];
        if [low, middle, high].iter().all(|y| placed(panel, k, *y)) {
            let style = stroked(3.0, ink);
            let bar = ErrorBar::new_vertical(curve.x[k], low, middle, high, style, fine(10.0) as u32);
            panel.plot().draw(&bar)?;
        }
    }
    settings_joined(panel, curve, ink, 0)
}

/// A point at every setting, joined by a thin line; smaller for later arms, so that an equal one before still shows.
fn settings_joined(
    panel: &mut Panel<'_>,
    curve: &Curve<'_>,
    ink: Ink,
    index: usize,
) -> Result<(), FigureError> {
    panel.draw_curve(points(curve), 1.5, ink.with_alpha(0.6))?;
    let smaller = (SHARED - 1).min(index) as f64;
    for [x, y] in points(curve).filter(|[x, y]| panel.point(*x, *y).is_some()) {
        for (radius, ink) in [(LARGEST + 2.0 - smaller, style::PAPER), (LARGEST - smaller, ink)] {
            panel.plot().draw(&Circle::new((x, y), fine(radius), filled(ink)))?;
        }
    }
    Ok(())
}

/// A dashed line, named at its end.
fn draw_guide(
    sheet: &Sheet<'_>,
    panel: &mut Panel<'_>,
    guide: &Guide<'_>,
    named: bool,
) -> Result<(), FigureError> {
    let placed: Vec<(f64, f64)> = guide.x.iter().copied().zip(guide.y.iter().copied()).collect();
    let kept = placed.iter().filter(|(x, y)| panel.point(*x, *y).is_some()).copied();
    let line: Vec<(f64, f64)> = kept.collect();
    let Some(&(x, y)) = line.last() else { return Ok(()) };
    panel.plot().draw(&DashedPathElement::new(line, fine(7.0), fine(7.0), stroked(2.0, MARKER)))?;
    match panel.point(x, y) {
        Some([column, row]) if named && !guide.name.is_empty() => {
            let wide = text::width(guide.name, Face::Regular, TICK);
            let fits = column - 6.0 - wide >= panel.area.left;
            let (x, anchor) = if fits { (column - 6.0, Anchor::End) } else { (column + 6.0, Anchor::Start) };
            draw_patched(sheet, guide.name, [x, row - 8.0], anchor)
        }
        _ => Ok(()),
    }
}

/// The dashed lines of the marked abscissa and level.
fn marks(
    sheet: &Sheet<'_>,
    panel: &Panel<'_>,
    figure: &Curves<'_>,
    quantity: &Quantity<'_>,
    named: bool,
) -> Result<(), FigureError> {
    let (area, style) = (panel.area, stroked(2.0, MARKER));
    if let Some((value, name)) = figure.mark
        && let Some(column) = panel.column(value)
    {
        panel.draw_dashed([(value, panel.y.low), (value, panel.y.high)], 7.0, style)?;
        if named {
            let wide = text::width(name, Face::Regular, TICK);
            let fits = column + 8.0 + wide <= area.right;
            let (x, anchor) = if fits { (column + 8.0, Anchor::Start) } else { (column - 8.0, Anchor::End) };
            draw_patched(sheet, name, [x, area.top + TICK], anchor)?;
        }
    }
    if let Some((value, name)) = quantity.level
        && let Some(row) = panel.row(value)
    {
        panel.draw_dashed([(panel.x.low, value), (panel.x.high, value)], 7.0, style)?;
        if named {
            draw_patched(sheet, name, [area.right - 6.0, row - 8.0], Anchor::End)?;
        }
    }
    Ok(())
}

/// Names in one line above the panel, each with a stroke of its colour.
fn name_above(sheet: &Sheet<'_>, panel: &Panel<'_>, curves: &[Curve<'_>]) -> Result<(), FigureError> {
    let width = |curve: &Curve<'_>| text::width(curve.arm, Face::Bold, LABEL) + 44.0;
    let total: f64 = curves.iter().map(|curve| width(curve) + 30.0).sum();
    let scale = (panel.area.width() / total).min(1.0);
    let (size, y) = (LABEL * scale, panel.area.top - 20.0);
    let mut x = panel.area.left;
    for (index, curve) in curves.iter().enumerate() {
        let ink = style::category(index);
        sheet.line([[x, y], [x + 34.0 * scale, y]], 4.0, ink)?;
        let position = [x + 44.0 * scale, y + 0.5 * text::CAP_HEIGHT * size];
        sheet.label(curve.arm, position, size, Face::Bold, style::readable(ink), Anchor::Start)?;
        x += (width(curve) + 30.0) * scale;
    }
    Ok(())
}

/// Names at the right of the panel, each at the height where its curve ends, pushed apart where they would touch,
/// and joined to its end by a thin line.
fn name_ends(sheet: &Sheet<'_>, panel: &Panel<'_>, curves: &[Curve<'_>]) -> Result<(), FigureError> {
    let last = |curve: &Curve<'_>| points(curve).filter_map(|[x, y]| panel.point(x, y)).last();
    let mut ends: Vec<(usize, [f64; 2])> =
        curves.iter().enumerate().filter_map(|(k, curve)| Some((k, last(curve)?))).collect();
    ends.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]).then(a.0.cmp(&b.0)));
    let rows = spaced(&ends.iter().map(|end| end.1[1]).collect::<Vec<_>>(), NAME_STEP, panel.area);
    for ((index, end), row) in ends.into_iter().zip(rows) {
        let start = panel.area.right + 26.0;
        let ink = style::category(index);
        sheet.line([[end[0] + 4.0, end[1]], [start - 6.0, row]], 1.5, ink.with_alpha(0.55))?;
        let (base, ink) = (row + 0.5 * text::CAP_HEIGHT * LABEL, style::readable(ink));
        sheet.label(curves[index].arm, [start, base], LABEL, Face::Bold, ink, Anchor::Start)?;
    }
    Ok(())
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

#[cfg(test)]
mod tests {
    use super::{digits, style};

    #[test]
    fn small_settings_are_told_apart() {
        let told = [12.0, 0.25, 1e-3, 2.5e-5, 0.0].map(|value| style::number(value, digits(value)));
        assert_eq!(told, ["12", "0.25", "0.001", "0.000025", "0"]);
    }
}
