//! Paints a [`Drawing`] with exact pixel coverage. Same drawing, same bytes.

use super::drawing::{Anchor, Drawing, Label, Mark, Rect};
use super::style::{Ink, PAPER};
use super::text;
use ab_glyph::OutlineCurve;
use ab_glyph_rasterizer::{Point, Rasterizer, point};

/// An image: `3 * width * height` bytes, red green blue, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width [pixels].
    pub width: usize,
    /// Height [pixels].
    pub height: usize,
    /// Red, green, blue of each pixel, row by row.
    pub pixels: Vec<u8>,
}

impl Image {
    /// Red, green and blue of a pixel; panics outside the image.
    pub fn pixel(&self, column: usize, row: usize) -> [u8; 3] {
        let start = 3 * (row * self.width + column);
        [self.pixels[start], self.pixels[start + 1], self.pixels[start + 2]]
    }

    fn blend(&mut self, column: usize, row: usize, ink: Ink, coverage: f32) {
        let share = (ink.alpha * coverage).clamp(0.0, 1.0);
        let start = 3 * (row * self.width + column);
        for k in 0..3 {
            let below = f32::from(self.pixels[start + k]);
            self.pixels[start + k] = (below + share * (f32::from(ink.rgb[k]) - below) + 0.5) as u8;
        }
    }
}

impl Drawing {
    /// Paints the marks in order on white paper. Marks with coordinates that are not finite are left out.
    pub fn paint(&self) -> Image {
        let (width, height) = (self.width as usize, self.height as usize);
        let mut image = Image { width, height, pixels: PAPER.rgb.repeat(width * height) };
        for mark in &self.marks {
            match mark {
                Mark::Polygon { points, ink } => fill(&mut image, &edges(points), *ink),
                Mark::Line { points, width, ink } => fill(&mut image, &stroke(points, *width), *ink),
                Mark::Disc { centre, radius, ink } => {
                    let paper = Rect { left: 0.0, top: 0.0, right: width as f64, bottom: height as f64 };
                    disc(&mut image, *centre, *radius, *ink, paper);
                }
                Mark::Splats { points, radius, clip } => {
                    for (centre, ink) in points {
                        disc(&mut image, *centre, *radius, *ink, *clip);
                    }
                }
                Mark::Text(label) => fill(&mut image, &letters(label), label.ink),
            }
        }
        image
    }
}

/// Directed edges of a region; it is filled where they wind round a point.
type Edges = Vec<OutlineCurve>;

fn to_point(p: [f64; 2]) -> Point {
    point(p[0] as f32, p[1] as f32)
}

fn edges(points: &[[f64; 2]]) -> Edges {
    if points.len() < 3 {
        return Edges::new();
    }
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| OutlineCurve::Line(to_point(*a), to_point(*b))).collect()
}

/// A line as the union of one rectangle per segment and one round join per inner point, all winding the same way.
fn stroke(points: &[[f64; 2]], width: f64) -> Edges {
    let half = 0.5 * width;
    let mut region = Edges::new();
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let length = libm::hypot(b[0] - a[0], b[1] - a[1]);
        if length > 0.0 {
            let normal = [-(b[1] - a[1]) / length * half, (b[0] - a[0]) / length * half];
            let side = |p: [f64; 2], s: f64| [p[0] + s * normal[0], p[1] + s * normal[1]];
            region.extend(edges(&[side(a, 1.0), side(a, -1.0), side(b, -1.0), side(b, 1.0)]));
        }
    }
    for corner in points.windows(3).filter(|corner| bends(corner)) {
        let joint = corner[1];
        let rim = |k: usize| {
            let angle = k as f64 * std::f64::consts::TAU / 12.0;
            [joint[0] + half * libm::cos(angle), joint[1] + half * libm::sin(angle)]
        };
        region.extend(edges(&(0..12).map(rim).collect::<Vec<_>>()));
    }
    region
}

/// Whether a line turns by more than about 6 degrees, so that its rectangles leave a visible wedge open.
fn bends(corner: &[[f64; 2]]) -> bool {
    let [a, b, c] = [corner[0], corner[1], corner[2]];
    let [u, v] = [[b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]];
    let lengths = libm::hypot(u[0], u[1]) * libm::hypot(v[0], v[1]);
    u[0] * v[0] + u[1] * v[1] < 0.995 * lengths
}

