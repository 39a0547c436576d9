//! Draws the voids of an inclusion field: sizes first, then places, largest first, with solid between them.

use rand_chacha::ChaCha8Rng;
use snowlab_solver::geometry::Vector;

use crate::directions::{even_directions, rotation};
use crate::inclusion::{Inclusion, Outline};
use crate::region::Region;
use crate::rng;
use crate::void_field::{InclusionField, Orientation};

/// Tries to draw or to place one void. Chosen: a void that fails so often finds room in less than about a thousandth
/// of the region.
const TRIES: usize = 2000;
/// Most voids in a field. Chosen: far more than any scene, few enough to place in a fraction of a second.
pub(crate) const MOST_VOIDS: usize = 2_000;

/// The round and the stretched shape of every void of one draw.
pub(crate) struct Layout<const D: usize> {
    pub round: Vec<Inclusion<D>>,
    pub stretched: Vec<Inclusion<D>>,
}

/// Places voids: random sequential addition (Widom 1966) with a least distance between outlines.
pub(crate) struct LayoutDrawer<'a, const D: usize> {
    field: &'a InclusionField,
    region: &'a Region<D>,
    /// Volume that is to be void over that of the unit ball [m^D].
    target_power: f64,
    /// Smaller radii are not drawn [m].
    least_radius: f64,
    surface: Vec<Vector<f64, D>>,
    quadrature: Vec<Vector<f64, D>>,
}

impl<'a, const D: usize> LayoutDrawer<'a, D> {
    /// `region_volume` in m^D, `least_radius` in m.
    pub fn new(
        field: &'a InclusionField,
        region: &'a Region<D>,
        region_volume: f64,
        least_radius: f64,
    ) -> Self {
        let unit_ball = if D == 2 { 1.0 } else { 4.0 / 3.0 } * std::f64::consts::PI;
        Self {
            field,
            region,
            target_power: field.porosity * region_volume / unit_ball,
            least_radius,
            // Chosen: points a quarter of a spacing apart on a void of radius three spacings, gaps true to 2 %.
            surface: even_directions(if D == 2 { 72 } else { 400 }),
            // Chosen: sufficient for the volume of an outline to 1e-4.
            quadrature: even_directions(if D == 2 { 128 } else { 1000 }),
        }
    }

    /// The number of voids of mean size that the porosity takes.
    pub fn expected_voids(&self) -> f64 {
        self.target_power / (0..D).map(|_| self.field.mean_radius).product::<f64>()
    }

    /// One draw; `None` if a void found no room.
    pub fn draw(&self, rng: &mut ChaCha8Rng) -> Option<Layout<D>> {
        let mut layout = Layout { round: Vec::new(), stretched: Vec::new() };
        let mut surfaces: Vec<[Vec<Vector<f64, D>>; 2]> = Vec::new();
        for radius in self.draw_radii(rng) {
            let outline = Outline::draw(self.field.irregularity, &self.quadrature, rng);
            let points = outline.points(&self.surface);
            let placed = (0..TRIES).find_map(|_| {
                let centre = self.free_centre(radius * outline.least(), &layout, rng)?;
                let pair = self.shapes(centre, radius, &outline, rng);
                let own = [0, 1].map(|shape| pair[shape].surface_offsets(&points));
                let fits = [0, 1].into_iter().all(|shape| {
                    let others = if shape == 0 { &layout.round } else { &layout.stretched };
                    self.within_region(&pair[shape], &own[shape])
                        && others.iter().zip(&surfaces).all(|(other, points)| {
                            apart(&pair[shape], &own[shape], other, &points[shape], self.field.gap)
                        })
                });
                fits.then_some((pair, own))
            });
            let ([round, stretched], own) = placed?;
            layout.round.push(round);
            layout.stretched.push(stretched);
            surfaces.push(own);
        }
        Some(layout)
    }

