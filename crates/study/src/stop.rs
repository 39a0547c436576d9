//! What stopped a run, in the words of who wrote its scene: which limit was crossed, by how much, and what to change.

use snowlab_solver::error::RejectionReason;
use snowlab_solver::timestep::{fastest_wave_squared, wave_limit};
use snowlab_solver::{Integrator, Real, Scene, Simulation, SimulationError, State, StepLength};

/// The error of a run that stopped, with the stability limit there and the remedy.
pub fn told<T: Real, const D: usize>(error: &SimulationError, simulation: &Simulation<T, D>) -> String {
    let (scene, state) = (simulation.scene(), simulation.state());
    let dt = match error {
        SimulationError::StepRejected { dt, .. } | SimulationError::EnergyRise { dt, .. } => Some(*dt),
        SimulationError::TooManySteps { .. } => None,
    };
    let limit = dt.and_then(|dt| beside_limit(dt, scene, state));
    let parts = [Some(error.to_string()), limit, Some(remedy(error, scene).into())];
    parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// `dt` [s] beside the limit derived for explicit steps from the state (docs/stability.md). Implicit steps have none.
fn beside_limit<T: Real, const D: usize>(dt: f64, scene: &Scene<T, D>, state: &State<T, D>) -> Option<String> {
    let speed = fastest_wave_squared(scene, state).as_f64().sqrt();
    let limit = wave_limit(scene.kernel, scene.transfer) * scene.spacing.as_f64() / speed;
    let known = scene.integrator == Integrator::Explicit && limit.is_finite() && limit > 0.0;
    known.then(|| format!("the stability limit there is {limit:.3e} s, this step {:.2} of it", dt / limit))
}

fn remedy<T: Real, const D: usize>(error: &SimulationError, scene: &Scene<T, D>) -> &'static str {
    let fixed = matches!(scene.time_step.length, StepLength::Fixed(_));
    match error {
        SimulationError::TooManySteps { .. } => {
            "raise `numerics.max_steps`, or look for what makes the steps short: stiffness, hardening, speed"
        }
        SimulationError::StepRejected { reason: RejectionReason::NotConverged { .. }, .. } => {
            "raise `max_iterations` or `tolerance` of `numerics.integrator`, or lower `numerics.greatest_step`"
        }
        _ if fixed => "make `numerics.fixed_step` shorter, or leave it out",
        SimulationError::StepRejected { .. } => {
            "look for material that obstacles overlap or trap, or that is faster than its waves"
        }
        SimulationError::EnergyRise { .. } => {
            "lower `numerics.wave_courant` and `numerics.advective_courant`, or leave them out"
        }
    }
}
