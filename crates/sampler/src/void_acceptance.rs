//! The acceptance test of a void field, before any particle is placed.

use snowlab_solver::geometry::Vector;

use crate::drawn_voids::{DrawnVoids, Rejections, VoidShape};
use crate::error::SamplerError;
use crate::raster::Raster;
use crate::region::Region;

/// Least diameter of a void over the grid spacing. Chosen: the support of the cubic kernel; the grid does not see
/// anything smaller.
pub(crate) const LEAST_DIAMETER: f64 = 4.0;
/// Relative deviation of the porosity that is accepted. Chosen: a tenth of the smallest step of a porosity sweep.
pub(crate) const POROSITY_TOLERANCE: f64 = 0.01;

/// Why a draw was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rejection {
    Crowded,
    SmallVoid,
    BrokenSolid,
    Porosity,
}

impl Rejections {
    pub(crate) fn count(&mut self, rejection: Rejection) {
        *match rejection {
            Rejection::Crowded => &mut self.crowded,
            Rejection::SmallVoid => &mut self.small_void,
            Rejection::BrokenSolid => &mut self.broken_solid,
            Rejection::Porosity => &mut self.porosity,
        } += 1;
    }
}

/// Cells of the acceptance raster per grid spacing: 8 in 2D; 4 in 3D (chosen: eight times fewer cells, and four
/// across the radius of the opening ball still tell a neck from a cut).
const fn cells_per_spacing(dimension: usize) -> f64 {
    if dimension == 2 { 8.0 } else { 4.0 }
}

/// A region on its acceptance raster.
pub(crate) struct Acceptance<'a, const D: usize> {
    pub region: &'a Region<D>,
    /// Grid spacing [m].
    pub h: f64,
    pub porosity: f64,
    pub raster: Raster<D>,
    /// Cells of the raster in the region.
    pub inside: Vec<bool>,
    /// Pieces of the region without voids, opened like the solid.
    bodies: usize,
    /// The raster porosity is counted on: h/20 in 2D, the acceptance raster in 3D.
    counting: Counting<D>,
}

struct Counting<const D: usize> {
    raster: Raster<D>,
    inside: usize,
}

impl<'a, const D: usize> Acceptance<'a, D> {
    pub fn new(region: &'a Region<D>, h: f64, porosity: f64) -> Result<Self, SamplerError> {
        let bounds = region.bounding_box();
        let raster = Raster::over(&bounds, h / cells_per_spacing(D), 2)?;
        let fine = if D == 2 { Raster::over(&bounds, h / 20.0, 0)? } else { raster.clone() };
        let inside = raster.mask(|centre| region.contains(centre));
        let mut counted = 0;
        fine.for_each_cell(|_, centre| counted += usize::from(region.contains(centre)));
        if counted == 0 || !inside.contains(&true) {
            let sides = bounds.max - bounds.min;
            return Err(SamplerError::EmptyRegion {
                filled: 0.0,
                bounds: sides.product(),
                least_share: crate::domain::LEAST_SHARE,
            });
        }
        let opened = raster.opened(&inside, h);
        let bodies = raster.pieces(|flat| opened[flat]).cells.len();
        Ok(Self {
            region,
            h,
            porosity,
            raster,
            inside,
            bodies,
            counting: Counting { raster: fine, inside: counted },
        })
    }

    /// Whether the field may be used: no void whose circle or ball of equal size is narrower than 4 h, the solid opened by a ball of radius h in as many
    /// pieces as the region without voids (one for one body), porosity within 1 %. Returns the field with its measures.
    pub fn judge(&self, shape: VoidShape<D>) -> Result<DrawnVoids<D>, Rejection> {
        let mut void = vec![false; self.raster.len()];
        self.raster.for_each_cell(|flat, centre| void[flat] = self.inside[flat] && shape.contains(centre));
        let voids = self.raster.pieces(|flat| void[flat]);
        let radii: Vec<f64> =
            voids.cells.iter().map(|&cells| equal_volume_radius::<D>(cells, self.raster.cell)).collect();
        let least_diameter = 2.0 * radii.iter().copied().fold(f64::INFINITY, f64::min);
        if least_diameter < LEAST_DIAMETER * self.h {
            return Err(Rejection::SmallVoid);
        }
        let solid: Vec<bool> =
            self.inside.iter().zip(&void).map(|(&inside, &void)| inside && !void).collect();
        let opened = self.raster.opened(&solid, self.h);
        let pieces = self.raster.pieces(|flat| opened[flat]).cells.len();
        if pieces != self.bodies || pieces == 0 {
            return Err(Rejection::BrokenSolid);
        }
        let porosity = self.counted_porosity(&shape);
        if (porosity - self.porosity).abs() > POROSITY_TOLERANCE * self.porosity {
            return Err(Rejection::Porosity);
        }
        Ok(DrawnVoids {
            porosity,
            draws: 0,
            rejections: Rejections::default(),
            count: radii.len(),
            mean_radius: radii.iter().sum::<f64>() / radii.len() as f64,
            least_diameter,
            least_width: self.least_width(&void, &voids.labels, radii.len()),
            shape,
        })
    }

    fn counted_porosity(&self, shape: &VoidShape<D>) -> f64 {
        let mut void = 0;
        self.counting.raster.for_each_cell(|_, centre: &Vector<f64, D>| {
            void += usize::from(shape.contains(centre) && self.region.contains(centre));
        });
        void as f64 / self.counting.inside as f64
    }

    /// Twice the greatest distance from the edge, of the void in which that is least [m].
    fn least_width(&self, void: &[bool], labels: &[u32], count: usize) -> f64 {
        let to_edge = self.raster.squared_distances(|flat| !void[flat]);
        let mut deepest = vec![0.0_f32; count];
        for (&label, &distance) in labels.iter().zip(&to_edge) {
            if label > 0 {
                let own = &mut deepest[label as usize - 1];
                *own = own.max(distance);
            }
        }
        let least = deepest.into_iter().fold(f32::INFINITY, f32::min);
        (2.0 * f64::from(least).sqrt() - 1.0) * self.raster.cell
    }
}

/// Radius of the disc or ball of the volume of `cells` cells of side `cell` [m].
pub(crate) fn equal_volume_radius<const D: usize>(cells: usize, cell: f64) -> f64 {
    let volume = cells as f64;
    let radius = if D == 2 {
        (volume / std::f64::consts::PI).sqrt()
    } else {
        libm::cbrt(0.75 * volume / std::f64::consts::PI)
    };
    radius * cell
}
