//! Particles sorted into square cells, for fixed-radius searches (Allen & Tildesley, "Computer Simulation of
//! Liquids", section 5.3), without a dense array of cells and without a hash map.
//!
//! Occupied cells alone are stored, in lexicographic order. The neighbours of a cell at a given offset then
//! come in the same order as the cells themselves, so one pass with a moving pointer per row of neighbours
//! finds them all.

use super::union_find::UnionFind;
use snowlab_solver::geometry::Vector;

/// The farthest cell offset a search may ask for, per axis.
pub const MAX_REACH: u32 = 3;
/// Empty cell numbers left round every cluster, so that offsets up to [`MAX_REACH`] never wrap or meet.
const MARGIN: u32 = 8;
/// An axis longer than this many cells is numbered cluster by cluster. Chosen: far below the 2^53 cells at
/// which f64 blurs the walls, and inside 32 bits.
const LONG_AXIS: f64 = (1u64 << 30) as f64;
/// Farther than this many cells from the origin f64 tells neighbouring cells apart no longer, and walls are
/// placed by the particles there.
const RESOLVED: f64 = (1u64 << 52) as f64;
/// Bits of a key per axis, and of the particle's index below them.
const FIELD: u32 = 32;

/// Particles in the order of their cells.
#[derive(Clone, Debug)]
pub struct CellList<const D: usize> {
    keys: Vec<u128>,
    starts: Vec<u32>,
    order: Vec<u32>,
    points: Vec<Vector<f64, D>>,
}

/// A stretch of one axis without gaps wider than the farthest search.
#[derive(Clone, Copy)]
struct Cluster {
    /// The least coordinate in it [m].
    from: f64,
    /// Where its cell walls are counted from [m].
    origin: f64,
    /// The cell of `from`, counted from `origin`.
    first_cell: f64,
    /// The number that cell is given.
    first_number: u32,
}

impl<const D: usize> CellList<D> {
    /// Sorts `positions` [m] into cells of side `side` [m]. Both must have passed the checks of
    /// [`super::error`]. With an `origin` [m] the cell walls lie at `origin + k side`; without one each
    /// cluster starts at its least coordinate.
    ///
    /// Cells that touch have numbers that differ by one. Clusters that lie farther apart than any search
    /// reaches are numbered as if the gap were a few cells wide, so debris at any distance costs nothing.
    pub fn new(positions: &[Vector<f64, D>], side: f64, origin: Option<Vector<f64, D>>) -> Self {
        let axes: [Vec<Cluster>; D] =
            std::array::from_fn(|axis| clusters(positions, axis, side, origin.map(|origin| origin[axis])));
        let mut tagged: Vec<u128> = positions
            .iter()
            .enumerate()
            .map(|(index, position)| {
                let cell = (0..D).fold(0u128, |key, axis| {
                    (key << FIELD) | u128::from(cell_number(&axes[axis], position[axis], side))
                });
                (cell << FIELD) | index as u128
            })
            .collect();
        tagged.sort_unstable();

        let order: Vec<u32> = tagged.iter().map(|&tag| tag as u32).collect();
        let points = order.iter().map(|&index| positions[index as usize]).collect();
        let (mut keys, mut starts) = (Vec::new(), Vec::new());
        for (slot, &tag) in tagged.iter().enumerate() {
            let key = tag >> FIELD;
            if keys.last() != Some(&key) {
                keys.push(key);
                starts.push(slot as u32);
            }
        }
        starts.push(positions.len() as u32);
        Self { keys, starts, order, points }
    }

    /// The number of occupied cells.
    pub fn cells(&self) -> usize {
        self.keys.len()
    }

