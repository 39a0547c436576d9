//! Grid, kernel, transfer, time step.

use serde::{Deserialize, Serialize};

/// Numerical choices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NumericsSpec {
    /// Grid spacing h [m].
    pub spacing: f64,
    /// B-spline.
    #[serde(default)]
    pub kernel: KernelName,
    /// Transfer between particles and grid.
    #[serde(default)]
    pub transfer: TransferName,
    /// Who carries out the transfer.
    #[serde(default)]
    pub engine: EngineName,
    /// FLIP share a of a step of the reference length.
    #[serde(default = "defaults::flip_share")]
    pub flip_share: f64,
    /// Length of the step `flip_share` is meant for [s].
    #[serde(default = "defaults::flip_reference_step")]
    pub flip_reference_step: f64,
    /// Whether the share is the same for every step, however long (S13).
    #[serde(default)]
    pub flip_per_step: bool,
    /// Which velocity moves particles.
    #[serde(default)]
    pub advection: AdvectionName,
    /// Implicit steps; explicit ones when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integrator: Option<IntegratorSpec>,
    /// How rest volumes are found.
    #[serde(default)]
    pub rest_volume: RestVolumeName,
    /// Floating point type of the run.
    #[serde(default)]
    pub precision: PrecisionName,
    /// A fixed time step [s] instead of the adaptive one.
    #[serde(default)]
    pub fixed_step: Option<f64>,
    /// C_wave; half the stability limit when left out.
    #[serde(default)]
    pub wave_courant: Option<f64>,
    /// C_adv.
    #[serde(default = "defaults::advective_courant")]
    pub advective_courant: f64,
    /// Longest time step [s].
    #[serde(default = "defaults::greatest_step")]
    pub greatest_step: f64,
    /// Whether the energy watchdog is on.
    #[serde(default = "defaults::yes")]
    pub watchdog: bool,
    /// Whether the energy that transfers and contacts lose is booked.
    #[serde(default = "defaults::yes", skip_serializing_if = "is_yes")]
    pub energy_budget: bool,
    /// The run stops after so many steps.
    #[serde(default = "defaults::max_steps")]
    pub max_steps: u64,
}

/// Implicit steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum IntegratorSpec {
    /// A share of the forces at the end of the step.
    SemiImplicit(SemiImplicitSpec),
    /// The mean of the forces at both ends.
    Trapezoidal(TrapezoidalSpec),
}

/// Semi-implicit steps and the solve of their linear system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SemiImplicitSpec {
    /// Share of the forces at the end of the step.
    #[serde(default = "defaults::beta")]
    pub beta: f64,
    /// Krylov method.
    #[serde(default)]
    pub method: MethodName,
    /// For the residual over the right side.
    #[serde(default = "defaults::tolerance")]
    pub tolerance: f64,
    /// After so many the step is refused.
    #[serde(default = "defaults::max_iterations")]
    pub max_iterations: u32,
    /// Whether the particles' Hessians are made positive semi-definite.
    #[serde(default)]
    pub definite: bool,
}

/// Trapezoidal steps and the solve of their linear system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrapezoidalSpec {
    /// Krylov method.
    #[serde(default)]
    pub method: MethodName,
    /// For the residual over the right side.
    #[serde(default = "defaults::tolerance")]
    pub tolerance: f64,
    /// After so many the step is refused.
    #[serde(default = "defaults::max_iterations")]
    pub max_iterations: u32,
    /// Whether the particles' Hessians are made positive semi-definite.
    #[serde(default)]
    pub definite: bool,
}

macro_rules! names {
    ($(#[$doc:meta])* $name:ident { $first:ident $(, $other:ident)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        #[allow(missing_docs)]
        pub enum $name { #[default] $first $(, $other)* }
    };
}

names!(/** B-spline kernels. */ KernelName { Cubic, Quadratic });
names!(/** Transfers between particles and grid. */ TransferName { Flip, Apic, Mls });
names!(/** Engines. */ EngineName { Fast, Reference });
names!(/** Velocities that can move particles. */ AdvectionName { Interpolated, Blended });
names!(/** Krylov methods. */ MethodName { Minres, ConjugateResiduals });
names!(/** Rules for rest volumes. */ RestVolumeName { Uniform, Density });
names!(/** Floating point types. */ PrecisionName { F64, F32 });

/// Whether a switch is on; what is on by default is not written out, so that a case has the key it had before there was the switch.
fn is_yes(switch: &bool) -> bool {
    *switch
}

/// Defaults of keys that may be left out. The FLIP share: the study's definition (docs/experiment.md); the rest is the solver's.
mod defaults {
    use snowlab_solver::{LinearSolve, StepLength, TimeStepControl};

    pub fn yes() -> bool {
        true
    }
    pub fn flip_share() -> f64 {
        0.95
    }
    pub fn flip_reference_step() -> f64 {
        1e-5
    }
    pub fn advective_courant() -> f64 {
        adaptive().0
    }
    pub fn greatest_step() -> f64 {
        adaptive().1
    }
    /// The least share of the end that is stable however long the step (S13 section 6).
    pub fn beta() -> f64 {
        0.5
    }
    pub fn tolerance() -> f64 {
        LinearSolve::default().tolerance
    }
    pub fn max_iterations() -> u32 {
        LinearSolve::default().max_iterations
    }
    pub fn max_steps() -> u64 {
        TimeStepControl::default().max_steps
    }

    fn adaptive() -> (f64, f64) {
        match TimeStepControl::default().length {
            StepLength::Adaptive { advection, greatest, .. } => (advection, greatest),
            StepLength::Fixed(dt) => (1.0, dt),
        }
    }
}
