//! The pair correlation function.

use std::f64::consts::PI;

use snowlab_solver::geometry::Vector;

use crate::error::{SamplerError, require};
use crate::neighbours::Neighbours;
use crate::region::Region;

/// One bin of a pair correlation function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairCorrelation {
    /// Middle of the bin [m].
    pub distance: f64,
    /// Pairs at that distance over those of independent points of the same density; 1 without any order.
    pub value: f64,
}

/// The pair correlation function `g(r)` of `positions` (Illian et al. 2008, chapter 4) up to `reach` [m] in `bins`
/// equal bins, for a mean number density `density` [1/m^D], the count over the volume filled. Pairs are counted from
/// those points alone that lie at least `reach` below the surface of `region`, which needs no correction for its edge
/// (minus sampling). Voids are not corrected for: their structure is part of the result.
///
/// # Errors
/// [`SamplerError::OutOfRange`] for a reach or density that is not positive, [`SamplerError::CountOutOfRange`] unless
/// bins are 1 to 10 000, [`SamplerError::TooFewSamples`] if no point lies deep enough.
pub fn pair_correlation<const D: usize>(
    positions: &[Vector<f64, D>],
    region: &Region<D>,
    density: f64,
    reach: f64,
    bins: usize,
) -> Result<Vec<PairCorrelation>, SamplerError> {
    region.validate()?;
    require(reach > 0.0, "reach of the pair correlation [m]", reach, "above 0")?;
    require(density > 0.0, "number density [1/m^D]", density, "above 0")?;
    if !(1..=10_000).contains(&bins) {
        let name = "bins of the pair correlation";
        return Err(SamplerError::CountOutOfRange { name, value: bins, least: 1, most: 10_000 });
    }
    let width = reach / bins as f64;
    let neighbours = Neighbours::new(positions, reach);
    let mut pairs = vec![0_u64; bins];
    let mut references = 0;
    for (point, position) in positions.iter().enumerate() {
        if region.depth(position) < reach {
            continue;
        }
        references += 1;
        neighbours.for_each(point, |_, squared| {
            let bin = (squared.sqrt() / width) as usize;
            if bin < bins {
                pairs[bin] += 1;
            }
        });
    }
    if references == 0 {
        return Err(SamplerError::TooFewSamples {
            measure: "pair correlation",
            needed: "a point farther than the reach below the surface",
            found: 0,
        });
    }
    Ok(pairs
        .into_iter()
        .enumerate()
        .map(|(bin, pairs)| {
            let shell = ball_volume::<D>((bin + 1) as f64 * width) - ball_volume::<D>(bin as f64 * width);
            PairCorrelation {
                distance: (bin as f64 + 0.5) * width,
                value: pairs as f64 / (references as f64 * density * shell),
            }
        })
        .collect())
}

fn ball_volume<const D: usize>(radius: f64) -> f64 {
    if D == 2 { PI * radius * radius } else { 4.0 / 3.0 * PI * radius * radius * radius }
}
