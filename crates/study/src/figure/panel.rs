//! A panel: a chart of plotters whose plot area lies exactly where the figure wants it, with its mesh, its curves and
//! its headings; and the titles and notes of whole figures, whose height plotters' captions would not tell.

use super::axis::{Axis, Tick};
use super::backend::FINE;
use super::drawing::{Anchor, Drawing, Rect};
use super::error::FigureError;
use super::sheet::{Sheet, filled, fine, lettering, stroked};
use super::style::{self, AXIS, GRID, HEADING, Ink, LABEL, MUTED, TEXT, TICK};
use super::text::{self, Face};
use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::combinators::{BindKeyPoints, WithKeyPoints};
use plotters::drawing::DrawingArea;
use plotters::element::{DashedPathElement, Polygon};
use plotters::series::LineSeries;
use plotters::style::ShapeStyle;

/// Length of a tick mark on the horizontal axis [pixels]; plotters sets the labels at twice the length.
const TICK_LENGTH: f64 = 7.0;
/// The same on the vertical axis, where the grid lines take the place of the marks.
const TICK_GAP: f64 = 5.0;
/// From the plot area to the base line of the label of the axis below [pixels].
const BELOW: f64 = 67.0;
/// From the plot area to the top of the label of the axis above [pixels].
const ABOVE: f64 = 63.0;

type Coordinates = Cartesian2d<WithKeyPoints<Axis>, WithKeyPoints<Axis>>;

/// A plot area with its axes.
pub(super) struct Panel<'d> {
    /// The plot area, without labels [pixels].
    pub area: Rect,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    sheet: Sheet<'d>,
    ticks: [Vec<Tick>; 2],
    side: LabelAreaPosition,
    chart: ChartContext<'d, &'d mut Drawing, Coordinates>,
}

impl<'d> Panel<'d> {
    /// A panel with as many ticks as fit and the labels of the horizontal axis below.
    pub fn new(sheet: &Sheet<'d>, area: Rect, x: Axis, y: Axis) -> Result<Self, FigureError> {
        let most = ((area.width() / 85.0) as usize).clamp(2, 9);
        Self::with_ticks(sheet, area, [x, y], x.ticks(most), LabelAreaPosition::Bottom)
    }

    /// A panel with the horizontal ticks given and their labels above or below. A tick without a label is a minor one.
    pub fn with_ticks(
        sheet: &Sheet<'d>,
        area: Rect,
        [x, y]: [Axis; 2],
        ticks: Vec<Tick>,
        side: LabelAreaPosition,
    ) -> Result<Self, FigureError> {
        let most = ((area.height() / 48.0) as usize).clamp(2, 9);
        let ticks = [ticks, y.ticks(most)];
        let named = |ticks: &[Tick]| -> Vec<f64> {
            ticks.iter().filter(|tick| !tick.label.is_empty()).map(|tick| tick.value).collect()
        };
        let widest = ticks[1].iter().map(|tick| text::width(&tick.label, Face::Regular, TICK));
        let left = 2.0 * TICK_GAP + widest.fold(0.0, f64::max) + 22.0 + text::CAP_HEIGHT * LABEL;
        let left = fine(left).min(fine(area.left));
        let [above, below] = match side {
            LabelAreaPosition::Top => [fine(ABOVE).min(fine(area.top)), 0],
            _ => [0, fine(BELOW).min(fine(sheet.height - area.bottom))],
        };
        let chart = ChartBuilder::on(&sheet.area)
            .margin_left(fine(area.left) - left)
            .margin_right(fine(sheet.width) - fine(area.right))
            .margin_top(fine(area.top) - above)
            .margin_bottom(fine(sheet.height) - fine(area.bottom) - below)
            .y_label_area_size(left)
            .x_label_area_size(below)
            .top_x_label_area_size(above)
            .build_cartesian_2d(x.with_key_points(named(&ticks[0])), y.with_key_points(named(&ticks[1])))?;
        Ok(Self { area, x, y, sheet: sheet.clone(), ticks, side, chart })
    }

