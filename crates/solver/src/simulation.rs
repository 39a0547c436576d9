//! A run: steps of adaptive length, rejected steps tried again, and the watchdog behind them.

use crate::diagnostics::{elastic_energy, potential_energy, total_mass};
use crate::error::{SceneError, SimulationError};
use crate::real::Real;
use crate::scene::{Scene, StepLength};
use crate::sort::sort_by_block;
use crate::state::State;
use crate::step::{Workspace, step};
use crate::timestep::{meet, step_length};

/// Particles are sorted anew after so many steps (chosen: sorting costs as much as a third of a step, and in 64 steps few
/// particles leave their block).
const SORT_INTERVAL: u64 = 16;

/// A scene with its state and scratch memory.
#[derive(Clone, Debug)]
pub struct Simulation<T: Real, const D: usize> {
    scene: Scene<T, D>,
    state: State<T, D>,
    workspace: Workspace<T, D>,
    accepted: Option<Snapshot<T, D>>,
    energy_scale: f64,
}

/// The latest state that passed the watchdog.
#[derive(Clone, Debug)]
struct Snapshot<T: Real, const D: usize> {
    state: State<T, D>,
    energy: f64,
}

impl<T: Real, const D: usize> Simulation<T, D> {
    /// A run of `scene` from `state`.
    ///
    /// # Errors
    /// What [`Scene::validate`] and [`State::validate`] find.
    pub fn new(scene: Scene<T, D>, state: State<T, D>) -> Result<Self, SceneError> {
        let workspace = Workspace::new(&scene, &state)?;
        let gravity = scene.gravity.norm().as_f64();
        // The energy to lift all material by one cell: the least that a rise is measured by in a scene at rest.
        let energy_scale = total_mass(&state) * gravity * scene.spacing.as_f64();
        Ok(Simulation { scene, state, workspace, accepted: None, energy_scale })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene<T, D> {
        &self.scene
    }

    /// The state now.
    pub fn state(&self) -> &State<T, D> {
        &self.state
    }

    /// The state, to be changed between steps (for tests and prepared scenes).
    pub fn state_mut(&mut self) -> &mut State<T, D> {
        &mut self.state
    }

    /// Advances to `time` [s], which is met exactly.
    ///
    /// # Errors
    /// Where no smaller step helps; the state is then the last one accepted.
    pub fn advance_to(&mut self, time: f64) -> Result<(), SimulationError> {
        while self.state.time < time {
            self.advance_one(time)?;
        }
        Ok(())
    }

    /// Takes one step, not beyond `end` [s].
    ///
    /// # Errors
    /// As [`Simulation::advance_to`].
    pub fn advance_one(&mut self, end: f64) -> Result<(), SimulationError> {
        let control = self.scene.time_step;
        if self.state.steps >= control.max_steps {
            return Err(SimulationError::TooManySteps { steps: self.state.steps, time: self.state.time });
        }
        if self.state.steps.is_multiple_of(SORT_INTERVAL) {
            sort_by_block(&self.scene, &mut self.state);
        }
        let checked =
            control.watchdog_interval > 0 && self.state.steps.is_multiple_of(control.watchdog_interval);
        let candidate = checked.then(|| self.state.clone());
        let remaining = end - self.state.time;
        let dt = meet(step_length(&self.scene, &self.state), remaining);
        let kinetic = self.step_or_halve(dt)?;
        // Additions of dt may miss the end by round-off: the last step ends there by definition.
        if dt == remaining && self.state.time != end && (self.state.time - end).abs() <= 1e-9 * dt {
            self.state.time = end;
        }
        match candidate {
            Some(before) => self.watch(before, kinetic, dt),
            None => Ok(()),
        }
    }

    /// Tries `dt`, then halves of it; the grid's kinetic energy at the beginning of the step [J].
    fn step_or_halve(&mut self, dt: f64) -> Result<f64, SimulationError> {
        let mut tried = dt;
        for halvings in 0.. {
            match step(&self.scene, &mut self.state, &mut self.workspace, tried) {
                Ok(ledger) => return Ok(ledger.kinetic_grid_before),
                Err(rejection) => {
                    self.state.ledger.rejected_steps += 1;
                    let fixed = matches!(self.scene.time_step.length, StepLength::Fixed(_));
                    if fixed || halvings == self.scene.time_step.max_rejections {
                        return Err(SimulationError::StepRejected {
                            particle: rejection.particle,
                            time: self.state.time,
                            dt: tried,
                            halvings,
                            reason: rejection.reason,
                        });
                    }
                    tried *= 0.5;
                }
            }
        }
        unreachable!("the loop returns")
    }

    /// Compares the energy at the beginning of the step just taken with that of the last snapshot: elastic, potential,
    /// and kinetic as the grid sees it, less the work of obstacles, can only fall.
    fn watch(&mut self, before: State<T, D>, kinetic: f64, dt: f64) -> Result<(), SimulationError> {
        let elastic = elastic_energy(&self.scene, &before.motion, &before.constants);
        let work = before.ledger.collider_work();
        let energy = kinetic + elastic + potential_energy(&self.scene, &before) - work;
        let tolerance = self.scene.time_step.watchdog_tolerance;
        if let Some(snapshot) = &self.accepted {
            let scale = self.energy_scale.max(work.abs());
            // Written so that a NaN is refused as well.
            if !(energy - snapshot.energy <= tolerance * scale) {
                return self.restore(energy, scale, dt);
            }
        } else {
            self.energy_scale = self.energy_scale.max(kinetic + elastic);
        }
        self.accepted = Some(Snapshot { state: before, energy });
        Ok(())
    }

    fn restore(&mut self, energy: f64, scale: f64, dt: f64) -> Result<(), SimulationError> {
        let Some(snapshot) = &self.accepted else { return Ok(()) };
        let error = SimulationError::EnergyRise {
            time: self.state.time,
            before: snapshot.energy,
            after: energy,
            scale,
            tolerance: self.scene.time_step.watchdog_tolerance,
            dt,
        };
        let restores = self.state.ledger.watchdog_restores + 1;
        let rejected = self.state.ledger.rejected_steps;
        let factor = self.state.step_factor * 0.5;
        self.state = snapshot.state.clone();
        self.state.ledger.watchdog_restores = restores;
        self.state.ledger.rejected_steps = rejected;
        let fixed = matches!(self.scene.time_step.length, StepLength::Fixed(_));
        if fixed || restores > u64::from(self.scene.time_step.max_rejections) {
            return Err(error);
        }
        self.state.step_factor = factor;
        Ok(())
    }
}
