//! Jittered placement: one point uniform in every cell of a lattice.

use crate::domain::Domain;
use crate::error::SamplerError;
use crate::lattice::{self, Fitted};
use crate::rng::{self, ChaCha8Rng};

/// A lattice turned by `angle` [rad] with every site moved to a uniform point of its cell (Cook 1986), fitted to the
/// count like a lattice: a site keeps its place within its cell while the spacing is sought.
pub(crate) fn place<const D: usize>(
    domain: &Domain<'_, D>,
    angle: f64,
    count: usize,
    rng: &mut ChaCha8Rng,
) -> Result<Fitted<D>, SamplerError> {
    lattice::fit(domain, angle, count, "jittered", rng, rng::uniform_vector::<D>)
}
