//! The pilot: damage against impact speed, every seed a point, and the level the speed is chosen by.

use super::axis::{Axis, Scale};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::{FigureError, same_length};
use super::panel::{Panel, draw_note, draw_patched, draw_title};
use super::strips::swarm;
use super::style::{self, AXIS, CHART_WIDTH, Ink, LABEL, MARGIN, MARKER, MUTED, TEXT, TICK};
use super::text::{self, Face};

/// One arm of the pilot.
#[derive(Clone, Copy, Debug)]
pub struct PilotArm<'a> {
    /// Name of the arm.
    pub arm: &'a str,
    /// For every speed of the figure the damage of each seed.
    pub damage: &'a [&'a [f64]],
}

/// The figure.
#[derive(Clone, Copy, Debug)]
pub struct Pilot<'a> {
    /// Title, may be empty.
    pub title: &'a str,
    /// Impact speeds [m/s], ascending; they stand at even distances.
    pub speeds: &'a [f64],
    /// The arms.
    pub arms: &'a [PilotArm<'a>],
    /// The damage aimed at.
    pub target: f64,
    /// The range of damage in which a speed is acceptable.
    pub accepted: [f64; 2],
    /// Index of the speed chosen, if one was.
    pub chosen: Option<usize>,
    /// Printed below the figure; may be empty.
    pub note: &'a str,
}

/// Draws the figure; see [`Pilot`]. A short line in the colour of the arm is its median.
///
/// # Errors
/// [`FigureError`] if there is no speed or arm, or an arm has not one list per speed.
pub fn pilot(figure: &Pilot<'_>) -> Result<Drawing, FigureError> {
    if figure.speeds.is_empty() {
        return Err(FigureError::Nothing { what: "speed" });
    }
    if figure.arms.is_empty() {
        return Err(FigureError::Nothing { what: "arm" });
    }
    for arm in figure.arms {
        same_length(arm.arm, ("speeds", figure.speeds.len()), ("damage", arm.damage.len()))?;
    }
    let title = if figure.title.is_empty() { 0.0 } else { style::TITLE * text::LEADING + 12.0 };
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 20.0 };
    let top = MARGIN + title + 60.0;
    let width = f64::from(CHART_WIDTH);
    let mut drawing = Drawing::new(width, top + 560.0 + 100.0 + note);
    draw_title(&mut drawing, figure.title);
    let area = Rect { left: 130.0, top, right: width - MARGIN - 190.0, bottom: top + 560.0 };
    let x = Axis { scale: Scale::Linear, low: 0.0, high: figure.speeds.len() as f64 };
    let values = figure.arms.iter().flat_map(|arm| arm.damage).flat_map(|seeds| seeds.iter()).copied();
    let held = [0.0, figure.target, figure.accepted[1]];
    let y = Axis { low: 0.0, ..Axis::around(Scale::Linear, values.chain(held), 0.04) };
    let panel = Panel { area, x, y };
    draw_chosen(&mut drawing, &panel, figure);
    panel.draw_y(&mut drawing, "damage D = 1 \u{2212} M_{1}/M");
    panel.draw_x_line(&mut drawing);
    draw_levels(&mut drawing, &panel, figure);
    let slot = area.width() / figure.speeds.len() as f64;
    for (index, speed) in figure.speeds.iter().enumerate() {
        let centre = area.left + (index as f64 + 0.5) * slot;
        let chosen = figure.chosen == Some(index);
        let name = style::number(*speed, 2);
        let face = if chosen { Face::Bold } else { Face::Regular };
        let ink = if chosen { TEXT } else { MUTED };
        drawing.line(vec![[centre, area.bottom], [centre, area.bottom + 7.0]], 1.5, AXIS);
        drawing.label(&name, [centre, area.bottom + 12.0 + TICK], TICK, face, ink, Anchor::Middle);
        if chosen {
            let position = [centre, area.top - 12.0];
            drawing.label("chosen", position, TICK, Face::Bold, TEXT, Anchor::Middle);
        }
        let part = 0.84 * slot / figure.arms.len() as f64;
        for (rank, arm) in figure.arms.iter().enumerate() {
            let middle = centre + (rank as f64 - 0.5 * (figure.arms.len() as f64 - 1.0)) * part;
            draw_seeds(&mut drawing, &panel, arm.damage[index], middle, part, style::category(rank));
        }
    }
    let below = area.bottom + 12.0 + TICK + 14.0 + LABEL;
    drawing.text("impact speed [m/s]", [area.centre()[0], below], LABEL, TEXT, Anchor::Middle);
    draw_legend(&mut drawing, figure, MARGIN + title);
    draw_note(&mut drawing, figure.note);
    Ok(drawing)
}

