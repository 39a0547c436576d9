//! Runs side by side, in sync: the particles of each at one moment.

use super::axis::{Axis, Scale};
use super::drawing::{Anchor, Drawing, Label, Mark, Rect};
use super::style::{self, Ink, MUTED, TEXT};
use super::text::Face;
use super::window::{window, within};

/// A moment of a run, in the plane of the picture.
#[derive(Clone, Debug, Default)]
pub struct Moment {
    /// Positions [m] and colours in the order in which they are painted.
    pub particles: Vec<([f64; 2], Ink)>,
    /// Outlines of the obstacles [m], painted before the particles.
    pub obstacles: Vec<(Vec<[f64; 2]>, Ink)>,
    /// Said below the panel, such as `12 fragments`.
    pub caption: String,
}

/// A run.
#[derive(Clone, Debug)]
pub struct Track {
    /// Its name, above the panel.
    pub name: String,
    /// Between particles at rest [m].
    pub spacing: f64,
    /// Its moments.
    pub moments: Vec<Moment>,
}

/// Runs that are shown together.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    /// The runs, of as many moments each.
    pub tracks: &'a [Track],
    /// What each moment is called, such as `6.0 R/v after contact`.
    pub times: &'a [String],
    /// Width [pixels].
    pub width: u32,
    /// Panels beside each other.
    pub columns: usize,
}

/// Radius of a splat over the spacing (as in [`super::snowballs`]).
const SPLAT: f64 = 0.62;
const GAP: f64 = 10.0;
const HEAD: f64 = 22.0;
const FOOT: f64 = 20.0;
const CLOCK: f64 = 24.0;
const SIZE: f64 = 13.0;
/// Most height of a panel over its width (as in [`super::snowballs`]).
const TALLEST: f64 = 1.2;
/// Room about what is seen, over its width.
const PAD: f64 = 0.04;

/// One drawing a moment; all panels show the same part of space, in which all moments of all runs lie. None without particles.
pub fn drawings(moving: &Moving<'_>) -> Vec<Drawing> {
    let moments = moving.tracks.iter().flat_map(|track| &track.moments);
    let seen: Vec<Vec<[f64; 2]>> = moments.map(|m| m.particles.iter().map(|(x, _)| *x).collect()).collect();
    let Some((low, high)) = window(&seen) else { return Vec::new() };
    let columns = moving.columns.clamp(1, moving.tracks.len().max(1));
    let rows = moving.tracks.len().div_ceil(columns);
    let panel = ((f64::from(moving.width) - GAP * (columns as f64 + 1.0)) / columns as f64).floor();
    let pad = PAD * (high[0] - low[0]).max(high[1] - low[1]);
    let scale = panel / (high[0] - low[0] + 2.0 * pad);
    // A little of the floor is seen.
    let corner = [low[0] - pad, low[1] - 2.0 * pad];
    let tall = ((high[1] + pad - corner[1]) * scale).ceil().min(TALLEST * panel);
    let height = (CLOCK + rows as f64 * (HEAD + tall + FOOT) + GAP).ceil() as u32;
    let count = moving.tracks.iter().map(|track| track.moments.len()).min().unwrap_or(0);
    let area = |k: usize| {
        let left = GAP + (k % columns) as f64 * (panel + GAP);
        let top = CLOCK + HEAD + (k / columns) as f64 * (HEAD + tall + FOOT);
        Rect { left, top, right: left + panel, bottom: top + tall }
    };
    let draw = |number: usize| {
        let mut marks = Vec::new();
        for (k, track) in moving.tracks.iter().enumerate() {
            let area = area(k);
            let pixel = |x: [f64; 2]| {
                [area.left + (x[0] - corner[0]) * scale, area.bottom - (x[1] - corner[1]) * scale]
            };
            let moment = &track.moments[number];
            for (outline, ink) in &moment.obstacles {
                let clipped = clip(&outline.iter().map(|x| pixel(*x)).collect::<Vec<_>>(), &area);
                marks.push(Mark::Polygon { points: clipped, ink: *ink });
            }
            let points = moment.particles.iter().map(|(x, ink)| (pixel(*x), *ink)).collect();
            marks.push(Mark::Splats { points, radius: (SPLAT * track.spacing * scale).max(0.5), clip: area });
            let text = |text: &str, y: f64, face: Face, ink: Ink| {
                let (text, position) = (text.to_string(), [area.left, y]);
                Mark::Text(Label {
                    text,
                    position,
                    size: SIZE,
                    face,
                    ink,
                    anchor: Anchor::Start,
                    upwards: false,
                })
            };
            marks.push(text(&track.name, area.top - 6.0, Face::Bold, TEXT));
            marks.push(text(&moment.caption, area.bottom + 14.0, Face::Regular, MUTED));
        }
        let position = [f64::from(moving.width) - GAP, 16.0];
        let text = moving.times.get(number).cloned().unwrap_or_default();
        let clock = Label {
            text,
            position,
            size: SIZE,
            face: Face::Regular,
            ink: MUTED,
            anchor: Anchor::End,
            upwards: false,
        };
        marks.push(Mark::Text(clock));
        Drawing { width: moving.width, height, marks }
    };
    (0..count).map(draw).collect()
}

/// The part of a polygon in a rectangle (Sutherland & Hodgman 1974).
fn clip(polygon: &[[f64; 2]], area: &Rect) -> Vec<[f64; 2]> {
    let axes = [[area.left, area.right], [area.top, area.bottom]].map(|[low, high]| Axis {
        scale: Scale::Linear,
        low,
        high,
    });
    within(&axes, polygon).into_iter().map(|(x, y)| [x, y]).collect()
}

/// The colour of a particle of the fragment of rank `rank`, 0 being the heaviest; of dust without one. `depth` from 0, before all, to 1 makes it darker.
pub fn ink(rank: Option<u32>, depth: f64) -> Ink {
    let ink = rank.map_or(style::DUST, |rank| style::category(rank as usize));
    let dim = 1.0 - 0.6 * depth.clamp(0.0, 1.0);
    Ink { rgb: ink.rgb.map(|channel| (f64::from(channel) * dim).round() as u8), alpha: ink.alpha }
}
