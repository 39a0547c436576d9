//! Materials, scenes and bodies that the experiments share.

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::{Matrix, Shape, Vector, unit};
use snowlab_solver::{
    Advection, Elastic, Engine, FlipShare, InitialParticle, KernelKind, Lame, Material, Real, Scene, Snow,
    StepLength, TimeStepControl, Transfer,
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

/// S13's snow.
pub fn snow<T: Real>() -> Material<T> {
    Material::Snow(Snow {
        lame: Lame::from_young(YOUNG, POISSON),
        critical_compression: T::of(CRITICAL_COMPRESSION),
        critical_stretch: T::of(CRITICAL_STRETCH),
        hardening: T::of(HARDENING),
        plastic_ratio_bounds: (T::zero(), T::of(f64::INFINITY)),
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
        advection: Advection::Interpolated,
        materials: vec![material],
        colliders: Vec::new(),
        gravity: Vector::zeros(),
        time_step: TimeStepControl::default(),
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

/// FLIP's share as a rate: a share per step would damp the more, the shorter the step.
pub fn rate_form(transfer: Transfer) -> Transfer {
    match transfer {
        Transfer::Flip(_) => Transfer::Flip(FlipShare::Rate { share: 0.95, reference_step: 1e-5 }),
        other => other,
    }
}
