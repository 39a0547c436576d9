//! Curves with bands, in one panel or in one for each arm, and with bars.

use snowlab_study::figure::Drawing;
use snowlab_study::figure::axis::Scale;
use snowlab_study::figure::curves::{self, Curve, Curves, Quantity, Spread};

use super::{ARMS, keep};

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
        guides: &[],
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
    let linear = |label, hold, curves| Quantity {
        label,
        scale: Scale::Linear,
        hold,
        level: None,
        guides: &[],
        curves,
    };
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
fn trends_show_bars_at_each_setting() {
    let numbers = [5e3, 1e4, 2e4, 3e4];
    let columns = bands(3, &numbers, |arm, n| 1.6 - 0.2 * arm as f64 * (n / 5e3).ln() / 2.0, 1.12);
    let curves = as_curves(&columns);
    let quantity = Quantity {
        label: "A = ln N_{eff}",
        scale: Scale::Linear,
        hold: &[0.0],
        level: Some((0.22, "ln 1.25")),
        guides: &[],
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
