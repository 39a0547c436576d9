/// Cliff's delta: P(treated > control) - P(treated < control) over all pairs, in [-1, 1]
/// (Cliff 1993, Psychol. Bull. 114, 494). `None` if either sample is empty.
pub fn cliffs_delta(treated: &[f64], control: &[f64]) -> Option<f64> {
    let pairs = treated.len() * control.len();
    let balance: i64 = treated
        .iter()
        .flat_map(|high| control.iter().map(move |low| i64::from(high > low) - i64::from(high < low)))
        .sum();
    (pairs > 0).then(|| balance as f64 / pairs as f64)
}
