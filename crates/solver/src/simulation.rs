//! A run: steps of adaptive length, rejected steps tried again, and the watchdog behind them.

use std::sync::OnceLock;

use crate::checkpoint::Saved;
use crate::diagnostics::{elastic_energy, potential_energy};
use crate::error::{Rejection, SceneError, SimulationError};
use crate::geometry::Vector;
use crate::ledger::{Ledger, StepLedger};
use crate::real::Real;
use crate::scene::{Scene, StepLength};
use crate::sort::sort_by_block;
use crate::state::State;
use crate::step::{Workspace, accept, kinetic_on_grid, step};
use crate::timestep::{StepHistory, meet, step_length, step_length_for};
use crate::watchdog::{Candidate, Check, StoredEnergy, Verdict, Watchdog};

/// The reference engine's particles are sorted anew after so many steps (chosen: sorting costs as much as a third of a step; in 16 steps few
/// particles leave their block).
const SORT_INTERVAL: u64 = 16;

/// A scene with its state and scratch memory.
#[derive(Clone, Debug)]
pub struct Simulation<T: Real, const D: usize> {
    scene: Scene<T, D>,
    /// Without particles while the fast engine holds them.
    pub(crate) state: State<T, D>,
    /// The whole state, made when somebody asks for it while the fast engine holds the particles.
    seen: OnceLock<State<T, D>>,
    pub(crate) workspace: Workspace<T, D>,
    pub(crate) watchdog: Watchdog<Saved<T, D>>,
}

impl<T: Real, const D: usize> Simulation<T, D> {
    /// A run of `scene` from `state`.
    ///
    /// # Errors
    /// What [`Scene::validate`] and [`State::validate`] find.
    pub fn new(scene: Scene<T, D>, state: State<T, D>) -> Result<Self, SceneError> {
        Self::with_threads(scene, state, 1)
    }

