//! Materials, scenes and bodies that the experiments share.

use std::ops::Range;

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::{Matrix, Shape, Vector, unit};
use snowlab_solver::{
    Advection, Elastic, Engine, FlipShare, InitialParticle, Integrator, KernelKind, Lame, Material, Real,
    Scene, Snow, State, StepLength, TimeStepControl, Transfer,
};

/// Young's modulus of S13's snow [Pa] (table 2).
pub const YOUNG: f64 = 1.4e5;
/// Its Poisson's ratio.
pub const POISSON: f64 = 0.2;
/// Its density [kg/m^D].
pub const DENSITY: f64 = 400.0;
/// Its critical compression theta_c.
pub const CRITICAL_COMPRESSION: f64 = 2.5e-2;
/// Its critical stretch theta_s.
pub const CRITICAL_STRETCH: f64 = 7.5e-3;
/// Its hardening coefficient xi.
pub const HARDENING: f64 = 10.0;

/// mu_0 and lambda_0 of S13's snow [Pa].
pub fn lame() -> Lame<f64> {
    Lame::from_young(YOUNG, POISSON)
}

/// M = lambda + 2 mu, the modulus of strain along one axis [Pa].
pub fn axial_modulus() -> f64 {
    let Lame { mu, lambda } = lame();
    lambda + 2.0 * mu
}

/// c = sqrt(M / rho), of a wave along its own direction in a wide body [m/s].
pub fn wave_speed() -> f64 {
    (axial_modulus() / DENSITY).sqrt()
}

/// Acceleration of gravity where a scene has any [m/s^2]: the standard value, rounded.
pub const GRAVITY: f64 = 9.81;

/// S13's snow.
pub fn snow<T: Real>() -> Material<T> {
    Material::Snow(Snow {
        lame: Lame::from_young(YOUNG, POISSON),
        critical_compression: T::of(CRITICAL_COMPRESSION),
        critical_stretch: T::of(CRITICAL_STRETCH),
        hardening: T::of(HARDENING),
        plastic_ratio_bounds: (T::zero(), T::of(f64::INFINITY)),
        hardening_limit: T::of(f64::INFINITY),
    })
}

/// The same without a yield surface.
pub fn elastic<T: Real>() -> Material<T> {
    Material::Elastic(Elastic { lame: Lame::from_young(YOUNG, POISSON) })
}

/// One material, no gravity, no obstacle, adaptive step.
pub fn scene<T: Real, const D: usize>(
    spacing: f64,
    kernel: KernelKind,
    transfer: Transfer,
    material: Material<T>,
) -> Scene<T, D> {
    Scene {
        spacing: T::of(spacing),
        kernel,
        transfer,
        engine: Engine::default(),
        integrator: Integrator::Explicit,
        advection: Advection::Interpolated,
        materials: vec![material],
        colliders: Vec::new(),
        gravity: Vector::zeros(),
        time_step: TimeStepControl::default(),
        energy_budget: true,
    }
}

/// A fixed step of `dt` [s] without watchdog.
pub fn fixed_step(dt: f64) -> TimeStepControl {
    TimeStepControl { length: StepLength::Fixed(dt), watchdog_interval: 0, ..TimeStepControl::default() }
}

/// A particle of snow at rest.
pub fn particle<const D: usize>(position: Vector<f64, D>, volume: f64) -> InitialParticle<D> {
    InitialParticle {
        position,
        velocity: Vector::zeros(),
        mass: DENSITY * volume,
        volume,
        stiffness_scale: 1.0,
        deformation: Matrix::identity(),
        plastic_ratio: 1.0,
        material: 0,
    }
}

/// `per_axis`^D particles in each of `cells` cells of spacing `h`, on a lattice with its corner at the origin.
pub fn lattice<const D: usize>(h: f64, cells: [usize; D], per_axis: usize) -> Vec<InitialParticle<D>> {
    let counts = cells.map(|c| c * per_axis);
    let apart = h / per_axis as f64;
    (0..counts.iter().product())
        .map(|index: usize| {
            let mut rest = index;
            let mut position = Vector::zeros();
            for axis in (0..D).rev() {
                position[axis] = ((rest % counts[axis]) as f64 + 0.5) * apart;
                rest /= counts[axis];
            }
            particle(position, (0..D).fold(1.0, |volume, _| volume * apart))
        })
        .collect()
}

