//! Friends-of-friends, the primary fragment metric: two particles are friends where their distance is at most
//! the link, and fragments are the connected components of friendship (Huchra & Geller, ApJ 257, 1982; Davis
//! et al., ApJ 292, 1985).

use super::cell_list::{CellList, side_of_clique, squared_distance};
use super::error::{LENGTH_RANGE, MetricError, check_masses, check_parameter, check_positions};
use super::fragments::FragmentAnalysis;
use super::union_find::UnionFind;
use snowlab_solver::geometry::Vector;

/// The fragments of `positions` [m] with `masses` [kg], one per particle, at linking length `link` [m]. The
/// study uses 2 h_max, the same metres in every arm.
///
/// All particles of a cell of side link/sqrt(D) are friends, so cells are linked instead of particles, and
/// only pairs of cells that are not yet in one component are searched for a friendship.
///
/// # Errors
/// Positions, masses or a link that are not finite; a link that is not positive; lengths that differ.
pub fn friends_of_friends<const D: usize>(
    positions: &[Vector<f64, D>],
    masses: &[f64],
    link: f64,
) -> Result<FragmentAnalysis, MetricError> {
    check_masses(positions.len(), masses)?;
    FragmentAnalysis::of_partition(&friend_components(positions, link)?, masses)
}

/// The component of each particle under friends-of-friends at `link` [m], named by one of its particles.
///
/// # Errors
/// As [`friends_of_friends`].
pub fn friend_components<const D: usize>(
    positions: &[Vector<f64, D>],
    link: f64,
) -> Result<Vec<u32>, MetricError> {
    check_positions(positions)?;
    check_parameter("link [m]", link, LENGTH_RANGE)?;
    let list = CellList::new(positions, side_of_clique::<D>(link), None);
    let mut cells = UnionFind::new(list.cells());
    let squared_link = link * link;
    list.for_each_cell_pair(2, |a, b| {
        let (a, b) = (a as u32, b as u32);
        if cells.find(a) != cells.find(b) && touch(&list, a as usize, b as usize, squared_link) {
            cells.union(a, b);
        }
    });
    Ok(list.components_of_particles(&mut cells))
}

/// Whether some particle of cell `a` is a friend of one of cell `b`.
fn touch<const D: usize>(list: &CellList<D>, a: usize, b: usize, squared_link: f64) -> bool {
    let others = &list.points()[list.slots(b)];
    list.points()[list.slots(a)]
        .iter()
        .any(|point| others.iter().any(|other| squared_distance(point, other) <= squared_link))
}
