//! How cases ended over two axes: a panel of cells for each arm, with the limit that was derived as a dashed line.

use super::axis::{Axis, Scale};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::{FigureError, same_length};
use super::panel::{Panel, draw_note, draw_title, title_height};
use super::sheet::{Sheet, filled, stroked};
use super::style::{self, CHART_WIDTH, Ink, LABEL, MARGIN, MARKER, PAPER, TEXT, TICK};
use super::text::{self, Face};
use plotters::chart::LabelAreaPosition;
use plotters::element::{PathElement, Rectangle};
use plotters::style::ShapeStyle;

/// One axis.
#[derive(Clone, Copy, Debug)]
pub struct Places<'a> {
    /// Label, with unit.
    pub label: &'a str,
    /// Where cases are, ascending; logarithmic where all are above 0 and the last is 3 times the first or more.
    pub values: &'a [f64],
}

/// One arm.
#[derive(Clone, Copy, Debug)]
pub struct OutcomePanel<'a> {
    /// Heading.
    pub arm: &'a str,
    /// For each vertical place the index of a kind at each horizontal one; `None` where nothing was run.
    pub cells: &'a [Vec<Option<usize>>],
    /// For each vertical place the horizontal one of the derived limit.
    pub limits: &'a [Option<f64>],
}

/// A way to end.
#[derive(Clone, Copy, Debug)]
pub struct Kind<'a> {
    /// Words of the legend.
    pub words: &'a str,
    /// Colour.
    pub ink: Ink,
}

/// The figure.
#[derive(Clone, Copy, Debug)]
pub struct Outcomes<'a> {
    /// Title, may be empty.
    pub title: &'a str,
    /// Horizontal axis of every panel.
    pub x: Places<'a>,
    /// Vertical axis of every panel.
    pub y: Places<'a>,
    /// Kinds of ends, in the order of the legend.
    pub kinds: &'a [Kind<'a>],
    /// The arms.
    pub panels: &'a [OutcomePanel<'a>],
    /// Printed below the figure; may be empty.
    pub note: &'a str,
}

/// Panels beside each other.
const COLUMNS: usize = 3;
const LEFT: f64 = 130.0;
const HEIGHT: f64 = 330.0;
/// Between panels beside each other [pixels].
const GUTTER: f64 = 34.0;
/// Above a panel: its heading.
const HEADROOM: f64 = 56.0;
/// Below the last row: ticks and label.
const FOOT: f64 = 96.0;
/// A line of the legend.
const LINE: f64 = 40.0;

/// Draws the figure; see [`Outcomes`].
///
/// # Errors
/// [`FigureError`] if there is no panel or place, or a panel has not one cell for each pair of places.
pub fn outcomes(figure: &Outcomes<'_>) -> Result<Drawing, FigureError> {
    if figure.panels.is_empty() {
        return Err(FigureError::Nothing { what: "arm" });
    }
    if figure.x.values.is_empty() || figure.y.values.is_empty() {
        return Err(FigureError::Nothing { what: "place" });
    }
    for panel in figure.panels {
        same_length(panel.arm, ("places", figure.y.values.len()), ("rows", panel.cells.len()))?;
        same_length(panel.arm, ("places", figure.y.values.len()), ("limits", panel.limits.len()))?;
        for row in panel.cells {
            same_length(panel.arm, ("places", figure.x.values.len()), ("cells", row.len()))?;
        }
    }
    let lines = legend_lines(figure);
    let rows = figure.panels.len().div_ceil(COLUMNS);
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 20.0 };
    let first = MARGIN + title_height(figure.title) + lines.len() as f64 * LINE;
    let total = first + rows as f64 * (HEADROOM + HEIGHT) + FOOT + note;
    Sheet::drawn(f64::from(CHART_WIDTH), total, |sheet| {
        draw_title(sheet, figure.title)?;
        draw_legend(sheet, &lines, MARGIN + title_height(figure.title))?;
        let columns = COLUMNS.min(figure.panels.len());
        let width = (sheet.width - LEFT - MARGIN - (columns - 1) as f64 * GUTTER) / columns as f64;
        for (index, panel) in figure.panels.iter().enumerate() {
            let left = LEFT + (index % columns) as f64 * (width + GUTTER);
            let top = first + (index / columns) as f64 * (HEADROOM + HEIGHT) + HEADROOM;
            let area = Rect { left, top, right: left + width, bottom: top + HEIGHT };
            let is_lowest = index + columns >= figure.panels.len();
            draw_panel(sheet, figure, panel, area, [index % columns == 0, is_lowest])?;
        }
        draw_note(sheet, figure.note)
    })
}

/// Where the cells round `values` meet: one more than there are values.
fn edges(values: &[f64], scale: Scale) -> Vec<f64> {
    let to = |value: f64| if scale == Scale::Linear { value } else { libm::log(value) };
    let from = |place: f64| if scale == Scale::Linear { place } else { libm::exp(place) };
    let at: Vec<f64> = values.iter().map(|value| to(*value)).collect();
    let half = |k: usize| if at.len() < 2 { 0.5 } else { 0.5 * (at[k + 1] - at[k]) };
    let last = at.len() - 1;
    let inner = (0..last).map(|k| 0.5 * (at[k] + at[k + 1]));
    let ends = (at[0] - half(0), at[last] + half(last.saturating_sub(1)));
    [ends.0].into_iter().chain(inner).chain([ends.1]).map(from).collect()
}

