//! Lattice placement: a square or cubic lattice of any angle, fitted to the exact count.

use snowlab_solver::geometry::{Matrix, Vector};

use crate::directions::lattice_rotation;
use crate::domain::Domain;
use crate::error::SamplerError;
use crate::rng::{self, ChaCha8Rng};

/// Bisections of the spacing. Chosen: the spacing is then known to its last bits.
const BISECTIONS: usize = 60;
/// Halvings of the least spacing until it gives enough sites. Chosen: down to a fortieth of the mean spacing.
const HALVINGS: usize = 6;
/// Most sites visited. Chosen: enough for the most particles in a ball, a few seconds.
const MOST_SITES: f64 = 3e8;

/// Positions and the spacing they were fitted with [m].
pub(crate) struct Fitted<const D: usize> {
    pub positions: Vec<Vector<f64, D>>,
    pub spacing: f64,
}

/// The sites of a lattice turned by `angle` [rad], its origin uniform in a cell.
pub(crate) fn place<const D: usize>(
    domain: &Domain<'_, D>,
    angle: f64,
    count: usize,
    rng: &mut ChaCha8Rng,
) -> Result<Fitted<D>, SamplerError> {
    fit(domain, angle, count, "lattice", rng, |_| Vector::<f64, D>::zeros())
}

/// Fits the spacing `a` of a lattice so that exactly `count` sites lie in the domain: sites are fixed in units of `a`,
/// `x = centre + a Q (i + origin + offset)`, and `a` is bisected until the count is met; as `a` shrinks, sites enter
/// the domain across its surface one by one. If the count jumps past the number asked for, the outermost sites of
/// the surplus are dropped. `offset` in `[0, 1)^D` moves every site within its cell.
pub(crate) fn fit<const D: usize>(
    domain: &Domain<'_, D>,
    angle: f64,
    count: usize,
    sampler: &'static str,
    rng: &mut ChaCha8Rng,
    mut offset: impl FnMut(&mut ChaCha8Rng) -> Vector<f64, D>,
) -> Result<Fitted<D>, SamplerError> {
    let origin = rng::uniform_vector::<D>(rng);
    let axes = lattice_rotation::<D>(angle);
    let per_site = domain.filled_volume / count as f64;
    let mean_spacing = if D == 2 { per_site.sqrt() } else { libm::cbrt(per_site) };
    let before_offsets = rng.clone();
    let mut placed = 0;
    for halving in 0..HALVINGS {
        // Chosen: a fifth below the mean spacing gives half as many sites again, enough for all but tiny counts.
        let least = 0.8 * mean_spacing / (1_u64 << halving) as f64;
        let mut rng = before_offsets.clone();
        let sites = sites_within(domain, &axes, &origin, least, || offset(&mut rng))?;
        let lattice = Lattice { domain, centre: 0.5 * (domain.bounds.min + domain.bounds.max), sites };
        placed = lattice.count(least);
        if placed >= count {
            return Ok(lattice.fit_count(count, least, mean_spacing));
        }
    }
    Err(SamplerError::CannotPlace { sampler, placed, wanted: count, tries: HALVINGS })
}

/// All sites that a lattice of spacing `least` [m] has in the bounding box of the domain, in units of the spacing.
fn sites_within<const D: usize>(
    domain: &Domain<'_, D>,
    axes: &Matrix<f64, D>,
    origin: &Vector<f64, D>,
    least: f64,
    mut offset: impl FnMut() -> Vector<f64, D>,
) -> Result<Vec<Vector<f64, D>>, SamplerError> {
    let half_extent = 0.5 * (domain.bounds.max - domain.bounds.min);
    // The box in the frame of the lattice; two more cells hold the origin and the offset.
    let reach = (axes.transpose().abs() * half_extent).map(|reach| (reach / least).ceil() + 2.0);
    let total = reach.map(|reach| 2.0 * reach + 1.0).product();
    if total > MOST_SITES {
        return Err(SamplerError::RasterTooFine { cell: least, cells: total, most: MOST_SITES });
    }
    let within = (half_extent / least).add_scalar(1e-9);
    let mut sites = Vec::new();
    let mut index = -reach;
    for _ in 0..total as usize {
        let site = axes * (index + origin + offset());
        if (0..D).all(|axis| site[axis].abs() <= within[axis]) {
            sites.push(site);
        }
        for axis in 0..D {
            index[axis] += 1.0;
            if index[axis] <= reach[axis] {
                break;
            }
            index[axis] = -reach[axis];
        }
    }
    Ok(sites)
}

struct Lattice<'a, const D: usize> {
    domain: &'a Domain<'a, D>,
    centre: Vector<f64, D>,
    sites: Vec<Vector<f64, D>>,
}

impl<const D: usize> Lattice<'_, D> {
    fn count(&self, spacing: f64) -> usize {
        self.sites.iter().filter(|site| self.domain.contains(&(self.centre + *site * spacing))).count()
    }

    /// Bisects between `least`, which gives at least `count` sites, and a spacing that gives fewer.
    fn fit_count(&self, count: usize, least: f64, mean_spacing: f64) -> Fitted<D> {
        let mut enough = least;
        let mut too_wide = 1.25 * mean_spacing;
        // A site off the centre leaves any bounded domain as the lattice widens, so a few doublings suffice.
        for _ in 0..HALVINGS {
            if self.count(too_wide) < count {
                break;
            }
            enough = too_wide;
            too_wide *= 2.0;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (enough + too_wide);
            let sites = self.count(middle);
            if sites >= count {
                enough = middle;
            } else {
                too_wide = middle;
            }
            if sites == count {
                break;
            }
        }
        let mut positions: Vec<Vector<f64, D>> = self
            .sites
            .iter()
            .map(|site| self.centre + site * enough)
            .filter(|point| self.domain.contains(point))
            .collect();
        self.drop_outermost(&mut positions, count);
        Fitted { positions, spacing: enough }
    }

    /// Keeps the `count` positions deepest below the surface of the region, in their order.
    fn drop_outermost(&self, positions: &mut Vec<Vector<f64, D>>, count: usize) {
        let mut outermost: Vec<(f64, usize)> = positions
            .iter()
            .enumerate()
            .map(|(index, point)| (self.domain.region.depth(point), index))
            .collect();
        outermost.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut dropped = vec![false; positions.len()];
        for &(_, index) in &outermost[..positions.len() - count] {
            dropped[index] = true;
        }
        let mut index = 0;
        positions.retain(|_| {
            index += 1;
            !dropped[index - 1]
        });
    }
}
