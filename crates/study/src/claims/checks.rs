//! Rule 6: whether an answer stands when its cases are measured otherwise.

use super::claim::Contrast;
use super::evidence::{differences, extreme_arms, leaning};
use super::limits::{ERROR_RATE, smallest_effect};
use super::observations::Check;
use super::rules::Case;
use crate::statistics::{mean, range_of_means, t_interval};

/// Why an answer does not stand.
pub(super) struct Doubt {
    /// Checks that speak against it.
    pub against: Vec<Check>,
    /// Checks the rule needs that are missing.
    pub missing: Vec<Check>,
}

/// `supported` stands if every check was made, d > 0 in all of them, d >= delta/2 in all but one, and the 95 %
/// interval lies above 0 for the flood fill or the bond graph.
pub(super) fn doubt_of_support(case: &Case) -> Option<Doubt> {
    let weights = fixed_weights(&case.claim.contrast, &case.blocks.values());
    let remeasured = |check: Check| case.checks.get(&check).map(|rows| differences(&weights, rows));
    let effect = |check: &Check| remeasured(*check).and_then(|d| mean(&d));
    let effect_below = |check: &Check, limit: f64| effect(check).is_some_and(|effect| effect < limit);

    let not_positive = |check: &Check| effect(check).is_some_and(|effect| effect <= 0.0);
    let small: Vec<Check> =
        Check::ALL.into_iter().filter(|check| effect_below(check, 0.5 * smallest_effect())).collect();
    let other_rulers = [Check::FloodFill, Check::BondGraph];
    let clear = other_rulers.into_iter().any(|check| {
        let interval = remeasured(check).and_then(|d| t_interval(&d, 1.0 - ERROR_RATE));
        interval.is_some_and(|interval| interval.lies_above(0.0))
    });

    let speaks_against = |check: &Check| {
        let unclear = !clear && other_rulers.contains(check) && case.checks.contains_key(check);
        not_positive(check) || (small.len() > 1 && small.contains(check)) || unclear
    };
    let against: Vec<Check> = Check::ALL.into_iter().filter(speaks_against).collect();
    let missing = missing(case);
    (!against.is_empty() || !missing.is_empty()).then_some(Doubt { against, missing })
}

/// `refuted` stands if d < delta in all checks but one; a check that is missing may be that one.
pub(super) fn doubt_of_refutation(case: &Case) -> Option<Doubt> {
    let effect = |rows: &Vec<Vec<f64>>| match case.claim.contrast.weights() {
        Some(weights) => mean(&differences(&weights, rows)),
        None => range_of_means(rows),
    };
    let large =
        |check: &Check| case.checks.get(check).and_then(effect).is_some_and(|d| d >= smallest_effect());
    let against: Vec<Check> = Check::ALL.into_iter().filter(large).collect();
    let missing = missing(case);
    (against.len() + missing.len() > 1).then_some(Doubt { against, missing })
}

/// Weights by which a support is re-measured: those of the contrast; for a range, the arm of largest mean less
/// the arm of smallest mean as the primary measurement found them, so that another order of the arms counts
/// against it.
pub(super) fn fixed_weights(contrast: &Contrast, primary: &[Vec<f64>]) -> Vec<f64> {
    contrast.weights().unwrap_or_else(|| {
        let leaning = leaning(contrast, primary);
        let mut weights = vec![0.0; leaning.len()];
        if let Some((high, low)) = extreme_arms(&leaning) {
            weights[high] += 1.0;
            weights[low] -= 1.0;
        }
        weights
    })
}

fn missing(case: &Case) -> Vec<Check> {
    Check::ALL.into_iter().filter(|check| !case.checks.contains_key(check)).collect()
}