    /// As [`Simulation::new`], on so many threads; their number does not show in any bit of a result. The reference engine uses one.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn with_threads(scene: Scene<T, D>, state: State<T, D>, threads: usize) -> Result<Self, SceneError> {
        let workspace = Workspace::with_threads(&scene, &state, threads)?;
        let watchdog = Watchdog::new(&scene, &state);
        Ok(Self::of_parts(scene, state, workspace, watchdog))
    }

    pub(crate) fn of_parts(
        scene: Scene<T, D>,
        state: State<T, D>,
        workspace: Workspace<T, D>,
        watchdog: Watchdog<Saved<T, D>>,
    ) -> Self {
        Simulation { scene, state, seen: OnceLock::new(), workspace, watchdog }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene<T, D> {
        &self.scene
    }

    /// The state now. Asked for while the fast engine holds the particles it is made anew, once a step: [`Simulation::time`] and its like cost
    /// nothing.
    pub fn state(&self) -> &State<T, D> {
        match &self.workspace.fast {
            Some(fast) if fast.is_loaded() => self.seen.get_or_init(|| {
                let mut state = self.state.clone();
                fast.write(&self.scene, &mut state);
                state
            }),
            _ => &self.state,
        }
    }

    /// Time [s].
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Accepted steps.
    pub fn steps(&self) -> u64 {
        self.state.steps
    }

    /// Sums over the run so far.
    pub fn ledger(&self) -> &Ledger<D> {
        &self.state.ledger
    }

    /// When an obstacle, mirrors not counted, first changed a velocity [s].
    pub fn first_contact(&self) -> Option<f64> {
        self.state.first_contact
    }

    /// The state, to be changed between steps (for tests and prepared scenes).
    pub fn state_mut(&mut self) -> &mut State<T, D> {
        self.unload();
        &mut self.state
    }

    /// Gives each particle the acceleration by a force of its own that `of` tells for its id [m/s^2], until it is told another.
    pub fn accelerate(&mut self, of: impl Fn(u32) -> Vector<T, D>) {
        self.seen.take();
        if let Some(fast) = &mut self.workspace.fast
            && fast.is_loaded()
            && fast.accelerate(&of)
        {
            return;
        }
        let state = self.state_mut();
        state.body_acceleration = state.constants.id.iter().map(|&id| of(id)).collect();
    }

    /// Bytes of particles and grid that the fast engine holds; those of snapshots and of the reference engine are not counted.
    pub fn bytes(&self) -> usize {
        self.workspace.fast.as_ref().map_or(0, |fast| fast.bytes())
    }

    /// Takes the particles back from the fast engine.
    fn unload(&mut self) {
        if let Some(fast) = &mut self.workspace.fast
            && fast.is_loaded()
        {
            match self.seen.take() {
                Some(seen) => self.state = seen,
                None => fast.write(&self.scene, &mut self.state),
            }
            fast.unload();
        }
    }

    /// Hands the particles to the fast engine, where there is one.
    fn load(&mut self) {
        if let Some(fast) = &mut self.workspace.fast
            && !fast.is_loaded()
        {
            fast.load(&self.scene, &self.state);
            self.state.take_particles();
        }
    }

    /// Advances to `time` [s], which is met exactly, in a state that the watchdog has accepted. It begins from the state as it would be saved, so
    /// that a run that goes on from a saved state has the same bits.
    ///
    /// # Errors
    /// Where no smaller step helps; the state is then the last one accepted.
    pub fn advance_to(&mut self, time: f64) -> Result<(), SimulationError> {
        self.unload();
        loop {
            while self.state.time < time {
                self.advance_one(time)?;
            }
            if self.confirm()? {
                return Ok(());
            }
        }
    }

    /// Has the watchdog look at the state as it is: to be called before a state is kept, and before a run is called done,
    /// for between its checks the watchdog is blind. `false` where it refused the state and went back, in time too, to one that
    /// it had accepted, from which the run goes on with smaller steps. It never goes back beyond a state confirmed here.
    ///
    /// # Errors
    /// [`SimulationError::EnergyRise`] where no smaller step is left to try; the state is then the last one accepted.
    pub fn confirm(&mut self) -> Result<bool, SimulationError> {
        if self.scene.time_step.watchdog_interval == 0 {
            return Ok(true);
        }
        self.load();
        let kinetic = match &mut self.workspace.fast {
            Some(fast) => fast.kinetic_on_grid(&self.scene),
            None => kinetic_on_grid(&self.scene, &self.state, &mut self.workspace),
        };
        let dt = self.step_length();
        self.watch(self.candidate(), kinetic, dt, Check::Between)
    }

    /// Takes one step, not beyond `end` [s]. Where the watchdog, which looks every so many steps, refuses the state, the step
    /// leads back in time to the last one it accepted.
    ///
    /// # Errors
    /// As [`Simulation::advance_to`].
    pub fn advance_one(&mut self, end: f64) -> Result<(), SimulationError> {
        let control = self.scene.time_step;
        if self.state.steps >= control.max_steps {
            return Err(SimulationError::TooManySteps { steps: self.state.steps, time: self.state.time });
        }
        self.load();
        if self.workspace.fast.is_none() && self.state.steps.is_multiple_of(SORT_INTERVAL) {
            sort_by_block(&self.scene, &mut self.state);
        }
        let checked =
            control.watchdog_interval > 0 && self.state.steps.is_multiple_of(control.watchdog_interval);
        let candidate = checked.then(|| self.candidate());
        let remaining = end - self.state.time;
        let reach = self.step_length();
        let dt = meet(reach, remaining);
        let (kinetic, taken) = self.step_or_halve(dt, checked)?;
        self.state.step_reach = if taken == dt { reach } else { taken };
        // Additions of dt may miss the end by round-off: the last step ends there by definition.
        if dt == remaining && self.state.time != end && (self.state.time - end).abs() <= 1e-9 * dt {
            self.state.time = end;
        }
        match candidate {
            Some(before) => self.watch(before, kinetic, dt, Check::OnSchedule).map(|_| ()),
            None => Ok(()),
        }
    }

    fn step_length(&self) -> f64 {
        match &self.workspace.fast {
            Some(fast) => {
                let history = StepHistory { factor: self.state.step_factor, reach: self.state.step_reach };
                step_length_for(&self.scene, history, fast.fastest())
            }
            None => step_length(&self.scene, &self.state),
        }
    }

    /// With `energies` the ledger has the grid's kinetic energies, whether the scene wants them or not.
    fn step(&mut self, dt: f64, energies: bool) -> Result<StepLedger<D>, Rejection> {
        let Some(fast) = &mut self.workspace.fast else {
            return step(&self.scene, &mut self.state, &mut self.workspace, dt);
        };
        let ledger = fast.step(&self.scene, self.state.time, dt, energies)?;
        self.seen.take();
        accept(&self.scene, &mut self.state, &ledger, dt);
        Ok(ledger)
    }

    /// Tries `dt`, then halves of it; the grid's kinetic energy at the beginning of the step [J], and the length that was taken [s].
    fn step_or_halve(&mut self, dt: f64, energies: bool) -> Result<(f64, f64), SimulationError> {
        let mut tried = dt;
        for halvings in 0.. {
            match self.step(tried, energies) {
                Ok(ledger) => return Ok((ledger.kinetic_grid_before, tried)),
                Err(rejection) => {
                    self.seen.take();
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

    /// The state as the watchdog wants it.
    fn candidate(&self) -> Candidate<Saved<T, D>> {
        let Simulation { scene, state, workspace, .. } = self;
        let (particles, stored) = match &workspace.fast {
            Some(fast) => (Some(fast.save()), fast.stored_energy(scene, &state.origin)),
            None => {
                let elastic = elastic_energy(scene, &state.motion, &state.constants);
                (None, StoredEnergy { elastic, potential: potential_energy(scene, state) })
            }
        };
        let saved = Saved { state: state.clone(), particles };
        Candidate { saved, time: state.time, stored, work: state.ledger.collider_work() }
    }

    /// Shows the watchdog a state that the run was in; `false` where it went back.
    fn watch(
        &mut self,
        candidate: Candidate<Saved<T, D>>,
        kinetic: f64,
        dt: f64,
        check: Check,
    ) -> Result<bool, SimulationError> {
        let tolerance = self.scene.time_step.watchdog_tolerance;
        match self.watchdog.check(candidate, kinetic, dt, check, tolerance) {
            Verdict::Accepted => Ok(true),
            Verdict::Refused(error) => self.restore(error).map(|()| false),
        }
    }

    /// Goes back to the snapshot, and on with half the step, or gives up with `error`.
    fn restore(&mut self, error: SimulationError) -> Result<(), SimulationError> {
        let restores = self.state.ledger.watchdog_restores + 1;
        let rejected = self.state.ledger.rejected_steps;
        let factor = self.state.step_factor * 0.5;
        if let Some(Saved { state, particles }) = self.watchdog.go_back() {
            self.state = state;
            self.seen.take();
            if let (Some(fast), Some(particles)) = (&mut self.workspace.fast, particles) {
                fast.restore(&self.scene, particles);
            }
        }
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
