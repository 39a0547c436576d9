//! The snowballs before and after impact: one column per arm, the state at rest above the state measured, all
//! panels at one scale of pixels per metre.

use super::drawing::{Anchor, Drawing, Mark, Rect};
use super::error::{FigureError, same_length};
use super::panel::draw_title;
use super::style::{self, AXIS, DUST, HEADING, Ink, LABEL, MUTED, TEXT, TICK};
use super::text::{self, Face};

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
    /// Height of the floor [m].
    pub floor: f64,
    /// Outline of an obstacle on the floor [m], such as a wedge; may be empty.
    pub obstacle: &'a [[f64; 2]],
    /// Names of the two rows, such as `before` and `6 R/v after contact`.
    pub rows: [&'a str; 2],
    /// Width of the figure [pixels]; 1800 keeps four arms of 30,000 particles legible.
    pub width: u32,
}

/// Radius of a splat over the mean spacing (chosen: neighbours on a square lattice just overlap).
const SPLAT: f64 = 0.62;
/// Share of the particles in fragments that may lie outside the window on each side (chosen: as for dust).
const OUTSIDE: f64 = 0.0005;
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
    let mut drawing = layout.frame(figure);
    for (column, ball) in figure.balls.iter().enumerate() {
        for (row, snapshot) in [ball.before, ball.after].iter().enumerate() {
            let ink = |k: usize| snapshot.fragments[k].map_or(DUST, |rank| style::category(rank as usize));
            // Dust first, then from the heaviest fragment to the lightest, so that small pieces are seen.
            let order = |k: usize| snapshot.fragments[k].map_or(0, |rank| u64::from(rank) + 1);
            layout.splats(&mut drawing, [column, row], ball.spacing, snapshot, &ink, &order);
            layout.caption(&mut drawing, [column, row], snapshot);
        }
    }
    layout.foreground(&mut drawing, figure);
    layout.length_bar(&mut drawing, 30.0);
    layout.fragment_key(&mut drawing);
    Ok(drawing)
}

