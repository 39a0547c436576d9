//! Points sorted into cells, to find neighbours within a fixed radius.

use snowlab_solver::geometry::Vector;

/// Cells a side, at most. Chosen: sixteen million cells in 3D.
const MOST_CELLS_A_SIDE: f64 = 256.0;

/// An index over positions for queries up to a fixed radius.
pub(crate) struct Neighbours<'a, const D: usize> {
    positions: &'a [Vector<f64, D>],
    first: Vector<f64, D>,
    cell: f64,
    shape: [usize; D],
    /// Indices of the points, cell after cell; cell `c` owns `starts[c]..starts[c + 1]`.
    order: Vec<u32>,
    starts: Vec<u32>,
}

impl<'a, const D: usize> Neighbours<'a, D> {
    /// Indexes `positions` (finite) for queries of `radius` [m], above 0.
    pub fn new(positions: &'a [Vector<f64, D>], radius: f64) -> Self {
        let unbounded = Vector::<f64, D>::repeat(f64::INFINITY);
        let (low, high) = positions
            .iter()
            .fold((unbounded, -unbounded), |(low, high), point| (low.inf(point), high.sup(point)));
        let side = if positions.is_empty() { 0.0 } else { (high - low).max() };
        let cell = radius.max(side / MOST_CELLS_A_SIDE);
        let mut shape = [1_usize; D];
        for axis in 0..D {
            if !positions.is_empty() {
                shape[axis] = ((high[axis] - low[axis]) / cell) as usize + 1;
            }
        }
        let mut index = Self { positions, first: low, cell, shape, order: Vec::new(), starts: Vec::new() };
        let cells: Vec<usize> = positions.iter().map(|point| index.flat(&index.steps(point))).collect();
        let mut starts = vec![0_u32; shape.iter().product::<usize>() + 1];
        for &cell in &cells {
            starts[cell + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        index.order = vec![0; positions.len()];
        for (point, &cell) in cells.iter().enumerate() {
            index.order[next[cell] as usize] = point as u32;
            next[cell] += 1;
        }
        index.starts = starts;
        index
    }

    /// Calls `visit` with the index and squared distance [m^2] of every point other than `point` in the cells about it,
    /// among them all within the radius.
    pub fn for_each(&self, point: usize, mut visit: impl FnMut(usize, f64)) {
        let steps = self.steps(&self.positions[point]);
        for neighbour in 0..3_usize.pow(D as u32) {
            let mut rest = neighbour;
            let mut cell = steps;
            let mut outside = false;
            for axis in 0..D {
                let step = cell[axis] + rest % 3;
                rest /= 3;
                outside |= step == 0 || step > self.shape[axis];
                cell[axis] = step.wrapping_sub(1);
            }
            if outside {
                continue;
            }
            let flat = self.flat(&cell);
            for &other in &self.order[self.starts[flat] as usize..self.starts[flat + 1] as usize] {
                if other as usize != point {
                    let offset = self.positions[other as usize] - self.positions[point];
                    visit(other as usize, offset.norm_squared());
                }
            }
        }
    }

    fn steps(&self, point: &Vector<f64, D>) -> [usize; D] {
        let mut steps = [0; D];
        for axis in 0..D {
            steps[axis] = (((point[axis] - self.first[axis]) / self.cell) as usize).min(self.shape[axis] - 1);
        }
        steps
    }

    fn flat(&self, steps: &[usize; D]) -> usize {
        (0..D).rev().fold(0, |flat, axis| flat * self.shape[axis] + steps[axis])
    }
}
