//! Numerics and materials.

use snowlab_solver::{
    Advection, Elastic, Engine, FlipShare, Integrator, KernelKind, Lame, LinearSolve, Material, Method, Real,
    Scene, Snow, StepLength, TimeStepControl, Transfer, Vector,
};

use crate::spec::SpecError;
use crate::spec::scene::{
    AdvectionName, EngineName, IntegratorSpec, KernelName, MaterialSpec, MethodName, NumericsSpec, SceneSpec,
    SemiImplicitSpec, TransferName, TrapezoidalSpec,
};

use super::obstacle::collider;
use super::vector::vector_or_zero;

pub(super) fn scene<T: Real, const D: usize>(
    spec: &SceneSpec,
    origin: &Vector<f64, D>,
) -> Result<Scene<T, D>, SpecError> {
    let n = &spec.numerics;
    let colliders = spec.collider.iter().enumerate();
    Ok(Scene {
        spacing: T::of(n.spacing),
        kernel: kernel(n.kernel),
        transfer: transfer(n),
        integrator: n.integrator.as_ref().map_or(Integrator::Explicit, integrator),
        engine: engine(n.engine),
        advection: match n.advection {
            AdvectionName::Interpolated => Advection::Interpolated,
            AdvectionName::Blended => Advection::Blended,
        },
        materials: spec.body.iter().map(|body| material(&body.material)).collect(),
        colliders: colliders.map(|(k, c)| collider(c, k, origin, n.spacing)).collect::<Result<_, _>>()?,
        gravity: vector_or_zero::<D>(&spec.gravity, "gravity")?.map(T::of),
        time_step: time_step(n),
        energy_budget: n.energy_budget,
    })
}

/// The engine that a scene names.
pub fn engine(name: EngineName) -> Engine {
    match name {
        EngineName::Fast => Engine::Fast,
        EngineName::Reference => Engine::Reference,
    }
}

/// The kernel that a scene names.
pub fn kernel(name: KernelName) -> KernelKind {
    match name {
        KernelName::Cubic => KernelKind::Cubic,
        KernelName::Quadratic => KernelKind::Quadratic,
    }
}

/// The velocity transfer that a scene asks for.
pub fn transfer(n: &NumericsSpec) -> Transfer {
    match n.transfer {
        TransferName::Apic => Transfer::Apic,
        TransferName::Mls => Transfer::Mls,
        TransferName::Flip if n.flip_per_step => Transfer::Flip(FlipShare::PerStep(n.flip_share)),
        TransferName::Flip => {
            Transfer::Flip(FlipShare::Rate { share: n.flip_share, reference_step: n.flip_reference_step })
        }
    }
}

fn integrator(spec: &IntegratorSpec) -> Integrator {
    match spec {
        IntegratorSpec::SemiImplicit(spec) => {
            let SemiImplicitSpec { beta, method, tolerance, max_iterations, definite } = *spec;
            let method = krylov_method(method);
            let solve = LinearSolve { method, tolerance, max_iterations, definite };
            Integrator::SemiImplicit { beta, solve }
        }
        IntegratorSpec::Trapezoidal(spec) => {
            let TrapezoidalSpec { method, tolerance, max_iterations, definite } = *spec;
            let method = krylov_method(method);
            Integrator::Trapezoidal { solve: LinearSolve { method, tolerance, max_iterations, definite } }
        }
    }
}

fn krylov_method(name: MethodName) -> Method {
    match name {
        MethodName::Minres => Method::Minres,
        MethodName::ConjugateResiduals => Method::ConjugateResiduals,
    }
}

pub(super) fn time_step(n: &NumericsSpec) -> TimeStepControl {
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

/// The material that a body names.
pub fn material<T: Real>(spec: &MaterialSpec) -> Material<T> {
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
            hardening_limit,
            ..
        } => {
            let [lower, upper] = plastic_ratio_bounds.unwrap_or([0.0, f64::INFINITY]);
            Material::Snow(Snow {
                lame: Lame::from_young(young, poisson),
                critical_compression: T::of(critical_compression),
                critical_stretch: T::of(critical_stretch),
                hardening: T::of(hardening),
                plastic_ratio_bounds: (T::of(lower), T::of(upper)),
                hardening_limit: T::of(hardening_limit.unwrap_or(f64::INFINITY)),
            })
        }
    }
}
