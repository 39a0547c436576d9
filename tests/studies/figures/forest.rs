//! Claims as effects with their intervals.

use snowlab_study::figure::forest::{self, Forest, Outcome, Row};
use snowlab_study::figure::{Drawing, FigureError};

use super::keep;

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
