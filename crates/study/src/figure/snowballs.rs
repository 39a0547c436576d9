//! The snowballs before and after impact: one column per arm, the state at rest above the state measured, all
//! panels at one scale of pixels per metre.

use super::axis::{Axis, Scale};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::{FigureError, same_length};
use super::panel::{Panel, draw_title, title_height};
use super::sheet::Sheet;
use super::solids::{draw_solids, foot};
use super::splats::Splats;
use super::style::{self, DUST, HEADING, Ink, LABEL, MUTED, TEXT, TICK};
use super::text::{self, Face};
use super::window::{in_fragments, inside, window};
use plotters::chart::LabelAreaPosition;

/// Particles at one time.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a> {
    /// Positions [m].
    pub positions: &'a [[f64; 2]],
    /// Rank of the fragment each particle belongs to, 0 for the heaviest; `None` for dust.
    pub fragments: &'a [Option<u32>],
    /// ln J_P of each particle.
    pub ln_plastic_volume_ratio: &'a [f64],
    /// Number of fragments.
    pub count: usize,
    /// Mass of the heaviest fragment over the mass of the case.
    pub largest_share: f64,
    /// Outlines of the obstacles [m]; a floor is a rectangle that reaches far beyond the particles.
    pub obstacles: &'a [Vec<[f64; 2]>],
}

/// One arm: the ball before and after.
#[derive(Clone, Copy, Debug)]
pub struct Snowball<'a> {
    /// Name of the arm.
    pub arm: &'a str,
    /// Mean spacing of the particles at rest [m]: the square root of area over number.
    pub spacing: f64,
    /// At rest.
    pub before: Snapshot<'a>,
    /// When measured.
    pub after: Snapshot<'a>,
}

/// The grid of panels.
#[derive(Clone, Copy, Debug)]
pub struct Snowballs<'a> {
    /// Title, may be empty.
    pub title: &'a str,
    /// One column each.
    pub balls: &'a [Snowball<'a>],
    /// Names of the two rows, such as `before` and `6 R/v after contact`.
    pub rows: [&'a str; 2],
    /// Width of the figure [pixels]; 1800 keeps four arms of 30,000 particles legible.
    pub width: u32,
}

/// Radius of a splat over the mean spacing (chosen: neighbours on a square lattice just overlap).
pub(super) const SPLAT: f64 = 0.62;
/// Arms beside each other; more arms start a new pair of rows (chosen: 30,000 particles stay legible).
const PER_LINE: usize = 4;
/// Most height of a panel over its width (chosen: a lone piece thrown high must not stretch the page).
const TALLEST: f64 = 1.6;
const GAP: f64 = 26.0;
const ROW_LABEL: f64 = 46.0;

/// Every particle in the colour of its fragment, dust in grey; count and largest share are printed with each panel.
///
/// # Errors
/// [`FigureError`] if no ball is given, a column has the wrong length, or a spacing is not above 0.
pub fn fragments(figure: &Snowballs<'_>) -> Result<Drawing, FigureError> {
    let layout = Layout::new(figure, 2.0 * TICK * text::LEADING + 20.0, 40.0)?;
    layout.drawn(figure, |sheet| {
        for (column, ball) in figure.balls.iter().enumerate() {
            for (row, snapshot) in [ball.before, ball.after].iter().enumerate() {
                let ink =
                    |k: usize| snapshot.fragments[k].map_or(DUST, |rank| style::category(rank as usize));
                // Dust first, then from the heaviest fragment to the lightest, so that small pieces are seen.
                let order = |k: usize| snapshot.fragments[k].map_or(0, |rank| u64::from(rank) + 1);
                let panel = layout.panel(sheet, [column, row])?;
                layout.splats(&panel, ball.spacing, snapshot, &ink, &order)?;
                layout.caption(sheet, [column, row], snapshot)?;
                draw_solids(&panel, snapshot.obstacles)?;
            }
        }
        layout.length_bar(sheet, 30.0)?;
        layout.fragment_key(sheet)
    })
}

