//! Lays an exact number of points into a region.

use snowlab_solver::geometry::Vector;

use crate::domain::Domain;
use crate::drawn_voids::DrawnVoids;
use crate::error::{SamplerError, require};
use crate::region::Region;
use crate::rng::{Purpose, Streams};
use crate::{jittered, lattice, poisson_disk, random};

/// Default angle of a lattice, 27 degrees [rad]. Chosen: rows of sites follow neither the axes of the grid nor its
/// diagonals, and 27 degrees has no rational slope, so that the two never repeat.
pub const LATTICE_ANGLE: f64 = 27.0 * std::f64::consts::PI / 180.0;

/// Most particles in a placement. Chosen: half a gigabyte of positions in 3D.
pub const MOST_PARTICLES: usize = 20_000_000;

/// How points are laid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampler {
    /// Independent uniform points, by rejection; `N` points are the first `N` of the stream.
    Random,
    /// One uniform point in every cell of a lattice.
    Jittered {
        /// Angle of the lattice [rad]; see [`crate::lattice_rotation`].
        angle: f64,
    },
    /// The sites of a square or cubic lattice, its origin uniform in a cell.
    Lattice {
        /// Angle of the lattice [rad]; see [`crate::lattice_rotation`].
        angle: f64,
    },
    /// Random points no two of which are nearer than a distance as large as the count allows.
    PoissonDisk,
}

/// Points laid into a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement<const D: usize> {
    /// Exactly as many positions as asked for [m].
    pub positions: Vec<Vector<f64, D>>,
    /// Volume of the region without its voids [m^D]; over the number of positions, the volume of a particle.
    pub filled_volume: f64,
    /// Share of the region that is void.
    pub porosity: f64,
    /// Spacing of a lattice or of the cells of a jittered one, least distance of a Poisson-disk set [m]; random points
    /// have none.
    pub spacing: Option<f64>,
}

/// Lays `count` points by `sampler` into `region` without `voids`, from the stream [`Purpose::Placement`].
///
/// # Errors
/// [`SamplerError::CountOutOfRange`] unless `count` is 1 to [`MOST_PARTICLES`], [`SamplerError::OutOfRange`] for an
/// angle that is not within 1000 rad, [`SamplerError::EmptyRegion`], [`SamplerError::CannotPlace`],
/// [`SamplerError::RasterTooFine`] if a sampler's cells outgrow memory, and whatever [`Region::validate`] finds.
pub fn place<const D: usize>(
    region: &Region<D>,
    sampler: &Sampler,
    voids: Option<&DrawnVoids<D>>,
    count: usize,
    streams: &Streams,
) -> Result<Placement<D>, SamplerError> {
    if !(1..=MOST_PARTICLES).contains(&count) {
        let name = "number of particles";
        return Err(SamplerError::CountOutOfRange { name, value: count, least: 1, most: MOST_PARTICLES });
    }
    if let Sampler::Jittered { angle } | Sampler::Lattice { angle } = *sampler {
        require(angle.abs() <= 1e3, "angle of a lattice [rad]", angle, "-1e3 to 1e3")?;
    }
    let domain = Domain::new(region, voids)?;
    let rng = &mut streams.stream(Purpose::Placement);
    let (positions, spacing) = match *sampler {
        Sampler::Random => (random::place(&domain, count, rng)?, None),
        Sampler::Jittered { angle } => {
            let fitted = jittered::place(&domain, angle, count, rng)?;
            (fitted.positions, Some(fitted.spacing))
        }
        Sampler::Lattice { angle } => {
            let fitted = lattice::place(&domain, angle, count, rng)?;
            (fitted.positions, Some(fitted.spacing))
        }
        Sampler::PoissonDisk => {
            let disks = poisson_disk::place(&domain, count, rng)?;
            (disks.positions, Some(disks.least_distance))
        }
    };
    let porosity = voids.map_or(0.0, |voids| voids.porosity);
    Ok(Placement { positions, filled_volume: domain.filled_volume, porosity, spacing })
}