fn scale_of(values: &[f64]) -> Scale {
    let (first, last) = (values[0], values[values.len() - 1]);
    if first > 0.0 && last >= 3.0 * first { Scale::Logarithmic } else { Scale::Linear }
}

fn axis_of(values: &[f64]) -> (Axis, Vec<f64>) {
    let scale = scale_of(values);
    let edges = edges(values, scale);
    (Axis { scale, low: edges[0], high: edges[edges.len() - 1] }, edges)
}

/// One panel; labels stand at the left of the first and below the lowest.
fn draw_panel(
    sheet: &Sheet<'_>,
    figure: &Outcomes<'_>,
    shown: &OutcomePanel<'_>,
    area: Rect,
    [is_first, is_lowest]: [bool; 2],
) -> Result<(), FigureError> {
    let ((x, columns), (y, rows)) = (axis_of(figure.x.values), axis_of(figure.y.values));
    let mut panel = Panel::with_ticks(sheet, area, [x, y], x.ticks(5), LabelAreaPosition::Bottom)?;
    if is_first {
        panel.draw_y(figure.y.label)?;
    }
    for (row, cells) in shown.cells.iter().enumerate() {
        for (column, kind) in cells.iter().enumerate() {
            let Some(kind) = kind.and_then(|kind| figure.kinds.get(kind)) else { continue };
            let corners = [(columns[column], rows[row]), (columns[column + 1], rows[row + 1])];
            let border = ShapeStyle { filled: false, ..stroked(1.0, PAPER) };
            panel.plot().draw(&Rectangle::new(corners, filled(kind.ink)))?;
            panel.plot().draw(&Rectangle::new(corners, border))?;
        }
    }
    for (row, limit) in shown.limits.iter().enumerate() {
        if let Some(limit) = limit.filter(|limit| (x.low..x.high).contains(limit)) {
            let ends = [(limit, rows[row]), (limit, rows[row + 1])];
            // On paper, so that it is seen on dark cells, too.
            panel.plot().draw(&PathElement::new(ends, stroked(9.0, PAPER)))?;
            panel.draw_dashed(ends, 7.0, stroked(4.0, MARKER))?;
        }
    }
    if is_lowest {
        panel.draw_x(figure.x.label)?;
    }
    panel.draw_heading(shown.arm, 12.0, TEXT)
}

/// What stands in a line of the legend: a patch, or the dashed line.
type Entry<'a> = (Option<Ink>, &'a str);

fn legend_lines<'a>(figure: &Outcomes<'a>) -> Vec<Vec<(f64, Entry<'a>)>> {
    let derived = figure.panels.iter().any(|panel| panel.limits.iter().any(Option::is_some));
    let kinds = figure.kinds.iter().map(|kind| (Some(kind.ink), kind.words));
    let all = kinds.chain(derived.then_some((None, "limit derived")));
    let mut lines = vec![Vec::new()];
    let mut x = MARGIN;
    for (ink, words) in all {
        let width = 40.0 + text::width(words, Face::Regular, LABEL) + 34.0;
        if x + width > f64::from(CHART_WIDTH) - MARGIN && x > MARGIN {
            lines.push(Vec::new());
            x = MARGIN;
        }
        if let Some(line) = lines.last_mut() {
            line.push((x, (ink, words)));
        }
        x += width;
    }
    lines
}

fn draw_legend(sheet: &Sheet<'_>, lines: &[Vec<(f64, Entry<'_>)>], top: f64) -> Result<(), FigureError> {
    for (number, line) in lines.iter().enumerate() {
        let top = top + number as f64 * LINE;
        for (x, (ink, words)) in line {
            let middle = top + 14.0;
            match ink {
                Some(ink) => {
                    let patch = Rect { left: *x, top: top + 2.0, right: x + 28.0, bottom: top + 26.0 };
                    sheet.rectangle(patch, *ink)?;
                }
                None => {
                    for dash in [0.0, 18.0] {
                        sheet.line([[x + dash, middle], [x + dash + 10.0, middle]], 4.0, MARKER)?;
                    }
                }
            }
            let position = [x + 40.0, middle + 0.5 * text::CAP_HEIGHT * LABEL];
            sheet.label(words, position, LABEL, Face::Regular, TEXT, Anchor::Start)?;
        }
    }
    Ok(())
}

/// Colours of ends from sound to stopped: the darker the worse, so that they are apart without colour, too.
pub mod inks {
    use super::style::Ink;

    /// Sound.
    pub const SOUND: Ink = Ink::hex(0xcfe8f5);
    /// Sound, at a bound.
    pub const CLAMPED: Ink = Ink::hex(0x7fc4e8);
    /// Sound, with shorter steps than were asked for.
    pub const HALVED: Ink = Ink::hex(0xf5d98b);
    /// Ended well, and is not sound.
    pub const UNSOUND: Ink = Ink::hex(0xcc79a7);
    /// Stopped, by reason: further ones repeat the last.
    pub const STOPPED: [Ink; 3] = [Ink::hex(0xd55e00), Ink::hex(0x33383d), Ink::hex(0x8f5a2b)];
}
