//! How far a placement can be stretched before the metric takes it for broken, although nothing tore.

use super::error::{MetricError, check_masses, check_parameter, check_positions};
use super::friends_of_friends::friends_of_friends;
use snowlab_solver::geometry::Vector;

/// The placement counts as fallen apart where M_1/M drops below this.
pub const WHOLE_SHARE: f64 = 0.9;
/// Stretches that are tried: the trials met 5 to 19.
pub const STRETCH_RANGE: [f64; 2] = [1.0, 20.0];
/// Arms compared must fall apart within this share of each other.
pub const AGREEMENT: f64 = 0.15;
/// Relative width to which the stretch is found. Chosen: far below [`AGREEMENT`].
const RESOLUTION: f64 = 1e-3;

/// `positions` [m] stretched along `axis` by `stretch`, about the coordinate 0; components are unchanged by
/// shifts.
pub fn stretched<const D: usize>(
    positions: &[Vector<f64, D>],
    axis: usize,
    stretch: f64,
) -> Vec<Vector<f64, D>> {
    let mut stretched = positions.to_vec();
    stretched.iter_mut().for_each(|position| position[axis] *= stretch);
    stretched
}

/// M_1/M of the placement under each of `stretches`, for the calibration figure: `(stretch, share)`.
///
/// # Errors
/// Positions, masses or a link that are not finite; a link that is not positive; lengths that differ; an axis
/// that does not exist; a stretch below 1 or above 20.
pub fn stretch_curve<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    link: f64,
    axis: usize,
    stretches: &[f64],
) -> Result<Vec<(f64, f64)>, MetricError> {
    check_parameter("axis", axis as f64, [0.0, D as f64 - 1.0])?;
    let share = |&stretch: &f64| {
        check_parameter("stretch", stretch, STRETCH_RANGE)?;
        let fragments = friends_of_friends(&stretched(positions, axis, stretch), masses, link)?;
        Ok((stretch, fragments.largest_share()))
    };
    stretches.iter().map(share).collect()
}

/// The least uniaxial stretch along `axis`, from 1 to 20 and to within 0.1 %, at which M_1/M < 0.9 at linking
/// length `link` [m]; `None` where the placement still holds at 20. Stretching only lengthens distances, so
/// M_1/M never rises and bisection finds it.
///
/// # Errors
/// As [`stretch_curve`].
pub fn breaking_stretch<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    link: f64,
    axis: usize,
) -> Result<Option<f64>, MetricError> {
    check_positions(positions)?;
    check_masses(positions.len(), masses)?;
    let broken = |stretch: f64| -> Result<bool, MetricError> {
        Ok(stretch_curve(positions, masses, link, axis, &[stretch])?[0].1 < WHOLE_SHARE)
    };
    let [mut whole, mut torn] = STRETCH_RANGE;
    if broken(whole)? {
        return Ok(Some(whole));
    }
    if !broken(torn)? {
        return Ok(None);
    }
    while torn > whole * (1.0 + RESOLUTION) {
        let middle = (whole * torn).sqrt();
        if broken(middle)? { torn = middle } else { whole = middle }
    }
    Ok(Some(torn))
}

/// Whether the breaking stretches of the arms of a claim agree: the greatest at most 15 % above the least.
/// Arms that all hold at 20 agree; an arm that holds and one that does not disagree. If they disagree, the
/// flood fill becomes the claim's primary metric.
pub fn stretches_agree(breaking: &[Option<f64>]) -> bool {
    let known: Vec<f64> = breaking.iter().copied().flatten().collect();
    if known.is_empty() {
        return true;
    }
    let least = known.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = known.iter().copied().fold(0.0, f64::max);
    known.len() == breaking.len() && greatest <= least * (1.0 + AGREEMENT)
}
