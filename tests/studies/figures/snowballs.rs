//! Snowballs before and after: their width, and that what is round is drawn round.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use snowlab_study::figure::Drawing;
use snowlab_study::figure::snowballs::{self, Snapshot, Snowball, Snowballs};

use super::keep;

/// A ball and a heap made from it: fragments are angular sectors thrown apart, the outermost shell is dust.
struct Ball {
    arm: &'static str,
    spacing: f64,
    before: [Vec<[f64; 2]>; 1],
    after: Vec<[f64; 2]>,
    whole: Vec<Option<u32>>,
    broken: Vec<Option<u32>>,
    at_rest: Vec<f64>,
    ln_j: Vec<f64>,
    count: usize,
    obstacles: Vec<Vec<[f64; 2]>>,
}

fn ball(arm: &'static str, number: usize, count: u32, seed: u64) -> Ball {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (radius, centre) = (0.25, [0.0, 0.3]);
    let (mut before, mut after, mut broken, mut ln_j) = (vec![], vec![], vec![], vec![]);
    while before.len() < number {
        let p = [rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0_f64)];
        let r = p[0].hypot(p[1]);
        if r > 1.0 {
            continue;
        }
        before.push([centre[0] + radius * p[0], centre[1] + radius * p[1]]);
        let angle = (p[1].atan2(p[0]) / std::f64::consts::TAU + 0.5).clamp(0.0, 0.9999);
        let piece = ((angle * angle) * f64::from(count)) as u32;
        let dust = r > 0.985;
        let away = (f64::from(piece) / f64::from(count) - 0.5) * 0.9;
        let throw = if dust { 1.6 } else { 1.0 };
        after.push([throw * (away + 0.22 * p[0]), (0.16 + 0.16 * p[1] * throw + 0.05 * away * away).abs()]);
        broken.push(if dust { None } else { Some(count - 1 - piece) });
        ln_j.push(-0.5 * (1.0 - r) + if (angle * f64::from(count)).fract() < 0.12 { 0.9 } else { 0.0 });
    }
    let spacing = (std::f64::consts::PI * radius * radius / number as f64).sqrt();
    Ball {
        arm,
        spacing,
        whole: vec![Some(0); number],
        at_rest: vec![0.0; number],
        before: [before],
        after,
        broken,
        ln_j,
        count: count as usize,
        obstacles: vec![vec![[-9.0, 0.0], [9.0, 0.0], [9.0, -9.0], [-9.0, -9.0]]],
    }
}

impl Ball {
    fn columns(&self) -> Snowball<'_> {
        let before = Snapshot {
            positions: &self.before[0],
            fragments: &self.whole,
            ln_plastic_volume_ratio: &self.at_rest,
            count: 1,
            largest_share: 1.0,
            obstacles: &self.obstacles,
        };
        let after = Snapshot {
            positions: &self.after,
            fragments: &self.broken,
            ln_plastic_volume_ratio: &self.ln_j,
            count: self.count,
            largest_share: 0.4231,
            obstacles: &self.obstacles,
        };
        Snowball { arm: self.arm, spacing: self.spacing, before, after }
    }
}

pub fn figure<'a>(balls: &'a [Snowball<'a>]) -> Snowballs<'a> {
    Snowballs {
        title: "Four snowballs at 8 m/s, before and after",
        balls,
        rows: ["before", "after 6 R/v"],
        width: 1800,
    }
}

#[test]
fn snowballs_fill_the_asked_width() {
    let made = [
        ball("random-5k", 5_000, 9, 1),
        ball("random-30k", 30_000, 4, 2),
        ball("circles-30k", 30_000, 12, 3),
        ball("ellipses-30k-equal-density", 30_000, 17, 4),
    ];
    let balls: Vec<_> = made.iter().map(Ball::columns).collect();
    let drawing = snowballs::fragments(&figure(&balls)).expect("the data is sound");
    assert_eq!(drawing.width, 1800);
    keep("snowballs", &drawing);
    keep("plastic-volume", &snowballs::plastic_volume(&figure(&balls)).expect("the data is sound"));
    let mut on_a_wedge = ball("random-30k", 30_000, 4, 2);
    on_a_wedge.obstacles.push(vec![[-0.1, 0.0], [0.0, 0.1], [0.1, 0.0]]);
    let alone = [on_a_wedge.columns()];
    keep("snowball-alone", &snowballs::fragments(&figure(&alone)).expect("the data is sound"));
}

/// Rows and columns in which an image differs from paper-like tones, as lowest and highest index.
fn extent(drawing: &Drawing, rgb: [u8; 3]) -> [[usize; 2]; 2] {
    let image = drawing.paint();
    let mut found = [[usize::MAX, 0]; 2];
    for row in 0..image.height {
        for column in 0..image.width {
            if image.pixel(column, row) == rgb {
                for (k, place) in [column, row].into_iter().enumerate() {
                    found[k] = [found[k][0].min(place), found[k][1].max(place)];
                }
            }
        }
    }
    found
}

#[test]
fn a_circle_of_particles_is_round_in_pixels() {
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / 2000.0;
    let positions: Vec<_> = (0..2000).map(|k| [0.2 * angle(k).cos(), 0.5 + 0.2 * angle(k).sin()]).collect();
    // Pink is the sixth colour; the key below the panels shows it too, so the key is cut off.
    let snapshot = Snapshot {
        positions: &positions,
        fragments: &vec![Some(5); positions.len()],
        ln_plastic_volume_ratio: &vec![0.0; positions.len()],
        count: 1,
        largest_share: 1.0,
        obstacles: &[],
    };
    let wide: Vec<_> = positions.iter().map(|p| [3.0 * p[0], 0.4 * p[1]]).collect();
    let after = Snapshot { positions: &wide, fragments: &vec![Some(0); wide.len()], ..snapshot };
    let balls = [Snowball { arm: "ring", spacing: 0.005, before: snapshot, after }];
    let mut drawing = snowballs::fragments(&Snowballs { width: 1111, ..figure(&balls) }).expect("sound data");
    drawing.height -= 60;
    let [columns, rows] = extent(&drawing, [0xcc, 0x79, 0xa7]);
    let (wide, high) = (columns[1] - columns[0], rows[1] - rows[0]);
    assert!(wide > 200, "the ring is {wide} pixels wide");
    assert!(wide.abs_diff(high) <= 1, "the ring is {wide} by {high} pixels");
}
