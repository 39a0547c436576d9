//! Intervals of a share: k of n cases.

use super::Interval;
use super::distributions::{beta_quantile, normal_quantile};

/// Wilson's score interval of a share at `confidence` in (0, 1) (Wilson 1927, JASA 22, 209); `None` if
/// `total` is 0 or `successes` exceeds it.
pub fn wilson(successes: usize, total: usize, confidence: f64) -> Option<Interval> {
    if total == 0 || successes > total {
        return None;
    }
    let (n, share) = (total as f64, successes as f64 / total as f64);
    let z = normal_quantile(0.5 + 0.5 * confidence);
    let shrink = 1.0 + z * z / n;
    let centre = (share + z * z / (2.0 * n)) / shrink;
    let half_width = z / shrink * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    // The ends are exactly 0 and 1 at no and all successes; the clamp removes round-off there.
    Some(Interval { lower: (centre - half_width).max(0.0), upper: (centre + half_width).min(1.0) })
}

/// Exact (Clopper & Pearson 1934, Biometrika 26, 404) interval of a share at `confidence` in (0, 1), which
/// covers at least as often as it says; `None` if `total` is 0 or `successes` exceeds it.
pub fn clopper_pearson(successes: usize, total: usize, confidence: f64) -> Option<Interval> {
    if total == 0 || successes > total {
        return None;
    }
    let (k, n, tail) = (successes as f64, total as f64, 0.5 - 0.5 * confidence);
    let lower = if successes == 0 { 0.0 } else { beta_quantile(tail, k, n - k + 1.0) };
    let upper = if successes == total { 1.0 } else { beta_quantile(1.0 - tail, k + 1.0, n - k) };
    Some(Interval { lower, upper })
}
