//! Every kind of figure, drawn from made-up data: sizes, aspect, repeatability, and data that is missing.

use plotters::chart::ChartBuilder;
use plotters::drawing::IntoDrawingArea;
use plotters::element::{Circle, PathElement, Rectangle};
use plotters::series::LineSeries;
use plotters::style::{BLACK, Color, RED, TRANSPARENT};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use snowlab_study::figure::axis::{Axis, Scale};
use snowlab_study::figure::curves::{self, Curve, Curves, Quantity, Spread};
use snowlab_study::figure::drawing::Anchor;
use snowlab_study::figure::energy::{Energy, EnergyCase, energy};
use snowlab_study::figure::forest::{self, Forest, Outcome, Row};
use snowlab_study::figure::pilot::{Pilot, PilotArm, pilot};
use snowlab_study::figure::sizes::{SizeArm, sizes};
use snowlab_study::figure::snowballs::{self, Snapshot, Snowball, Snowballs};
use snowlab_study::figure::strips::{self, Endpoint, Strip, Strips, Summary};
use snowlab_study::figure::style::Ink;
use snowlab_study::figure::{Drawing, FigureError};
use std::path::PathBuf;

/// Keeps a figure under the target directory to be looked at.
fn keep(name: &str, drawing: &Drawing) -> Vec<u8> {
    let bytes = drawing.png();
    assert_eq!(&bytes[1..4], b"PNG");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("figures");
    std::fs::create_dir_all(&folder).expect("the target directory can be written");
    std::fs::write(folder.join(format!("{name}.png")), &bytes).expect("the target directory can be written");
    bytes
}

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
        };
        let after = Snapshot {
            positions: &self.after,
            fragments: &self.broken,
            ln_plastic_volume_ratio: &self.ln_j,
            count: self.count,
            largest_share: 0.4231,
        };
        Snowball { arm: self.arm, spacing: self.spacing, before, after }
    }
}

fn figure<'a>(balls: &'a [Snowball<'a>]) -> Snowballs<'a> {
    Snowballs {
        title: "Four snowballs at 8 m/s, before and after",
        balls,
        floor: 0.0,
        obstacle: &[],
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
    let columns = Snowballs { obstacle: &[[-0.1, 0.0], [0.0, 0.1], [0.1, 0.0]], ..figure(&balls[1..2]) };
    keep("snowball-alone", &snowballs::fragments(&columns).expect("the data is sound"));
}

/// A standard normal number, by the sum of twelve uniform ones.
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0
}

const ARMS: [&str; 12] = [
    "random-5k",
    "random-30k",
    "circles-30k",
    "ellipses-30k-equal-density",
    "jittered-5k",
    "jittered-30k",
    "lattice-5k",
    "lattice-30k",
    "poisson-disk-30k",
    "weight-noise-lattice",
    "stiffness-only",
    "gaussian-field-30k",
];

/// Strips of `cases` values for four endpoints and the first `arms` arms.
fn strip_figure(name: &str, arms: usize, cases: usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let made: Vec<Vec<Vec<f64>>> = (0..4)
        .map(|endpoint| {
            let arm = |arm: usize| -> Vec<f64> {
                let shift = 0.25 * (arm % 4) as f64;
                let value = |rng: &mut ChaCha8Rng| match endpoint {
                    0 => (3.0 + 2.0 * shift + 1.4 * normal(rng)).round().max(1.0),
                    1 => 0.8 + shift + 0.25 * normal(rng),
                    2 => (0.3 + 0.2 * shift + 0.1 * normal(rng)).clamp(0.0, 1.0),
                    _ => (1.0 + shift + 0.3 * normal(rng)).exp(),
                };
                (0..cases).map(|_| value(&mut rng)).collect()
            };
            (0..arms).map(arm).collect()
        })
        .collect();
    let summary = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        let half = 2.0 * spread / (values.len() as f64).sqrt();
        Summary { mean, low: mean - half, high: mean + half }
    };
    let strips_of: Vec<Vec<Strip<'_>>> = made
        .iter()
        .map(|arms| arms.iter().map(|v| Strip { values: v, summary: Some(summary(v)) }).collect())
        .collect();
    let labels = ["fragments N_{f}", "A = ln N_{eff}", "damage D", "crack length [m]"];
    let endpoint = |k: usize| Endpoint { label: labels[k], scale: Scale::Linear, strips: &strips_of[k] };
    let endpoints: Vec<_> = (0..4).map(endpoint).collect();
    let figure = Strips {
        title: "Every seed of the four arms",
        arms: &ARMS[..arms],
        endpoints: &endpoints,
        note: "Points: one case each. Bar: mean with its 95 % interval over blocks.",
    };
    keep(name, &strips::strips(&figure).expect("the data is sound"));
}

