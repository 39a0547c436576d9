//! What stopped a run, in the words of who wrote its scene: which limit was crossed, by how much, and what to change.

use snowlab_solver::error::RejectionReason;
use snowlab_solver::timestep::{fastest_wave_squared, wave_limit};
use snowlab_solver::{Integrator, Real, Scene, Simulation, SimulationError, State, StepLength};

/// The error of a run that stopped, with the stability limit there and the remedy.
pub fn told<T: Real, const D: usize>(error: &SimulationError, simulation: &Simulation<T, D>) -> String {
    let (scene, state) = (simulation.scene(), simulation.state());
    let why = match error {
        SimulationError::StepRejected { dt, .. } | SimulationError::EnergyRise { dt, .. } => {
            beside_limit(*dt, scene, state)
        }
        SimulationError::TooManySteps { .. } => Some(over_a_cell(scene, state)),
    };
    let restores = state.ledger.watchdog_restores;
    let halved = (restores > 1)
        .then(|| format!("the watchdog has halved the step {restores} times: energy kept rising"));
    let parts = [Some(error.to_string()), why, halved, Some(remedy(error, scene).into())];
    parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// `dt` [s] beside the limit derived for explicit steps from the state (docs/stability.md). Implicit steps have none.
fn beside_limit<T: Real, const D: usize>(
    dt: f64,
    scene: &Scene<T, D>,
    state: &State<T, D>,
) -> Option<String> {
    let speed = fastest_wave_squared(scene, state).as_f64().sqrt();
    let limit = wave_limit(scene.kernel, scene.transfer) * scene.spacing.as_f64() / speed;
    let known = scene.integrator == Integrator::Explicit && limit.is_finite() && limit > 0.0;
    known.then(|| format!("the stability limit there is {limit:.3e} s, this step {:.2} of it", dt / limit))
}

/// What makes steps short: how long the fastest wave and particle take over a cell [s].
fn over_a_cell<T: Real, const D: usize>(scene: &Scene<T, D>, state: &State<T, D>) -> String {
    let h = scene.spacing.as_f64();
    let wave = fastest_wave_squared(scene, state).as_f64().sqrt();
    let speed = state.motion.velocity.iter().map(|v| v.norm().as_f64()).fold(0.0, f64::max);
    // Waves stand still where hardening has left no stiffness.
    let over = |speed: f64| if speed > 0.0 { format!("{:.3e} s", h / speed) } else { "for ever".into() };
    format!("the fastest wave takes {} over a cell, the fastest particle {}", over(wave), over(speed))
}

fn remedy<T: Real, const D: usize>(error: &SimulationError, scene: &Scene<T, D>) -> &'static str {
    let fixed = matches!(scene.time_step.length, StepLength::Fixed(_));
    match error {
        SimulationError::TooManySteps { .. } => {
            "raise `numerics.max_steps`, or soften or slow what makes the steps short"
        }
        SimulationError::StepRejected { reason: RejectionReason::NotConverged { .. }, .. } => {
            "raise `max_iterations` or `tolerance` of `numerics.integrator`, or lower `numerics.greatest_step`"
        }
        _ if fixed => "make `numerics.fixed_step` shorter, or leave it out",
        SimulationError::StepRejected { .. } => {
            "look for material that obstacles overlap or trap, or that is faster than its waves"
        }
        SimulationError::EnergyRise { .. } => {
            "lower `numerics.wave_courant`, or `poisson` where it is above 0.4: plastic flow then makes energy"
        }
    }
}
