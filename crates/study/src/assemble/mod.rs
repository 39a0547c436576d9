//! From a scene file's words to particles, obstacles and numerics.

mod body;
mod mesh;
mod numerics;
mod obstacle;
mod region;
mod vector;

pub use numerics::{engine, kernel, material, transfer};
pub use region::region;

use std::path::Path;

use snowlab_solver::{InitialParticle, Real, Scene, State, Vector};

use crate::spec::scene::{
    BodySpec, NumericsSpec, OutputSpec, PrecisionName, RestVolumeName, SceneSpec, TimeUnit,
};
use crate::spec::{Spec, SpecError};

use body::{BuiltBody, build_body};
use numerics::scene;
use vector::vector_or_zero;

/// A scene ready to run, with what is worth recording of how it was built.
#[derive(Clone, Debug)]
pub struct Assembly<T: Real, const D: usize> {
    /// What does not change.
    pub scene: Scene<T, D>,
    /// What does.
    pub state: State<T, D>,
    /// What was built.
    pub made: Made,
}

/// What a sampler made of a scene.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Made {
    /// Number of particles.
    pub particles: usize,
    /// Mass of all particles [kg].
    pub mass: f64,
    /// Mass of the bodies without their voids [kg].
    pub solid_mass: f64,
    /// Area or volume the particles fill [m^D].
    pub filled_volume: f64,
    /// Share of the bodies that is void.
    pub porosity: f64,
    /// Draws of void fields until each was accepted, all bodies together; 0 without voids.
    pub void_draws: usize,
    /// Width of the narrowest void [m]: the diameter of the largest circle or ball in it; infinite without voids.
    #[serde(with = "crate::record::maybe_infinite")]
    pub least_void_width: f64,
    /// Number of voids.
    pub voids: usize,
    /// Particles per cell of the filled space.
    pub particles_per_cell: f64,
    /// R / v of the first body [s]: half its largest extent over its speed; infinite at rest.
    #[serde(with = "crate::record::maybe_infinite")]
    pub crossing_time: f64,
    /// Shift of the first body by the grid phase [m].
    pub phase: Vec<f64>,
}

/// Bodies further than so many cells from the world's origin get a local origin near them, which f32 needs to resolve
/// a step's motion (chosen: 2^14 cells leave 2^-9 of a cell in f32).
const FAR: f64 = 16384.0;

/// Builds `spec`. Paths of particle files and meshes are relative to `folder`.
///
/// # Errors
/// [`SpecError::Value`] with key, value and remedy.
pub fn assemble<T: Real, const D: usize>(
    spec: &SceneSpec,
    folder: &Path,
) -> Result<Assembly<T, D>, SpecError> {
    spec.validate()?;
    if spec.dimension != D {
        return Err(SpecError::value("`dimension`", format!("is {}, but {D} is asked for", spec.dimension)));
    }
    let mut particles = Vec::new();
    let mut made = Made { least_void_width: f64::INFINITY, ..Made::default() };
    for (number, body) in spec.body.iter().enumerate() {
        let built = build_body::<D>(spec, body, number, folder)?;
        made.add(&built, number);
        particles.extend(built.particles);
    }
    made.finish(&particles, spec.numerics.spacing.powi(D as i32));
    made.crossing_time = crossing_time::<D>(&spec.body[0], &particles, folder)?;
    let origin = local_origin(&particles, spec.numerics.spacing);
    check_reach(&particles, &origin, &spec.numerics)?;
    let scene = scene::<T, D>(spec, &origin)?;
    let refused = |error: snowlab_solver::SceneError| {
        let advice = "check the bodies' sizes, densities and stiffness, and `numerics.precision`";
        SpecError::value("scene", format!("{error}; {advice}"))
    };
    let mut state = State::at_rest(&scene, origin, &particles).map_err(refused)?;
    if spec.numerics.rest_volume == RestVolumeName::Density {
        state.assign_density_volumes(&scene);
    }
    Ok(Assembly { scene, state, made })
}