    /// The plot area in the units of the axes. Elements that reach beyond it are held to its edge.
    pub fn plot(&self) -> &DrawingArea<&'d mut Drawing, Coordinates> {
        self.chart.plotting_area()
    }

    /// Point of a pair of values [pixels]; `None` where it has no place on an axis.
    pub fn point(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        self.x.share(x).and(self.y.share(y))?;
        let (column, row) = self.chart.backend_coord(&(x, y));
        Some([f64::from(column) / FINE, f64::from(row) / FINE])
    }

    /// Column of a value [pixels]; `None` where it has no place on the axis.
    pub fn column(&self, x: f64) -> Option<f64> {
        self.point(x, self.y.low).map(|[column, _]| column)
    }

    /// Row of a value [pixels]; `None` where it has no place on the axis.
    pub fn row(&self, y: f64) -> Option<f64> {
        self.point(self.x.low, y).map(|[_, row]| row)
    }

    /// Grid lines at the labelled vertical ticks, and at the left their labels and that of the axis.
    pub fn draw_y(&mut self, label: &str) -> Result<(), FigureError> {
        let name = |value: &f64| name(&self.ticks[1], *value);
        let mut mesh = self.chart.configure_mesh();
        mesh.disable_x_mesh()
            .disable_x_axis()
            .axis_style(filled(AXIS.with_alpha(0.0)))
            .bold_line_style(stroked(1.5, GRID))
            .set_all_tick_mark_size(fine(TICK_GAP))
            .y_label_style(lettering(TICK, Face::Regular, MUTED, Anchor::End))
            .y_label_formatter(&name)
            .axis_desc_style(lettering(LABEL, Face::Regular, TEXT, Anchor::Middle))
            .y_desc(label);
        Ok(mesh.draw()?)
    }

    /// Grid lines alone, for a panel whose labels stand at its left neighbour.
    pub fn draw_grid(&mut self) -> Result<(), FigureError> {
        let mut mesh = self.chart.configure_mesh();
        mesh.disable_x_mesh().disable_axes().bold_line_style(stroked(1.5, GRID));
        Ok(mesh.draw()?)
    }

    /// The horizontal axis line with ticks, tick labels and the label of the axis.
    pub fn draw_x(&mut self, label: &str) -> Result<(), FigureError> {
        let name = |value: &f64| name(&self.ticks[0], *value);
        let mut mesh = self.chart.configure_mesh();
        mesh.disable_mesh()
            .disable_y_axis()
            .axis_style(stroked(1.5, AXIS))
            .set_all_tick_mark_size(fine(TICK_LENGTH))
            .x_label_style(lettering(TICK, Face::Regular, MUTED, Anchor::Middle))
            .x_label_formatter(&name)
            .axis_desc_style(lettering(LABEL, Face::Regular, TEXT, Anchor::Middle))
            .x_desc(label);
        mesh.draw()?;
        // plotters knows no shorter marks for minor ticks.
        let (edge, length) = match self.side {
            LabelAreaPosition::Top => (self.area.top, -0.6 * TICK_LENGTH),
            _ => (self.area.bottom, 0.6 * TICK_LENGTH),
        };
        for tick in self.ticks[0].iter().filter(|tick| tick.label.is_empty()) {
            if let Some(column) = self.column(tick.value) {
                self.sheet.line([[column, edge], [column, edge + length]], 1.5, AXIS)?;
            }
        }
        Ok(())
    }

    /// The line along the bottom of the plot area.
    pub fn draw_x_line(&mut self) -> Result<(), FigureError> {
        let mut mesh = self.chart.configure_mesh();
        mesh.disable_mesh()
            .disable_y_axis()
            .axis_style(stroked(1.5, AXIS))
            .set_all_tick_mark_size(0)
            .x_label_formatter(&|_| String::new());
        Ok(mesh.draw()?)
    }

    /// A bold heading above the plot area, at its left.
    pub fn draw_heading(&self, heading: &str, gap: f64, ink: Ink) -> Result<(), FigureError> {
        let (lines, size) = text::shrink(heading, Face::Bold, HEADING, 18.0, self.area.width());
        let first = self.area.top - gap - (lines.len() - 1) as f64 * size * text::LEADING;
        self.sheet.lines(&lines, [self.area.left, first], size, Face::Bold, ink, Anchor::Start)
    }

    /// A note in the middle of an area that has nothing to show.
    pub fn draw_empty(&self, note: &str) -> Result<(), FigureError> {
        self.sheet.label(note, self.area.centre(), LABEL, Face::Oblique, MUTED, Anchor::Middle)
    }

    /// A line through `points` in order. A point without a place interrupts it.
    pub fn draw_curve(
        &mut self,
        points: impl IntoIterator<Item = [f64; 2]>,
        width: f64,
        ink: Ink,
    ) -> Result<(), FigureError> {
        let mut pieces = vec![Vec::new()];
        for [x, y] in points {
            if self.point(x, y).is_none() {
                pieces.push(Vec::new());
            } else if let Some(piece) = pieces.last_mut() {
                piece.push((x, y));
            }
        }
        for piece in pieces.into_iter().filter(|piece| piece.len() > 1) {
            self.chart.draw_series(LineSeries::new(piece, stroked(width, ink)))?;
        }
        Ok(())
    }

    /// The area between two curves over the same `x`. Points without a place are passed over.
    pub fn draw_band(&self, x: &[f64], low: &[f64], high: &[f64], ink: Ink) -> Result<(), FigureError> {
        let kept = |k: &usize| self.point(x[*k], low[*k]).and(self.point(x[*k], high[*k])).is_some();
        let places: Vec<usize> = (0..x.len()).filter(kept).collect();
        let lower = places.iter().map(|k| (x[*k], low[*k]));
        let upper = places.iter().rev().map(|k| (x[*k], high[*k]));
        let outline: Vec<_> = lower.chain(upper).collect();
        Ok(self.plot().draw(&Polygon::new(outline, filled(ink)))?)
    }

    /// A straight line in dashes of `dash` pixels.
    pub fn draw_dashed(
        &self,
        ends: [(f64, f64); 2],
        dash: f64,
        style: ShapeStyle,
    ) -> Result<(), FigureError> {
        Ok(self.plot().draw(&DashedPathElement::new(ends, fine(dash), fine(dash), style))?)
    }
}