/// Every particle coloured by ln J_P, with one colour bar for all panels: blue where snow is compacted, orange where
/// it has opened. The bar ends at the 98 % quantile of |ln J_P| over all panels; values beyond take the end colour.
///
/// # Errors
/// As [`fragments`].
pub fn plastic_volume(figure: &Snowballs<'_>) -> Result<Drawing, FigureError> {
    let layout = Layout::new(figure, 20.0, 92.0)?;
    let mut drawing = layout.frame(figure);
    let all = figure.balls.iter().flat_map(|ball| [ball.before, ball.after]);
    let mut sizes: Vec<f64> = all
        .flat_map(|snapshot| snapshot.ln_plastic_volume_ratio.iter())
        .map(|value| value.abs())
        .filter(|value| value.is_finite())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let end = sizes.get(sizes.len() * 98 / 100).copied().unwrap_or(0.0);
    let end = (end * 20.0).ceil().max(1.0) / 20.0;
    for (column, ball) in figure.balls.iter().enumerate() {
        for (row, snapshot) in [ball.before, ball.after].iter().enumerate() {
            let values = snapshot.ln_plastic_volume_ratio;
            let ink = |k: usize| style::diverging(values[k] / end);
            let order = |k: usize| (values[k].abs() * 1e6) as u64;
            layout.splats(&mut drawing, [column, row], ball.spacing, snapshot, &ink, &order);
        }
    }
    layout.foreground(&mut drawing, figure);
    layout.length_bar(&mut drawing, 74.0);
    layout.colour_bar(&mut drawing, end);
    Ok(drawing)
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
        let title = if figure.title.is_empty() { 0.0 } else { style::TITLE * text::LEADING + 12.0 };
        let heading = |ball: &Snowball<'_>| text::shrink(ball.arm, Face::Bold, HEADING, 18.0, panel).0.len();
        let lines = figure.balls.iter().map(heading).max().unwrap_or(1);
        let names = lines as f64 * HEADING * text::LEADING + 12.0;
        let start = style::MARGIN + title;
        let mut top = start + names;
        let mut areas = Vec::new();
        let mut corners = Vec::new();
        for row in rows {
            // A row without particles shows the floor alone.
            let empty = ([low, figure.floor], [high, figure.floor + 0.3 * (high - low)]);
            let (row_low, row_high) = row.unwrap_or(empty);
            let bottom = row_low[1].min(figure.floor) - 2.0 * pad;
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

    fn place(&self, panel: [usize; 2], [x, y]: [f64; 2]) -> [f64; 2] {
        let (area, corner) = (self.area(panel), self.corner[panel[1]]);
        [area.left + (x - corner[0]) * self.scale, area.bottom - (y - corner[1]) * self.scale]
    }

    /// Titles, names of arms and rows, and the paper of the panels.
    fn frame(&self, figure: &Snowballs<'_>) -> Drawing {
        let mut drawing = Drawing::new(self.size[0], self.size[1]);
        draw_title(&mut drawing, figure.title);
        for (column, ball) in figure.balls.iter().enumerate() {
            let area = self.area([column, 0]);
            if column % PER_LINE == 0 {
                for (row, name) in figure.rows.iter().enumerate() {
                    let middle = self.area([column, row]).centre()[1];
                    drawing.upwards(name, [style::MARGIN + LABEL, middle], LABEL, TEXT);
                }
            }
            let (lines, size) = text::shrink(ball.arm, Face::Bold, HEADING, 18.0, area.width());
            let first = area.top - 16.0 - (lines.len() - 1) as f64 * size * text::LEADING;
            for (row, line) in lines.iter().enumerate() {
                let position = [area.left, first + row as f64 * size * text::LEADING];
                drawing.label(line, position, size, Face::Bold, TEXT, Anchor::Start);
            }
            for row in 0..2 {
                drawing.rectangle(self.area([column, row]), Ink::hex(0xf6f7f9));
            }
        }
        drawing
    }

    fn splats(
        &self,
        drawing: &mut Drawing,
        panel: [usize; 2],
        spacing: f64,
        snapshot: &Snapshot<'_>,
        ink: &dyn Fn(usize) -> Ink,
        order: &dyn Fn(usize) -> u64,
    ) {
        let area = self.area(panel);
        let positions = snapshot.positions;
        let mut shown: Vec<usize> =
            (0..positions.len()).filter(|k| positions[*k].iter().all(|v| v.is_finite())).collect();
        if shown.is_empty() {
            let note = if positions.is_empty() { "no particles" } else { "no finite positions" };
            drawing.label(note, area.centre(), TICK, Face::Oblique, MUTED, Anchor::Middle);
            return;
        }
        shown.sort_by_key(|k| (order(*k), *k));
        let points = shown.into_iter().map(|k| (self.place(panel, positions[k]), ink(k))).collect();
        drawing.marks.push(Mark::Splats { points, radius: SPLAT * spacing * self.scale, clip: area });
    }

    /// Number of particles whose centre lies outside the panel.
    fn outside(&self, panel: [usize; 2], snapshot: &Snapshot<'_>) -> usize {
        let Rect { left, top, right, bottom } = self.area(panel);
        let inside = |[x, y]: [f64; 2]| x >= left && x <= right && y >= top && y <= bottom;
        snapshot.positions.iter().filter(|p| !inside(self.place(panel, **p))).count()
    }

    /// Number of fragments and largest share below a panel and, where there are any, the particles out of view.
    fn caption(&self, drawing: &mut Drawing, panel: [usize; 2], snapshot: &Snapshot<'_>) {
        let area = self.area(panel);
        let noun = if snapshot.count == 1 { "fragment" } else { "fragments" };
        let mut lines = vec![format!("{} {noun}", snapshot.count)];
        if snapshot.largest_share.is_finite() {
            lines[0] += &format!(", largest {} %", style::number(100.0 * snapshot.largest_share, 1));
        }
        let share = 100.0 * self.outside(panel, snapshot) as f64 / snapshot.positions.len().max(1) as f64;
        if share > 0.0 {
            lines.push(format!("{} % of the particles out of view", style::number(share.max(0.01), 2)));
        }
        for (row, line) in lines.iter().enumerate() {
            let (line, size) = text::shrink(line, Face::Regular, TICK, 12.0, area.width());
            let position = [area.left, area.bottom + 6.0 + TICK + row as f64 * TICK * text::LEADING];
            drawing.text(&line.join(" "), position, size, MUTED, Anchor::Start);
        }
    }

    /// The floor and the obstacle in every panel.
    fn foreground(&self, drawing: &mut Drawing, figure: &Snowballs<'_>) {
        for column in 0..figure.balls.len() {
            for row in 0..2 {
                let panel = [column, row];
                let area = self.area(panel);
                let level = self.place(panel, [0.0, figure.floor])[1];
                drawing.rectangle(Rect { top: level, ..area }, Ink::hex(0xdfe3e7));
                drawing.line(vec![[area.left, level], [area.right, level]], 2.5, TEXT);
                let outline: Vec<_> = figure.obstacle.iter().map(|p| self.place(panel, *p)).collect();
                drawing.polygon(outline, Ink::hex(0x7d8791));
            }
        }
    }

    fn length_bar(&self, drawing: &mut Drawing, key: f64) {
        let wide = self.rows[0].width() / self.scale * 0.3;
        let power = libm::pow(10.0, libm::floor(libm::log10(wide)));
        let length = [5.0, 2.0, 1.0].map(|f| f * power).into_iter().find(|l| *l <= wide).unwrap_or(power);
        let right = self.size[0] - style::MARGIN;
        let (left, y) = (right - length * self.scale, self.size[1] - key);
        drawing.line(vec![[left, y], [right, y]], 3.0, TEXT);
        for end in [left, right] {
            drawing.line(vec![[end, y - 6.0], [end, y + 6.0]], 2.0, TEXT);
        }
        let label = match length {
            l if l < 0.01 => format!("{} mm", style::number(1000.0 * l, 2)),
            l if l < 1.0 => format!("{} cm", style::number(100.0 * l, 2)),
            l => format!("{} m", style::number(l, 2)),
        };
        drawing.text(&label, [left - 12.0, y + 0.5 * text::CAP_HEIGHT * TICK], TICK, TEXT, Anchor::End);
    }

    fn fragment_key(&self, drawing: &mut Drawing) {
        let y = self.size[1] - 30.0;
        let mut x = self.rows[0].left;
        for rank in 0..style::OKABE_ITO.len() {
            drawing.disc([x + 8.0, y], 8.0, style::category(rank), None);
            x += 22.0;
        }
        let base = y + 0.5 * text::CAP_HEIGHT * TICK;
        let words = "fragments, heaviest first (colours repeat)";
        drawing.text(words, [x + 6.0, base], TICK, MUTED, Anchor::Start);
        x += 6.0 + text::width(words, Face::Regular, TICK) + 34.0;
        drawing.disc([x + 8.0, y], 8.0, DUST, None);
        drawing.text("dust", [x + 24.0, base], TICK, MUTED, Anchor::Start);
    }

    fn colour_bar(&self, drawing: &mut Drawing, end: f64) {
        let width = (0.42 * self.size[0]).floor();
        let left = self.rows[0].left + 16.0;
        let area = Rect { left, top: self.size[1] - 88.0, right: left + width, bottom: self.size[1] - 60.0 };
        let steps = width as usize;
        for step in 0..steps {
            let t = 2.0 * (step as f64 + 0.5) / steps as f64 - 1.0;
            let x = area.left + step as f64;
            drawing.rectangle(Rect { left: x, right: x + 1.0, ..area }, style::diverging(t));
        }
        let middle = area.centre()[1];
        for (x, out, t) in [(area.left, -16.0, -1.0), (area.right, 16.0, 1.0)] {
            let triangle = vec![[x, area.top], [x + out, middle], [x, area.bottom]];
            drawing.polygon(triangle, style::diverging(t));
        }
        let axis = super::axis::Axis { scale: super::axis::Scale::Linear, low: -end, high: end };
        for tick in axis.ticks(11) {
            let x = area.left + axis.share(tick.value).unwrap_or(0.0) * width;
            drawing.line(vec![[x, area.bottom], [x, area.bottom + 7.0]], 1.5, AXIS);
            drawing.text(&tick.label, [x, area.bottom + 10.0 + TICK], TICK, MUTED, Anchor::Middle);
        }
        let base = middle + 0.5 * text::CAP_HEIGHT * LABEL;
        drawing.text("ln J_{P}", [area.right + 34.0, base], LABEL, TEXT, Anchor::Start);
        let words = "compacted below 0, opened above";
        drawing.text(words, [area.right + 120.0, base], TICK, MUTED, Anchor::Start);
    }
}

/// Positions of the particles that belong to fragments; of all particles if none does. Specks of dust fly far and
/// must not shrink the rest.
fn in_fragments(snapshot: &Snapshot<'_>) -> Vec<[f64; 2]> {
    let paired = snapshot.positions.iter().zip(snapshot.fragments);
    let kept: Vec<_> = paired.filter(|(_, rank)| rank.is_some()).map(|(p, _)| *p).collect();
    if kept.is_empty() { snapshot.positions.to_vec() } else { kept }
}

/// Lower left and upper right corner of a box round all but [`OUTSIDE`] of each list of points; `None` without any.
fn window(lists: &[Vec<[f64; 2]>]) -> Option<([f64; 2], [f64; 2])> {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for list in lists {
        for axis in 0..2 {
            let mut values: Vec<f64> = list.iter().map(|p| p[axis]).filter(|v| v.is_finite()).collect();
            values.sort_by(f64::total_cmp);
            let Some(last) = values.len().checked_sub(1) else { continue };
            let cut = (OUTSIDE * values.len() as f64) as usize;
            low[axis] = low[axis].min(values[cut]);
            high[axis] = high[axis].max(values[last - cut]);
        }
    }
    (low[0] <= high[0] && low[1] <= high[1]).then_some((low, high))
}
