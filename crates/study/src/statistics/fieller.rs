use serde::{Deserialize, Serialize};

use super::distributions::student_t_quantile;
use super::{Interval, mean};

/// The set of ratios of two means that the paired data do not reject.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FiellerSet {
    /// A bounded interval: the denominator's mean differs from zero at the level asked for.
    Bounded(Interval),
    /// An unbounded set: the denominator's mean may be zero, and the ratio anything far out.
    Unbounded,
}

/// Ratio of the means of paired `numerators` and `denominators` with Fieller's confidence set at `confidence`
/// in (0, 1) (Fieller 1954, J. R. Stat. Soc. B 16, 175): the q with (x - q y)^2 <= t^2 var(x - q y), x and y
/// the means. `None` if the lengths differ, there are fewer than two pairs, or the denominators' mean is zero.
pub fn ratio_of_means(
    numerators: &[f64],
    denominators: &[f64],
    confidence: f64,
) -> Option<(f64, FiellerSet)> {
    let count = numerators.len();
    if count != denominators.len() || count < 2 {
        return None;
    }
    let (x, y) = (mean(numerators)?, mean(denominators)?);
    let freedom = (count - 1) as f64;
    let moment = |a: &[f64], a_mean: f64, b: &[f64], b_mean: f64| {
        a.iter().zip(b).map(|(a, b)| (a - a_mean) * (b - b_mean)).sum::<f64>() / (freedom * count as f64)
    };
    let t = student_t_quantile(0.5 + 0.5 * confidence, freedom);
    // (y^2 - t^2 v_yy) q^2 - 2 (x y - t^2 v_xy) q + (x^2 - t^2 v_xx) <= 0
    let quadratic = y * y - t * t * moment(denominators, y, denominators, y);
    let linear = x * y - t * t * moment(numerators, x, denominators, y);
    let constant = x * x - t * t * moment(numerators, x, numerators, x);
    if y == 0.0 {
        return None;
    }
    if quadratic <= 0.0 {
        return Some((x / y, FiellerSet::Unbounded));
    }
    let root = (linear * linear - quadratic * constant).max(0.0).sqrt();
    let interval = Interval { lower: (linear - root) / quadratic, upper: (linear + root) / quadratic };
    Some((x / y, FiellerSet::Bounded(interval)))
}
