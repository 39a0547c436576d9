//! Numbers of a scene that tell, before it is run, what it will meet.

use std::collections::HashSet;
use std::path::Path;

use serde::Serialize;
use snowlab_solver::timestep::{fastest_wave_squared, step_length, wave_limit};
use snowlab_solver::{Lame, Scene, State, StepLength};

use crate::assemble::{Assembly, time_unit, transfer};
use crate::memory;
use crate::record::maybe_infinite;
use crate::run::latest_end;
use crate::spec::scene::{MaterialSpec, PlacementSpec, VoidSpec};
use crate::spec::{SceneSpec, SpecError};

use super::approach::{Approach, approach, presses};

/// What bounds the first time step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepBound {
    /// Elastic waves: C_wave h / c.
    Waves,
    /// Motion: C_adv h / |v|.
    Motion,
    /// `greatest_step`.
    Greatest,
    /// `fixed_step`.
    Fixed,
}

/// Numbers of a scene at its start. Lengths in cells are over the spacing h.
#[derive(Clone, Debug, Serialize)]
pub struct Facts {
    /// 2 or 3.
    pub dimension: usize,
    /// Number of particles.
    pub particles: usize,
    /// Particles per cell of the filled space.
    pub particles_per_cell: f64,
    /// Share of the filled cells that have no particle at the start, expected of independent random points (exp(-PPC), Poisson); `None` where no
    /// body has such a placement.
    pub empty_cells: Option<f64>,
    /// Pairs of particles at the same place.
    pub coincident: usize,
    /// First time step [s].
    pub first_step: f64,
    /// What bounds it.
    pub bound: StepBound,
    /// dt c / h of the first step.
    pub courant: f64,
    /// The greatest dt c / h at which an explicit step is stable (docs/stability.md).
    pub courant_limit: f64,
    /// End of the run, from the start, or from the first contact where the scene says so [s].
    pub duration: f64,
    /// Speed of compression waves in the softest body, sqrt((lambda + 2 mu) / rho) [m/s].
    pub wave_speed: f64,
    /// The greatest speed at which bodies, or a body and an obstacle, come together; 0 where nothing does [m/s].
    pub impact_speed: f64,
    /// When the first of them meet [s]; infinite where nothing does.
    #[serde(with = "maybe_infinite")]
    pub first_meeting: f64,
    /// The greatest speed of a particle at the start [m/s].
    pub speed_at_start: f64,
    /// Cells from the origin of coordinates to the particle farthest from it.
    pub reach: f64,
    /// Impact speed over wave speed.
    pub mach: f64,
    /// Impact speed over the speed at which snow yields, theta c_P: behind the wave that an impact at v sends into a body at rest the strain is
    /// v / c_P (one-dimensional jump of momentum and of displacement across the front). The lesser theta of the body that yields first; `None`
    /// without snow.
    pub speed_over_yield: Option<f64>,
    /// Cells across the smallest extent of all particles.
    pub cells_across: f64,
    /// Cells across the narrowest void.
    pub cells_across_void: Option<f64>,
    /// Cells across the thinnest bridge between voids that is asked for.
    pub cells_across_bridge: Option<f64>,
    /// Particles that lie in an obstacle, by the obstacle's number.
    pub buried: Vec<(usize, usize)>,
    /// Pairs of walls that close on each other within the run, by their numbers, and when they meet [s].
    pub presses: Vec<(usize, usize, f64)>,
    /// Memory at the peak of the run [bytes].
    pub memory: Option<f64>,
    /// Memory that is free [bytes].
    pub memory_free: Option<f64>,
}

