use serde::Serialize;

use super::median;

/// Median damage the pilot aims at: pieces have broken off, the ball has not gone to dust.
const TARGET_DAMAGE: f64 = 0.25;
/// Median damage within which a speed can serve: neither floor nor ceiling.
const USABLE_DAMAGE: std::ops::RangeInclusive<f64> = 0.05..=0.6;

/// The damages a pilot saw at one speed, all arms and blocks pooled.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedTrial {
    /// Impact speed, m/s.
    pub speed: f64,
    /// Damage D = 1 - M1/M of every case that ended well.
    pub damages: Vec<f64>,
}

/// What the pilot says about the speed of the primary runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum OperatingSpeed {
    /// A speed whose median damage is usable.
    Found {
        /// Impact speed, m/s.
        speed: f64,
        /// Pooled median of D there.
        median_damage: f64,
    },
    /// No speed has a usable median: go on to the wedge, or say so.
    NoneUsable {
        /// The (speed in m/s, median of D) nearest the target; `None` if no speed has a case.
        nearest: Option<(f64, f64)>,
    },
}

/// The pilot's rule: among the speeds whose pooled median of D lies within [0.05, 0.6], the one nearest 0.25
/// (the slower of two as near); without such a speed, `NoneUsable` with the nearest (speed, median).
pub fn operating_speed(trials: &[SpeedTrial]) -> OperatingSpeed {
    let mut medians: Vec<(f64, f64)> =
        trials.iter().filter_map(|trial| Some((trial.speed, median(&trial.damages)?))).collect();
    medians.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest_of = |candidates: &mut dyn Iterator<Item = (f64, f64)>| {
        candidates.min_by(|a, b| (a.1 - TARGET_DAMAGE).abs().total_cmp(&(b.1 - TARGET_DAMAGE).abs()))
    };
    let mut usable = medians.iter().copied().filter(|(_, damage)| USABLE_DAMAGE.contains(damage));
    match nearest_of(&mut usable) {
        Some((speed, median_damage)) => OperatingSpeed::Found { speed, median_damage },
        None => OperatingSpeed::NoneUsable { nearest: nearest_of(&mut medians.iter().copied()) },
    }
}
