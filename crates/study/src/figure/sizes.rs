//! Size distributions: the complementary cumulative distribution of the fragments' mass shares, arm by arm.

use super::axis::Scale;
use super::curves::{Curve, Curves, Quantity, Spread, curves};
use super::drawing::Drawing;
use super::error::FigureError;

/// The fragments of one arm.
#[derive(Clone, Copy, Debug)]
pub struct SizeArm<'a> {
    /// Name of the arm.
    pub arm: &'a str,
    /// For every case the masses of its fragments over the mass of the case.
    pub cases: &'a [&'a [f64]],
}

/// Number of abscissae, spaced evenly in the logarithm (chosen: steps of single fragments stay visible).
const POINTS: usize = 120;

/// Mean over the cases of the share of fragments at least as heavy as m, against m, both axes logarithmic, with the
/// band from the 10 % to the 90 % quantile over cases. Cases without fragments are passed over.
///
/// # Errors
/// [`FigureError`] if no arm is given.
pub fn sizes(title: &str, arms: &[SizeArm<'_>]) -> Result<Drawing, FigureError> {
    if arms.is_empty() {
        return Err(FigureError::Nothing { what: "arm" });
    }
    let positive = |share: &f64| *share > 0.0 && share.is_finite();
    let shares = arms.iter().flat_map(|arm| arm.cases).flat_map(|case| case.iter()).copied().filter(positive);
    let low = shares.clone().fold(f64::INFINITY, f64::min).min(0.5);
    let most = arms.iter().flat_map(|arm| arm.cases).map(|case| case.len()).max().unwrap_or(1).max(1);
    let grid: Vec<f64> = (0..POINTS).map(|k| libm::pow(low, 1.0 - k as f64 / (POINTS - 1) as f64)).collect();
    // A band that reaches 0 is drawn down to half the smallest share a case can show.
    let floor = 0.5 / most as f64;
    let columns: Vec<[Vec<f64>; 3]> = arms.iter().map(|arm| distribution(arm, &grid, floor)).collect();
    let lines: Vec<Curve<'_>> = arms
        .iter()
        .zip(&columns)
        .map(|(arm, [middle, low, high])| Curve { arm: arm.arm, x: &grid, middle, low, high })
        .collect();
    curves(&Curves {
        title,
        x_label: "mass share m of a fragment, M_{k}/M",
        x_scale: Scale::Logarithmic,
        mark: None,
        spread: Spread::Band,
        note: "Mean over cases with the band from the 10 % to the 90 % quantile over cases.",
        quantities: &[Quantity {
            label: "share of fragments \u{2265} m",
            scale: Scale::Logarithmic,
            hold: &[floor],
            level: None,
            guides: &[],
            curves: &lines,
        }],
    })
}

/// Mean, 10 % and 90 % quantile over cases at each abscissa; the curve ends where the mean falls below
/// `floor`.
fn distribution(arm: &SizeArm<'_>, grid: &[f64], floor: f64) -> [Vec<f64>; 3] {
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    for threshold in grid {
        // A share equal to the threshold counts in spite of rounding in the grid.
        let least = threshold * (1.0 - 1e-12);
        let above = |case: &&&[f64]| case.iter().filter(|s| **s >= least).count() as f64 / case.len() as f64;
        let mut values: Vec<f64> =
            arm.cases.iter().filter(|case| !case.is_empty()).map(|c| above(&c)).collect();
        values.sort_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let quantile = |q: f64| {
            let rank = (q * values.len().saturating_sub(1) as f64 + 0.5) as usize;
            values.get(rank).map_or(f64::NAN, |v| v.max(floor))
        };
        let shown = mean >= floor;
        columns[0].push(if shown { mean } else { f64::NAN });
        columns[1].push(if shown { quantile(0.1) } else { f64::NAN });
        columns[2].push(if shown { quantile(0.9) } else { f64::NAN });
    }
    columns
}