#[test]
fn strips_hold_four_and_twelve_arms() {
    strip_figure("strips", 4, 24);
    strip_figure("strips-twelve", 12, 48);
}

fn forest_figure() -> Result<Drawing, FigureError> {
    let row = |claim, contrast, effect: f64, half: f64, verdict, outcome| Row {
        claim,
        contrast,
        effect: Some(effect),
        interval: Some([effect - half, effect + half]),
        verdict,
        outcome,
    };
    let rows = [
        row(
            "coarse-breaks-more",
            "5k \u{2212} 30k, random, h_{0}",
            0.62,
            0.21,
            "supported",
            Outcome::Supported,
        ),
        row(
            "homogenised",
            "slope of A on log_{2} N",
            0.05,
            0.1,
            "refuted (smaller than 1.25\u{d7})",
            Outcome::Refuted,
        ),
        row(
            "circular-voids-finer",
            "V1 \u{2212} S0, circles",
            0.3,
            0.35,
            "inconclusive",
            Outcome::Inconclusive,
        ),
        row(
            "ellipsoidal-voids-finer",
            "V1 \u{2212} S0, ellipses",
            -0.45,
            0.2,
            "refuted (reversed)",
            Outcome::Refuted,
        ),
        Row {
            claim: "stencil-ratio",
            contrast: "range of the arm means over PPC",
            effect: None,
            interval: None,
            verdict: "not-run (7 of 12 blocks)",
            outcome: Outcome::NotRun,
        },
    ];
    forest::forest(&Forest {
        title: "Claims: effect on A = ln N_{eff}",
        label: "difference of A, treated \u{2212} control",
        delta: 1.25_f64.ln(),
        rows: &rows,
        note: "Bars: simultaneous 99 % intervals. Grey zone: effects smaller than a ratio of 1.25.",
    })
}

#[test]
fn forest_shows_claims_with_and_without_effect() {
    let bytes = keep("forest", &forest_figure().expect("the data is sound"));
    let again = forest_figure().expect("the data is sound").png();
    assert!(bytes == again, "the same claims give the same bytes");
}

/// Columns of a made-up curve: x, middle, low, high.
type Columns = [Vec<f64>; 4];

fn bands(arms: usize, x: &[f64], value: impl Fn(usize, f64) -> f64, width: f64) -> Vec<Columns> {
    (0..arms)
        .map(|arm| {
            let middle: Vec<f64> = x.iter().map(|x| value(arm, *x)).collect();
            let low = middle.iter().map(|m| m / width).collect();
            let high = middle.iter().map(|m| m * width).collect();
            [x.to_vec(), middle, low, high]
        })
        .collect()
}

fn as_curves(columns: &[Columns]) -> Vec<Curve<'_>> {
    let curve = |(arm, [x, middle, low, high]): (usize, &'_ Columns)| {
        (arm, x.len(), middle.len(), low.len(), high.len())
    };
    assert!(columns.iter().enumerate().map(curve).all(|(_, x, m, l, h)| x == m && m == l && l == h));
    columns
        .iter()
        .zip(ARMS)
        .map(|([x, middle, low, high], arm)| Curve { arm, x, middle, low, high })
        .collect()
}

