//! The watchdog: energy cannot come from nowhere. It keeps the latest state it has accepted, to go back to.

use crate::diagnostics::{elastic_energy, potential_energy, total_mass};
use crate::error::SimulationError;
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;

/// What a run is watched by.
#[derive(Clone, Debug)]
pub(crate) struct Watchdog<T: Real, const D: usize> {
    accepted: Option<Snapshot<T, D>>,
    /// What a rise is measured by [J].
    scale: f64,
}

/// The latest state that passed.
#[derive(Clone, Debug)]
struct Snapshot<T: Real, const D: usize> {
    state: State<T, D>,
    /// Its energy [J].
    energy: f64,
    /// The energy that a later one is compared with [J]: that of the latest check on schedule.
    reference: f64,
}

/// When a state is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Check {
    /// Every so many steps.
    OnSchedule,
    /// Between, where somebody is about to keep the state. However many of these there are, a rise counts from the last
    /// check on schedule, or small rises that add up would pass.
    Between,
}

/// What a check found.
pub(crate) enum Verdict {
    /// The state is the new snapshot.
    Accepted,
    /// Energy rose.
    Refused(SimulationError),
}

impl<T: Real, const D: usize> Watchdog<T, D> {
    /// For a run of `scene` from `state`.
    pub(crate) fn new(scene: &Scene<T, D>, state: &State<T, D>) -> Self {
        let gravity = scene.gravity.norm().as_f64();
        // The energy to lift all material by one cell: the least that a rise is measured by in a scene at rest.
        Watchdog { accepted: None, scale: total_mass(state) * gravity * scene.spacing.as_f64() }
    }

    /// Compares the energy of `state`, whose kinetic energy on the grid is `kinetic` [J], with that of an earlier check:
    /// elastic, potential, and kinetic as the grid sees it, less the work of obstacles, can only fall. `dt` is the step
    /// that a refusal is laid to [s].
    pub(crate) fn check(
        &mut self,
        scene: &Scene<T, D>,
        state: State<T, D>,
        kinetic: f64,
        dt: f64,
        check: Check,
    ) -> Verdict {
        let elastic = elastic_energy(scene, &state.motion, &state.constants);
        let work = state.ledger.collider_work();
        let energy = kinetic + elastic + potential_energy(scene, &state) - work;
        let mut reference = energy;
        if let Some(snapshot) = &self.accepted {
            let scale = self.scale.max(work.abs());
            let tolerance = scene.time_step.watchdog_tolerance;
            // Written so that a NaN is refused as well.
            if !(energy - snapshot.reference <= tolerance * scale) {
                let (time, before, after) = (state.time, snapshot.reference, energy);
                return Verdict::Refused(SimulationError::EnergyRise {
                    time,
                    before,
                    after,
                    scale,
                    tolerance,
                    dt,
                });
            }
            if check == Check::Between {
                reference = snapshot.reference;
            }
        } else {
            self.scale = self.scale.max(kinetic + elastic);
        }
        self.accepted = Some(Snapshot { state, energy, reference });
        Verdict::Accepted
    }

    /// The snapshot, from which a rise counts anew; `None` before the first check.
    pub(crate) fn go_back(&mut self) -> Option<State<T, D>> {
        let snapshot = self.accepted.as_mut()?;
        snapshot.reference = snapshot.energy;
        Some(snapshot.state.clone())
    }
}
