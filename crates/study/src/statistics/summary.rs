use serde::Serialize;

use super::{Interval, mean, quantile, standard_deviation, t_interval};

/// One row of a summary table: an arm's values of one endpoint, all in that endpoint's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Number of values.
    pub count: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Sample standard deviation; `None` for a single value.
    pub standard_deviation: Option<f64>,
    /// Two-sided t interval of the mean; `None` for a single value.
    pub interval: Option<Interval>,
    /// Smallest value.
    pub minimum: f64,
    /// Quantile at 0.25.
    pub lower_quartile: f64,
    /// Median.
    pub median: f64,
    /// Quantile at 0.75.
    pub upper_quartile: f64,
    /// Largest value.
    pub maximum: f64,
}

/// Summary of the values of an arm with the mean's t interval at `confidence` in (0, 1); `None` for no values.
pub fn summarise(values: &[f64], confidence: f64) -> Option<Summary> {
    Some(Summary {
        count: values.len(),
        mean: mean(values)?,
        standard_deviation: standard_deviation(values),
        interval: t_interval(values, confidence),
        minimum: quantile(values, 0.0)?,
        lower_quartile: quantile(values, 0.25)?,
        median: quantile(values, 0.5)?,
        upper_quartile: quantile(values, 0.75)?,
        maximum: quantile(values, 1.0)?,
    })
}