/// The outlines of a label at its place; the base line lies on a whole pixel, which keeps stems sharp.
fn letters(label: &Label) -> Edges {
    let shift = match label.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => 0.5,
        Anchor::End => 1.0,
    } * text::width(&label.text, label.face, label.size);
    let [x, y] = label.position;
    let map = |p: Point| {
        if label.upwards {
            point((x.round() + f64::from(p.y)) as f32, (y + shift - f64::from(p.x)) as f32)
        } else {
            point((x - shift + f64::from(p.x)) as f32, (y.round() + f64::from(p.y)) as f32)
        }
    };
    let turn = |curve| match curve {
        OutlineCurve::Line(a, b) => OutlineCurve::Line(map(a), map(b)),
        OutlineCurve::Quad(a, b, c) => OutlineCurve::Quad(map(a), map(b), map(c)),
        OutlineCurve::Cubic(a, b, c, d) => OutlineCurve::Cubic(map(a), map(b), map(c), map(d)),
    };
    text::outlines(&label.text, label.face, label.size).into_iter().map(turn).collect()
}

fn corners(curve: &OutlineCurve) -> Vec<Point> {
    match curve {
        OutlineCurve::Line(a, b) => vec![*a, *b],
        OutlineCurve::Quad(a, b, c) => vec![*a, *b, *c],
        OutlineCurve::Cubic(a, b, c, d) => vec![*a, *b, *c, *d],
    }
}

/// Fills a region by the exact area each pixel shares with it.
fn fill(image: &mut Image, region: &Edges, ink: Ink) {
    let all: Vec<Point> = region.iter().flat_map(corners).collect();
    if all.is_empty() || all.iter().any(|p| !p.x.is_finite() || !p.y.is_finite()) {
        return;
    }
    let low = all.iter().fold([f32::MAX; 2], |m, p| [m[0].min(p.x), m[1].min(p.y)]).map(|v| v.floor() - 1.0);
    let high = all.iter().fold([f32::MIN; 2], |m, p| [m[0].max(p.x), m[1].max(p.y)]).map(|v| v.ceil() + 1.0);
    let size = [(high[0] - low[0]) as usize, (high[1] - low[1]) as usize];
    let mut rasterizer = Rasterizer::new(size[0], size[1]);
    let move_to = |p: &Point| point(p.x - low[0], p.y - low[1]);
    for curve in region {
        match curve {
            OutlineCurve::Line(a, b) => rasterizer.draw_line(move_to(a), move_to(b)),
            OutlineCurve::Quad(a, b, c) => rasterizer.draw_quad(move_to(a), move_to(b), move_to(c)),
            OutlineCurve::Cubic(a, b, c, d) => {
                rasterizer.draw_cubic(move_to(a), move_to(b), move_to(c), move_to(d));
            }
        }
    }
    rasterizer.for_each_pixel_2d(|column, row, coverage| {
        let (x, y) = (i64::from(column) + low[0] as i64, i64::from(row) + low[1] as i64);
        let inside = x >= 0 && y >= 0 && x < image.width as i64 && y < image.height as i64;
        if coverage > 0.0 && inside {
            image.blend(x as usize, y as usize, ink, coverage.min(1.0));
        }
    });
}

/// Paints a disc; a pixel is covered by its distance from the rim. Discs under half a pixel keep their area by
/// losing opacity.
fn disc(image: &mut Image, centre: [f64; 2], radius: f64, ink: Ink, clip: Rect) {
    if !(centre[0].is_finite() && centre[1].is_finite() && radius > 0.0) {
        return;
    }
    let drawn = radius.max(0.5);
    let ink = ink.with_alpha(ink.alpha * ((radius / drawn) * (radius / drawn)) as f32);
    let span = |middle: f64, low: f64, high: f64, limit: usize| {
        let first = (middle - drawn - 1.0).floor().max(low.max(0.0));
        let last = (middle + drawn + 1.0).ceil().min(high.min(limit as f64));
        (first as usize, last.max(first) as usize)
    };
    let (first_row, last_row) = span(centre[1], clip.top, clip.bottom, image.height);
    let (first_column, last_column) = span(centre[0], clip.left, clip.right, image.width);
    for row in first_row..last_row {
        for column in first_column..last_column {
            let distance = libm::hypot(column as f64 + 0.5 - centre[0], row as f64 + 0.5 - centre[1]);
            let coverage = (drawn + 0.5 - distance).clamp(0.0, 1.0);
            if coverage > 0.0 {
                image.blend(column, row, ink, coverage as f32);
            }
        }
    }
}