fn linking_figure(arms: usize) -> Drawing {
    let links: Vec<f64> = (0..60).map(|k| 0.5 * 8.0_f64.powf(f64::from(k) / 59.0)).collect();
    let number = |arm: usize, link: f64| {
        let plateau = 4.0 + 3.0 * (arm % 4) as f64;
        plateau + 3000.0 * (-(link * (2.0 + 0.6 * (arm % 4) as f64)).powi(2) / 2.0).exp()
    };
    let columns = bands(arms, &links, number, 1.25);
    let curves = as_curves(&columns);
    let quantity = Quantity {
        label: "number of components N",
        scale: Scale::Logarithmic,
        hold: &[1.0],
        level: None,
        curves: &curves,
    };
    curves::curves(&Curves {
        title: "Components against linking length",
        x_label: "link / h",
        x_scale: Scale::Logarithmic,
        mark: Some((2.0, "used: 2 h")),
        spread: Spread::Band,
        note: "Median and 10\u{2013}90 % band over blocks.",
        quantities: &[quantity],
    })
    .expect("the data is sound")
}

fn history_figure(arms: usize) -> Drawing {
    let times: Vec<f64> = (0..100).map(|k| -1.0 + 8.0 * f64::from(k) / 99.0).collect();
    let rise = |arm: usize, t: f64| 1.0 - (-(t.max(0.0)) / (0.6 + 0.4 * (arm % 4) as f64)).exp();
    let count = bands(arms, &times, |arm, t| 1.0 + (3.0 + 4.0 * (arm % 4) as f64) * rise(arm, t), 1.2);
    let share = bands(arms, &times, |arm, t| 1.0 - (0.2 + 0.15 * (arm % 4) as f64) * rise(arm, t), 1.05);
    let (count, share) = (as_curves(&count), as_curves(&share));
    let linear = |label, hold, curves| Quantity { label, scale: Scale::Linear, hold, level: None, curves };
    curves::curves(&Curves {
        title: "Fragments over time",
        x_label: "time after contact [R/v]",
        x_scale: Scale::Linear,
        mark: Some((6.0, "t_{m}")),
        spread: Spread::Band,
        note: "Median and 10\u{2013}90 % band over blocks.",
        quantities: &[
            linear("fragments N_{f}", &[0.0], &count),
            linear("largest share M_{1}/M", &[0.0, 1.0], &share),
        ],
    })
    .expect("the data is sound")
}

#[test]
fn curves_share_a_panel_or_stand_apart() {
    keep("linking", &linking_figure(4));
    keep("linking-twelve", &linking_figure(12));
    keep("history", &history_figure(4));
    keep("history-twelve", &history_figure(12));
}

#[test]
fn sizes_take_the_fragments_of_every_case() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut case = |arm: usize| -> Vec<f64> {
        let mut rest = 1.0_f64;
        let mut shares: Vec<f64> = (0..4 + 8 * arm)
            .map(|_| {
                let share = rest * rng.random_range(0.05..0.6);
                rest -= share;
                share.max(0.002)
            })
            .collect();
        shares.push(rest.max(0.002));
        shares
    };
    let made: Vec<Vec<Vec<f64>>> = (0..4).map(|arm| (0..24).map(|_| case(arm)).collect()).collect();
    let slices: Vec<Vec<&[f64]>> = made.iter().map(|arm| arm.iter().map(Vec::as_slice).collect()).collect();
    let arms: Vec<_> = slices.iter().zip(ARMS).map(|(cases, arm)| SizeArm { arm, cases }).collect();
    keep("sizes", &sizes("Sizes of fragments", &arms).expect("the data is sound"));
}

#[test]
fn trends_show_bars_at_each_setting() {
    let numbers = [5e3, 1e4, 2e4, 3e4];
    let columns = bands(3, &numbers, |arm, n| 1.6 - 0.2 * arm as f64 * (n / 5e3).ln() / 2.0, 1.12);
    let curves = as_curves(&columns);
    let quantity = Quantity {
        label: "A = ln N_{eff}",
        scale: Scale::Linear,
        hold: &[0.0],
        level: Some((0.22, "ln 1.25")),
        curves: &curves,
    };
    let figure = Curves {
        title: "Trend over the number of particles",
        x_label: "number of particles N",
        x_scale: Scale::Logarithmic,
        mark: None,
        spread: Spread::Bars,
        note: "Mean with its 95 % interval over blocks.",
        quantities: &[quantity],
    };
    keep("trend", &curves::curves(&figure).expect("the data is sound"));
}

