//! How well predictions do.

use super::data::Data;
use super::surface::{LEVEL, Prediction};
use crate::statistics::{Interval, mean};

/// The interval score (Gneiting & Raftery 2007, J. Am. Stat. Assoc. 102, 359, eq. 43): the interval's width, and 2/alpha times how far the value lies
/// outside. The lower, the better.
pub fn interval_score(interval: Interval, value: f64, level: f64) -> f64 {
    let outside = (interval.lower - value).max(value - interval.upper).max(0.0);
    interval.upper - interval.lower + 2.0 / (1.0 - level) * outside
}

/// How a model predicts points it was not shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skill {
    /// Mean interval score over all balls.
    pub score: f64,
    /// Share of the balls in the interval.
    pub coverage: f64,
    /// 1 - sum of squared errors of the points' means over that about their mean.
    pub explained: f64,
}

impl Skill {
    /// Of one prediction for each point.
    pub fn of(data: &Data, predictions: &[Prediction]) -> Self {
        let pairs = || {
            let both = data.points.iter().zip(predictions);
            both.flat_map(|(point, prediction)| {
                point.values.iter().map(move |value| (prediction.interval(LEVEL), *value))
            })
        };
        let balls = pairs().count().max(1) as f64;
        let inside = pairs().filter(|(interval, value)| interval.contains(*value)).count();
        let means: Vec<f64> = data.points.iter().map(|point| point.mean()).collect();
        let centre = mean(&means).unwrap_or(f64::NAN);
        let errors = means.iter().zip(predictions).map(|(m, p)| (m - p.mean).powi(2)).sum::<f64>();
        let about = means.iter().map(|m| (m - centre).powi(2)).sum::<f64>();
        Skill {
            score: pairs().map(|(interval, value)| interval_score(interval, value, LEVEL)).sum::<f64>()
                / balls,
            coverage: inside as f64 / balls,
            explained: 1.0 - errors / about,
        }
    }
}
