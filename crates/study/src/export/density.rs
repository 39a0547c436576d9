//! The density of the particles on a grid, in blocks of 8 x 8 x 8 nodes that are there only where material is.

use std::collections::BTreeMap;

use snowlab_solver::kernel::{Cubic, Kernel};

use super::Snapshot;

/// Nodes along a block's edge: that of a leaf of OpenVDB.
pub const EDGE: usize = 8;
const NODES: usize = EDGE * EDGE * EDGE;
/// A grid of more nodes is not written as a box. Chosen: half a gigabyte in single precision.
const MOST_NODES: f64 = 1.3e8;
/// A grid has nodes whose numbers fit (OpenVDB's coordinates are 32-bit).
const MOST_CELLS: f64 = 1e9;

/// Values at the nodes of a grid whose nodes lie at the multiples of its spacing: the density over that at rest.
#[derive(Clone, Debug)]
pub struct Density {
    /// Spacing [m].
    pub cell: f64,
    /// What a value of 1 is [kg/m^3]: the density at rest, or 1 where rest volumes are not known.
    pub unit: f64,
    /// Blocks by the numbers of their first node; z runs fastest in them.
    pub blocks: BTreeMap<[i32; 3], Box<[f64; NODES]>>,
}

/// A density that cannot be put on a grid.
#[derive(Debug, thiserror::Error)]
pub enum DensityError {
    /// In a plane.
    #[error("a density on a grid needs three dimensions; `ply`, `vtp` and `xyz` take two")]
    Flat,
    /// Nobody knows the size of its cells.
    #[error("the file says no grid spacing; give the side of the cells as `--cell` [m]")]
    NoCell,
    /// Cells of no size.
    #[error(
        "cells of {0:?} m; they must have a side above 0 that 1e9 of them reach farther than the particles with"
    )]
    Cell(f64),
    /// Particles without masses.
    #[error("the file says no masses; add a column `mass`")]
    NoMasses,
    /// A box of too many nodes.
    #[error(
        "the box about the particles has {0:.1e} nodes, over the {MOST_NODES:.1e} that are written; make the cells larger with `--cell`, \
         or write `vdb`, which has nodes only where snow is"
    )]
    TooFine(f64),
}

impl Density {
    /// Spreads the masses with the cubic B-spline, whose weights sum to one, over nodes `cell` [m] apart, by default the scene's spacing: the values
    /// sum to the mass over unit and cell's volume.
    ///
    /// # Errors
    /// [`DensityError`], but for [`DensityError::TooFine`].
    pub fn of(snapshot: &Snapshot, cell: Option<f64>) -> Result<Self, DensityError> {
        if snapshot.dimension != 3 {
            return Err(DensityError::Flat);
        }
        let cell = cell.or(snapshot.spacing).ok_or(DensityError::NoCell)?;
        let masses = snapshot.masses.as_ref().ok_or(DensityError::NoMasses)?;
        let farthest = snapshot.positions.iter().flatten().fold(0.0, |most, x| f64::max(most, x.abs()));
        if !(cell > 0.0 && cell.is_finite() && farthest / cell < MOST_CELLS) {
            return Err(DensityError::Cell(cell));
        }
        let volume = snapshot.volumes.as_ref().map_or(0.0, |volumes| volumes.iter().sum::<f64>());
        let unit = if volume > 0.0 { masses.iter().sum::<f64>() / volume } else { 1.0 };
        let mut density = Density { cell, unit, blocks: BTreeMap::new() };
        for (position, mass) in snapshot.positions.iter().zip(masses) {
            density.spread(position, mass / (unit * cell * cell * cell));
        }
        Ok(density)
    }

    fn spread(&mut self, position: &[f64; 3], amount: f64) {
        let [x, y, z] = position.map(|x| Cubic::weights(x / self.cell));
        for i in 0..Cubic::SUPPORT {
            for j in 0..Cubic::SUPPORT {
                for k in 0..Cubic::SUPPORT {
                    let node = [x.0 + i as i32, y.0 + j as i32, z.0 + k as i32];
                    *self.at(node) += amount * x.1[i] * y.1[j] * z.1[k];
                }
            }
        }
    }

    fn at(&mut self, node: [i32; 3]) -> &mut f64 {
        let edge = EDGE as i32;
        let first = node.map(|n| n.div_euclid(edge) * edge);
        let [i, j, k] = node.map(|n| n.rem_euclid(edge) as usize);
        let block = self.blocks.entry(first).or_insert_with(|| Box::new([0.0; NODES]));
        &mut block[(i * EDGE + j) * EDGE + k]
    }

    /// All values above 0 with their nodes.
    pub fn values(&self) -> impl Iterator<Item = ([i32; 3], f64)> + '_ {
        self.blocks.iter().flat_map(|(first, block)| {
            block.iter().enumerate().filter(|(_, value)| **value > 0.0).map(move |(n, value)| {
                let [i, j, k] = [n / (EDGE * EDGE), n / EDGE % EDGE, n % EDGE];
                ([first[0] + i as i32, first[1] + j as i32, first[2] + k as i32], *value)
            })
        })
    }

    /// The first and the last node of the box about all values above 0, with so many nodes of margin; `None` where there is none.
    ///
    /// # Errors
    /// [`DensityError::TooFine`].
    pub fn bounds(&self, margin: i32) -> Result<Option<[[i32; 3]; 2]>, DensityError> {
        let mut bounds: Option<[[i32; 3]; 2]> = None;
        for (node, _) in self.values() {
            let [low, high] = bounds.get_or_insert([node, node]);
            for axis in 0..3 {
                low[axis] = low[axis].min(node[axis]);
                high[axis] = high[axis].max(node[axis]);
            }
        }
        if let Some([low, high]) = &mut bounds {
            low.iter_mut().for_each(|n| *n -= margin);
            high.iter_mut().for_each(|n| *n += margin);
        }
        let nodes = bounds.map_or(0.0, |[low, high]| {
            (0..3).map(|axis| f64::from(high[axis]) - f64::from(low[axis]) + 1.0).product()
        });
        if nodes > MOST_NODES { Err(DensityError::TooFine(nodes)) } else { Ok(bounds) }
    }
}
