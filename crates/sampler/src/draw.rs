//! Draws void fields until one is accepted.

use crate::drawn_voids::{DrawnVoids, IndexedInclusions, Rejections, VoidShape};
use crate::error::{SamplerError, require};
use crate::gaussian_field::PlaneWaves;
use crate::inclusion_layout::{Layout, LayoutDrawer, MOST_VOIDS};
use crate::level_cut::LevelCut;
use crate::region::Region;
use crate::rng::{ChaCha8Rng, Purpose, Streams};
use crate::void_acceptance::{Acceptance, LEAST_DIAMETER, Rejection};
use crate::void_field::{GaussianField, InclusionField, InclusionShape, VoidField};

/// Draws of a void field before it is given up.
const MOST_DRAWS: usize = 1000;
/// Draws without room for all voids, none accepted, after which more would only take time. Chosen: an acceptance rate
/// above 4 % would have given one with 98 % probability.
const MOST_CROWDED: usize = 100;

/// Least equal-volume radius of an inclusion that is drawn, over the grid spacing. Chosen: half the least diameter that
/// is accepted, and 2 % for the final rescaling to the porosity; drawing smaller ones would only be rejected.
const LEAST_RADIUS: f64 = 0.51 * LEAST_DIAMETER;

/// Draws `field` in `region` from the stream [`Purpose::Voids`] until a draw is accepted for a grid of spacing `h` [m].
///
/// A draw is accepted on the field alone, before any particle is placed: on a raster of h/8 (h/4 in 3D) no void has
/// an equal-volume diameter below 4 h, and the solid, opened by a disc or ball of radius h, is in one piece (or in as
/// many as a region of several bodies has without voids); the porosity, counted on a raster of h/20 (h/4 in 3D), is
/// within 1 % of the one asked for. Inclusions are judged in both shapes, so that circles and ellipses accept alike.
/// To share one field among grids, give the coarsest spacing.
///
/// # Errors
/// [`SamplerError::OutOfRange`] for a parameter of the field, the region or `h`, among them a mean radius below 2 h or
/// so large that the porosity is less than half a void; [`SamplerError::CountOutOfRange`] for more than 2000 voids;
/// [`SamplerError::RasterTooFine`]; [`SamplerError::EmptyRegion`];
/// [`SamplerError::FieldRejected`] after 1000 draws, or after 100 without room for all voids.
pub fn draw_voids<const D: usize>(
    region: &Region<D>,
    field: &VoidField,
    h: f64,
    streams: &Streams,
) -> Result<DrawnVoids<D>, SamplerError> {
    region.validate()?;
    field.validate()?;
    require(h > 0.0 && h <= 1e6, "grid spacing h [m]", h, "above 0, at most 1e6")?;
    let acceptance = Acceptance::new(region, h, field.porosity())?;
    let mut rng = streams.stream(Purpose::Voids);
    match field {
        VoidField::Inclusions(inclusions) => {
            let volume = region.volume(region.volume_raster())?;
            let drawer = LayoutDrawer::new(inclusions, region, volume, LEAST_RADIUS * h);
            let (radius, voids) = (inclusions.mean_radius, drawer.expected_voids());
            let name = "mean radius of the voids [m]";
            require(radius >= 2.0 * h, name, radius, "2 h or more, half the least diameter accepted")?;
            require(voids >= 0.5, name, radius, "that of a single void of the porosity, or less")?;
            if voids > MOST_VOIDS as f64 {
                return Err(SamplerError::CountOutOfRange {
                    name: "number of voids, by porosity and mean radius,",
                    value: voids as usize,
                    least: 1,
                    most: MOST_VOIDS,
                });
            }
            until_accepted(&acceptance, &mut rng, |rng| {
                let layout = drawer.draw(rng).ok_or(Rejection::Crowded)?;
                judge_both_shapes(&acceptance, inclusions, layout)
            })
        }
        VoidField::Gaussian(GaussianField { correlation_length, .. }) => {
            let bounds = region.bounding_box();
            require(
                (h..=(bounds.max - bounds.min).max()).contains(correlation_length),
                "correlation length of a void field [m]",
                *correlation_length,
                "the grid spacing h to the longest side of the region",
            )?;
            until_accepted(&acceptance, &mut rng, |rng| {
                let waves = PlaneWaves::<D>::draw(*correlation_length, rng);
                acceptance.judge(VoidShape::LevelCut(LevelCut::draw(&waves, &acceptance)))
            })
        }
    }
}

fn judge_both_shapes<const D: usize>(
    acceptance: &Acceptance<'_, D>,
    field: &InclusionField,
    layout: Layout<D>,
) -> Result<DrawnVoids<D>, Rejection> {
    let round = acceptance.judge(VoidShape::Inclusions(IndexedInclusions::new(layout.round)))?;
    let stretched = acceptance.judge(VoidShape::Inclusions(IndexedInclusions::new(layout.stretched)))?;
    Ok(match field.shape {
        InclusionShape::Circles => round,
        InclusionShape::Ellipses => stretched,
    })
}

fn until_accepted<const D: usize>(
    acceptance: &Acceptance<'_, D>,
    rng: &mut ChaCha8Rng,
    mut draw: impl FnMut(&mut ChaCha8Rng) -> Result<DrawnVoids<D>, Rejection>,
) -> Result<DrawnVoids<D>, SamplerError> {
    let mut rejections = Rejections::default();
    let mut draws = 0;
    while draws < MOST_DRAWS && rejections.crowded < MOST_CROWDED {
        draws += 1;
        match draw(rng) {
            Ok(drawn) => return Ok(DrawnVoids { draws, rejections, ..drawn }),
            Err(rejection) => rejections.count(rejection),
        }
    }
    Err(SamplerError::FieldRejected { porosity: acceptance.porosity, draws, rejections })
}