fn name(ticks: &[Tick], value: f64) -> String {
    ticks.iter().find(|tick| tick.value == value).map_or_else(String::new, |tick| tick.label.clone())
}

/// Height of a title with the gap below it, nothing for an empty one. Figures leave room for one line.
pub(super) fn title_height(title: &str) -> f64 {
    if title.is_empty() { 0.0 } else { style::TITLE * text::LEADING + 12.0 }
}

/// The title of a figure at its upper left.
pub(super) fn draw_title(sheet: &Sheet<'_>, title: &str) -> Result<(), FigureError> {
    let (lines, size) = text::fit(title, Face::Bold, style::TITLE, 24.0, sheet.width - 2.0 * style::MARGIN);
    let first = [style::MARGIN, style::MARGIN + text::CAP_HEIGHT * size];
    sheet.lines(&lines, first, size, Face::Bold, TEXT, Anchor::Start)
}

/// Text on a patch of paper, so that what lies behind does not cross it out.
pub(super) fn draw_patched(
    sheet: &Sheet<'_>,
    words: &str,
    [x, y]: [f64; 2],
    anchor: Anchor,
) -> Result<(), FigureError> {
    let wide = text::width(words, Face::Regular, TICK);
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - 0.5 * wide,
        Anchor::End => x - wide,
    };
    let patch =
        Rect { left: left - 4.0, top: y - 0.85 * TICK, right: left + wide + 4.0, bottom: y + 0.3 * TICK };
    sheet.rectangle(patch, style::PAPER.with_alpha(0.9))?;
    sheet.text(words, [x, y], TICK, MUTED, anchor)
}

/// Notes under a figure, at its lower left.
pub(super) fn draw_note(sheet: &Sheet<'_>, note: &str) -> Result<(), FigureError> {
    sheet.label(note, [style::MARGIN, sheet.height - 18.0], TICK, Face::Oblique, MUTED, Anchor::Start)
}
