//! The pilot: damage against impact speed, every seed a point, and the level the speed is chosen by.

use super::axis::{Axis, Scale, Tick};
use super::drawing::{Anchor, Drawing, Rect};
use super::error::{FigureError, same_length};
use super::panel::{Panel, draw_note, draw_patched, draw_title, title_height};
use super::sheet::{Sheet, filled, stroked};
use super::strips::draw_swarm;
use super::style::{self, AXIS, CHART_WIDTH, Ink, LABEL, MARGIN, MARKER, MUTED, TEXT, TICK};
use super::text::{self, Face};
use plotters::chart::LabelAreaPosition;
use plotters::element::{PathElement, Rectangle};

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
    let note = if figure.note.is_empty() { 0.0 } else { TICK + 20.0 };
    let top = MARGIN + title_height(figure.title) + 60.0;
    let width = f64::from(CHART_WIDTH);
    let area = Rect { left: 130.0, top, right: width - MARGIN - 190.0, bottom: top + 560.0 };
    let x = Axis { scale: Scale::Linear, low: 0.0, high: figure.speeds.len() as f64 };
    let values = figure.arms.iter().flat_map(|arm| arm.damage).flat_map(|seeds| seeds.iter()).copied();
    let held = [0.0, figure.target, figure.accepted[1]];
    let y = Axis { low: 0.0, ..Axis::around(Scale::Linear, values.chain(held), 0.04) };
    let tick =
        |(index, speed): (usize, &f64)| Tick { value: index as f64 + 0.5, label: style::number(*speed, 2) };
    let ticks = figure.speeds.iter().enumerate().map(tick).collect();
    Sheet::drawn(width, area.bottom + 100.0 + note, |sheet| {
        draw_title(sheet, figure.title)?;
        let mut panel = Panel::with_ticks(sheet, area, [x, y], ticks, LabelAreaPosition::Bottom)?;
        draw_chosen(sheet, &panel, figure)?;
        panel.draw_y("damage D = 1 \u{2212} M_{1}/M")?;
        panel.draw_x("impact speed [m/s]")?;
        draw_levels(sheet, &panel, figure)?;
        let part = 0.84 / figure.arms.len() as f64;
        for index in 0..figure.speeds.len() {
            for (rank, arm) in figure.arms.iter().enumerate() {
                let shift = (rank as f64 - 0.5 * (figure.arms.len() as f64 - 1.0)) * part;
                let middle = index as f64 + 0.5 + shift;
                draw_seeds(sheet, &panel, arm.damage[index], middle, part, style::category(rank))?;
            }
        }
        draw_legend(sheet, figure, MARGIN + title_height(figure.title))?;
        draw_note(sheet, figure.note)
    })
}

/// A zone behind the speed chosen.
fn draw_chosen(sheet: &Sheet<'_>, panel: &Panel<'_>, figure: &Pilot<'_>) -> Result<(), FigureError> {
    let Some(chosen) = figure.chosen.map(|index| index as f64) else { return Ok(()) };
    let zone = [(chosen, panel.y.low), (chosen + 1.0, panel.y.high)];
    panel.plot().draw(&Rectangle::new(zone, filled(Ink::hex(0xeef1f4))))?;
    let Some(centre) = panel.column(chosen + 0.5) else { return Ok(()) };
    sheet.label("chosen", [centre, panel.area.top - 12.0], TICK, Face::Bold, TEXT, Anchor::Middle)
}

/// The target and the ends of the accepted range as dashed lines, named at the right.
fn draw_levels(sheet: &Sheet<'_>, panel: &Panel<'_>, figure: &Pilot<'_>) -> Result<(), FigureError> {
    let ends = |value: f64| [(panel.x.low, value), (panel.x.high, value)];
    let column = panel.area.right + 14.0;
    let base = |row: f64| [column, row + 0.5 * text::CAP_HEIGHT * TICK];
    for (value, name) in figure.accepted.iter().zip(["accepted from", "accepted to"]) {
        if let Some(row) = panel.row(*value) {
            panel.draw_dashed(ends(*value), 4.0, stroked(1.5, AXIS))?;
            let name = format!("{name} {}", style::number(*value, 2));
            sheet.text(&name, base(row), TICK, MUTED, Anchor::Start)?;
        }
    }
    if let Some(row) = panel.row(figure.target) {
        panel.draw_dashed(ends(figure.target), 9.0, stroked(2.5, MARKER))?;
        let name = format!("target {}", style::number(figure.target, 2));
        draw_patched(sheet, &name, base(row), Anchor::Start)?;
    }
    Ok(())
}

/// The seeds of one arm at one speed round the abscissa `middle`, in a slot `part` wide, with their median.
fn draw_seeds(
    sheet: &Sheet<'_>,
    panel: &Panel<'_>,
    seeds: &[f64],
    middle: f64,
    part: f64,
    ink: Ink,
) -> Result<(), FigureError> {
    let mut seeds: Vec<f64> = seeds.iter().copied().filter(|v| panel.row(*v).is_some()).collect();
    let slot = panel.area.width() / (panel.x.high - panel.x.low);
    draw_swarm(panel, middle, &seeds, 6.5, 0.42 * part * slot, ink.with_alpha(0.7))?;
    seeds.sort_by(f64::total_cmp);
    if let Some(last) = seeds.len().checked_sub(1) {
        let median = 0.5 * (seeds[last / 2] + seeds[last.div_ceil(2)]);
        let ends = [(middle - 0.4 * part, median), (middle + 0.4 * part, median)];
        return Ok(panel.plot().draw(&PathElement::new(ends, stroked(3.5, style::readable(ink))))?);
    }
    let Some(column) = panel.column(middle) else { return Ok(()) };
    let position = [column, panel.area.centre()[1]];
    sheet.label("no data", position, style::SMALLEST, Face::Oblique, MUTED, Anchor::Middle)
}

fn draw_legend(sheet: &Sheet<'_>, figure: &Pilot<'_>, top: f64) -> Result<(), FigureError> {
    let mut x = 130.0;
    for (rank, arm) in figure.arms.iter().enumerate() {
        let ink = style::category(rank);
        sheet.disc([x + 8.0, top + 10.0], 8.0, ink)?;
        let (position, ink) = ([x + 26.0, top + 18.0], style::readable(ink));
        sheet.label(arm.arm, position, LABEL, Face::Bold, ink, Anchor::Start)?;
        x += 26.0 + text::width(arm.arm, Face::Bold, LABEL) + 36.0;
    }
    Ok(())
}
