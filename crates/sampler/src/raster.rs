//! Sets of points as cells of a regular raster: distances, openings and connected pieces, in 2D and 3D alike.

use snowlab_solver::geometry::{Aabb, Vector};

use crate::error::SamplerError;

/// Most cells of a raster that is held in memory. Chosen: half a gigabyte of labels and distances.
const MOST_CELLS: f64 = 4e7;

/// Cubic cells over a box, with a margin of empty cells on every side. Cell `(i, j, k)` has the flat index
/// `i + shape[0] (j + shape[1] k)`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Raster<const D: usize> {
    /// Centre of the cell of index zero [m].
    pub first: Vector<f64, D>,
    /// Side of a cell [m].
    pub cell: f64,
    pub shape: [usize; D],
}

/// Connected pieces of a set of cells: cells that share a face.
pub(crate) struct Pieces {
    /// For every cell, the number of its piece plus one; 0 outside the set.
    pub labels: Vec<u32>,
    /// Number of cells of every piece.
    pub cells: Vec<usize>,
}

impl<const D: usize> Raster<D> {
    /// Cells of side `cell` [m] over `bounds`, and `margin` more on every side.
    pub fn over(bounds: &Aabb<D>, cell: f64, margin: usize) -> Result<Self, SamplerError> {
        let sides = (bounds.max - bounds.min).map(|side| (side / cell).ceil() + 2.0 * margin as f64);
        let cells = sides.product();
        if cells.is_nan() || cells > MOST_CELLS {
            return Err(SamplerError::RasterTooFine { cell, cells, most: MOST_CELLS });
        }
        let mut shape = [0; D];
        for axis in 0..D {
            shape[axis] = sides[axis] as usize;
        }
        Ok(Self { first: bounds.min.add_scalar((0.5 - margin as f64) * cell), cell, shape })
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Calls `visit` with the flat index and the centre [m] of every cell, in order.
    pub fn for_each_cell(&self, mut visit: impl FnMut(usize, &Vector<f64, D>)) {
        let mut step = [0_usize; D];
        let mut centre = self.first;
        for flat in 0..self.len() {
            visit(flat, &centre);
            for axis in 0..D {
                step[axis] += 1;
                if step[axis] < self.shape[axis] {
                    centre[axis] = self.first[axis] + step[axis] as f64 * self.cell;
                    break;
                }
                step[axis] = 0;
                centre[axis] = self.first[axis];
            }
        }
    }

    /// The cells whose centre satisfies `inside`, none of them on the border of the raster.
    pub fn mask(&self, inside: impl Fn(&Vector<f64, D>) -> bool) -> Vec<bool> {
        let mut mask = vec![false; self.len()];
        self.for_each_cell(|flat, centre| mask[flat] = inside(centre) && !self.is_border(flat));
        mask
    }

    fn is_border(&self, flat: usize) -> bool {
        let mut rest = flat;
        self.shape.iter().any(|&length| {
            let step = rest % length;
            rest /= length;
            step == 0 || step + 1 == length
        })
    }

    /// Squared distance from every cell to the nearest cell in which `feature` holds, in cells; the lower envelope of
    /// parabolas, axis by axis (Felzenszwalb & Huttenlocher 2012). [`FAR`] if there is none.
    pub fn squared_distances(&self, feature: impl Fn(usize) -> bool) -> Vec<f32> {
        let mut distances: Vec<f32> =
            (0..self.len()).map(|flat| if feature(flat) { 0.0 } else { FAR }).collect();
        let longest = self.shape.iter().copied().max().unwrap_or(0);
        let mut envelope = Envelope::with_length(longest);
        let mut stride = 1;
        for axis in 0..D {
            let length = self.shape[axis];
            for block in 0..self.len() / (stride * length) {
                for offset in 0..stride {
                    envelope.transform(&mut distances, block * stride * length + offset, stride, length);
                }
            }
            stride *= length;
        }
        distances
    }

    /// The cells of `mask` that some disc or ball of `radius` [m] inside the mask covers: erosion, then dilation
    /// (Serra 1982). The edge of the mask lies half a cell from the centres of its outermost cells.
    pub fn opened(&self, mask: &[bool], radius: f64) -> Vec<bool> {
        let radius = (radius / self.cell) as f32;
        let to_edge = self.squared_distances(|flat| !mask[flat]);
        let kept = (radius + 0.5) * (radius + 0.5);
        let to_core = self.squared_distances(|flat| to_edge[flat] >= kept);
        mask.iter().zip(to_core).map(|(&member, distance)| member && distance <= radius * radius).collect()
    }

    /// The pieces of the set of cells in which `member` holds; no such cell may lie on the border of the raster.
    pub fn pieces(&self, member: impl Fn(usize) -> bool) -> Pieces {
        let mut strides = [1; D];
        for axis in 1..D {
            strides[axis] = strides[axis - 1] * self.shape[axis - 1];
        }
        let mut pieces = Pieces { labels: vec![0; self.len()], cells: Vec::new() };
        let mut stack = Vec::new();
        for start in 0..self.len() {
            if pieces.labels[start] != 0 || !member(start) {
                continue;
            }
            let label = pieces.cells.len() as u32 + 1;
            let mut cells = 0;
            pieces.labels[start] = label;
            stack.push(start);
            while let Some(cell) = stack.pop() {
                cells += 1;
                for stride in strides {
                    for neighbour in [cell - stride, cell + stride] {
                        if pieces.labels[neighbour] == 0 && member(neighbour) {
                            pieces.labels[neighbour] = label;
                            stack.push(neighbour);
                        }
                    }
                }
            }
            pieces.cells.push(cells);
        }
        pieces
    }
}

/// A squared distance no raster reaches, in cells.
pub(crate) const FAR: f32 = 1e12;

/// Scratch of the one-dimensional distance transform.
struct Envelope {
    values: Vec<f64>,
    vertices: Vec<usize>,
    bounds: Vec<f64>,
}

impl Envelope {
    fn with_length(length: usize) -> Self {
        Self { values: vec![0.0; length], vertices: vec![0; length], bounds: vec![0.0; length + 1] }
    }

