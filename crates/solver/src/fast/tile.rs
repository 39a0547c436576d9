//! The nodes that the stencils of one block reach, copied to where arithmetic is fast: row by row, and in a row quantity by quantity, so
//! that the four nodes which a particle meets in a row are neighbours.

use super::lanes::Lanes;
use crate::grid::{BLOCK_EDGE, Grid};
use crate::kernel::MAX_SUPPORT;
use crate::real::Real;

/// Nodes that stencils of a block reach on one axis.
const REACH: usize = BLOCK_EDGE + MAX_SUPPORT - 1;
/// Places in a row: a power of two not below [`REACH`].
const ROW: usize = 8;
/// Mass, momentum and force in 3D.
const QUANTITIES: usize = 7;
/// Rows in 3D.
const ROWS: usize = REACH * REACH;

/// A row: a quantity after the other.
pub(super) type TileRow<T> = [[T; ROW]; QUANTITIES];

/// The tile of a block.
pub(super) struct Tile<T: Real, const D: usize> {
    rows: Box<[TileRow<T>; ROWS]>,
}

impl<T: Real, const D: usize> Tile<T, D> {
    pub fn new() -> Self {
        Tile { rows: Box::new([[[T::zero(); ROW]; QUANTITIES]; ROWS]) }
    }

    /// The row at `offset` from a stencil that begins at `local` in the block.
    #[inline(always)]
    pub fn row(&mut self, local: &[u8; D], offset: &[usize; D]) -> &mut TileRow<T> {
        let mut number = 0;
        for k in 0..D - 1 {
            number = number * REACH + usize::from(local[k]) + offset[k];
        }
        &mut self.rows[number]
    }

    fn row_count() -> usize {
        REACH.pow(D as u32 - 1)
    }

    /// The offset of a row from the block's first node.
    fn offset(number: usize) -> [usize; D] {
        let mut offset = [0; D];
        let mut rest = number;
        for axis in (0..D - 1).rev() {
            offset[axis] = rest % REACH;
            rest /= REACH;
        }
        offset
    }

    /// Adds mass, momentum and force to the grid's nodes and empties the tile.
    pub fn pour(&mut self, grid: &mut Grid<T, D>, block: u32) {
        let anchor = grid.block_anchor(block);
        for number in 0..Self::row_count() {
            let row = &mut self.rows[number];
            let first = anchor.row(&Self::offset(number));
            for (k, node) in grid.sums[first..first + REACH].iter_mut().enumerate() {
                node.mass += row[0][k];
                for axis in 0..D {
                    node.momentum[axis] += row[1 + axis][k];
                    node.force[axis] += row[1 + D + axis][k];
                }
            }
            *row = [[T::zero(); ROW]; QUANTITIES];
        }
    }

    /// Takes velocity and its change from the grid's nodes.
    pub fn fill(&mut self, grid: &Grid<T, D>, block: u32) {
        let anchor = grid.block_anchor(block);
        for number in 0..Self::row_count() {
            let row = &mut self.rows[number];
            let first = anchor.row(&Self::offset(number));
            for (k, node) in grid.motion[first..first + REACH].iter().enumerate() {
                for axis in 0..D {
                    row[axis][k] = node.velocity[axis];
                    row[D + axis][k] = node.change[axis];
                }
            }
        }
    }
}

/// Four places of a row from `first` on; `first` is at most 3.
#[inline(always)]
pub(super) fn places<T>(row: &mut [T; ROW], first: u8) -> &mut [T; MAX_SUPPORT] {
    let first = usize::from(first) & (BLOCK_EDGE - 1);
    (&mut row[first..first + MAX_SUPPORT]).try_into().expect("four places")
}

/// Adds to four places of a row.
#[inline(always)]
pub(super) fn add<T: Real, V: Lanes<T>>(row: &mut [T; ROW], first: u8, value: V) {
    let places = places(row, first);
    V::load(places).plus(value).store(places);
}
