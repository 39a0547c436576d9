//! How evenly particles fill a grid.

use snowlab_solver::geometry::Vector;

use super::Spread;
use crate::drawn_voids::DrawnVoids;
use crate::error::{SamplerError, require};
use crate::region::Region;

/// Most cells of a measuring grid. Chosen: a second of work.
const MOST_CELLS: f64 = 2e7;

/// A grid, and the material that it is laid over; nodes at `origin + h i`.
#[derive(Clone, Copy, Debug)]
pub struct MeasuringGrid<'a, const D: usize> {
    /// Spacing [m].
    pub h: f64,
    /// Any node [m].
    pub origin: Vector<f64, D>,
    /// Where the particles were laid.
    pub region: &'a Region<D>,
    /// What was spared.
    pub voids: Option<&'a DrawnVoids<D>>,
}

/// Number of particles in those cells of the grid that lie wholly inside the material.
///
/// # Errors
/// [`SamplerError::OutOfRange`] for `h`, [`SamplerError::RasterTooFine`], [`SamplerError::TooFewSamples`] if no cell
/// lies inside.
pub fn particles_per_cell_spread<const D: usize>(
    positions: &[Vector<f64, D>],
    grid: &MeasuringGrid<'_, D>,
) -> Result<Spread, SamplerError> {
    let window = Window::over(grid)?;
    let mut counts = vec![0.0; window.len()];
    for position in positions {
        let steps = window.coordinates(grid, position).map(f64::floor);
        if let Some(flat) = window.flat(&steps) {
            counts[flat] += 1.0;
        }
    }
    window.spread(grid, &counts, 0.5, "particles per cell")
}

/// Density at those nodes whose cubic B-spline support (two cells either way) lies wholly inside the material, in
/// particles per cell: `sum_p w_p N(x_i - x_p)` with weights `w_p`, 1 if none are given. For random placement with
/// `n` particles per cell the relative spread is `(151/315)^(D/2) / sqrt(n)`, since `151/315` is the integral of `N^2`.
///
/// # Errors
/// As [`particles_per_cell_spread`]; [`SamplerError::CountOutOfRange`] if the weights are not as many as positions.
pub fn grid_density_spread<const D: usize>(
    positions: &[Vector<f64, D>],
    weights: Option<&[f64]>,
    grid: &MeasuringGrid<'_, D>,
) -> Result<Spread, SamplerError> {
    check_weights(positions, weights)?;
    let window = Window::over(grid)?;
    let mut density = vec![0.0; window.len()];
    for (particle, position) in positions.iter().enumerate() {
        let coordinates = window.coordinates(grid, position);
        let base = coordinates.map(|coordinate| coordinate.floor() - 1.0);
        let particle_weight = weights.map_or(1.0, |weights| weights[particle]);
        for node in 0..1_usize << (2 * D) {
            let steps = Vector::<f64, D>::from_fn(|axis, _| base[axis] + (node >> (2 * axis) & 3) as f64);
            if let Some(flat) = window.flat(&steps) {
                density[flat] += particle_weight * (coordinates - steps).map(cubic_b_spline).product();
            }
        }
    }
    window.spread(grid, &density, 2.0, "grid density")
}

/// Refuses weights that are not one for every position.
pub(super) fn check_weights<const D: usize>(
    positions: &[Vector<f64, D>],
    weights: Option<&[f64]>,
) -> Result<(), SamplerError> {
    match weights {
        Some(weights) if weights.len() != positions.len() => Err(SamplerError::CountOutOfRange {
            name: "number of weights",
            value: weights.len(),
            least: positions.len(),
            most: positions.len(),
        }),
        _ => Ok(()),
    }
}

/// The cubic B-spline (S13, section 4).
fn cubic_b_spline(x: f64) -> f64 {
    let x = x.abs();
    if x < 1.0 {
        0.5 * x * x * x - x * x + 2.0 / 3.0
    } else if x < 2.0 {
        (2.0 - x) * (2.0 - x) * (2.0 - x) / 6.0
    } else {
        0.0
    }
}

/// The nodes of a grid over the bounding box of its region.
struct Window<const D: usize> {
    /// Index of the first node.
    first: Vector<f64, D>,
    shape: [usize; D],
}

impl<const D: usize> Window<D> {
    fn over(grid: &MeasuringGrid<'_, D>) -> Result<Self, SamplerError> {
        grid.region.validate()?;
        require(grid.h > 0.0, "grid spacing h [m]", grid.h, "above 0")?;
        grid.origin
            .iter()
            .try_for_each(|&value| require(value.abs() <= 1e6, "grid origin [m]", value, "-1e6 to 1e6"))?;
        let bounds = grid.region.bounding_box();
        let first = ((bounds.min - grid.origin) / grid.h).map(f64::floor);
        let sides = ((bounds.max - grid.origin) / grid.h).map(f64::ceil) - first;
        let cells = sides.map(|side| side + 1.0).product();
        if cells > MOST_CELLS {
            return Err(SamplerError::RasterTooFine { cell: grid.h, cells, most: MOST_CELLS });
        }
        let mut shape = [0; D];
        for axis in 0..D {
            shape[axis] = sides[axis] as usize + 1;
        }
        Ok(Self { first, shape })
    }

    fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Position in cells from the first node.
    fn coordinates(&self, grid: &MeasuringGrid<'_, D>, position: &Vector<f64, D>) -> Vector<f64, D> {
        (position - grid.origin) / grid.h - self.first
    }

    fn flat(&self, steps: &Vector<f64, D>) -> Option<usize> {
        (0..D).rev().try_fold(0, |flat, axis| {
            let inside = steps[axis] >= 0.0 && steps[axis] < self.shape[axis] as f64;
            inside.then(|| flat * self.shape[axis] + steps[axis] as usize)
        })
    }

    /// The spread of `values` over the cells (`half_width` 0.5) or the nodes (more) whose cube of `half_width` cells
    /// either way lies inside the material.
    fn spread(
        &self,
        grid: &MeasuringGrid<'_, D>,
        values: &[f64],
        half_width: f64,
        measure: &'static str,
    ) -> Result<Spread, SamplerError> {
        let to_centre = if half_width < 1.0 { half_width } else { 0.0 };
        let mut interior = Vec::new();
        let mut steps = self.first;
        for &value in values {
            let centre = grid.origin + steps.map(|step| (step + to_centre) * grid.h);
            if is_interior(grid, &centre, half_width * grid.h) {
                interior.push(value);
            }
            for axis in 0..D {
                steps[axis] += 1.0;
                if steps[axis] < self.first[axis] + self.shape[axis] as f64 {
                    break;
                }
                steps[axis] = self.first[axis];
            }
        }
        Spread::of(&interior, measure, "a cell or kernel support wholly inside the material")
    }
}

/// Whether the cube of `half_width` [m] about `centre` lies in the region and meets no void; voids are probed at
/// 5^D points, which no void of an accepted field slips through.
fn is_interior<const D: usize>(
    grid: &MeasuringGrid<'_, D>,
    centre: &Vector<f64, D>,
    half_width: f64,
) -> bool {
    grid.region.depth(centre) >= half_width * (D as f64).sqrt()
        && grid.voids.is_none_or(|voids| {
            (0..5_usize.pow(D as u32)).all(|probe| {
                let mut rest = probe;
                let offset = Vector::<f64, D>::from_fn(|_, _| {
                    let step = (rest % 5) as f64;
                    rest /= 5;
                    (0.5 * step - 1.0) * half_width
                });
                !voids.contains(&(centre + offset))
            })
        })
}
