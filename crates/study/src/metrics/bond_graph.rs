//! The bond graph: fragments that stay apart once torn, and the length of crack between them.

use super::cell_list::{CellList, side_over, squared_distance};
use super::error::{LENGTH_RANGE, MetricError, check_length, check_masses, check_parameter, check_positions};
use super::fragments::FragmentAnalysis;
use super::interior::interior;
use super::union_find::UnionFind;
use snowlab_solver::geometry::Vector;
use std::f64::consts::PI;

/// Bond length over grid spacing: material that a cubic kernel's half width (2h) joins is bonded.
const BOND_REACH: f64 = 2.0;
/// Distance over grid spacing beyond which a bond is cut. Chosen: half a bond more than at rest at most, so
/// that elastic strain (a few percent) never cuts, while a gap that the kernel no longer spans does.
const CUT_REACH: f64 = 3.0;

/// The bonds of particles at rest: all pairs within 2h. Needs 4 bytes a bond: 12.6 PPC bonds a particle times
/// a half in 2D, 33.5 PPC times a half in 3D.
#[derive(Clone, Debug)]
pub struct BondGraph<const D: usize> {
    /// The particles, neighbours near each other: bonds are kept and walked in this order, which the memory
    /// likes.
    order: Vec<u32>,
    /// The bonds of the particle in place k are `partners[starts[k]..starts[k + 1]]`, places again, each bond
    /// once.
    starts: Vec<usize>,
    partners: Vec<u32>,
    spacing: f64,
    interior: InteriorDegree,
}

/// The number of bonds of particles farther than a bond from the edge of their body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteriorDegree {
    /// How many particles there are in the interior.
    pub particles: usize,
    /// Their mean number of bonds; `None` where there are none (bodies thinner than about 4h).
    pub mean_degree: Option<f64>,
}

/// The bond graph of a deformed state.
#[derive(Clone, Debug, PartialEq)]
pub struct BondAnalysis {
    /// The components of the bonds still alive.
    pub fragments: FragmentAnalysis,
    /// The number of bonds that are cut.
    pub cut_bonds: usize,
    /// The crack length [m] in 2D, the crack area [m^2] in 3D: see [`BondGraph::crack_measure`].
    pub crack_measure: Option<f64>,
}

impl<const D: usize> BondGraph<D> {
    /// Bonds all pairs of `reference` positions [m] (at t = 0) within 2h, where `spacing` is the grid spacing
    /// h [m].
    ///
    /// # Errors
    /// Positions or a spacing that are not finite; a spacing that is not positive.
    pub fn new(reference: &[Vector<f64, D>], spacing: f64) -> Result<Self, MetricError> {
        check_positions(reference)?;
        check_parameter("grid spacing [m]", spacing, LENGTH_RANGE)?;
        let length = BOND_REACH * spacing;
        let list = CellList::new(reference, side_over(length), None);

        let mut degree = vec![0_usize; reference.len()];
        let mut starts = vec![0_usize; reference.len() + 1];
        list.for_each_pair_within(length, |a, b| {
            degree[a] += 1;
            degree[b] += 1;
            starts[a + 1] += 1;
        });
        for place in 0..reference.len() {
            starts[place + 1] += starts[place];
        }
        let mut next = starts.clone();
        let mut partners = vec![0; starts[reference.len()]];
        list.for_each_pair_within(length, |a, b| {
            partners[next[a]] = b as u32;
            next[a] += 1;
        });

        let inside = interior(reference, length)?;
        let degrees_inside =
            list.order().iter().zip(&degree).filter(|(particle, _)| inside[**particle as usize]);
        let (particles, bonds) = degrees_inside.fold((0, 0), |(n, sum), (_, degree)| (n + 1, sum + degree));
        let mean_degree = (particles > 0).then(|| bonds as f64 / particles as f64);
        let interior = InteriorDegree { particles, mean_degree };
        Ok(Self { order: list.order().to_vec(), starts, partners, spacing, interior })
    }

    /// The number of bonds at t = 0.
    pub fn bonds(&self) -> usize {
        self.partners.len()
    }

    /// The bond length l = 2h [m].
    pub fn bond_length(&self) -> f64 {
        BOND_REACH * self.spacing
    }

    /// The mean degree of the interior at t = 0: particles farther than l from the body's edge, by
    /// [`interior`].
    pub fn interior_degree(&self) -> InteriorDegree {
        self.interior
    }

    /// n, particles per m^D at t = 0: the interior's mean degree over the volume of a ball of radius l (pi
    /// l^2 in 2D, 4/3 pi l^3 in 3D). `None` without an interior.
    pub fn number_density(&self) -> Option<f64> {
        let l = self.bond_length();
        let ball = if D == 2 { PI * l * l } else { 4.0 / 3.0 * PI * l * l * l };
        self.interior.mean_degree.map(|degree| degree / ball)
    }

    /// The crack that cuts so many bonds: its length [m] in 2D, its area [m^2] in 3D; `None` without an
    /// interior that has bonds.
    ///
    /// The pairs within l that a straight cut separates number n^2 int_{|r| < l, r_y > 0} r_y dr per unit of
    /// cut: (2/3) n^2 l^3 in 2D, (pi/4) n^2 l^4 in 3D, for particles placed independently. Where a cut comes
    /// out at a free surface the bonds to the outside are missing, and it reads short by half the mean reach
    /// along the cut: by (3/16) l at each end in 2D, 8 l/(15 pi) all along the rim in 3D (int r_y |r_x| dr
    /// over twice int r_y dr).
    pub fn crack_measure(&self, cut_bonds: usize) -> Option<f64> {
        let l = self.bond_length();
        let moment = if D == 2 { 2.0 / 3.0 * l.powi(3) } else { PI / 4.0 * l.powi(4) };
        self.number_density().filter(|n| *n > 0.0).map(|n| cut_bonds as f64 / (n * n * moment))
    }

    /// Which bonds hold at `positions` [m], given in the order of the reference positions: those of length at
    /// most 3h. `masses` [kg], one per particle.
    ///
    /// # Errors
    /// Positions or masses that are not finite, or not one for each particle of the reference.
    pub fn analyse(&self, positions: &[Vector<f64, D>], masses: &[f64]) -> Result<BondAnalysis, MetricError> {
        check_length("positions", self.order.len(), positions.len())?;
        check_positions(positions)?;
        check_masses(positions.len(), masses)?;
        let longest = CUT_REACH * self.spacing;
        let places: Vec<_> = self.order.iter().map(|&particle| positions[particle as usize]).collect();
        let mut sets = UnionFind::new(positions.len());
        let mut cut_bonds = 0;
        for (place, position) in places.iter().enumerate() {
            for &partner in &self.partners[self.starts[place]..self.starts[place + 1]] {
                if squared_distance(position, &places[partner as usize]) <= longest * longest {
                    sets.union(place as u32, partner);
                } else {
                    cut_bonds += 1;
                }
            }
        }
        let mut components = vec![0; positions.len()];
        for (&particle, root) in self.order.iter().zip(sets.roots()) {
            components[particle as usize] = root;
        }
        Ok(BondAnalysis {
            fragments: FragmentAnalysis::of_partition(&components, masses)?,
            cut_bonds,
            crack_measure: self.crack_measure(cut_bonds),
        })
    }
}
