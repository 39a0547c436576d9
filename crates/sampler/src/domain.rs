//! What a sampler fills: a region without its voids.

use snowlab_solver::geometry::{Aabb, Vector};

use crate::drawn_voids::DrawnVoids;
use crate::error::SamplerError;
use crate::region::Region;

/// A region fills at least one part in this many of its bounding box. Chosen: rejection then ends in seconds.
pub(crate) const LEAST_SHARE: f64 = 2000.0;

/// The points of a region outside its voids.
pub(crate) struct Domain<'a, const D: usize> {
    pub region: &'a Region<D>,
    voids: Option<&'a DrawnVoids<D>>,
    pub bounds: Aabb<D>,
    /// Volume to fill [m^D].
    pub filled_volume: f64,
}

impl<'a, const D: usize> Domain<'a, D> {
    /// # Errors
    /// Whatever [`Region::volume`] finds, and [`SamplerError::EmptyRegion`].
    pub fn new(region: &'a Region<D>, voids: Option<&'a DrawnVoids<D>>) -> Result<Self, SamplerError> {
        region.validate()?;
        let volume = region.volume(region.volume_raster())?;
        let filled_volume = volume * (1.0 - voids.map_or(0.0, |voids| voids.porosity));
        let bounds = region.bounding_box();
        let bounds_volume = (bounds.max - bounds.min).product();
        // Written so that a volume that is no number is refused too.
        if filled_volume * LEAST_SHARE >= bounds_volume && filled_volume > 0.0 {
            Ok(Self { region, voids, bounds, filled_volume })
        } else {
            Err(SamplerError::EmptyRegion {
                filled: filled_volume,
                bounds: bounds_volume,
                least_share: LEAST_SHARE,
            })
        }
    }

    /// Whether a particle may lie at `point` [m].
    pub fn contains(&self, point: &Vector<f64, D>) -> bool {
        self.region.contains(point) && !self.voids.is_some_and(|voids| voids.contains(point))
    }

    /// The point at `share` in `[0, 1)^D` of the bounding box [m].
    pub fn point_at(&self, share: &Vector<f64, D>) -> Vector<f64, D> {
        self.bounds.min + (self.bounds.max - self.bounds.min).component_mul(share)
    }
}
