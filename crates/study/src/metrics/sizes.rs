//! Size distributions of the fragments of many cases.

use super::error::{MetricError, check_masses, check_parameter};

/// What the ordinate of a size distribution counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ordinate {
    /// The number of fragments of at least the mass, per case.
    Number,
    /// The share of the case's fragments of at least the mass: the complementary cumulative distribution
    /// function (CCDF).
    Share,
    /// The share of the case's mass in fragments of at least the mass.
    MassShare,
}

/// The distributions of many cases at one mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandPoint {
    /// The mass [kg] (or mass share, as the input was).
    pub mass: f64,
    /// The mean over the cases.
    pub mean: f64,
    /// The lower quantile, the median and the upper quantile over the cases.
    pub quantiles: [f64; 3],
}

/// The ordinate of one case at `mass`, from its fragment masses in descending order.
pub fn distribution_at(descending: &[f64], mass: f64, ordinate: Ordinate) -> f64 {
    let number = descending.partition_point(|&fragment| fragment >= mass);
    match ordinate {
        _ if descending.is_empty() => 0.0,
        Ordinate::Number => number as f64,
        Ordinate::Share => number as f64 / descending.len() as f64,
        Ordinate::MassShare => descending[..number].iter().sum::<f64>() / descending.iter().sum::<f64>(),
    }
}

/// The size distribution of several cases with a band: at each of `masses` (any order) the mean and the
/// quantiles 0.5 - `coverage`/2, 0.5 and 0.5 + `coverage`/2 of the cases' own distributions there. Quantiles
/// interpolate linearly between order statistics (Hyndman & Fan, The American Statistician 50(4), 1996, type
/// 7).
///
/// `cases` holds the fragment masses of each case, in any order. The band is pointwise: it is no interval for
/// a curve.
///
/// # Errors
/// No case; a fragment mass that is not finite and positive; a coverage outside [0, 1].
pub fn distribution_band(
    cases: &[Vec<f64>],
    masses: &[f64],
    ordinate: Ordinate,
    coverage: f64,
) -> Result<Vec<BandPoint>, MetricError> {
    check_parameter("number of cases", cases.len() as f64, [1.0, f64::MAX])?;
    check_parameter("coverage of the band", coverage, [0.0, 1.0])?;
    let mut descending = cases.to_vec();
    for case in &mut descending {
        check_masses(case.len(), case)?;
        case.sort_unstable_by(|a, b| b.total_cmp(a));
    }
    let point = |&mass: &f64| {
        let mut values: Vec<f64> =
            descending.iter().map(|case| distribution_at(case, mass, ordinate)).collect();
        values.sort_unstable_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let quantiles = [-0.5, 0.0, 0.5].map(|side| quantile(&values, 0.5 + side * coverage));
        BandPoint { mass, mean, quantiles }
    };
    Ok(masses.iter().map(point).collect())
}

/// `count` masses, log-spaced from the least to the greatest fragment of all cases; fewer than two where all
/// are equal.
pub fn mass_grid(cases: &[Vec<f64>], count: usize) -> Vec<f64> {
    let all = || cases.iter().flatten().copied();
    let (least, greatest) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    if least >= greatest || count < 2 {
        return all().take(1).collect();
    }
    let step = libm::log(greatest / least) / (count - 1) as f64;
    let mut grid: Vec<f64> = (0..count).map(|k| least * libm::exp(step * k as f64)).collect();
    grid[count - 1] = greatest;
    grid
}

fn quantile(ascending: &[f64], share: f64) -> f64 {
    let place = share * (ascending.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(ascending.len() - 1);
    ascending[below] + (place - below as f64) * (ascending[above] - ascending[below])
}
