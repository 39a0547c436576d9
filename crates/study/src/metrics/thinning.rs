//! Equal counts: measuring arms of different N on the same number of particles.

use super::error::{MetricError, check_length, check_masses, check_parameter};
use super::exact_sum::FixedPoint;
use rand::Rng;
use snowlab_sampler::{Purpose, Streams};
use snowlab_solver::geometry::Vector;

/// How many random subsets are averaged where a placement has no prefix property.
pub const SUBSETS: usize = 16;

/// Which particles stand for the whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thinning {
    /// The particles of lowest id: for random placement, where any prefix is a random placement itself.
    Prefix,
    /// 16 random subsets, drawn from the stream [`Purpose::Thinning`] of this seed: for every other placement.
    RandomSubsets {
        /// The seed of the block.
        seed: u64,
    },
}

impl Thinning {
    /// The subsets of `count` particles to measure, each as ascending indices into `ids`. They depend on the
    /// ids alone, not on the order of the particles in memory; where `count` is the number of particles there
    /// is one subset, all of them.
    ///
    /// # Errors
    /// A count above the number of particles, or below 1 where there are particles.
    pub fn subsets<I: Ord>(self, ids: &[I], count: usize) -> Result<Vec<Vec<usize>>, MetricError> {
        let particles = ids.len();
        let range = [particles.min(1) as f64, particles as f64];
        check_parameter("number of particles after thinning", count as f64, range)?;
        let mut by_id: Vec<usize> = (0..particles).collect();
        by_id.sort_by(|&a, &b| ids[a].cmp(&ids[b]));
        let ascending = |chosen: &[usize]| {
            let mut chosen = chosen.to_vec();
            chosen.sort_unstable();
            chosen
        };
        match self {
            Self::RandomSubsets { seed } if count < particles => {
                let mut random = Streams::new(seed).stream(Purpose::Thinning);
                Ok((0..SUBSETS).map(|_| ascending(&draw(&by_id, count, &mut random))).collect())
            }
            _ => Ok(vec![ascending(&by_id[..count])]),
        }
    }
}

/// `count` of `particles`, each subset with the same chance: the first steps of a Fisher-Yates shuffle
/// (Knuth, "The Art of Computer Programming" 2, algorithm 3.4.2 P). An index below n is the high half of a
/// 64-bit number times n, whose bias of n / 2^64 is far below notice.
fn draw(particles: &[usize], count: usize, random: &mut impl Rng) -> Vec<usize> {
    let mut deck = particles.to_vec();
    for place in 0..count {
        let left = (deck.len() - place) as u128;
        let pick = place + ((u128::from(random.next_u64()) * left) >> 64) as usize;
        deck.swap(place, pick);
    }
    deck.truncate(count);
    deck
}

/// The positions [m] and masses [kg] of a subset, the masses rescaled to the total of all.
///
/// # Errors
/// Masses that do not fit the positions or are not finite and positive; an index beyond the particles.
pub fn thinned<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    subset: &[usize],
) -> Result<(Vec<Vector<f64, D>>, Vec<f64>), MetricError> {
    check_masses(positions.len(), masses)?;
    if let Some(&beyond) = subset.iter().find(|&&index| index >= positions.len()) {
        let range = [0.0, positions.len() as f64 - 1.0];
        check_parameter("index of a thinned particle", beyond as f64, range)?;
    }
    let kept: Vec<f64> = subset.iter().map(|&index| masses[index]).collect();
    let factor = FixedPoint::sum(masses) / FixedPoint::sum(&kept);
    Ok((
        subset.iter().map(|&index| positions[index]).collect(),
        kept.iter().map(|mass| mass * factor).collect(),
    ))
}

/// The mean of `measure(positions, masses)` over the subsets of `count` particles that `thinning` picks: an
/// endpoint at equal counts. `ids`, `positions` [m] and `masses` [kg] run over the same particles.
///
/// # Errors
/// Arrays that differ in length, a count above the number of particles, and what `measure` refuses.
pub fn mean_over_subsets<const D: usize, I: Ord>(
    thinning: Thinning,
    count: usize,
    ids: &[I],
    positions: &[Vector<f64, D>],
    masses: &[f64],
    mut measure: impl FnMut(&[Vector<f64, D>], &[f64]) -> Result<f64, MetricError>,
) -> Result<f64, MetricError> {
    check_length("ids", positions.len(), ids.len())?;
    let subsets = thinning.subsets(ids, count)?;
    let mut sum = 0.0;
    for subset in &subsets {
        let (positions, masses) = thinned(positions, masses, subset)?;
        sum += measure(&positions, &masses)?;
    }
    Ok(sum / subsets.len() as f64)
}
