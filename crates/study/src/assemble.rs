//! From a scene file's words to particles, obstacles and numerics.

use std::path::Path;

use snowlab_sampler::{
    DrawnVoids, GaussianField, InclusionField, InclusionShape, Orientation, Purpose, Region, Sampler,
    Streams, VoidField, draw_voids, place, rng,
};
use snowlab_solver::{
    Advection, Collider, Contact, Elastic, FlipShare, InitialParticle, KernelKind, Lame, Material, Matrix,
    Real, Scene, Shape, Snow, State, StepLength, TimeStepControl, Transfer, Vector,
};

use crate::points;
use crate::spec::scene::{
    AdvectionName, BodySpec, ColliderSpec, ContactName, CountOf, InclusionSpec, KernelName, MaterialSpec,
    NumericsSpec, OutputSpec, PlacementSpec, RegionSpec, RestVolumeName, SceneSpec, SolidSpec, TimeUnit,
    TransferName, VoidSpec,
};
use crate::spec::{Spec, SpecError};

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

/// Builds `spec`. Paths of particle files are relative to `folder`.
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
    let mut made = Made::default();
    for (number, body) in spec.body.iter().enumerate() {
        let built = build_body::<D>(spec, body, number, folder)?;
        made.add(&built, number);
        particles.extend(built.particles);
    }
    made.finish(&particles, spec.numerics.spacing.powi(D as i32));
    made.crossing_time = crossing_time::<D>(&spec.body[0], &particles)?;
    let origin = local_origin(&particles, spec.numerics.spacing);
    check_reach(&particles, &origin, spec.numerics.spacing)?;
    let scene = scene::<T, D>(spec, &origin)?;
    let refused = |error: snowlab_solver::SceneError| SpecError::value("scene", error.to_string());
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

/// One body as particles.
struct BuiltBody<const D: usize> {
    particles: Vec<InitialParticle<D>>,
    solid_mass: f64,
    filled_volume: f64,
    void_volume: f64,
    voids: Option<DrawnVoids<D>>,
    phase: Vector<f64, D>,
}

