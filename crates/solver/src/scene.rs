//! What does not change in a run.

use crate::collision::{Collider, Contact};
use crate::error::SceneError;
use crate::geometry::{Matrix, Shape, Vector};
use crate::implicit::krylov::Method;
use crate::kernel::KernelKind;
use crate::material::{ConstitutiveModel, Material};
use crate::math::{determinant, norm_squared};
use crate::real::Real;

/// The share of the FLIP velocity in `v_p = (1 - a) PIC + a FLIP`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlipShare {
    /// a is the same for every step, however long (S13).
    PerStep(f64),
    /// a(dt) = share^(dt / reference_step): the damping per second does not depend on the step.
    Rate {
        /// a of a step of the reference length.
        share: f64,
        /// The reference length [s].
        reference_step: f64,
    },
}

impl FlipShare {
    /// a for a step of `dt` [s].
    pub fn of_step(&self, dt: f64) -> f64 {
        match *self {
            FlipShare::PerStep(share) => share,
            FlipShare::Rate { share, reference_step } => libm::pow(share, dt / reference_step),
        }
    }
}

/// How velocities go from grid to particles and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// A blend of PIC and FLIP (S13 section 4.1 step 8).
    Flip(FlipShare),
    /// Affine particle-in-cell (Jiang et al. 2015), forces by the kernel's gradient.
    Apic,
    /// Moving least squares MPM (Hu et al. 2018): APIC with grad w replaced by D^-1 w (x_i - x_p).
    Mls,
}

impl Transfer {
    /// Whether particles keep an affine velocity matrix.
    pub fn keeps_affine(&self) -> bool {
        matches!(self, Transfer::Apic | Transfer::Mls)
    }

    /// The FLIP share a of a step of `dt` [s], where the transfer has one.
    pub fn flip_share(&self, dt: f64) -> Option<f64> {
        match self {
            Transfer::Flip(share) => Some(share.of_step(dt)),
            Transfer::Apic | Transfer::Mls => None,
        }
    }
}

/// Who takes the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Engine {
    /// The plain definition.
    Reference,
    /// 16 particles at a time, on threads; the same step with its sums in another order. On a CPU without AVX2 and FMA: the reference.
    #[default]
    Fast,
}

impl Engine {
    /// Whether a scene that asks for it gets it on this CPU.
    pub fn is_available(self) -> bool {
        self == Engine::Reference || crate::fast::is_available()
    }

    /// The vectors that the fast engine takes on this CPU: `avx512`, `avx2` or `none`.
    pub fn vectors() -> &'static str {
        crate::fast::vectors()
    }
}

/// Which velocity moves a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Advection {
    /// The interpolated grid velocity.
    Interpolated,
    /// The particle's own, blended velocity (S13 section 4.1 step 10).
    Blended,
}

/// How nodes come by their velocity at the end of a step (`implicit`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Integrator {
    /// By the forces at its beginning (symplectic Euler).
    #[default]
    Explicit,
    /// By a share of the forces at its end, linearised (S13 section 6): first order, damped; stable without a bound from `beta` = 1/2 on.
    SemiImplicit {
        /// 0 is the explicit step, 1 backward Euler.
        beta: f64,
        /// How its linear system is solved.
        solve: LinearSolve,
    },
    /// By the mean of the forces at both ends, linearised, with positions and deformations moved by the mean of the velocities: second
    /// order, undamped.
    Trapezoidal {
        /// How its linear system is solved.
        solve: LinearSolve,
    },
}

impl Integrator {
    /// How the linear system is solved, where there is one.
    pub fn solve(&self) -> Option<&LinearSolve> {
        match self {
            Integrator::Explicit => None,
            Integrator::SemiImplicit { solve, .. } | Integrator::Trapezoidal { solve } => Some(solve),
        }
    }
}

/// How a step's linear system is solved. Residuals are weighted by the nodes' masses (S13); what other preconditioners gave is told in
/// docs/integrators.md.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSolve {
    /// Krylov method.
    pub method: Method,
    /// For the residual over the right side, each node's over the root of its mass: the error of the velocities' change over the step, relative to
    /// the change in an explicit one.
    pub tolerance: f64,
    /// Applications of the operator after which the step is refused.
    pub max_iterations: u32,
    /// Whether negative eigenvalues of the particles' Hessians count as 0.
    pub definite: bool,
}

impl Default for LinearSolve {
    fn default() -> Self {
        // chosen: a hundredth of 0.1, which gives the same errors as 1e-4 in the scenes of docs/integrators.md, for others; those need up to 28
        // iterations at this tolerance and steps of 4 h / c, and up to 141 at 0.01 and the longest steps.
        LinearSolve { method: Method::default(), tolerance: 1e-3, max_iterations: 200, definite: false }
    }
}

