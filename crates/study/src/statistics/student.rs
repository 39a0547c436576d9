//! Studentised (t) limits of a mean: mean -+ t * s/sqrt n.

use super::distributions::student_t_quantile;
use super::{Interval, mean, standard_deviation};

/// Two-sided t interval of the mean at `confidence` in (0, 1); `None` for fewer than two values.
pub fn t_interval(values: &[f64], confidence: f64) -> Option<Interval> {
    let (centre, half_width) = centre_and_half_width(values, 0.5 + 0.5 * confidence)?;
    Some(Interval { lower: centre - half_width, upper: centre + half_width })
}

/// One-sided lower t bound of the mean at `confidence` in (0, 1); `None` for fewer than two values.
pub fn t_lower_bound(values: &[f64], confidence: f64) -> Option<f64> {
    centre_and_half_width(values, confidence).map(|(centre, half_width)| centre - half_width)
}

/// One-sided upper t bound of the mean at `confidence` in (0, 1); `None` for fewer than two values.
pub fn t_upper_bound(values: &[f64], confidence: f64) -> Option<f64> {
    centre_and_half_width(values, confidence).map(|(centre, half_width)| centre + half_width)
}

fn centre_and_half_width(values: &[f64], probability: f64) -> Option<(f64, f64)> {
    let spread = standard_deviation(values)?;
    let count = values.len() as f64;
    Some((mean(values)?, student_t_quantile(probability, count - 1.0) * spread / count.sqrt()))
}