/// Every particle coloured by ln J_P, with one colour bar for all panels: blue where snow is compacted, orange where
/// it has opened. The bar ends at the 98 % quantile of |ln J_P| over all panels; values beyond take the end colour.
///
/// # Errors
/// As [`fragments`].
pub fn plastic_volume(figure: &Snowballs<'_>) -> Result<Drawing, FigureError> {
    let layout = Layout::new(figure, 20.0, 92.0)?;
    let all = figure.balls.iter().flat_map(|ball| [ball.before, ball.after]);
    let mut sizes: Vec<f64> = all
        .flat_map(|snapshot| snapshot.ln_plastic_volume_ratio.iter())
        .map(|value| value.abs())
        .filter(|value| value.is_finite())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let end = sizes.get(sizes.len() * 98 / 100).copied().unwrap_or(0.0);
    let end = (end * 20.0).ceil().max(1.0) / 20.0;
    layout.drawn(figure, |sheet| {
        for (column, ball) in figure.balls.iter().enumerate() {
            for (row, snapshot) in [ball.before, ball.after].iter().enumerate() {
                let values = snapshot.ln_plastic_volume_ratio;
                let ink = |k: usize| style::diverging(values[k] / end);
                let order = |k: usize| (values[k].abs() * 1e6) as u64;
                let panel = layout.panel(sheet, [column, row])?;
                layout.splats(&panel, ball.spacing, snapshot, &ink, &order)?;
                draw_solids(&panel, snapshot.obstacles)?;
            }
        }
        layout.length_bar(sheet, 74.0)?;
        layout.colour_bar(sheet, end)
    })
}

/// Where the panels lie and which part of space they show.
struct Layout {
    /// Pixels per metre, the same in both directions and in all panels.
    scale: f64,
    /// Lower left corner of what each row shows [m].
    corner: [[f64; 2]; 2],
    /// Plot areas of the two rows in the first column.
    rows: [Rect; 2],
    /// Distance from column to column, and from one pair of rows to the next [pixels].
    pitch: [f64; 2],
    size: [f64; 2],
}

impl Layout {
    fn new(figure: &Snowballs<'_>, captions: f64, key: f64) -> Result<Self, FigureError> {
        if figure.balls.is_empty() {
            return Err(FigureError::Nothing { what: "snowball" });
        }
        for ball in figure.balls {
            if !(ball.spacing > 0.0 && ball.spacing.is_finite()) {
                return Err(FigureError::NotPositive { what: "spacing", value: ball.spacing });
            }
            for snapshot in [ball.before, ball.after] {
                let positions = ("positions", snapshot.positions.len());
                same_length(ball.arm, positions, ("fragments", snapshot.fragments.len()))?;
                let values = snapshot.ln_plastic_volume_ratio.len();
                same_length(ball.arm, positions, ("ln_plastic_volume_ratio", values))?;
            }
        }
        let rows = [0, 1].map(|row| {
            let of = |ball: &Snowball<'_>| in_fragments(&[ball.before, ball.after][row]);
            window(&figure.balls.iter().map(of).collect::<Vec<_>>())
        });
        let seen = || rows.iter().flatten();
        let spacing = figure.balls.iter().map(|ball| ball.spacing).fold(0.0, f64::max);
        let low = seen().map(|(low, _)| low[0]).fold(f64::INFINITY, f64::min);
        let high = seen().map(|(_, high)| high[0]).fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = if low < high { (low, high) } else { (-50.0 * spacing, 50.0 * spacing) };
        let columns = figure.balls.len().min(PER_LINE) as f64;
        let width = f64::from(figure.width);
        let panel = ((width - 2.0 * style::MARGIN - ROW_LABEL - (columns - 1.0) * GAP) / columns).floor();
        let pad = 0.04 * (high - low);
        let scale = panel / (high - low + 2.0 * pad);
        let heading = |ball: &Snowball<'_>| text::shrink(ball.arm, Face::Bold, HEADING, 18.0, panel).0.len();
        let lines = figure.balls.iter().map(heading).max().unwrap_or(1);
        let names = lines as f64 * HEADING * text::LEADING + 12.0;
        let start = style::MARGIN + title_height(figure.title);
        let mut top = start + names;
        let mut areas = Vec::new();
        let mut corners = Vec::new();
        for (row, row_window) in rows.into_iter().enumerate() {
            // A row without particles shows some empty space.
            let (row_low, row_high) = row_window.unwrap_or(([low, 0.0], [high, 0.3 * (high - low)]));
            let solids = figure.balls.iter().flat_map(|ball| [ball.before, ball.after][row].obstacles);
            let bottom = foot(solids, [low, high], row_low[1]) - 2.0 * pad;
            let height = ((row_high[1] + pad - bottom) * scale).ceil().min(TALLEST * panel);
            let left = style::MARGIN + ROW_LABEL;
            areas.push(Rect { left, top, right: left + panel, bottom: top + height });
            corners.push([low - pad, bottom]);
            top += height + captions;
        }
        let pitch = [panel + GAP, top - start + 14.0];
        let size = [width, start + figure.balls.len().div_ceil(PER_LINE) as f64 * pitch[1] + key];
        let (rows, corner) = ([areas[0], areas[1]], [corners[0], corners[1]]);
        Ok(Self { scale, corner, rows, pitch, size })
    }

