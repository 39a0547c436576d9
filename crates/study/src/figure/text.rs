//! Text: the embedded fonts, its width, its outlines, and lines broken to fit.
//!
//! The fonts are those of the `dejavu` crate, so that a figure is the same on a machine without fonts. Markup:
//! `_{…}` lowers and `^{…}` raises what the braces hold; nothing else is special, so a name may hold `_` or `^`.

use ab_glyph::{Font, FontRef, OutlineCurve, Point};
use std::sync::LazyLock;

/// Weight and slant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Upright.
    Regular,
    /// Upright, bold.
    Bold,
    /// Slanted, for notes.
    Oblique,
}

static REGULAR: LazyLock<FontRef<'static>> = LazyLock::new(|| embedded(dejavu::sans_condensed::regular()));
static BOLD: LazyLock<FontRef<'static>> = LazyLock::new(|| embedded(dejavu::sans_condensed::bold()));
static OBLIQUE: LazyLock<FontRef<'static>> = LazyLock::new(|| embedded(dejavu::sans_condensed::oblique()));

fn embedded(bytes: &'static [u8]) -> FontRef<'static> {
    FontRef::try_from_slice(bytes).expect("the embedded font is a valid TrueType file")
}

fn font(face: Face) -> &'static FontRef<'static> {
    match face {
        Face::Regular => &REGULAR,
        Face::Bold => &BOLD,
        Face::Oblique => &OBLIQUE,
    }
}

/// Height of a capital letter over the size (DejaVu Sans: 1493 of 2048 units).
pub const CAP_HEIGHT: f64 = 0.729;
/// Distance of base lines over the size (chosen: text of two or three lines reads as one block).
pub const LEADING: f64 = 1.22;
/// Size of raised and lowered text over the size (chosen, as TeX does at 10 pt).
const SCRIPT: f64 = 0.72;

/// A stretch of text on one base line.
pub(super) struct Run<'a> {
    /// The characters.
    pub text: &'a str,
    /// Size over the size of the whole.
    pub scale: f64,
    /// Shift downwards over the size of the whole.
    pub lower: f64,
}

/// Splits `_{…}` and `^{…}` from the rest. A brace that is not closed is taken as it stands.
pub(super) fn runs(text: &str) -> Vec<Run<'_>> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(start) = [rest.find("_{"), rest.find("^{")].into_iter().flatten().min() {
        let Some(length) = rest[start + 2..].find('}') else { break };
        found.push(Run { text: &rest[..start], scale: 1.0, lower: 0.0 });
        let lower = if rest[start..].starts_with('_') { 0.2 } else { -0.36 };
        found.push(Run { text: &rest[start + 2..start + 2 + length], scale: SCRIPT, lower });
        rest = &rest[start + 3 + length..];
    }
    found.push(Run { text: rest, scale: 1.0, lower: 0.0 });
    found
}

/// Width of a line of text [pixels] at `size` pixels per em.
pub fn width(text: &str, face: Face, size: f64) -> f64 {
    let mut end = 0.0;
    place(text, face, size, |_, x, _, advance| end = x + advance);
    end
}

/// Calls `each(glyph, x, run, advance)` for every glyph of a line that starts at x = 0.
fn place(text: &str, face: Face, size: f64, mut each: impl FnMut(ab_glyph::GlyphId, f64, &Run<'_>, f64)) {
    let font = font(face);
    let unit = size / f64::from(font.units_per_em().unwrap_or(2048.0));
    let mut x = 0.0;
    for run in runs(text) {
        let mut previous = None;
        for character in run.text.chars() {
            let glyph = font.glyph_id(character);
            if let Some(before) = previous {
                x += f64::from(font.kern_unscaled(before, glyph)) * unit * run.scale;
            }
            let advance = f64::from(font.h_advance_unscaled(glyph)) * unit * run.scale;
            each(glyph, x, &run, advance);
            x += advance;
            previous = Some(glyph);
        }
    }
}

/// The outlines of a line of text whose base line starts at the origin; x to the right and y down [pixels]. Left
/// bearings are kept: they are part of the outline's coordinates.
pub(super) fn outlines(text: &str, face: Face, size: f64) -> Vec<OutlineCurve> {
    let font = font(face);
    let unit = size / f64::from(font.units_per_em().unwrap_or(2048.0));
    let mut curves = Vec::new();
    place(text, face, size, |glyph, x, run, _| {
        let Some(outline) = font.outline(glyph) else { return };
        let map = |p: Point| Point {
            x: (x + f64::from(p.x) * unit * run.scale) as f32,
            y: (run.lower * size - f64::from(p.y) * unit * run.scale) as f32,
        };
        curves.extend(outline.curves.into_iter().map(|curve| match curve {
            OutlineCurve::Line(a, b) => OutlineCurve::Line(map(a), map(b)),
            OutlineCurve::Quad(a, b, c) => OutlineCurve::Quad(map(a), map(b), map(c)),
            OutlineCurve::Cubic(a, b, c, d) => OutlineCurve::Cubic(map(a), map(b), map(c), map(d)),
        }));
    });
    curves
}

/// Breaks a text into lines no wider than `limit` pixels, after spaces and hyphens; a piece which is too wide by
/// itself is left whole. At least one line.
pub fn wrap(text: &str, face: Face, size: f64, limit: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for piece in text.split_inclusive([' ', '-', '/']) {
        let last = lines.last_mut().expect("there is always a last line");
        let joined = format!("{last}{piece}");
        if last.is_empty() || width(joined.trim_end(), face, size) <= limit {
            *last = joined;
        } else {
            lines.push(piece.to_owned());
        }
    }
    lines.iter().map(|line| line.trim_end().to_owned()).collect()
}

/// A name on one line at the largest size from `size` down to `smallest` at which it fits `limit` pixels; broken as
/// [`wrap`] does if none does. Returns the lines and the size.
pub fn shrink(text: &str, face: Face, size: f64, smallest: f64, limit: f64) -> (Vec<String>, f64) {
    let fitting = size * limit / width(text, face, size).max(1e-9);
    if fitting >= smallest {
        return (vec![text.to_owned()], fitting.min(size));
    }
    (wrap(text, face, smallest, limit), smallest)
}

/// Breaks a name to fit `limit` pixels, at the largest size from `size` down to `smallest` at which every line fits.
/// Returns the lines and the size.
pub fn fit(text: &str, face: Face, size: f64, smallest: f64, limit: f64) -> (Vec<String>, f64) {
    let mut current = size;
    loop {
        let lines = wrap(text, face, current, limit);
        if current <= smallest || lines.iter().all(|line| width(line, face, current) <= limit) {
            return (lines, current);
        }
        current = (current - 1.0).max(smallest);
    }
}
