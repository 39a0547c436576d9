//! Regions, samplers and void fields in the sampler's terms.

use std::path::Path;

use snowlab_sampler::{
    GaussianField, Heterogeneity, InclusionField, InclusionShape, Orientation, Region, Sampler, VoidField,
};

use crate::spec::SpecError;
use crate::spec::scene::{
    BallSpec, BoxSpec, CountOf, CountSpec, HeterogeneitySpec, InclusionSpec, LatticeSpec, PlacementSpec,
    RegionSpec, VoidSpec,
};

use super::mesh::mesh;
use super::vector::vector;

/// The region a body's words describe. Paths of meshes are relative to `folder`.
///
/// # Errors
/// A vector of the wrong length, or a mesh that cannot be read, is none, or has no place.
pub fn region<const D: usize>(spec: &RegionSpec, key: &str, folder: &Path) -> Result<Region<D>, SpecError> {
    let at = |values: &[f64], name: &str| vector::<D>(values, &format!("{key}.{name}"));
    Ok(match spec {
        RegionSpec::Ball(BallSpec { centre, radius }) => {
            Region::Ball { centre: at(centre, "centre")?, radius: *radius }
        }
        RegionSpec::Box(BoxSpec { centre, half_extent, angle }) => Region::Box {
            centre: at(centre, "centre")?,
            half_extent: at(half_extent, "half_extent")?,
            orientation: snowlab_sampler::rotation(angle.to_radians()),
        },
        RegionSpec::Ellipsoid { centre, semi_axes, angle } => Region::Ellipsoid {
            centre: at(centre, "centre")?,
            semi_axes: at(semi_axes, "semi_axes")?,
            orientation: snowlab_sampler::rotation(angle.to_radians()),
        },
        RegionSpec::Mesh(spec) => Region::Mesh(mesh(spec, key, folder)?),
        RegionSpec::Union { parts } => Region::Union(
            parts
                .iter()
                .enumerate()
                .map(|(k, part)| region(part, &format!("{key}.parts.{k}"), folder))
                .collect::<Result<_, _>>()?,
        ),
        RegionSpec::Difference { solid, removed } => Region::Difference {
            solid: Box::new(region(solid, &format!("{key}.solid"), folder)?),
            removed: Box::new(region(removed, &format!("{key}.removed"), folder)?),
        },
    })
}

pub(super) fn sampler(placement: &PlacementSpec) -> (Sampler, usize, CountOf) {
    match *placement {
        PlacementSpec::Random(CountSpec { count, count_of }) => (Sampler::Random, count, count_of),
        PlacementSpec::Jittered(LatticeSpec { count, count_of, angle }) => {
            (Sampler::Jittered { angle: angle.to_radians() }, count, count_of)
        }
        PlacementSpec::Lattice(LatticeSpec { count, count_of, angle }) => {
            (Sampler::Lattice { angle: angle.to_radians() }, count, count_of)
        }
        PlacementSpec::PoissonDisk(CountSpec { count, count_of }) => (Sampler::PoissonDisk, count, count_of),
        PlacementSpec::File { .. } => (Sampler::Random, 0, CountOf::Body),
    }
}

/// How the particles of a body differ.
pub(super) fn heterogeneity(spec: &HeterogeneitySpec) -> Heterogeneity {
    match *spec {
        HeterogeneitySpec::Independent { spread, .. } => Heterogeneity::Independent { spread },
        HeterogeneitySpec::Correlated { spread, correlation_length, .. } => {
            Heterogeneity::Correlated { spread, correlation_length }
        }
        HeterogeneitySpec::Shell { factor, thickness, .. } => Heterogeneity::Shell { factor, thickness },
    }
}

/// The field and the spacing it is judged by [m].
pub(super) fn void_field(spec: &VoidSpec, spacing: f64) -> (VoidField, f64) {
    let inclusions = |shape, spec: &InclusionSpec| {
        let h = spec.judged_at.unwrap_or(spacing);
        let field = InclusionField {
            shape,
            porosity: spec.porosity,
            mean_radius: spec.mean_radius.unwrap_or(InclusionField::circles(h).mean_radius),
            radius_spread: spec.radius_spread,
            irregularity: spec.irregularity,
            aspect: spec.aspect,
            orientation: spec.angle.map_or(Orientation::Random, |a| Orientation::Aligned(a.to_radians())),
            gap: spec.gap.unwrap_or(InclusionField::circles(h).gap),
        };
        (VoidField::Inclusions(field), h)
    };
    match spec {
        VoidSpec::Circles(spec) => inclusions(InclusionShape::Circles, spec),
        VoidSpec::Ellipses(spec) => inclusions(InclusionShape::Ellipses, spec),
        VoidSpec::GaussianField { porosity, correlation_length, judged_at } => {
            let field = GaussianField { porosity: *porosity, correlation_length: *correlation_length };
            (VoidField::Gaussian(field), judged_at.unwrap_or(spacing))
        }
    }
}
