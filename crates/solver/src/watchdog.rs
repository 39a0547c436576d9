//! The watchdog: energy cannot come from nowhere. It keeps the latest state it has accepted, to go back to.

use serde::{Deserialize, Serialize};

use crate::diagnostics::total_mass;
use crate::error::SimulationError;
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;

/// What a run is watched by; `S` is what it goes back to.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Watchdog<S> {
    accepted: Option<Snapshot<S>>,
    /// What a rise is measured by [J].
    scale: f64,
}

/// The latest state that passed.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Snapshot<S> {
    saved: S,
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

/// What a state holds beside its motion [J].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StoredEnergy {
    pub elastic: f64,
    /// 0 at the world's origin.
    pub potential: f64,
}

/// A state that is looked at.
#[derive(Clone, Debug)]
pub(crate) struct Candidate<S> {
    pub saved: S,
    /// [s].
    pub time: f64,
    pub stored: StoredEnergy,
    /// Work of obstacles on the material so far [J].
    pub work: f64,
}

/// What a check found.
pub(crate) enum Verdict {
    /// The state is the new snapshot.
    Accepted,
    /// Energy rose.
    Refused(SimulationError),
}

impl<S: Clone> Watchdog<S> {
    /// For a run of `scene` from `state`.
    pub(crate) fn new<T: Real, const D: usize>(scene: &Scene<T, D>, state: &State<T, D>) -> Self {
        let gravity = scene.gravity.norm().as_f64();
        // The energy to lift all material by one cell: the least that a rise is measured by in a scene at rest.
        Watchdog { accepted: None, scale: total_mass(state) * gravity * scene.spacing.as_f64() }
    }

    /// Compares the energy of a state, whose kinetic energy on the grid is `kinetic` [J], with that of an earlier check:
    /// elastic, potential, and kinetic as the grid sees it, less the work of obstacles, can only fall, but for a share of `tolerance`. `dt` is
    /// the step that a refusal is laid to [s].
    pub(crate) fn check(
        &mut self,
        candidate: Candidate<S>,
        kinetic: f64,
        dt: f64,
        check: Check,
        tolerance: f64,
    ) -> Verdict {
        let Candidate { saved, time, stored, work } = candidate;
        let energy = kinetic + stored.elastic + stored.potential - work;
        let mut reference = energy;
        if let Some(snapshot) = &self.accepted {
            let scale = self.scale.max(work.abs());
            // Written so that a NaN is refused as well.
            if !(energy - snapshot.reference <= tolerance * scale) {
                let (before, after) = (snapshot.reference, energy);
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
            self.scale = self.scale.max(kinetic + stored.elastic);
        }
        self.accepted = Some(Snapshot { saved, energy, reference });
        Verdict::Accepted
    }

    /// What it would go back to; `None` before the first check.
    pub(crate) fn accepted(&self) -> Option<&S> {
        self.accepted.as_ref().map(|snapshot| &snapshot.saved)
    }

    /// The snapshot, from which a rise counts anew; `None` before the first check.
    pub(crate) fn go_back(&mut self) -> Option<S> {
        let snapshot = self.accepted.as_mut()?;
        snapshot.reference = snapshot.energy;
        Some(snapshot.saved.clone())
    }
}