    /// The slots of a cell: a range of [`order`](Self::order) and [`points`](Self::points).
    #[inline]
    pub fn slots(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    /// The particle in each slot; within a cell in ascending order.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The position in each slot [m].
    pub fn points(&self) -> &[Vector<f64, D>] {
        &self.points
    }

    /// The number of a cell on each axis; only differences between cells within reach of each other have a
    /// meaning.
    pub fn coordinates(&self, cell: usize) -> [i64; D] {
        std::array::from_fn(|axis| (self.keys[cell] >> (FIELD * (D - 1 - axis) as u32)) as u32 as i64)
    }

    /// Calls `visit(a, b)` once for every unordered pair of different occupied cells whose numbers differ by
    /// at most `reach` (1 to [`MAX_REACH`]) on every axis; near rows first.
    pub fn for_each_cell_pair(&self, reach: u32, mut visit: impl FnMut(usize, usize)) {
        debug_assert!((1..=MAX_REACH).contains(&reach));
        for row in half_rows::<D>(i128::from(reach)) {
            let least = if row == 0 { 1 } else { row - i128::from(reach) };
            let greatest = row + i128::from(reach);
            let mut pointer = 0;
            for (cell, &key) in self.keys.iter().enumerate() {
                let (least, greatest) = (key as i128 + least, key as i128 + greatest);
                while pointer < self.keys.len() && (self.keys[pointer] as i128) < least {
                    pointer += 1;
                }
                let mut other = pointer;
                while other < self.keys.len() && self.keys[other] as i128 <= greatest {
                    visit(cell, other);
                    other += 1;
                }
            }
        }
    }

    /// Calls `visit(a, b)` once for every unordered pair of slots whose points are at most `radius` [m]
    /// apart. The cells must have been made with [`side_over`]`(radius)`.
    pub fn for_each_pair_within(&self, radius: f64, mut visit: impl FnMut(usize, usize)) {
        let mut test = |a: usize, b: usize| {
            if squared_distance(&self.points[a], &self.points[b]) <= radius * radius {
                visit(a, b);
            }
        };
        for cell in 0..self.cells() {
            let slots = self.slots(cell);
            for a in slots.clone() {
                (a + 1..slots.end).for_each(|b| test(a, b));
            }
        }
        self.for_each_cell_pair(1, |first, second| {
            for a in self.slots(first) {
                self.slots(second).for_each(|b| test(a, b));
            }
        });
    }

    /// The component of each particle where `cells` holds those of the cells, named by one of its particles.
    pub fn components_of_particles(&self, cells: &mut UnionFind) -> Vec<u32> {
        let mut components = vec![0; self.order.len()];
        for cell in 0..self.cells() {
            let root = cells.find(cell as u32) as usize;
            let name = self.order[self.slots(root).start];
            for &particle in &self.order[self.slots(cell)] {
                components[particle as usize] = name;
            }
        }
        components
    }
}

/// Twice the rounding error of a cell coordinate, relative to the cell, and then some: inside a cluster
/// coordinates stay below 2^34 cells, so f64 places a wall within 2^-18 of a cell.
const ROUNDING: f64 = 1.0 / 65536.0;

/// The cell side [m] for which particles within `radius` [m] always lie in the same cell or in cells that
/// touch.
pub fn side_over(radius: f64) -> f64 {
    radius * (1.0 + ROUNDING)
}

/// The cell side [m] for which all particles of one cell lie within `radius` [m] of each other, and particles
/// within `radius` at most 2 cells apart per axis: `radius` over the root of D, the side of the cube with
/// that diagonal.
pub fn side_of_clique<const D: usize>(radius: f64) -> f64 {
    radius / (D as f64).sqrt() * (1.0 - ROUNDING)
}

/// The squared distance of two points [m^2]. Every metric compares this value, so that they agree to the last
/// bit.
#[inline]
pub fn squared_distance<const D: usize>(a: &Vector<f64, D>, b: &Vector<f64, D>) -> f64 {
    (0..D).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum()
}

/// The clusters of one axis, ascending; one cluster for all where the axis is not too long to number
/// directly.
fn clusters<const D: usize>(
    positions: &[Vector<f64, D>],
    axis: usize,
    side: f64,
    origin: Option<f64>,
) -> Vec<Cluster> {
    let coordinates = || positions.iter().map(|position| position[axis]);
    let (least, greatest) =
        coordinates().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    if positions.is_empty() {
        return Vec::new();
    }
    let counted_from = origin.unwrap_or(least);
    let cells = |x: f64| ((x - counted_from) / side).floor();
    if cells(least).abs() < LONG_AXIS && cells(greatest).abs() < LONG_AXIS {
        return vec![Cluster {
            from: least,
            origin: counted_from,
            first_cell: cells(least),
            first_number: MARGIN,
        }];
    }
    let mut sorted: Vec<f64> = coordinates().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let mut clusters: Vec<Cluster> = Vec::new();
    let mut before = f64::NEG_INFINITY;
    for x in sorted {
        // Cells at most MAX_REACH apart hold particles less than MAX_REACH + 1 sides apart.
        if x - before > f64::from(MAX_REACH + 1) * side {
            let first_number = clusters.last().map_or(0, |cluster| number_in(cluster, before, side)) + MARGIN;
            let walls_are_resolved = origin.is_some() && cells(x).abs() < RESOLVED;
            let (origin, first_cell) = if walls_are_resolved { (counted_from, cells(x)) } else { (x, 0.0) };
            clusters.push(Cluster { from: x, origin, first_cell, first_number });
        }
        before = x;
    }
    clusters
}

fn number_in(cluster: &Cluster, x: f64, side: f64) -> u32 {
    cluster.first_number + (((x - cluster.origin) / side).floor() - cluster.first_cell) as u32
}

fn cell_number(clusters: &[Cluster], x: f64, side: f64) -> u32 {
    let after = if clusters.len() == 1 { 1 } else { clusters.partition_point(|cluster| cluster.from <= x) };
    number_in(&clusters[after - 1], x, side)
}

/// The key offsets of the rows of cells (along the last axis) that lie ahead of a cell within `reach`, its
/// own row (0) first, then by distance: with the row's own cells ahead they visit every unordered pair of
/// cells once.
fn half_rows<const D: usize>(reach: i128) -> Vec<i128> {
    let mut rows: Vec<(i128, [i128; 2])> = Vec::new();
    for first in if D == 3 { -reach..=reach } else { 0..=0 } {
        for second in -reach..=reach {
            if (first, second) >= (0, 0) {
                rows.push((first * first + second * second, [first, second]));
            }
        }
    }
    rows.sort_unstable();
    rows.into_iter().map(|(_, [first, second])| (first << (2 * FIELD)) + (second << FIELD)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_clusters_are_numbered_close_together_and_keep_their_walls() {
        let points: Vec<Vector<f64, 2>> =
            [-1e300, 0.0, 0.9, 1.0, 2.5, 1e15].map(|x| Vector::from([x, 0.0])).to_vec();
        let list = CellList::new(&points, 1.0, Some(Vector::from([0.5, 0.0])));
        let columns: Vec<i64> = (0..list.cells()).map(|cell| list.coordinates(cell)[0]).collect();
        assert_eq!(columns, [8, 16, 17, 19, 27]);
        assert_eq!((list.slots(2), list.order()), (2..4, &[0, 1, 2, 3, 4, 5][..]));
    }

    #[test]
    fn every_pair_of_cells_within_reach_is_visited_once() {
        for reach in 1..=MAX_REACH {
            let points: Vec<Vector<f64, 3>> = (0..125)
                .filter(|i| i % 7 != 3)
                .map(|i| Vector::from([i % 5, i / 5 % 5, i / 25].map(|k| k as f64 + 0.5)))
                .collect();
            let list = CellList::new(&points, 1.0, Some(Vector::zeros()));
            let mut seen = Vec::new();
            list.for_each_cell_pair(reach, |a, b| seen.push((a.min(b), a.max(b))));
            seen.sort_unstable();
            let near = |a: usize, b: usize| {
                let (a, b) = (list.coordinates(a), list.coordinates(b));
                (0..3).all(|axis| (a[axis] - b[axis]).abs() <= i64::from(reach))
            };
            let expected: Vec<(usize, usize)> = (0..list.cells())
                .flat_map(|a| (a + 1..list.cells()).map(move |b| (a, b)))
                .filter(|&(a, b)| near(a, b))
                .collect();
            assert_eq!(seen, expected, "reach {reach}");
        }
    }
}