    fn area(&self, [column, row]: [usize; 2]) -> Rect {
        let Rect { left, top, right, bottom } = self.rows[row];
        let x = (column % PER_LINE) as f64 * self.pitch[0];
        let y = (column / PER_LINE) as f64 * self.pitch[1];
        Rect { left: left + x, top: top + y, right: right + x, bottom: bottom + y }
    }

    /// The axes of a row [m]: those of a panel at one scale in both directions.
    fn axes(&self, row: usize) -> [Axis; 2] {
        let (area, [x, y]) = (self.rows[row], self.corner[row]);
        let axis =
            |low: f64, pixels: f64| Axis { scale: Scale::Linear, low, high: low + pixels / self.scale };
        [axis(x, area.width()), axis(y, area.height())]
    }

    /// The chart of a panel.
    fn panel<'d>(&self, sheet: &Sheet<'d>, [column, row]: [usize; 2]) -> Result<Panel<'d>, FigureError> {
        let [x, y] = self.axes(row);
        Panel::new(sheet, self.area([column, row]), x, y)
    }

    /// A drawing with titles, names of arms and rows, the paper of the panels, and what `draw` adds.
    fn drawn(
        &self,
        figure: &Snowballs<'_>,
        draw: impl FnOnce(&Sheet<'_>) -> Result<(), FigureError>,
    ) -> Result<Drawing, FigureError> {
        Sheet::drawn(self.size[0], self.size[1], |sheet| {
            draw_title(sheet, figure.title)?;
            for (column, ball) in figure.balls.iter().enumerate() {
                if column % PER_LINE == 0 {
                    for (row, name) in figure.rows.iter().enumerate() {
                        let middle = self.area([column, row]).centre()[1];
                        sheet.upwards(name, [style::MARGIN + LABEL, middle], LABEL, TEXT)?;
                    }
                }
                self.panel(sheet, [column, 0])?.draw_heading(ball.arm, 16.0, TEXT)?;
                for row in 0..2 {
                    sheet.rectangle(self.area([column, row]), Ink::hex(0xf6f7f9))?;
                }
            }
            draw(sheet)
        })
    }

    fn splats(
        &self,
        panel: &Panel<'_>,
        spacing: f64,
        snapshot: &Snapshot<'_>,
        ink: &dyn Fn(usize) -> Ink,
        order: &dyn Fn(usize) -> u64,
    ) -> Result<(), FigureError> {
        let positions = snapshot.positions;
        if !positions.iter().any(|p| p.iter().all(|v| v.is_finite())) {
            let note = if positions.is_empty() { "no particles" } else { "no finite positions" };
            return panel.draw_empty(note);
        }
        let axes = [panel.x, panel.y];
        let mut shown: Vec<usize> = (0..positions.len()).filter(|k| inside(&axes, positions[*k])).collect();
        shown.sort_by_key(|k| (order(*k), *k));
        Ok(panel.plot().draw(&Splats {
            centres: shown.iter().map(|k| positions[*k].into()).collect(),
            inks: shown.into_iter().map(ink).collect(),
            radius: SPLAT * spacing * self.scale,
            clip: panel.area,
        })?)
    }

    /// Number of fragments and largest share below a panel and, where there are any, the particles out of view.
    fn caption(
        &self,
        sheet: &Sheet<'_>,
        [column, row]: [usize; 2],
        snapshot: &Snapshot<'_>,
    ) -> Result<(), FigureError> {
        let area = self.area([column, row]);
        let noun = if snapshot.count == 1 { "fragment" } else { "fragments" };
        let mut lines = vec![format!("{} {noun}", snapshot.count)];
        if snapshot.largest_share.is_finite() {
            lines[0] += &format!(", largest {} %", style::number(100.0 * snapshot.largest_share, 1));
        }
        let outside = snapshot.positions.iter().filter(|p| !inside(&self.axes(row), **p)).count();
        let share = 100.0 * outside as f64 / snapshot.positions.len().max(1) as f64;
        if share > 0.0 {
            lines.push(format!("{} % of the particles out of view", style::number(share.max(0.01), 2)));
        }
        for (row, line) in lines.iter().enumerate() {
            let (line, size) = text::shrink(line, Face::Regular, TICK, 12.0, area.width());
            let position = [area.left, area.bottom + 6.0 + TICK + row as f64 * TICK * text::LEADING];
            sheet.text(&line.join(" "), position, size, MUTED, Anchor::Start)?;
        }
        Ok(())
    }

    fn length_bar(&self, sheet: &Sheet<'_>, key: f64) -> Result<(), FigureError> {
        let wide = self.rows[0].width() / self.scale * 0.3;
        let power = libm::pow(10.0, libm::floor(libm::log10(wide)));
        let length = [5.0, 2.0, 1.0].map(|f| f * power).into_iter().find(|l| *l <= wide).unwrap_or(power);
        let right = self.size[0] - style::MARGIN;
        let (left, y) = (right - length * self.scale, self.size[1] - key);
        sheet.line([[left, y], [right, y]], 3.0, TEXT)?;
        for end in [left, right] {
            sheet.line([[end, y - 6.0], [end, y + 6.0]], 2.0, TEXT)?;
        }
        let label = match length {
            l if l < 0.01 => format!("{} mm", style::number(1000.0 * l, 2)),
            l if l < 1.0 => format!("{} cm", style::number(100.0 * l, 2)),
            l => format!("{} m", style::number(l, 2)),
        };
        sheet.text(&label, [left - 12.0, y + 0.5 * text::CAP_HEIGHT * TICK], TICK, TEXT, Anchor::End)
    }

    fn fragment_key(&self, sheet: &Sheet<'_>) -> Result<(), FigureError> {
        let y = self.size[1] - 30.0;
        let mut x = self.rows[0].left;
        for rank in 0..style::OKABE_ITO.len() {
            sheet.disc([x + 8.0, y], 8.0, style::category(rank))?;
            x += 22.0;
        }
        let base = y + 0.5 * text::CAP_HEIGHT * TICK;
        let words = "fragments, heaviest first (colours repeat)";
        sheet.text(words, [x + 6.0, base], TICK, MUTED, Anchor::Start)?;
        x += 6.0 + text::width(words, Face::Regular, TICK) + 34.0;
        sheet.disc([x + 8.0, y], 8.0, DUST)?;
        sheet.text("dust", [x + 24.0, base], TICK, MUTED, Anchor::Start)
    }

    fn colour_bar(&self, sheet: &Sheet<'_>, end: f64) -> Result<(), FigureError> {
        let width = (0.42 * self.size[0]).floor();
        let left = self.rows[0].left + 16.0;
        let area = Rect { left, top: self.size[1] - 88.0, right: left + width, bottom: self.size[1] - 60.0 };
        let steps = width as usize;
        for step in 0..steps {
            let t = 2.0 * (step as f64 + 0.5) / steps as f64 - 1.0;
            let x = area.left + step as f64;
            sheet.rectangle(Rect { left: x, right: x + 1.0, ..area }, style::diverging(t))?;
        }
        let middle = area.centre()[1];
        for (x, out, t) in [(area.left, -16.0, -1.0), (area.right, 16.0, 1.0)] {
            let triangle = [[x, area.top], [x + out, middle], [x, area.bottom]];
            sheet.polygon(&triangle, style::diverging(t))?;
        }
        let x = Axis { scale: Scale::Linear, low: -end, high: end };
        let y = Axis { scale: Scale::Linear, low: 0.0, high: 1.0 };
        let side = LabelAreaPosition::Bottom;
        Panel::with_ticks(sheet, area, [x, y], x.ticks(11), side)?.draw_x("")?;
        let base = middle + 0.5 * text::CAP_HEIGHT * LABEL;
        sheet.text("ln J_{P}", [area.right + 34.0, base], LABEL, TEXT, Anchor::Start)?;
        let words = "compacted below 0, opened above";
        sheet.text(words, [area.right + 120.0, base], TICK, MUTED, Anchor::Start)
    }
}