    /// Log-normal radii [m], none below the least, largest first, rescaled so that their volumes add up to the target
    /// exactly.
    fn draw_radii(&self, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let mut radii = Vec::new();
        let mut power = 0.0;
        while radii.len() < MOST_VOIDS {
            let radius = self.draw_radius(rng);
            let own = (0..D).map(|_| radius).product::<f64>();
            // The last void is kept if that brings the sum nearer to its target; the first always is.
            if power > 0.0 && power + 0.5 * own > self.target_power {
                break;
            }
            radii.push(radius);
            power += own;
        }
        let scale = libm::pow(self.target_power / power, 1.0 / D as f64);
        for radius in &mut radii {
            *radius *= scale;
        }
        radii.sort_by(|a, b| b.total_cmp(a));
        radii
    }

    /// One log-normal radius [m], drawn again while it is below the least.
    fn draw_radius(&self, rng: &mut ChaCha8Rng) -> f64 {
        let spread = self.field.radius_spread;
        let variance = libm::log(1.0 + spread * spread);
        let mut radius = self.field.mean_radius;
        for _ in 0..TRIES {
            let factor = libm::exp(variance.sqrt() * rng::normal(rng) - 0.5 * variance);
            radius = self.field.mean_radius * factor;
            if radius >= self.least_radius {
                break;
            }
        }
        radius
    }

    /// A random centre [m] about which a ball of radius `core` [m] leaves the gap; most have none, and cost little.
    fn free_centre(&self, core: f64, layout: &Layout<D>, rng: &mut ChaCha8Rng) -> Option<Vector<f64, D>> {
        let bounds = self.region.bounding_box();
        let centre = bounds.min + (bounds.max - bounds.min).component_mul(&rng::uniform_vector::<D>(rng));
        let free = self.region.depth(&centre) >= core + self.field.gap
            && layout.round.iter().all(|other| {
                let least = core + other.core + self.field.gap;
                (centre - other.centre).norm_squared() >= least * least
            });
        free.then_some(centre)
    }

    /// The round and the stretched shape.
    fn shapes(
        &self,
        centre: Vector<f64, D>,
        radius: f64,
        outline: &Outline<D>,
        rng: &mut ChaCha8Rng,
    ) -> [Inclusion<D>; 2] {
        let axes = match self.field.orientation {
            Orientation::Random => rng::orientation::<D>(rng),
            Orientation::Aligned(angle) => rotation::<D>(angle),
        };
        [1.0, self.field.aspect].map(|aspect| Inclusion::new(centre, radius, outline.clone(), aspect, &axes))
    }

    fn within_region(&self, inclusion: &Inclusion<D>, surface: &[Vector<f64, D>]) -> bool {
        let depth = self.region.depth(&inclusion.centre);
        depth >= inclusion.reach + self.field.gap
            || (depth >= inclusion.core + self.field.gap
                && surface
                    .iter()
                    .all(|offset| self.region.depth(&(inclusion.centre + offset)) >= self.field.gap))
    }
}

/// Whether the surfaces of `a` and `b`, given as offsets from their centres, are at least `gap` apart [m].
fn apart<const D: usize>(
    a: &Inclusion<D>,
    a_surface: &[Vector<f64, D>],
    b: &Inclusion<D>,
    b_surface: &[Vector<f64, D>],
    gap: f64,
) -> bool {
    let between = b.centre - a.centre;
    let distance = between.norm();
    if distance >= a.reach + b.reach + gap {
        return true;
    }
    if distance < a.core + b.core + gap {
        return false;
    }
    let near: Vec<Vector<f64, D>> = b_surface
        .iter()
        .map(|offset| between + offset)
        .filter(|point| point.norm() < a.reach + gap)
        .collect();
    a_surface
        .iter()
        .filter(|point| (*point - between).norm() < b.reach + gap)
        .all(|point| near.iter().all(|other| (point - other).norm_squared() >= gap * gap))
        && !a.contains(&b.centre)
        && !b.contains(&a.centre)
}
