//! How far the debris reaches, and how much of it has been compacted or loosened.

use super::error::{MetricError, check_length, check_masses, check_parameter, check_positions};
use super::exact_sum::FixedPoint;
use snowlab_solver::geometry::Vector;

/// The mass quantiles between which the bulk of the debris lies: a few stray particles do not move them.
pub const BULK: [f64; 2] = [0.05, 0.95];
/// The plastic volume ratios above which the study records the mass share.
pub const LOOSENED: [f64; 3] = [1.05, 1.3, 2.0];

/// Where the debris lies along one axis [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The least and the greatest coordinate.
    pub full: [f64; 2],
    /// The 5 % and the 95 % mass quantile.
    pub bulk: [f64; 2],
}

impl Extent {
    /// The full width [m].
    pub fn full_width(&self) -> f64 {
        self.full[1] - self.full[0]
    }

    /// The width between the 5 % and the 95 % mass quantile [m].
    pub fn bulk_width(&self) -> f64 {
        self.bulk[1] - self.bulk[0]
    }
}

/// The extents of the debris on every axis and its run-out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread<const D: usize> {
    /// By axis.
    pub extents: [Extent; D],
    /// The axis that points up.
    pub up: usize,
    /// The horizontal distance from the centre: the 95 % mass quantile and the greatest [m].
    pub run_out: [f64; 2],
}

impl<const D: usize> Spread<D> {
    /// The spread of `positions` [m] with `masses` [kg]; `up` is the vertical axis, `centre` the
    /// point that run-out is measured from [m], of which the horizontal coordinates count.
    ///
    /// The q quantile is the least coordinate below or at which lies at least the share q of the mass.
    ///
    /// # Errors
    /// Positions or masses that are not finite; no particles; lengths that differ; an axis that does not
    /// exist.
    pub fn new(
        positions: &[Vector<f64, D>],
        masses: &[f64],
        up: usize,
        centre: Vector<f64, D>,
    ) -> Result<Self, MetricError> {
        check_positions(positions)?;
        check_masses(positions.len(), masses)?;
        check_positions(&[centre])?;
        check_parameter("vertical axis", up as f64, [0.0, D as f64 - 1.0])?;
        check_parameter("number of particles", positions.len() as f64, [1.0, f64::MAX])?;
        let extents = std::array::from_fn(|axis| {
            let coordinates: Vec<f64> = positions.iter().map(|position| position[axis]).collect();
            let [least, low, high, greatest] =
                mass_quantiles(&coordinates, masses, [0.0, BULK[0], BULK[1], 1.0]);
            Extent { full: [least, greatest], bulk: [low, high] }
        });
        let distances: Vec<f64> = positions
            .iter()
            .map(|position| {
                let horizontal = (0..D).filter(|&axis| axis != up).map(|axis| position[axis] - centre[axis]);
                horizontal.map(|step| step * step).sum::<f64>().sqrt()
            })
            .collect();
        Ok(Self { extents, up, run_out: mass_quantiles(&distances, masses, [BULK[1], 1.0]) })
    }

    /// The vertical extent.
    pub fn height(&self) -> Extent {
        self.extents[self.up]
    }

    /// ln extent: the logarithm of the horizontal bulk width in metres, in 3D its mean over the two
    /// horizontal axes. Minus infinity where the bulk of the mass has one coordinate.
    pub fn log_extent(&self) -> f64 {
        let horizontal = (0..D).filter(|&axis| axis != self.up);
        horizontal.map(|axis| libm::log(self.extents[axis].bulk_width())).sum::<f64>() / (D - 1) as f64
    }
}

/// The mass quantiles of `values`, one or more, for ascending shares in [0, 1].
fn mass_quantiles<const Q: usize>(values: &[f64], masses: &[f64], shares: [f64; Q]) -> [f64; Q] {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_unstable_by(|&a, &b| values[a].total_cmp(&values[b]));
    let scale = FixedPoint::for_masses(masses);
    let mut below: i128 = 0;
    let cumulative: Vec<i128> = order
        .iter()
        .map(|&index| {
            below += scale.encode(masses[index]);
            below
        })
        .collect();
    let total = scale.decode(below);
    shares.map(|share| {
        let place = cumulative.partition_point(|&sum| scale.decode(sum) < share * total);
        values[order[place.min(order.len() - 1)]]
    })
}

/// The share of the mass [kg] whose plastic volume ratio J_P lies above each of `thresholds`, for example
/// [`LOOSENED`]. Zeros without particles.
///
/// # Errors
/// Masses that do not fit the ratios or are not finite and positive; a ratio that is not finite.
pub fn mass_shares_above<const Q: usize>(
    plastic_ratios: &[f64],
    masses: &[f64],
    thresholds: [f64; Q],
) -> Result<[f64; Q], MetricError> {
    check_length("plastic volume ratios", masses.len(), plastic_ratios.len())?;
    check_masses(masses.len(), masses)?;
    if let Some(index) = plastic_ratios.iter().position(|ratio| !ratio.is_finite()) {
        let value = plastic_ratios[index];
        return Err(MetricError::Value { quantity: "plastic volume ratio", index, value });
    }
    let total = FixedPoint::sum(masses);
    Ok(thresholds.map(|threshold| {
        let above: Vec<f64> = masses
            .iter()
            .zip(plastic_ratios)
            .filter_map(|(&m, &ratio)| (ratio > threshold).then_some(m))
            .collect();
        if above.is_empty() { 0.0 } else { FixedPoint::sum(&above) / total }
    }))
}
