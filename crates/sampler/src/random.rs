//! Random placement: independent uniform points, by rejection.

use snowlab_solver::geometry::Vector;

use crate::domain::{Domain, LEAST_SHARE};
use crate::error::SamplerError;
use crate::rng::{self, ChaCha8Rng};

/// The first `count` points of the stream that fall into the domain [m]. Fewer points are the first of more, and a
/// domain with voids keeps those points of the solid one that its voids spare.
pub(crate) fn place<const D: usize>(
    domain: &Domain<'_, D>,
    count: usize,
    rng: &mut ChaCha8Rng,
) -> Result<Vec<Vector<f64, D>>, SamplerError> {
    let mut positions = Vec::with_capacity(count);
    let mut tries = 0;
    while positions.len() < count {
        // Chosen: ten times the tries that the emptiest domain allowed needs on average, and a million to start.
        if tries > 1_000_000 + 10 * LEAST_SHARE as usize * positions.len() {
            return Err(SamplerError::CannotPlace {
                sampler: "random",
                placed: positions.len(),
                wanted: count,
                tries,
            });
        }
        tries += 1;
        let point = domain.point_at(&rng::uniform_vector::<D>(rng));
        if domain.contains(&point) {
            positions.push(point);
        }
    }
    Ok(positions)
}
