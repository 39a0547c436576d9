/// Arithmetic mean; `None` for no values.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Sample standard deviation with divisor n - 1; `None` for fewer than two values.
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    if values.len() < 2 {
        return None;
    }
    let centre = mean(values)?;
    let squares: f64 = values.iter().map(|value| (value - centre) * (value - centre)).sum();
    Some((squares / (values.len() - 1) as f64).sqrt())
}

/// Sample quantile at `probability` in [0, 1], linear between order statistics with plotting position
/// (k - 1)/(n - 1): type 7 of Hyndman & Fan (1996), Am. Stat. 50, 361. `None` for no values.
///
/// # Panics
/// If `probability` is outside [0, 1].
pub fn quantile(values: &[f64], probability: f64) -> Option<f64> {
    assert!((0.0..=1.0).contains(&probability), "quantile: probability {probability} is outside [0, 1]");
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    Some(between_order_statistics(&sorted, probability * last as f64))
}

/// Median: the quantile at one half.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// Value at a fractional index (0-based) of an ascending slice, linear between neighbours, held at the ends.
pub(super) fn between_order_statistics(sorted: &[f64], position: f64) -> f64 {
    let last = sorted.len() - 1;
    let position = position.clamp(0.0, last as f64);
    let below = position.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}

/// Ordinary least-squares slope of `y` on `x` (unit of y over unit of x); `None` if the lengths differ, there
/// are fewer than two points, or all x are equal.
pub fn least_squares_slope(x: &[f64], y: &[f64]) -> Option<f64> {
    if x.len() != y.len() {
        return None;
    }
    let (x_mean, y_mean) = (mean(x)?, mean(y)?);
    let spread: f64 = x.iter().map(|x| (x - x_mean) * (x - x_mean)).sum();
    let covariance: f64 = x.iter().zip(y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    (spread > 0.0).then(|| covariance / spread)
}