/// A zone behind the speed chosen.
fn draw_chosen(drawing: &mut Drawing, panel: &Panel, figure: &Pilot<'_>) {
    let area = panel.area;
    if let Some(chosen) = figure.chosen {
        let slot = area.width() / figure.speeds.len() as f64;
        let left = area.left + chosen as f64 * slot;
        drawing.rectangle(Rect { left, right: left + slot, ..area }, Ink::hex(0xeef1f4));
    }
}

/// The target and the ends of the accepted range as dashed lines, named at the right.
fn draw_levels(drawing: &mut Drawing, panel: &Panel, figure: &Pilot<'_>) {
    let area = panel.area;
    let column = area.right + 14.0;
    for (value, name) in figure.accepted.iter().zip(["accepted from", "accepted to"]) {
        if let Some(row) = panel.row(*value) {
            drawing.dashed([area.left, row], [area.right, row], 1.5, AXIS, 4.0);
            let name = format!("{name} {}", style::number(*value, 2));
            drawing.text(&name, [column, row + 0.5 * text::CAP_HEIGHT * TICK], TICK, MUTED, Anchor::Start);
        }
    }
    if let Some(row) = panel.row(figure.target) {
        drawing.dashed([area.left, row], [area.right, row], 2.5, MARKER, 9.0);
        let name = format!("target {}", style::number(figure.target, 2));
        draw_patched(drawing, &name, [column, row + 0.5 * text::CAP_HEIGHT * TICK], Anchor::Start);
    }
}

fn draw_seeds(drawing: &mut Drawing, panel: &Panel, seeds: &[f64], middle: f64, part: f64, ink: Ink) {
    let mut rows: Vec<f64> = seeds.iter().filter_map(|v| panel.row(*v)).collect();
    for [x, row] in swarm(middle, &rows, 6.5, 0.42 * part).0 {
        drawing.disc([x, row], 6.5, ink.with_alpha(0.7), None);
    }
    rows.sort_by(f64::total_cmp);
    if let Some(last) = rows.len().checked_sub(1) {
        let median = 0.5 * (rows[last / 2] + rows[last.div_ceil(2)]);
        let half = 0.4 * part;
        drawing.line(vec![[middle - half, median], [middle + half, median]], 3.5, style::readable(ink));
    } else {
        let position = [middle, panel.area.centre()[1]];
        drawing.label("no data", position, 16.0, Face::Oblique, MUTED, Anchor::Middle);
    }
}

fn draw_legend(drawing: &mut Drawing, figure: &Pilot<'_>, top: f64) {
    let mut x = 130.0;
    for (rank, arm) in figure.arms.iter().enumerate() {
        let ink = style::category(rank);
        drawing.disc([x + 8.0, top + 10.0], 8.0, ink, None);
        drawing.label(
            arm.arm,
            [x + 26.0, top + 18.0],
            LABEL,
            Face::Bold,
            style::readable(ink),
            Anchor::Start,
        );
        x += 26.0 + text::width(arm.arm, Face::Bold, LABEL) + 36.0;
    }
}
