//! The level cut of a random field, cleaned of what no grid can see.

use snowlab_solver::geometry::Vector;

use crate::gaussian_field::PlaneWaves;
use crate::raster::{Pieces, Raster};
use crate::void_acceptance::{Acceptance, LEAST_DIAMETER, POROSITY_TOLERANCE, equal_volume_radius};

/// Bisections of the level. Chosen: the level is then known to 1e-5 standard deviations.
const BISECTIONS: usize = 20;
/// Value given to cells that change sides, in standard deviations of the field. Chosen: typical of the field, so that
/// a cell at the surface of the region outweighs its neighbour outside, which keeps its side.
const CLEANED: f64 = 1.0;

/// A field sampled at the cells of a raster, multilinear between them; void where it is positive.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LevelCut<const D: usize> {
    raster: Raster<D>,
    values: Vec<f64>,
}

impl<const D: usize> LevelCut<D> {
    /// Cuts `waves` at the level at which the cleaned void share of the region is the porosity asked for. Cleaning
    /// fills voids of an equal-volume diameter below 4 h, then clears all solid but the largest piece of every body.
    pub fn draw(waves: &PlaneWaves<D>, acceptance: &Acceptance<'_, D>) -> Self {
        let raster = acceptance.raster.clone();
        let field = waves.on_raster(&raster, &acceptance.region.bounding_box().min);
        let bodies = raster.pieces(|flat| acceptance.inside[flat]);
        let total = acceptance.inside.iter().filter(|&&inside| inside).count() as f64;
        // Beyond four standard deviations a level leaves less than a ten-thousandth on one side.
        let (mut low, mut high) = (-4.0, 4.0);
        let mut values = Vec::new();
        for _ in 0..BISECTIONS {
            let level = 0.5 * (low + high);
            values = field.iter().map(|value| value - level).collect::<Vec<f64>>();
            clean(acceptance, &bodies, &mut values);
            let void =
                values.iter().zip(&acceptance.inside).filter(|(value, inside)| **inside && **value > 0.0);
            let porosity = void.count() as f64 / total;
            // A tenth of the tolerance leaves the rest to the finer raster on which porosity is measured.
            if (porosity - acceptance.porosity).abs() < 0.1 * POROSITY_TOLERANCE * acceptance.porosity {
                break;
            }
            if porosity > acceptance.porosity { low = level } else { high = level }
        }
        Self { raster, values }
    }

    /// Whether the field is positive at `point` [m]; points off the raster are not void.
    pub fn is_void(&self, point: &Vector<f64, D>) -> bool {
        let mut base = 0;
        let mut stride = 1;
        let mut fractions = Vector::<f64, D>::zeros();
        let mut strides = [0; D];
        for axis in 0..D {
            let position = (point[axis] - self.raster.first[axis]) / self.raster.cell;
            if !(position >= 0.0 && position < (self.raster.shape[axis] - 1) as f64) {
                return false;
            }
            let step = position as usize;
            fractions[axis] = position - step as f64;
            base += step * stride;
            strides[axis] = stride;
            stride *= self.raster.shape[axis];
        }
        let mut value = 0.0;
        for corner in 0..1_usize << D {
            let (mut weight, mut cell) = (1.0, base);
            for axis in 0..D {
                if corner >> axis & 1 == 1 {
                    weight *= fractions[axis];
                    cell += strides[axis];
                } else {
                    weight *= 1.0 - fractions[axis];
                }
            }
            value += weight * self.values[cell];
        }
        value > 0.0
    }
}

/// Cleans the cut on the cells of the region; `bodies` are its pieces without voids.
fn clean<const D: usize>(acceptance: &Acceptance<'_, D>, bodies: &Pieces, values: &mut [f64]) {
    let (raster, inside) = (&acceptance.raster, &acceptance.inside);
    let voids = raster.pieces(|flat| inside[flat] && values[flat] > 0.0);
    let least = 0.5 * LEAST_DIAMETER * acceptance.h;
    for (value, &label) in values.iter_mut().zip(&voids.labels) {
        if label > 0 && equal_volume_radius::<D>(voids.cells[label as usize - 1], raster.cell) < least {
            *value = -CLEANED;
        }
    }
    let solids = raster.pieces(|flat| inside[flat] && values[flat] <= 0.0);
    let mut largest = vec![(0, 0); bodies.cells.len()];
    for (&body, &solid) in bodies.labels.iter().zip(&solids.labels) {
        if solid > 0 {
            let best = &mut largest[body as usize - 1];
            *best = (*best).max((solids.cells[solid as usize - 1], solid));
        }
    }
    for ((value, &body), &solid) in values.iter_mut().zip(&bodies.labels).zip(&solids.labels) {
        if solid > 0 && largest[body as usize - 1].1 != solid {
            *value = CLEANED;
        }
    }
}
