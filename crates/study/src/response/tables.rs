//! What the surfaces say, as tables.

use super::surface::{LEVEL, Surface};
use crate::table::{Row, Table};

/// Shares of a factor's range at which its response is written.
const STEPS: usize = 9;

/// `response_models`: how well each model predicts points it was not shown.
pub fn models(surfaces: &[Surface]) -> Table {
    let rows = surfaces.iter().flat_map(|surface| {
        let names = ["quadratic", "Gaussian process", "no factor"];
        names.into_iter().zip(surface.skills).map(move |(name, skill)| {
            let mut row = Row::default();
            row.put("arm", "-", "arm", surface.data.arm.as_str())
                .put("response", "-", "what responds", surface.data.metric.words())
                .put("model", "-", "model", name)
                .put(
                    "chosen",
                    "-",
                    "whether predictions are made by it",
                    if name == surface.kind.words() { "yes" } else { "no" },
                )
                .count("points", "points of the box", surface.data.points.len() as u64)
                .number(
                    "score",
                    "of the response",
                    "interval score at 80 %, points left out, mean over balls; the lower, the better",
                    skill.score,
                )
                .number("coverage", "-", "share of the balls in the 80 % interval", skill.coverage)
                .number(
                    "explained",
                    "-",
                    "share of the variance of the points' means that is predicted",
                    skill.explained,
                );
            row
        })
    });
    Table { name: "response_models", rows: rows.collect() }
}

/// `response`: what is predicted of one ball along each factor, the others in the middle of their ranges.
pub fn effects(surfaces: &[Surface]) -> Table {
    let mut rows = Vec::new();
    for surface in surfaces {
        let factors = &surface.data.factors;
        for (k, factor) in factors.iter().enumerate() {
            for step in 0..STEPS {
                let mut at = vec![0.5; factors.len()];
                at[k] = step as f64 / (STEPS - 1) as f64;
                let prediction = surface.predict(&at);
                let interval = prediction.interval(LEVEL);
                let mut row = Row::default();
                row.put("arm", "-", "arm", surface.data.arm.as_str())
                    .put("response", "-", "what responds", surface.data.metric.words())
                    .put(
                        "factor",
                        "-",
                        "factor that is varied, the others in the middle of their ranges",
                        factor.name.as_str(),
                    )
                    .number("number", "of the factor", "its number", factor.at(at[k]))
                    .number("mean", "of the response", "predicted mean", prediction.mean)
                    .number(
                        "lower",
                        "of the response",
                        "lower end of the 80 % interval for one ball",
                        interval.lower,
                    )
                    .number(
                        "upper",
                        "of the response",
                        "upper end of the 80 % interval for one ball",
                        interval.upper,
                    );
                rows.push(row);
            }
        }
    }
    Table { name: "response", rows }
}
