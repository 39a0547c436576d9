//! Bodies as particles.

use std::path::Path;

use snowlab_sampler::{DrawnVoids, Purpose, Streams, draw_voids, place, rng};
use snowlab_solver::{InitialParticle, Matrix, Vector};

use crate::points::{self, PointsError};
use crate::spec::SpecError;
use crate::spec::scene::{BodySpec, CountOf, PlacementSpec, Property, RestVolumeName, SceneSpec};

use super::region::{heterogeneity, region, sampler, void_field};
use super::vector::vector_or_zero;

/// One body as particles.
pub(super) struct BuiltBody<const D: usize> {
    pub(super) particles: Vec<InitialParticle<D>>,
    pub(super) solid_mass: f64,
    pub(super) filled_volume: f64,
    pub(super) void_volume: f64,
    pub(super) voids: Option<DrawnVoids<D>>,
    pub(super) phase: Vector<f64, D>,
}

pub(super) fn build_body<const D: usize>(
    spec: &SceneSpec,
    body: &BodySpec,
    number: usize,
    folder: &Path,
) -> Result<BuiltBody<D>, SpecError> {
    let key = format!("body.{number}");
    // Each body has its own streams; the first has those of the seed itself.
    let streams = Streams::new(spec.seed ^ ((number as u64) << 48));
    let phase = grid_phase::<D>(body, &streams);
    let mut built = if let PlacementSpec::File { path, filled_volume } = &body.placement {
        from_file(spec, body, &key, &folder.join(path), *filled_volume)?
    } else {
        from_sampler(spec, body, &key, &streams, folder)?
    };
    built.phase = phase;
    let base = vector_or_zero::<D>(&body.velocity, &format!("{key}.velocity"))?;
    let spin = spin_matrix::<D>(&body.spin, &format!("{key}.spin"))?;
    let centre = built.particles.iter().fold(Vector::<f64, D>::zeros(), |sum, p| sum + p.position)
        / built.particles.len().max(1) as f64;
    for particle in &mut built.particles {
        particle.velocity += base + spin * (particle.position - centre);
        particle.position += phase;
        particle.stiffness_scale *= body.stiffness_scale;
        particle.material = number as u16;
    }
    Ok(built)
}

fn from_sampler<const D: usize>(
    spec: &SceneSpec,
    body: &BodySpec,
    key: &str,
    streams: &Streams,
    folder: &Path,
) -> Result<BuiltBody<D>, SpecError> {
    let refused =
        |error: snowlab_sampler::SamplerError| SpecError::value(format!("`{key}`"), error.to_string());
    let region_spec = body.region.as_ref().ok_or_else(|| {
        SpecError::value(
            format!("`{key}.region`"),
            "is missing; only a placement of kind `file` does without",
        )
    })?;
    let region = region::<D>(region_spec, &format!("{key}.region"), folder)?;
    let (sampler, count, count_of) = sampler(&body.placement);
    let voids = match &body.voids {
        None => None,
        Some(voids) => {
            let (field, judged_at) = void_field(voids, spec.numerics.spacing);
            Some(draw_voids(&region, &field, judged_at, streams).map_err(refused)?)
        }
    };
    let porosity = voids.as_ref().map_or(0.0, |v| v.porosity);
    let count = match count_of {
        CountOf::Body => count,
        CountOf::Solid => (count as f64 * (1.0 - porosity)).round() as usize,
    };
    let placement = place(&region, &sampler, voids.as_ref(), count, streams).map_err(refused)?;
    let solid_volume = region.volume(region.volume_raster()).map_err(refused)?;
    let volume = placement.filled_volume / placement.positions.len() as f64;
    let mut particles: Vec<_> = placement.positions.iter().map(|&x| at_rest(x, volume, body)).collect();
    if let Some(spec) = &body.heterogeneity {
        let factors = heterogeneity(spec).factors(&region, &placement.positions, streams).map_err(refused)?;
        particles.iter_mut().zip(factors).for_each(|(particle, factor)| scale(particle, spec.of(), factor));
    }
    Ok(BuiltBody {
        particles,
        solid_mass: body.material.density() * solid_volume,
        filled_volume: placement.filled_volume,
        void_volume: solid_volume - placement.filled_volume,
        voids,
        phase: Vector::zeros(),
    })
}