fn build_body<const D: usize>(
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

/// R / v: half the largest extent of the first body's region, or of all particles without one, over its speed.
fn crossing_time<const D: usize>(
    body: &BodySpec,
    particles: &[InitialParticle<D>],
) -> Result<f64, SpecError> {
    let extent = match &body.region {
        Some(spec) => {
            let bounds = region::<D>(spec, "body.0.region")?.bounding_box();
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

/// Nodes are counted by 32 bits: a body this many cells from the local origin has room to move as far again.
const MOST_CELLS: f64 = (1_u32 << 30) as f64;

fn check_reach<const D: usize>(
    particles: &[InitialParticle<D>],
    origin: &Vector<f64, D>,
    spacing: f64,
) -> Result<(), SpecError> {
    let reach = particles.iter().map(|p| (p.position - origin).amax()).fold(0.0, f64::max) / spacing;
    if reach < MOST_CELLS {
        return Ok(());
    }
    let message = format!(
        "is {spacing:?}, so that the bodies reach {reach:.3e} cells from their middle; allowed: {MOST_CELLS}"
    );
    Err(SpecError::value("`numerics.spacing`", message))
}

fn local_origin<const D: usize>(particles: &[InitialParticle<D>], spacing: f64) -> Vector<f64, D> {
    let mean = particles.iter().fold(Vector::<f64, D>::zeros(), |sum, p| sum + p.position)
        / particles.len().max(1) as f64;
    if mean.amax() > FAR * spacing { mean.map(|c| (c / spacing).round() * spacing) } else { Vector::zeros() }
}

fn scene<T: Real, const D: usize>(
    spec: &SceneSpec,
    origin: &Vector<f64, D>,
) -> Result<Scene<T, D>, SpecError> {
    let n = &spec.numerics;
    let colliders = spec.collider.iter().enumerate();
    Ok(Scene {
        spacing: T::of(n.spacing),
        kernel: match n.kernel {
            KernelName::Cubic => KernelKind::Cubic,
            KernelName::Quadratic => KernelKind::Quadratic,
        },
        transfer: transfer(n),
        advection: match n.advection {
            AdvectionName::Interpolated => Advection::Interpolated,
            AdvectionName::Blended => Advection::Blended,
        },
        materials: spec.body.iter().map(|body| material(&body.material)).collect(),
        colliders: colliders.map(|(k, c)| collider(c, k, origin, n.spacing)).collect::<Result<_, _>>()?,
        gravity: vector_or_zero::<D>(&spec.gravity, "gravity")?.map(T::of),
        time_step: time_step(n),
    })
}

fn transfer(n: &NumericsSpec) -> Transfer {
    match n.transfer {
        TransferName::Apic => Transfer::Apic,
        TransferName::Mls => Transfer::Mls,
        TransferName::Flip if n.flip_per_step => Transfer::Flip(FlipShare::PerStep(n.flip_share)),
        TransferName::Flip => {
            Transfer::Flip(FlipShare::Rate { share: n.flip_share, reference_step: n.flip_reference_step })
        }
    }
}

fn time_step(n: &NumericsSpec) -> TimeStepControl {
    let guards = TimeStepControl::default();
    TimeStepControl {
        length: match n.fixed_step {
            Some(dt) => StepLength::Fixed(dt),
            None => StepLength::Adaptive {
                wave: n.wave_courant,
                advection: n.advective_courant,
                greatest: n.greatest_step,
            },
        },
        watchdog_interval: if n.watchdog { guards.watchdog_interval } else { 0 },
        max_steps: n.max_steps,
        ..guards
    }
}

fn material<T: Real>(spec: &MaterialSpec) -> Material<T> {
    match *spec {
        MaterialSpec::Elastic { young, poisson, .. } => {
            Material::Elastic(Elastic { lame: Lame::from_young(young, poisson) })
        }
        MaterialSpec::Snow {
            young,
            poisson,
            critical_compression,
            critical_stretch,
            hardening,
            plastic_ratio_bounds,
            ..
        } => {
            let [lower, upper] = plastic_ratio_bounds.unwrap_or([0.0, f64::INFINITY]);
            Material::Snow(Snow {
                lame: Lame::from_young(young, poisson),
                critical_compression: T::of(critical_compression),
                critical_stretch: T::of(critical_stretch),
                hardening: T::of(hardening),
                plastic_ratio_bounds: (T::of(lower), T::of(upper)),
            })
        }
    }
}

fn collider<T: Real, const D: usize>(
    spec: &ColliderSpec,
    number: usize,
    origin: &Vector<f64, D>,
    spacing: f64,
) -> Result<Collider<T, D>, SpecError> {
    let key = format!("collider.{number}");
    let at = |values: &[f64], name: &str| vector::<D>(values, &format!("{key}.shape.{name}"));
    let shape = match &spec.shape {
        SolidSpec::HalfSpace { point, normal } => {
            half_space(at(point, "point")? - origin, at(normal, "normal")?, spacing)
        }
        SolidSpec::Ball { centre, radius } => {
            Shape::Ball { centre: (at(centre, "centre")? - origin).map(T::of), radius: T::of(*radius) }
        }
        SolidSpec::Box { centre, half_extent, angle } => Shape::Box {
            centre: (at(centre, "centre")? - origin).map(T::of),
            half_extent: at(half_extent, "half_extent")?.map(T::of),
            orientation: snowlab_sampler::rotation::<D>(angle.to_radians()).map(T::of),
        },
    };
    let collider = Collider {
        shape,
        contact: match spec.contact {
            ContactName::Separate => Contact::Separate,
            ContactName::Slip => Contact::Slip,
            ContactName::Sticky => Contact::Sticky,
            ContactName::Mirror => Contact::Mirror,
        },
        friction: T::of(spec.friction),
        velocity: vector_or_zero::<D>(&spec.velocity, &format!("{key}.velocity"))?.map(T::of),
    };
    if collider.contact == Contact::Mirror {
        collider
            .mirror_plane(T::of(spacing))
            .map_err(|error| SpecError::value(format!("`{key}`"), error.to_string()))?;
    }
    Ok(collider)
}

/// A plane across an axis that lies on a row of nodes to within 1e-6 of a cell is put exactly where the grid puts that row,
/// so that the nodes on it are in contact whatever the rounding.
fn half_space<T: Real, const D: usize>(
    mut point: Vector<f64, D>,
    normal: Vector<f64, D>,
    spacing: f64,
) -> Shape<T, D> {
    let normal = normal.normalize();
    let mut local = point.map(T::of);
    if let Some(axis) = (0..D).find(|&k| normal[k].abs() == 1.0) {
        let row = (point[axis] / spacing).round();
        if (point[axis] / spacing - row).abs() < 1e-6 && row.abs() < f64::from(i32::MAX) {
            point[axis] = row * spacing;
            local[axis] = T::of_index(row as i32) * T::of(spacing);
        }
    }
    Shape::HalfSpace { point: local, normal: normal.map(T::of) }
}

/// The region a body's words describe.
///
/// # Errors
/// A vector of the wrong length.
pub fn region<const D: usize>(spec: &RegionSpec, key: &str) -> Result<Region<D>, SpecError> {
    let at = |values: &[f64], name: &str| vector::<D>(values, &format!("{key}.{name}"));
    Ok(match spec {
        RegionSpec::Ball { centre, radius } => {
            Region::Ball { centre: at(centre, "centre")?, radius: *radius }
        }
        RegionSpec::Box { centre, half_extent, angle } => Region::Box {
            centre: at(centre, "centre")?,
            half_extent: at(half_extent, "half_extent")?,
            orientation: snowlab_sampler::rotation(angle.to_radians()),
        },
        RegionSpec::Ellipsoid { centre, semi_axes, angle } => Region::Ellipsoid {
            centre: at(centre, "centre")?,
            semi_axes: at(semi_axes, "semi_axes")?,
            orientation: snowlab_sampler::rotation(angle.to_radians()),
        },
        RegionSpec::Union { parts } => Region::Union(
            parts
                .iter()
                .enumerate()
                .map(|(k, part)| region(part, &format!("{key}.parts.{k}")))
                .collect::<Result<_, _>>()?,
        ),
        RegionSpec::Difference { solid, removed } => Region::Difference {
            solid: Box::new(region(solid, &format!("{key}.solid"))?),
            removed: Box::new(region(removed, &format!("{key}.removed"))?),
        },
    })
}

fn sampler(placement: &PlacementSpec) -> (Sampler, usize, CountOf) {
    match *placement {
        PlacementSpec::Random { count, count_of } => (Sampler::Random, count, count_of),
        PlacementSpec::Jittered { count, count_of, angle } => {
            (Sampler::Jittered { angle: angle.to_radians() }, count, count_of)
        }
        PlacementSpec::Lattice { count, count_of, angle } => {
            (Sampler::Lattice { angle: angle.to_radians() }, count, count_of)
        }
        PlacementSpec::PoissonDisk { count, count_of } => (Sampler::PoissonDisk, count, count_of),
        PlacementSpec::File { .. } => (Sampler::Random, 0, CountOf::Body),
    }
}

/// The field and the spacing it is judged by [m].
fn void_field(spec: &VoidSpec, spacing: f64) -> (VoidField, f64) {
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

/// One of the output's time units [s].
///
/// # Errors
/// Crossing times of a body at rest.
pub fn time_unit(output: &OutputSpec, crossing_time: f64) -> Result<f64, SpecError> {
    match output.time_unit {
        TimeUnit::Second => Ok(1.0),
        TimeUnit::Crossing if crossing_time.is_finite() => Ok(crossing_time),
        TimeUnit::Crossing => Err(SpecError::value(
            "output.time_unit",
            "is `crossing`, but the first body does not move; use `second`",
        )),
    }
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

fn vector_or_zero<const D: usize>(values: &[f64], key: &str) -> Result<Vector<f64, D>, SpecError> {
    if values.is_empty() { Ok(Vector::zeros()) } else { vector(values, key) }
}

fn vector<const D: usize>(values: &[f64], key: &str) -> Result<Vector<f64, D>, SpecError> {
    if values.len() == D && values.iter().all(|v| v.is_finite()) {
        return Ok(Vector::from_fn(|k, _| values[k]));
    }
    Err(SpecError::value(key, format!("is {values:?}; a scene in {D}D takes {D} finite numbers")))
}