    /// Replaces `f(p)` by `min_q f(q) + (p - q)^2` along one line of the raster.
    fn transform(&mut self, distances: &mut [f32], start: usize, stride: usize, length: usize) {
        for (position, value) in self.values[..length].iter_mut().enumerate() {
            *value = f64::from(distances[start + position * stride]);
        }
        if self.values[..length].iter().all(|&value| value == 0.0) {
            return;
        }
        let mut last = 0;
        self.vertices[0] = 0;
        self.bounds[0] = f64::NEG_INFINITY;
        self.bounds[1] = f64::INFINITY;
        for q in 1..length {
            let mut crossing = self.crossing(self.vertices[last], q);
            while crossing <= self.bounds[last] {
                last -= 1;
                crossing = self.crossing(self.vertices[last], q);
            }
            last += 1;
            self.vertices[last] = q;
            self.bounds[last] = crossing;
            self.bounds[last + 1] = f64::INFINITY;
        }
        let mut current = 0;
        for p in 0..length {
            while self.bounds[current + 1] < p as f64 {
                current += 1;
            }
            let vertex = self.vertices[current];
            let offset = p as f64 - vertex as f64;
            distances[start + p * stride] =
                (self.values[vertex] + offset * offset).min(f64::from(FAR)) as f32;
        }
    }

    /// Where the parabolas over `p < q` cross.
    fn crossing(&self, p: usize, q: usize) -> f64 {
        let (x, y) = (p as f64, q as f64);
        ((self.values[q] + y * y) - (self.values[p] + x * x)) / (2.0 * (y - x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::uniform;
    use crate::{Purpose, Streams};

    fn raster<const D: usize>(side: f64) -> Raster<D> {
        let bounds = Aabb { min: Vector::<f64, D>::zeros(), max: Vector::<f64, D>::repeat(side) };
        Raster::over(&bounds, 1.0, 2).unwrap()
    }

    fn steps<const D: usize>(raster: &Raster<D>, flat: usize) -> Vector<f64, D> {
        let mut rest = flat;
        Vector::<f64, D>::from_fn(|axis, _| {
            let step = rest % raster.shape[axis];
            rest /= raster.shape[axis];
            step as f64
        })
    }

    fn distances_agree_with_all_pairs<const D: usize>(side: f64) {
        let raster = raster::<D>(side);
        let mut rng = Streams::new(1).stream(Purpose::Noise);
        let features: Vec<bool> = (0..raster.len()).map(|_| uniform(&mut rng) < 0.02).collect();
        let found = raster.squared_distances(|flat| features[flat]);
        for flat in 0..raster.len() {
            let to = |other: usize| (steps(&raster, flat) - steps(&raster, other)).norm_squared();
            let least =
                (0..raster.len()).filter(|&other| features[other]).map(to).fold(f64::INFINITY, f64::min);
            assert_eq!(f64::from(found[flat]), least, "cell {flat}");
        }
    }

    #[test]
    fn distances_agree_with_all_pairs_in_2d_and_3d() {
        distances_agree_with_all_pairs::<2>(40.0);
        distances_agree_with_all_pairs::<3>(10.0);
        let nothing = raster::<2>(5.0);
        assert!(nothing.squared_distances(|_| false).iter().all(|&distance| distance == FAR));
    }

    /// Two squares of 20 cells joined by a neck: a disc passes the neck if it is as wide as the disc's diameter.
    #[test]
    fn an_opening_cuts_necks_narrower_than_the_disc() {
        let raster = raster::<2>(60.0);
        for (neck, pieces) in [(5.0, 2), (7.0, 2), (9.0, 1), (13.0, 1)] {
            let mask = raster.mask(|centre| {
                let in_squares = (centre[1] - 30.5).abs() < 10.0 && (centre[0] - 30.0).abs() > 8.0;
                let in_neck = (centre[1] - 30.5).abs() < 0.5 * neck;
                (centre[0] - 30.0).abs() < 28.0 && (in_squares || in_neck)
            });
            let opened = raster.opened(&mask, 4.0);
            assert_eq!(raster.pieces(|flat| opened[flat]).cells.len(), pieces, "neck of {neck} cells");
            assert_eq!(raster.pieces(|flat| mask[flat]).cells.len(), 1);
        }
    }

    #[test]
    fn pieces_share_faces_and_count_their_cells() {
        let raster = raster::<3>(8.0);
        let mask = raster.mask(|centre| {
            let [low, high] = [2.0, 4.0].map(|corner| centre.iter().all(|&x| x > corner && x < corner + 2.0));
            low || high
        });
        // Two cubes of eight cells that touch at a corner.
        assert_eq!(raster.pieces(|flat| mask[flat]).cells, vec![8, 8]);
    }
}