#[test]
fn energy_stacks_parts() {
    let time: Vec<f64> = (0..80).map(|k| f64::from(k) * 0.09).collect();
    let fall = |t: f64, rate: f64| (-(t - 1.0).max(0.0) * rate).exp();
    let made: Vec<Vec<Vec<f64>>> = (0..4)
        .map(|arm| {
            let rate = 0.7 + 0.2 * f64::from(arm);
            let kinetic: Vec<f64> = time.iter().map(|t| fall(*t, rate)).collect();
            let elastic: Vec<f64> =
                time.iter().map(|t| 0.2 * (fall(*t, rate) - fall(*t, 3.0 * rate))).collect();
            let lost: Vec<f64> = kinetic.iter().zip(&elastic).map(|(k, e)| 1.0 - k - e).collect();
            let part = |share: f64| lost.iter().map(|v| v * share).collect::<Vec<_>>();
            vec![kinetic.clone(), elastic.clone(), part(0.5), part(0.2), part(0.3)]
        })
        .collect();
    let slices: Vec<Vec<&[f64]>> = made.iter().map(|case| case.iter().map(Vec::as_slice).collect()).collect();
    let cases: Vec<_> =
        slices.iter().zip(ARMS).map(|(parts, arm)| EnergyCase { arm, time: &time, parts }).collect();
    let figure = Energy {
        title: "Where the energy of impact goes",
        x_label: "time after contact [R/v]",
        y_label: "share of the energy at contact",
        parts: &["kinetic", "elastic", "lost to plastic flow", "lost to friction", "lost to the transfer"],
        cases: &cases,
        note: "One case per arm (block 1).",
    };
    keep("energy", &energy(&figure).expect("the data is sound"));
}

#[test]
fn pilot_shows_every_seed_at_every_speed() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let speeds = [2.0, 3.0, 5.0, 8.0, 12.0];
    let mut seeds = |speed: f64, arm: usize| -> Vec<f64> {
        (0..6).map(|_| (0.05 * speed + 0.08 * arm as f64 + 0.05 * normal(&mut rng)).clamp(0.0, 1.0)).collect()
    };
    let made: Vec<Vec<Vec<f64>>> =
        (0..2).map(|arm| speeds.iter().map(|s| seeds(*s, arm)).collect()).collect();
    let slices: Vec<Vec<&[f64]>> = made.iter().map(|arm| arm.iter().map(Vec::as_slice).collect()).collect();
    let arms: Vec<_> = slices.iter().zip(ARMS).map(|(damage, arm)| PilotArm { arm, damage }).collect();
    let figure = Pilot {
        title: "Pilot: which speed breaks a quarter off",
        speeds: &speeds,
        arms: &arms,
        target: 0.25,
        accepted: [0.05, 0.6],
        chosen: Some(2),
        note: "Points: six seeds per arm and speed. Short lines: medians.",
    };
    keep("pilot", &pilot(&figure).expect("the data is sound"));
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

#[test]
fn letters_keep_their_left_bearing() {
    // Without its bearing the j of "ij" would start left of where the i ends and touch it.
    let mut drawing = Drawing::new(200.0, 100.0);
    drawing.text("ij", [50.0, 60.0], 40.0, Ink::hex(0), Anchor::Start);
    let image = drawing.paint();
    let dark = |column: usize| (0..100).any(|row| image.pixel(column, row)[0] < 128);
    let columns: Vec<usize> = (0..200).filter(|c| dark(*c)).collect();
    let gaps = columns.windows(2).filter(|pair| pair[1] > pair[0] + 1).count();
    assert_eq!(gaps, 1, "i and j are two separate strokes: {columns:?}");
    assert!(columns[0] > 50, "the i starts after its bearing, not at the origin");
}