/// How the step is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepLength {
    /// dt = min(wave h / max c_p, advection h / max |v_p|, greatest).
    Adaptive {
        /// C_wave; `None` for half the limit of the scene's kernel and transfer (docs/stability.md).
        wave: Option<f64>,
        /// C_adv.
        advection: f64,
        /// dt_max [s].
        greatest: f64,
    },
    /// Always this [s] (but for the last two steps before an output, which share what is left).
    Fixed(f64),
}

/// The step's length and the guards behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeStepControl {
    /// How the step is chosen.
    pub length: StepLength,
    /// The watchdog compares energies every so many steps; 0 switches it off.
    pub watchdog_interval: u64,
    /// A rise of the energy by more than this share of the scene's energy is refused.
    pub watchdog_tolerance: f64,
    /// How often in a row a step may be halved before the run stops.
    pub max_rejections: u32,
    /// The run stops after so many steps.
    pub max_steps: u64,
}

impl Default for TimeStepControl {
    fn default() -> Self {
        TimeStepControl {
            // C_adv chosen: a particle crosses a cell in four steps or more, the least that keeps the return map's
            // increments small beside 1. dt_max chosen: without effect in all but motionless scenes.
            length: StepLength::Adaptive { wave: None, advection: 0.25, greatest: 1e-2 },
            // chosen: a check costs a copy of the state and a sum over the particles, little beside 50 steps, and the elastic body
            // of docs/stability.md, 12 % over its limit, is noticed at the next one. 1 %: that page's sound runs stay below 0.01 %.
            watchdog_interval: 50,
            watchdog_tolerance: 0.01,
            // chosen: 2^-12 of the first try is below any useful step.
            max_rejections: 12,
            // chosen: more than a day of the largest scenes; a run that needs it is a mistake.
            max_steps: 50_000_000,
        }
    }
}

/// A scene: everything that stays the same while the state advances. Coordinates are relative to the state's origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene<T: Real, const D: usize> {
    /// Grid spacing h [m].
    pub spacing: T,
    /// B-spline.
    pub kernel: KernelKind,
    /// Velocity transfer.
    pub transfer: Transfer,
    /// Where nodes get their velocity from.
    pub integrator: Integrator,
    /// Who takes the steps.
    pub engine: Engine,
    /// Which velocity moves particles.
    pub advection: Advection,
    /// Materials, by the index that particles hold.
    pub materials: Vec<Material<T>>,
    /// Obstacles.
    pub colliders: Vec<Collider<T, D>>,
    /// Acceleration of gravity [m/s^2].
    pub gravity: Vector<T, D>,
    /// Step length and guards.
    pub time_step: TimeStepControl,
    /// Whether every step books the energy lost in transfers and contacts. Where it does not, those entries of the ledger are NaN, and the fast
    /// engine's affine transfers need half the sums on the nodes. FLIP keeps those sums in any case.
    pub energy_budget: bool,
}

impl<T: Real, const D: usize> Scene<T, D> {
    /// Checks every value against what the method allows.
    ///
    /// # Errors
    /// The first value that is out of range, with what is allowed.
    pub fn validate(&self) -> Result<(), SceneError> {
        require(D == 2 || D == 3, "dimension", D as f64, "2 or 3")?;
        positive("spacing", self.spacing.as_f64())?;
        for k in 0..D {
            finite("gravity", self.gravity[k].as_f64())?;
        }
        require(!self.materials.is_empty(), "materials", 0.0, "at least one")?;
        for material in &self.materials {
            validate_material::<T, D>(material)?;
        }
        validate_transfer(&self.transfer)?;
        self.validate_integrator()?;
        validate_time_step(&self.time_step)?;
        self.colliders.iter().try_for_each(|collider| self.validate_collider(collider))
    }

    /// Whether the plastic ratio of some material has bounds.
    pub fn bounds_plastic_ratio(&self) -> bool {
        self.materials
            .iter()
            .any(|material| matches!(material, Material::Snow(snow) if snow.bounds_plastic_ratio()))
    }

    fn validate_integrator(&self) -> Result<(), SceneError> {
        match self.integrator {
            Integrator::Explicit => return Ok(()),
            Integrator::SemiImplicit { beta, .. } => {
                require((0.0..=1.0).contains(&beta), "beta", beta, "in [0, 1]")?
            }
            Integrator::Trapezoidal { .. } => {
                let moved = if self.advection == Advection::Interpolated { 0.0 } else { 1.0 };
                require(
                    moved == 0.0,
                    "share of the particles' own velocity in advection",
                    moved,
                    "0 with a trapezoidal step",
                )?;
            }
        }
        let solve = self.integrator.solve().expect("an integrator with a system");
        require(
            solve.tolerance > 0.0 && solve.tolerance < 1.0,
            "tolerance of the solve",
            solve.tolerance,
            "in (0, 1)",
        )?;
        require(solve.max_iterations > 0, "iterations of the solve", 0.0, "1 or more")
    }

