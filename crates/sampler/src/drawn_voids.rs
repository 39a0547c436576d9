//! A void field as drawn: what is void, and what drawing it took.

use std::fmt;

use snowlab_solver::geometry::Vector;

use crate::inclusion::Inclusion;
use crate::level_cut::LevelCut;

/// A drawn and accepted void field.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnVoids<const D: usize> {
    pub(crate) shape: VoidShape<D>,
    /// Share of the region that is void, counted on a raster of h/20 in 2D and h/4 in 3D.
    pub porosity: f64,
    /// Draws made, the accepted one included; their reciprocal estimates the acceptance rate.
    pub draws: usize,
    /// Why the others were rejected.
    pub rejections: Rejections,
    /// Number of connected voids.
    pub count: usize,
    /// Mean over the voids of the radius of the circle or sphere of equal area or volume [m].
    pub mean_radius: f64,
    /// Least diameter of a void, by equal area or volume [m].
    pub least_diameter: f64,
    /// Diameter of the largest disc or ball inside the narrowest void [m].
    pub least_width: f64,
}

impl<const D: usize> DrawnVoids<D> {
    /// Whether `point` [m] lies in a void.
    pub fn contains(&self, point: &Vector<f64, D>) -> bool {
        self.shape.contains(point)
    }

    /// Centre [m] and equal-volume radius [m] of every void, in the order of their drawing; empty for a Gaussian field.
    pub fn inclusions(&self) -> Vec<(Vector<f64, D>, f64)> {
        match &self.shape {
            VoidShape::Inclusions(inclusions) => {
                inclusions.all.iter().map(|inclusion| (inclusion.centre, inclusion.radius)).collect()
            }
            VoidShape::LevelCut(_) => Vec::new(),
        }
    }
}

/// How many draws were rejected, by the first reason found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rejections {
    /// No room for all voids.
    pub crowded: usize,
    /// A void whose circle or ball of equal size is narrower than 4 h.
    pub small_void: usize,
    /// The solid falls apart, opened by a disc or ball of radius h.
    pub broken_solid: usize,
    /// Porosity off by more than 1 %.
    pub porosity: usize,
}

impl fmt::Display for Rejections {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} had no room for all voids, {} had a void below the least diameter, {} left the solid in pieces, \
             {} missed the porosity",
            self.crowded, self.small_void, self.broken_solid, self.porosity
        )
    }
}

/// The set of void points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum VoidShape<const D: usize> {
    Inclusions(IndexedInclusions<D>),
    LevelCut(LevelCut<D>),
}

impl<const D: usize> VoidShape<D> {
    pub fn contains(&self, point: &Vector<f64, D>) -> bool {
        match self {
            Self::Inclusions(inclusions) => inclusions.contains(point),
            Self::LevelCut(cut) => cut.is_void(point),
        }
    }
}

/// Inclusions, and for every cell of a coarse grid those that may reach into it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct IndexedInclusions<const D: usize> {
    pub all: Vec<Inclusion<D>>,
    origin: Vector<f64, D>,
    cell: f64,
    shape: [usize; D],
    /// Indices into `all`, cell after cell; cell `c` owns `starts[c]..starts[c + 1]`.
    members: Vec<u32>,
    starts: Vec<u32>,
}

impl<const D: usize> IndexedInclusions<D> {
    pub fn new(all: Vec<Inclusion<D>>) -> Self {
        let unbounded = Vector::<f64, D>::repeat(f64::INFINITY);
        let (mut low, mut high, mut reach) = (unbounded, -unbounded, 0.0_f64);
        for inclusion in &all {
            low = low.inf(&inclusion.centre.add_scalar(-inclusion.reach));
            high = high.sup(&inclusion.centre.add_scalar(inclusion.reach));
            reach = reach.max(inclusion.reach);
        }
        // Chosen: cells as wide as the largest void's radius, at most 64 a side.
        let side = if all.is_empty() { 0.0 } else { (high - low).max() };
        let cell = reach.max(side / 64.0).max(f64::MIN_POSITIVE);
        let mut shape = [0_usize; D];
        for axis in 0..D {
            shape[axis] = if all.is_empty() { 0 } else { ((high[axis] - low[axis]) / cell) as usize + 1 };
        }
        let mut index = Self { all, origin: low, cell, shape, members: Vec::new(), starts: vec![0] };
        for flat in 0..shape.iter().product::<usize>() {
            let mut rest = flat;
            let centre = low
                + Vector::<f64, D>::from_fn(|axis, _| {
                    let step = rest % shape[axis];
                    rest /= shape[axis];
                    (step as f64 + 0.5) * cell
                });
            for (number, inclusion) in index.all.iter().enumerate() {
                let beyond = (inclusion.centre - centre).map(|offset| (offset.abs() - 0.5 * cell).max(0.0));
                // A relative margin keeps points that round onto the neighbouring cell.
                if beyond.norm() <= inclusion.reach * (1.0 + 1e-9) {
                    index.members.push(number as u32);
                }
            }
            index.starts.push(index.members.len() as u32);
        }
        index
    }

    fn contains(&self, point: &Vector<f64, D>) -> bool {
        let (mut flat, mut stride) = (0, 1);
        for axis in 0..D {
            let step = (point[axis] - self.origin[axis]) / self.cell;
            if !(step >= 0.0 && step < self.shape[axis] as f64) {
                return false;
            }
            flat += step as usize * stride;
            stride *= self.shape[axis];
        }
        let range = self.starts[flat] as usize..self.starts[flat + 1] as usize;
        self.members[range].iter().any(|&number| self.all[number as usize].contains(point))
    }
}