impl Made {
    fn add<const D: usize>(&mut self, body: &BuiltBody<D>, number: usize) {
        self.solid_mass += body.solid_mass;
        self.filled_volume += body.filled_volume;
        // Until the sum is known, the void volume.
        self.porosity += body.void_volume;
        if let Some(voids) = &body.voids {
            self.void_draws += voids.draws;
            self.voids += voids.count;
            self.least_void_width = self.least_void_width.min(voids.least_width);
        }
        if number == 0 {
            self.phase = body.phase.iter().copied().collect();
        }
    }

    fn finish<const D: usize>(&mut self, particles: &[InitialParticle<D>], cell: f64) {
        self.particles = particles.len();
        self.mass = particles.iter().map(|p| p.mass).sum();
        self.porosity /= self.porosity + self.filled_volume;
        self.particles_per_cell = particles.len() as f64 * cell / self.filled_volume;
    }
}

/// One of the output's time units [s].
///
/// # Errors
/// Crossing times of a body at rest or without extent.
pub fn time_unit(output: &OutputSpec, crossing_time: f64) -> Result<f64, SpecError> {
    match output.time_unit {
        TimeUnit::Second => Ok(1.0),
        TimeUnit::Crossing if crossing_time.is_finite() && crossing_time > 0.0 => Ok(crossing_time),
        TimeUnit::Crossing => Err(SpecError::value(
            "`output.time_unit`",
            "is `crossing`, but the first body does not move or has no extent; use `second`",
        )),
    }
}

/// R / v: half the largest extent of the first body's region, or of all particles without one, over its speed.
fn crossing_time<const D: usize>(
    body: &BodySpec,
    particles: &[InitialParticle<D>],
    folder: &Path,
) -> Result<f64, SpecError> {
    let extent = match &body.region {
        Some(spec) => {
            let bounds = region::<D>(spec, "body.0.region", folder)?.bounding_box();
            (bounds.max - bounds.min).max()
        }
        None => (0..D)
            .map(|k| {
                let coordinates = particles.iter().map(|p| p.position[k]);
                coordinates.clone().fold(f64::NEG_INFINITY, f64::max)
                    - coordinates.fold(f64::INFINITY, f64::min)
            })
            .fold(0.0, f64::max),
    };
    Ok(0.5 * extent / vector_or_zero::<D>(&body.velocity, "body.0.velocity")?.norm())
}

/// Cells that a body may reach from the local origin. Nodes are counted by 32 bits, and there is room to move as far again; f32 has at least
/// 8 places within a cell there.
fn most_cells(precision: PrecisionName) -> u32 {
    match precision {
        PrecisionName::F64 => 1 << 30,
        PrecisionName::F32 => 1 << 20,
    }
}

fn check_reach<const D: usize>(
    particles: &[InitialParticle<D>],
    origin: &Vector<f64, D>,
    numerics: &NumericsSpec,
) -> Result<(), SpecError> {
    let (spacing, most) = (numerics.spacing, most_cells(numerics.precision));
    let reach = particles.iter().map(|p| (p.position - origin).amax()).fold(0.0, f64::max) / spacing;
    if reach < f64::from(most) {
        return Ok(());
    }
    let message = format!(
        "is {spacing:?}, so that the bodies reach {reach:.3e} cells from their middle; allowed: {most}"
    );
    Err(SpecError::value("`numerics.spacing`", message))
}

fn local_origin<const D: usize>(particles: &[InitialParticle<D>], spacing: f64) -> Vector<f64, D> {
    let mean = particles.iter().fold(Vector::<f64, D>::zeros(), |sum, p| sum + p.position)
        / particles.len().max(1) as f64;
    if mean.amax() > FAR * spacing { mean.map(|c| (c / spacing).round() * spacing) } else { Vector::zeros() }
}