/// A disc about `centre` [m], 4 particles to a cell on a lattice about it, all with one velocity [m/s].
pub fn disc(
    h: f64,
    centre: Vector<f64, 2>,
    radius: f64,
    velocity: Vector<f64, 2>,
) -> Vec<InitialParticle<2>> {
    let cells = 2 * libm::ceil(radius / h) as usize;
    let middle = centre.add_scalar(-0.5 * cells as f64 * h);
    lattice::<2>(h, [cells; 2], 2)
        .into_iter()
        .map(|body| InitialParticle { position: body.position + middle, velocity, ..body })
        .filter(|body| (body.position - centre).norm() < radius)
        .collect()
}

/// How some particles move as a whole.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion {
    /// Mass [kg/m].
    pub mass: f64,
    /// Centre of mass [m].
    pub centre: Vector<f64, 2>,
    /// Its velocity [m/s].
    pub velocity: Vector<f64, 2>,
    /// Angular momentum about it, apic's affine part included [kg m/s].
    pub angular_momentum: f64,
    /// Moment of inertia about it [kg m].
    pub inertia: f64,
}

/// The motion of the particles with the given ids.
pub fn body_motion(scene: &Scene<f64, 2>, state: &State<f64, 2>, ids: Range<u32>) -> BodyMotion {
    let own: Vec<usize> = (0..state.len()).filter(|&p| ids.contains(&state.constants.id[p])).collect();
    let (position, velocity, mass) = (&state.motion.position, &state.motion.velocity, &state.constants.mass);
    let total: f64 = own.iter().map(|&p| mass[p]).sum();
    let mean = |field: &[Vector<f64, 2>]| {
        own.iter().fold(Vector::<f64, 2>::zeros(), |sum, &p| sum + field[p] * (mass[p] / total))
    };
    let (centre, drift) = (mean(position), mean(velocity));
    let of_affine = scene.spacing * scene.spacing / scene.kernel.inverse_inertia();
    let (mut angular, mut inertia) = (0.0, 0.0);
    for &p in &own {
        let (x, v) = (position[p] - centre, velocity[p] - drift);
        angular += mass[p] * x.perp(&v);
        inertia += mass[p] * x.norm_squared();
        if let Some(c) = state.motion.affine.get(p) {
            angular += mass[p] * of_affine * (c[(1, 0)] - c[(0, 1)]);
        }
    }
    BodyMotion {
        mass: total,
        centre: state.origin + centre,
        velocity: drift,
        angular_momentum: angular,
        inertia,
    }
}

/// The half-space beyond `at` [m] on one axis, its normal along `sign`.
pub fn wall<T: Real, const D: usize>(axis: usize, sign: f64, at: f64, contact: Contact) -> Collider<T, D> {
    Collider {
        shape: Shape::HalfSpace {
            point: unit::<T, D>(axis) * T::of(at),
            normal: unit::<T, D>(axis) * T::of(sign),
        },
        contact,
        friction: T::zero(),
        velocity: Vector::zeros(),
    }
}

/// Both B-splines.
pub const KERNELS: [KernelKind; 2] = [KernelKind::Cubic, KernelKind::Quadratic];
/// The transfers compared: FLIP as S13 has it, APIC, MLS.
pub const TRANSFERS: [Transfer; 3] =
    [Transfer::Flip(FlipShare::PerStep(0.95)), Transfer::Apic, Transfer::Mls];

/// `cubic` or `quadratic`.
pub fn kernel_name(kernel: KernelKind) -> &'static str {
    match kernel {
        KernelKind::Cubic => "cubic",
        KernelKind::Quadratic => "quadratic",
    }
}

/// `flip`, `apic` or `mls`.
pub fn transfer_name(transfer: Transfer) -> &'static str {
    match transfer {
        Transfer::Flip(_) => "flip",
        Transfer::Apic => "apic",
        Transfer::Mls => "mls",
    }
}

/// The exponent p of error = C size^p, by least squares in logarithms; `points` are (size, error).
pub fn observed_order(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (libm::log(*x), libm::log(*y))).collect();
    let count = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / count, sy + y / count));
    let (top, bottom) = logs
        .iter()
        .fold((0.0, 0.0), |(top, bottom), (u, v)| (top + (u - x) * (v - y), bottom + (u - x) * (u - x)));
    top / bottom
}

/// FLIP's share of 0.95 as a rate, for steps of `reference_step` [s]: a share per step would damp the more, the shorter the step.
pub fn rate_form(transfer: Transfer, reference_step: f64) -> Transfer {
    match transfer {
        Transfer::Flip(_) => Transfer::Flip(FlipShare::Rate { share: 0.95, reference_step }),
        other => other,
    }
}
