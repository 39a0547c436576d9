//! Bodies as particles.

use std::path::Path;

use snowlab_sampler::{DrawnVoids, Purpose, Streams, draw_voids, place, rng};
use snowlab_solver::{InitialParticle, Matrix, Vector};

use crate::points;
use crate::spec::SpecError;
use crate::spec::scene::{BodySpec, CountOf, PlacementSpec, SceneSpec};

use super::region::{region, sampler, void_field};
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
        from_file(body, &key, &folder.join(path), *filled_volume)?
    } else {
        from_sampler(spec, body, &key, &streams)?
    };
    built.phase = phase;
    let base = vector_or_zero::<D>(&body.velocity, &format!("{key}.velocity"))?;
    let spin = spin_matrix::<D>(&body.spin, &format!("{key}.spin"))?;
    let centre = built.particles.iter().fold(Vector::<f64, D>::zeros(), |sum, p| sum + p.position)
        / built.particles.len().max(1) as f64;
    for particle in &mut built.particles {
        particle.velocity += base + spin * (particle.position - centre);
        particle.position += phase;
        particle.stiffness_scale = body.stiffness_scale;
        particle.material = number as u16;
    }
    Ok(built)
}

fn from_sampler<const D: usize>(
    spec: &SceneSpec,
    body: &BodySpec,
    key: &str,
    streams: &Streams,
) -> Result<BuiltBody<D>, SpecError> {
    let refused =
        |error: snowlab_sampler::SamplerError| SpecError::value(format!("`{key}`"), error.to_string());
    let region_spec = body.region.as_ref().ok_or_else(|| {
        SpecError::value(
            format!("`{key}.region`"),
            "is missing; only a placement of kind `file` does without",
        )
    })?;
    let region = region::<D>(region_spec, &format!("{key}.region"))?;
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
    Ok(BuiltBody {
        particles: placement.positions.iter().map(|&x| at_rest(x, volume, body)).collect(),
        solid_mass: body.material.density() * solid_volume,
        filled_volume: placement.filled_volume,
        void_volume: solid_volume - placement.filled_volume,
        voids,
        phase: Vector::zeros(),
    })
}

fn from_file<const D: usize>(
    body: &BodySpec,
    key: &str,
    path: &Path,
    filled_volume: f64,
) -> Result<BuiltBody<D>, SpecError> {
    let cloud = points::read::<D>(path)
        .map_err(|error| SpecError::value(format!("`{key}.placement.path`"), error.to_string()))?;
    if cloud.positions.is_empty() {
        let message = format!("{} has no point; a body has one or more", path.display());
        return Err(SpecError::value(format!("`{key}.placement.path`"), message));
    }
    let volume = filled_volume / cloud.positions.len() as f64;
    let mut particles: Vec<_> = cloud.positions.iter().map(|&x| at_rest(x, volume, body)).collect();
    for (particle, velocity) in particles.iter_mut().zip(cloud.velocities.iter().flatten()) {
        particle.velocity = *velocity;
    }
    Ok(BuiltBody {
        particles,
        solid_mass: body.material.density() * filled_volume,
        filled_volume,
        void_volume: 0.0,
        voids: None,
        phase: Vector::zeros(),
    })
}

fn at_rest<const D: usize>(position: Vector<f64, D>, volume: f64, body: &BodySpec) -> InitialParticle<D> {
    InitialParticle {
        position,
        velocity: Vector::zeros(),
        mass: body.material.density() * volume,
        volume,
        stiffness_scale: 1.0,
        material: 0,
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
