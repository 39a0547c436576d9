//! What a void field is asked to be. Lengths are absolute, in metres, so that one field serves every grid.

use crate::error::{SamplerError, require};

/// Parameters of a void field; [`crate::draw_voids`] draws one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VoidField {
    /// Separate irregular voids.
    Inclusions(InclusionField),
    /// A level cut of a Gaussian random field.
    Gaussian(GaussianField),
}

impl VoidField {
    /// Share of the region that is to be void.
    pub const fn porosity(&self) -> f64 {
        match self {
            Self::Inclusions(field) => field.porosity,
            Self::Gaussian(field) => field.porosity,
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`SamplerError::OutOfRange`] naming the parameter, its value and its range.
    pub fn validate(&self) -> Result<(), SamplerError> {
        let porosity = self.porosity();
        require(porosity > 0.0 && porosity <= 0.6, "porosity", porosity, "above 0, at most 0.6")?;
        match self {
            Self::Inclusions(field) => field.validate(),
            Self::Gaussian(GaussianField { correlation_length, .. }) => {
                positive_length("correlation length of a void field [m]", *correlation_length)
            }
        }
    }
}

/// Irregular circles and ellipses (spheres and ellipsoids in 3D).
///
/// A field keeps `gap` of solid between any two voids and between voids and the surface, and does so for the round
/// AND for the stretched shape of every void. Two fields that differ in `shape` alone therefore accept the same draws:
/// circles and ellipses of one seed share centres, areas and outlines, and the ellipse is the stretched circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InclusionField {
    /// Round or stretched.
    pub shape: InclusionShape,
    /// Share of the region that is to be void, in (0, 0.6].
    pub porosity: f64,
    /// Mean radius of the circle or sphere of a void's area or volume [m].
    pub mean_radius: f64,
    /// Standard deviation of the radius over its mean, log-normal, in [0, 1]; radii below 2 h are drawn again, which
    /// raises the mean and narrows the spread of fields near that limit.
    pub radius_spread: f64,
    /// Root mean square of the outline's relative perturbation, in [0, 0.2].
    pub irregularity: f64,
    /// Long over short axis of the stretched shape, in [1, 5]; circles leave room for it too.
    pub aspect: f64,
    /// Direction of the long axes of the stretched shape.
    pub orientation: Orientation,
    /// Least solid between two voids and between a void and the surface [m].
    pub gap: f64,
}

impl InclusionField {
    /// Irregular circles for a grid of spacing `h` [m]: porosity 0.15, mean radius 3 h, radius spread 0.2,
    /// irregularity 0.1, room for aspect 2 at random orientation, gap 2 h.
    ///
    /// Chosen: PS17 gives no numbers. The gap is the diameter of the disc that opens the solid in the acceptance
    /// test, and half the support of the cubic kernel; a mean radius of 3 h leaves voids two standard deviations
    /// below it near the least diameter accepted, 4 h. In a disc 70 cells across such fields are accepted at the
    /// first draw up to a porosity of 0.2; larger voids, or a gap of h, reach 0.3. In a ball 40
    /// cells across a porosity of 0.15 needs a mean radius of 4 h and a gap of h.
    pub const fn circles(h: f64) -> Self {
        Self {
            shape: InclusionShape::Circles,
            porosity: 0.15,
            mean_radius: 3.0 * h,
            radius_spread: 0.2,
            irregularity: 0.1,
            aspect: 2.0,
            orientation: Orientation::Random,
            gap: 2.0 * h,
        }
    }

    /// The ellipses that belong to [`InclusionField::circles`].
    pub const fn ellipses(h: f64) -> Self {
        Self { shape: InclusionShape::Ellipses, ..Self::circles(h) }
    }

    fn validate(&self) -> Result<(), SamplerError> {
        positive_length("mean radius of the voids [m]", self.mean_radius)?;
        require(
            (0.0..=1.0).contains(&self.radius_spread),
            "radius spread of the voids",
            self.radius_spread,
            "0 to 1",
        )?;
        require(
            (0.0..=0.2).contains(&self.irregularity),
            "irregularity of the voids",
            self.irregularity,
            "0 to 0.2",
        )?;
        require((1.0..=5.0).contains(&self.aspect), "aspect of the voids", self.aspect, "1 to 5")?;
        require((0.0..=1e6).contains(&self.gap), "gap between voids [m]", self.gap, "0 to 1e6")?;
        match self.orientation {
            Orientation::Random => Ok(()),
            Orientation::Aligned(angle) => {
                require(angle.abs() <= 1e3, "orientation of the voids [rad]", angle, "-1e3 to 1e3")
            }
        }
    }
}

/// Which of the two shapes of every void is cut out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InclusionShape {
    /// The round shape.
    Circles,
    /// The shape stretched to the field's aspect.
    Ellipses,
}

/// Direction of the long axis of a void.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// Uniform over all directions, each void its own.
    Random,
    /// At this angle [rad] from the first axis, in the plane of the first two.
    Aligned(f64),
}

/// The points where a Gaussian random field of covariance `exp(-r^2 / (2 l^2))` exceeds a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianField {
    /// Share of the region that is to be void, in (0, 0.6].
    pub porosity: f64,
    /// Correlation length `l` [m], from the grid spacing to the longest side of the region. Four grid spacings give
    /// voids of a radius of four to five, accepted at nearly every draw.
    pub correlation_length: f64,
}

fn positive_length(name: &'static str, value: f64) -> Result<(), SamplerError> {
    require(value > 0.0 && value <= 1e6, name, value, "above 0, at most 1e6")
}