    fn validate_collider(&self, collider: &Collider<T, D>) -> Result<(), SceneError> {
        let friction = collider.friction.as_f64();
        require(friction >= 0.0 && friction.is_finite(), "collider friction", friction, "finite and >= 0")?;
        for k in 0..D {
            finite("collider velocity", collider.velocity[k].as_f64())?;
        }
        let place = match &collider.shape {
            Shape::HalfSpace { point, .. } => point,
            Shape::Ball { centre, .. } | Shape::Box { centre, .. } => centre,
        };
        for k in 0..D {
            finite("collider position", place[k].as_f64())?;
        }
        match &collider.shape {
            Shape::HalfSpace { normal, .. } => {
                let length = normal.norm().as_f64();
                require((length - 1.0).abs() < 1e-5, "half-space normal length", length, "1")?;
            }
            Shape::Ball { radius, .. } => positive("ball collider radius", radius.as_f64())?,
            Shape::Box { half_extent, orientation, .. } => {
                for k in 0..D {
                    positive("box collider half extent", half_extent[k].as_f64())?;
                }
                let skew =
                    norm_squared(&(orientation.transpose() * orientation - Matrix::identity())).as_f64();
                let turned = skew < 1e-10 && determinant(orientation) > T::zero();
                require(
                    turned,
                    "box collider orientation",
                    skew.sqrt(),
                    "a proper rotation, |Q^T Q - I| < 1e-5",
                )?;
            }
        }
        if collider.contact == Contact::Mirror {
            collider.mirror_plane(self.spacing)?;
        }
        Ok(())
    }
}

fn validate_material<T: Real, const D: usize>(material: &Material<T>) -> Result<(), SceneError> {
    let lame = ConstitutiveModel::<T, D>::lame(material);
    positive("shear modulus mu", lame.mu.as_f64())?;
    let lambda = lame.lambda.as_f64();
    require(lambda >= 0.0 && lambda.is_finite(), "first Lame parameter lambda", lambda, "finite and >= 0")?;
    if let Material::Snow(snow) = material {
        let compression = snow.critical_compression.as_f64();
        require(compression > 0.0 && compression < 1.0, "critical compression", compression, "in (0, 1)")?;
        positive("critical stretch", snow.critical_stretch.as_f64())?;
        let hardening = snow.hardening.as_f64();
        require((0.0..=100.0).contains(&hardening), "hardening", hardening, "in [0, 100]")?;
        let (lower, upper) = snow.plastic_ratio_bounds;
        require(lower >= T::zero() && lower < T::one(), "lower bound of J_P", lower.as_f64(), "in [0, 1)")?;
        require(upper > T::one(), "upper bound of J_P", upper.as_f64(), "> 1")?;
        let limit = snow.hardening_limit;
        require(limit >= T::one(), "limit of hardening", limit.as_f64(), ">= 1")?;
    }
    Ok(())
}

fn validate_transfer(transfer: &Transfer) -> Result<(), SceneError> {
    if let Transfer::Flip(share) = transfer {
        let value = match *share {
            FlipShare::PerStep(value) => value,
            FlipShare::Rate { share, reference_step } => {
                positive("FLIP reference step", reference_step)?;
                share
            }
        };
        require((0.0..=1.0).contains(&value), "FLIP share", value, "in [0, 1]")?;
    }
    Ok(())
}

fn validate_time_step(control: &TimeStepControl) -> Result<(), SceneError> {
    let tolerance = control.watchdog_tolerance;
    require(tolerance >= 0.0 && tolerance.is_finite(), "watchdog tolerance", tolerance, "finite and >= 0")?;
    match control.length {
        StepLength::Fixed(dt) => positive("fixed time step", dt),
        StepLength::Adaptive { wave, advection, greatest } => {
            if let Some(wave) = wave {
                positive("wave Courant number", wave)?;
            }
            require(advection > 0.0 && advection <= 1.0, "advective Courant number", advection, "in (0, 1]")?;
            positive("greatest time step", greatest)
        }
    }
}

fn positive(quantity: &'static str, value: f64) -> Result<(), SceneError> {
    require(value > 0.0 && value.is_finite(), quantity, value, "finite and > 0")
}

fn finite(quantity: &'static str, value: f64) -> Result<(), SceneError> {
    require(value.is_finite(), quantity, value, "finite")
}

fn require(holds: bool, quantity: &'static str, value: f64, allowed: &'static str) -> Result<(), SceneError> {
    if holds { Ok(()) } else { Err(SceneError::OutOfRange { quantity, value, allowed }) }
}