impl Facts {
    /// The facts of a scene that is built, whose meshes are in `folder`.
    ///
    /// # Errors
    /// An output that counts in crossing times of a body at rest.
    pub fn of<const D: usize>(
        spec: &SceneSpec,
        folder: &Path,
        assembly: &Assembly<f64, D>,
    ) -> Result<Self, SpecError> {
        let Assembly { scene, state, made } = assembly;
        let h = spec.numerics.spacing;
        let first_step = step_length(scene, state);
        let stiffest = fastest_wave_squared(scene, state).sqrt();
        let unit = time_unit(&spec.output, made.crossing_time)?;
        let wave_speed =
            least(spec.body.iter().map(|body| wave_speed_of(&body.material, body.stiffness_scale)));
        let yielding = spec.body.iter().filter_map(|body| {
            Some(least_strain(&body.material)? * wave_speed_of(&body.material, body.stiffness_scale))
        });
        let yield_speed = yielding.reduce(f64::min);
        let Approach { speed, time, buried } = approach(scene, state, latest_end(&spec.output, unit));
        Ok(Facts {
            dimension: D,
            particles: made.particles,
            particles_per_cell: made.particles_per_cell,
            empty_cells: is_random(spec).then(|| libm::exp(-made.particles_per_cell)),
            coincident: coincident(state),
            first_step,
            bound: bound(scene, state, first_step),
            courant: first_step * stiffest / h,
            courant_limit: wave_limit(scene.kernel, transfer(&spec.numerics)),
            duration: spec.output.end * unit,
            wave_speed,
            impact_speed: speed,
            first_meeting: time,
            speed_at_start: fastest(state),
            reach: state.motion.position.iter().map(|x| x.amax()).fold(0.0, f64::max) / h,
            mach: speed / wave_speed,
            speed_over_yield: yield_speed.map(|slowest| speed / slowest),
            cells_across: extent(state) / h,
            cells_across_void: (made.voids > 0).then_some(made.least_void_width / h),
            cells_across_bridge: bridge(spec).map(|width| width / h),
            buried,
            presses: presses(scene, latest_end(&spec.output, unit)),
            memory: memory::of_case(spec, folder, None),
            memory_free: memory::available(),
        })
    }
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, f64::min)
}

/// sqrt((lambda + 2 mu) / rho) [m/s].
fn wave_speed_of(material: &MaterialSpec, scale: f64) -> f64 {
    let (MaterialSpec::Snow { young, poisson, density, .. }
    | MaterialSpec::Elastic { young, poisson, density }) = *material;
    let Lame::<f64> { mu, lambda } = Lame::from_young(young * scale, poisson);
    ((lambda + 2.0 * mu) / density).sqrt()
}

/// The strain at which a material yields first; `None` for one that does not.
fn least_strain(material: &MaterialSpec) -> Option<f64> {
    match *material {
        MaterialSpec::Snow { critical_compression, critical_stretch, .. } => {
            Some(critical_compression.min(critical_stretch))
        }
        MaterialSpec::Elastic { .. } => None,
    }
}

fn is_random(spec: &SceneSpec) -> bool {
    spec.body.iter().any(|body| matches!(body.placement, PlacementSpec::Random(_)))
}

/// max |v_p| [m/s].
fn fastest<const D: usize>(state: &State<f64, D>) -> f64 {
    state.motion.velocity.iter().map(|v| v.norm()).fold(0.0, f64::max)
}

fn bound<const D: usize>(scene: &Scene<f64, D>, state: &State<f64, D>, first_step: f64) -> StepBound {
    match scene.time_step.length {
        StepLength::Fixed(_) => StepBound::Fixed,
        StepLength::Adaptive { greatest, .. } if first_step >= greatest => StepBound::Greatest,
        StepLength::Adaptive { advection, .. } => {
            let of_motion = advection * scene.spacing / fastest(state) <= first_step * (1.0 + 1e-9);
            if of_motion { StepBound::Motion } else { StepBound::Waves }
        }
    }
}

/// The smallest extent of the particles along an axis [m].
fn extent<const D: usize>(state: &State<f64, D>) -> f64 {
    let along = |k: usize| {
        let coordinates = || state.motion.position.iter().map(move |x| x[k]);
        coordinates().fold(f64::NEG_INFINITY, f64::max) - coordinates().fold(f64::INFINITY, f64::min)
    };
    least((0..D).map(along))
}

/// Particles at the place of an earlier one.
fn coincident<const D: usize>(state: &State<f64, D>) -> usize {
    let mut places = HashSet::with_capacity(state.len());
    let is_taken = |x: &&snowlab_solver::Vector<f64, D>| !places.insert(x.map(f64::to_bits).data.0);
    state.motion.position.iter().filter(is_taken).count()
}

/// The least solid between voids that the void fields leave [m]: the gap of inclusions, else the opening that the acceptance test makes.
fn bridge(spec: &SceneSpec) -> Option<f64> {
    let of = |voids: &VoidSpec| match voids {
        VoidSpec::Circles(field) | VoidSpec::Ellipses(field) => {
            let judged_at = field.judged_at.unwrap_or(spec.numerics.spacing);
            field.gap.unwrap_or(2.0 * judged_at)
        }
        VoidSpec::GaussianField { judged_at, .. } => 2.0 * judged_at.unwrap_or(spec.numerics.spacing),
    };
    spec.body.iter().filter_map(|body| body.voids.as_ref().map(of)).reduce(f64::min)
}
