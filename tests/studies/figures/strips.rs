//! Every case of every arm, as points with their mean.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use snowlab_study::figure::axis::Scale;
use snowlab_study::figure::strips::{self, Endpoint, Strip, Strips, Summary};

use super::{ARMS, keep, normal};

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
    let endpoint =
        |k: usize| Endpoint { label: labels[k], scale: Scale::Linear, hold: &[], strips: &strips_of[k] };
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