/// The points of a file with whatever it says of them; the rest as for a body of the scene.
fn from_file<const D: usize>(
    spec: &SceneSpec,
    body: &BodySpec,
    key: &str,
    path: &Path,
    filled_volume: Option<f64>,
) -> Result<BuiltBody<D>, SpecError> {
    let refused =
        |name: &str, message: String| Err(SpecError::value(format!("`{key}.placement.{name}`"), message));
    let file = path.display();
    let cloud = match points::read::<D>(path) {
        Ok(cloud) => cloud,
        Err(error @ PointsError::Io { .. }) => {
            let place = format!("`{key}.placement.path`");
            return Err(SpecError::Particles { place, message: error.to_string() });
        }
        Err(error) => return refused("path", error.to_string()),
    };
    let count = cloud.positions.len();
    if count == 0 {
        return refused("path", format!("{file} has no point; a body has one or more"));
    }
    let volumes = match (cloud.volumes, filled_volume) {
        (Some(_), Some(given)) => {
            let message = format!("is {given:?}, but {file} has a column `volume`; leave out one of them");
            return refused("filled_volume", message);
        }
        (None, None) => {
            return refused("filled_volume", format!("is missing, and {file} has no column `volume`"));
        }
        (Some(_), None) if spec.numerics.rest_volume == RestVolumeName::Density => {
            let message = format!(
                "{file} has a column `volume`, which `numerics.rest_volume` = \"density\" passes over; use \"uniform\""
            );
            return refused("path", message);
        }
        (Some(volumes), None) => volumes,
        (None, Some(filled)) => vec![filled / count as f64; count],
    };
    let mut particles: Vec<_> =
        cloud.positions.iter().zip(&volumes).map(|(&x, &volume)| at_rest(x, volume, body)).collect();
    // A velocity of the scene takes the place of the file's.
    if body.velocity.is_empty() {
        set(&mut particles, cloud.velocities, |particle, velocity| particle.velocity = velocity);
    }
    set(&mut particles, cloud.masses, |particle, mass| particle.mass = mass);
    set(&mut particles, cloud.plastic_ratios, |particle, ratio| particle.plastic_ratio = ratio);
    set(&mut particles, cloud.deformations, |particle, deformation| particle.deformation = deformation);
    Ok(BuiltBody {
        solid_mass: particles.iter().map(|particle| particle.mass).sum(),
        filled_volume: filled_volume.unwrap_or_else(|| volumes.iter().sum()),
        particles,
        void_volume: 0.0,
        voids: None,
        phase: Vector::zeros(),
    })
}

/// Gives each particle its value, where there are values.
fn set<V, const D: usize>(
    particles: &mut [InitialParticle<D>],
    values: Option<Vec<V>>,
    give: impl Fn(&mut InitialParticle<D>, V),
) {
    particles
        .iter_mut()
        .zip(values.into_iter().flatten())
        .for_each(|(particle, value)| give(particle, value));
}

fn scale<const D: usize>(particle: &mut InitialParticle<D>, property: Property, factor: f64) {
    match property {
        Property::Weight => {
            particle.mass *= factor;
            particle.volume *= factor;
        }
        Property::Mass => particle.mass *= factor,
        Property::Stiffness => particle.stiffness_scale *= factor,
    }
}

fn at_rest<const D: usize>(position: Vector<f64, D>, volume: f64, body: &BodySpec) -> InitialParticle<D> {
    InitialParticle {
        position,
        velocity: Vector::zeros(),
        mass: body.material.density() * volume,
        volume,
        stiffness_scale: 1.0,
        material: 0,
        deformation: Matrix::identity(),
        plastic_ratio: 1.0,
    }
}

fn grid_phase<const D: usize>(body: &BodySpec, streams: &Streams) -> Vector<f64, D> {
    rng::uniform_vector::<D>(&mut streams.stream(Purpose::GridPhase)) * body.phase_shift
}

fn spin_matrix<const D: usize>(spin: &[f64], key: &str) -> Result<Matrix<f64, D>, SpecError> {
    let mut w = Matrix::<f64, D>::zeros();
    match (D, spin) {
        (_, []) => {}
        (2, &[z]) => (w[(0, 1)], w[(1, 0)]) = (-z, z),
        (3, &[x, y, z]) => {
            (w[(2, 1)], w[(1, 2)]) = (x, -x);
            (w[(0, 2)], w[(2, 0)]) = (y, -y);
            (w[(1, 0)], w[(0, 1)]) = (z, -z);
        }
        _ => {
            let message =
                format!("has {} numbers; a scene in {D}D takes {}", spin.len(), if D == 2 { 1 } else { 3 });
            return Err(SpecError::value(key, message));
        }
    }
    Ok(w)
}