#[test]
fn missing_data_leave_a_note_and_contradictions_an_error() {
    let nan = [f64::NAN; 3];
    let none = Snapshot {
        positions: &[],
        fragments: &[],
        ln_plastic_volume_ratio: &[],
        count: 0,
        largest_share: f64::NAN,
    };
    let lost = Snapshot {
        positions: &[[f64::NAN, 1.0]],
        fragments: &[None],
        ln_plastic_volume_ratio: &[f64::NAN],
        ..none
    };
    let balls = [Snowball { arm: "empty", spacing: 0.01, before: none, after: lost }];
    keep("empty-snowballs", &snowballs::fragments(&figure(&balls)).expect("empty is no error"));
    keep("empty-volume", &snowballs::plastic_volume(&figure(&balls)).expect("empty is no error"));
    let short = Snapshot { fragments: &[], ..lost };
    let wrong = [Snowball { arm: "short", spacing: 0.01, before: short, after: none }];
    let error = snowballs::fragments(&figure(&wrong)).expect_err("one position, no label");
    assert!(error.to_string().contains("`fragments` of `short` has 0 values, 1 are needed"), "{error}");
    assert!(matches!(snowballs::fragments(&figure(&[])), Err(FigureError::Nothing { .. })));

    let strip = [Strip { values: &nan, summary: None }, Strip { values: &[1.0], summary: None }];
    let endpoint = [
        Endpoint { label: "D", scale: Scale::Linear, strips: &strip },
        Endpoint { label: "N", scale: Scale::Logarithmic, strips: &[strip[0]; 2] },
    ];
    let figure = Strips { title: "", arms: &["a", "b"], endpoints: &endpoint, note: "" };
    keep("empty-strips", &strips::strips(&figure).expect("values may be missing"));
    let three = Strips { arms: &["a", "b", "c"], ..figure };
    assert!(matches!(strips::strips(&three), Err(FigureError::LengthMismatch { .. })));

    let curve = Curve { arm: "a", x: &[0.0, 1.0, 2.0], middle: &nan, low: &nan, high: &nan };
    let one = Curve { arm: "b", x: &[1.0], middle: &[2.0], low: &[1.0], high: &[3.0] };
    for (name, lines) in [("empty-curves", vec![curve]), ("one-point", vec![one, curve])] {
        let quantity =
            Quantity { label: "y", scale: Scale::Logarithmic, hold: &[], level: None, curves: &lines };
        let figure = Curves {
            title: name,
            x_label: "x",
            x_scale: Scale::Linear,
            mark: None,
            spread: Spread::Band,
            note: "",
            quantities: &[quantity],
        };
        keep(name, &curves::curves(&figure).expect("values may be missing"));
    }
    keep(
        "empty-sizes",
        &sizes("", &[SizeArm { arm: "none", cases: &[&[]] }]).expect("no fragments is no error"),
    );
    let cases = [EnergyCase { arm: "a", time: &[0.0, 1.0, 2.0], parts: &[&nan] }];
    let parts =
        Energy { title: "", x_label: "t", y_label: "E", parts: &["kinetic"], cases: &cases, note: "" };
    keep("empty-energy", &energy(&parts).expect("values may be missing"));
    let arms = [PilotArm { arm: "a", damage: &[&nan] }];
    let speeds = Pilot {
        title: "",
        speeds: &[5.0],
        arms: &arms,
        target: 0.25,
        accepted: [0.05, 0.6],
        chosen: None,
        note: "",
    };
    keep("empty-pilot", &pilot(&speeds).expect("values may be missing"));
}

#[test]
fn ticks_are_round_and_inside() {
    let axis = Axis { scale: Scale::Linear, low: -0.33, high: 0.71 };
    let labels: Vec<String> = axis.ticks(6).into_iter().map(|tick| tick.label).collect();
    assert_eq!(labels, ["\u{2212}0.2", "0.0", "0.2", "0.4", "0.6"]);
    let axis = Axis { scale: Scale::Logarithmic, low: 0.5, high: 2000.0 };
    let labels: Vec<String> =
        axis.ticks(6).into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect();
    assert_eq!(labels, ["1", "10", "100", "1000"]);
    assert_eq!(axis.share(0.0), None, "0 has no place on a logarithmic axis");
    assert!((axis.share(2000.0).expect("its end") - 1.0).abs() < 1e-12);
}

#[test]
fn plotters_draws_on_a_drawing_without_snapping_to_pixels() {
    // The drawing claims to be finer than it is, so that a shape of plotters may end inside a pixel.
    let mut drawing = Drawing::new(20.0, 10.0);
    let area = (&mut drawing).into_drawing_area();
    let fine = (area.dim_in_pixel().0 / 20) as i32;
    assert!(fine >= 16, "{fine} steps to a pixel");
    assert_eq!(area.dim_in_pixel(), (20 * fine as u32, 10 * fine as u32));
    let rectangle = [(2 * fine, 3 * fine), (6 * fine + fine / 2, 7 * fine)];
    area.draw(&Rectangle::new(rectangle, BLACK.filled())).expect("a rectangle");
    area.draw(&Circle::new((14 * fine, 5 * fine), 3 * fine, RED.filled())).expect("a disc");
    area.draw(&PathElement::new(
        [(0, fine / 2), (20 * fine, fine / 2)],
        TRANSPARENT.stroke_width(fine as u32),
    ))
    .expect("nothing");
    drop(area);
    let image = drawing.paint();
    assert_eq!(image.pixel(5, 5), [0; 3], "inside the rectangle");
    assert_eq!(image.pixel(6, 5), [128; 3], "half a pixel at its right edge");
    assert_eq!([image.pixel(7, 5), image.pixel(5, 7), image.pixel(1, 5)], [[255; 3]; 3], "outside");
    assert_eq!(image.pixel(0, 0), [255; 3], "what is transparent leaves nothing");
    let disc: f64 = (10..20)
        .flat_map(|column| (0..10).map(move |row| (column, row)))
        .map(|(column, row)| 1.0 - f64::from(image.pixel(column, row)[1]) / 255.0)
        .sum();
    let area = 9.0 * std::f64::consts::PI;
    assert!((disc - area).abs() < 0.02 * area, "the disc covers {disc} pixels, {area} are asked");
}

#[test]
fn a_chart_of_plotters_lies_where_its_builder_says() {
    // The line from corner to corner of a plot area of 100 by 50 pixels with its lower left corner at (30, 60).
    let mut drawing = Drawing::new(140.0, 80.0);
    let area = (&mut drawing).into_drawing_area();
    let fine = area.dim_in_pixel().0 / 140;
    let x = Axis { scale: Scale::Logarithmic, low: 1.0, high: 100.0 };
    let y = Axis { scale: Scale::Linear, low: -1.0, high: 1.0 };
    let mut chart = ChartBuilder::on(&area)
        .margin_left(30 * fine)
        .margin_right(10 * fine)
        .margin_top(10 * fine)
        .margin_bottom(20 * fine)
        .build_cartesian_2d(x, y)
        .expect("a chart");
    let points = [(1.0, -1.0), (10.0, 0.0), (100.0, 1.0)];
    chart.draw_series(LineSeries::new(points, BLACK.stroke_width(2 * fine))).expect("a line");
    let middle = chart.backend_coord(&(10.0, 0.0));
    let exact = (80 * fine as i32, 35 * fine as i32);
    assert!((middle.0 - exact.0).abs() <= 1 && (middle.1 - exact.1).abs() <= 1, "{middle:?}, not {exact:?}");
    drop(chart);
    drop(area);
    let image = drawing.paint();
    let dark = |column: usize, row: usize| image.pixel(column, row)[0] < 128;
    assert!(dark(79, 35) && dark(31, 59) && dark(128, 10), "the line goes from corner to corner");
    assert!(!dark(79, 40) && !dark(20, 62) && !dark(133, 8), "and nowhere else");
}
