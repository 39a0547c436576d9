//! What a run leaves behind beside its frames: how it ended, and what it cost in steps. No clock: the same case gives the
//! same bytes.

use serde::{Deserialize, Serialize};
use snowlab_solver::diagnostics::energies;
use snowlab_solver::{Real, Simulation, SimulationError, State};

use crate::assemble::Made;
use crate::stop::told;

/// How a case ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It ran to its end.
    Ok,
    /// It ran to its end, and some particles met a bound of J_P.
    OkWithClamps,
    /// It stopped.
    Stopped {
        /// Short reason, as it stands in tables.
        reason: String,
        /// The error in full.
        message: String,
    },
}

impl Outcome {
    /// `ok`, `ok-with-clamps` or `stopped(reason)`.
    pub fn in_words(&self) -> String {
        match self {
            Outcome::Ok => "ok".into(),
            Outcome::OkWithClamps => "ok-with-clamps".into(),
            Outcome::Stopped { reason, .. } => format!("stopped({reason})"),
        }
    }

    /// Why it stopped, where it has.
    pub fn message(&self) -> Option<&str> {
        match self {
            Outcome::Ok | Outcome::OkWithClamps => None,
            Outcome::Stopped { message, .. } => Some(message),
        }
    }

    /// A case whose scene cannot be built. The same scene never can: it is not tried again.
    pub fn not_built(message: String) -> Self {
        Outcome::Stopped { reason: "not-built".into(), message }
    }

    /// A case that failed for no fault of its own. It is tried again.
    pub fn failed(reason: &str, message: String) -> Self {
        Outcome::Stopped { reason: reason.into(), message }
    }

    /// A stop of `simulation` by the solver.
    pub fn stopped<T: Real, const D: usize>(error: &SimulationError, simulation: &Simulation<T, D>) -> Self {
        let reason = match error {
            SimulationError::StepRejected { .. } => "step-rejected",
            SimulationError::EnergyRise { .. } => "energy-rise",
            SimulationError::TooManySteps { .. } => "too-many-steps",
        };
        Outcome::Stopped { reason: reason.into(), message: told(error, simulation) }
    }
}

/// The ledgers of a run at one time. Energies [J].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistoryRow {
    /// Time [s].
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Kinetic energy of the particles.
    pub kinetic: f64,
    /// Elastic energy.
    pub elastic: f64,
    /// Potential energy in the field of gravity.
    pub potential: f64,
    /// Lost to plastic flow so far.
    pub plastic_loss: f64,
    /// Lost between particles and grid so far, both ways, where it is booked.
    pub transfer_loss: Option<f64>,
    /// Lost in contacts so far, where it is booked.
    pub contact_loss: Option<f64>,
    /// Work of obstacles so far.
    pub collider_work: f64,
    /// Impulse on each obstacle so far [kg m/s], by axis.
    pub impulses: Vec<Vec<f64>>,
}

impl HistoryRow {
    /// Whether all its entries are numbers, which those of f32 may outgrow.
    pub fn is_finite(&self) -> bool {
        let energies = [self.kinetic, self.elastic, self.potential, self.plastic_loss, self.collider_work];
        let booked = [self.transfer_loss, self.contact_loss];
        let impulses = self.impulses.iter().flatten();
        energies.iter().chain(booked.iter().flatten()).chain(impulses).all(|entry| entry.is_finite())
    }

    /// The ledgers of a simulation now.
    pub fn of<T: Real, const D: usize>(simulation: &Simulation<T, D>) -> Self {
        let state = simulation.state();
        let now = energies(simulation.scene(), state);
        let ledger = &state.ledger;
        let budget = simulation.scene().energy_budget;
        let booked = |loss: f64| budget.then_some(loss);
        HistoryRow {
            time: state.time,
            steps: state.steps,
            kinetic: now.kinetic,
            elastic: now.elastic,
            potential: now.potential,
            plastic_loss: ledger.plastic_loss,
            transfer_loss: booked(ledger.particles_to_grid_loss + ledger.grid_to_particles_loss),
            contact_loss: booked(ledger.colliders.iter().map(|c| c.loss).sum()),
            collider_work: ledger.collider_work(),
            impulses: ledger.colliders.iter().map(|c| c.impulse.iter().copied().collect()).collect(),
        }
    }
}

/// A run, as far as it came.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// How it ended.
    pub outcome: Outcome,
    /// What was built.
    pub made: Made,
    /// One of the output's time units [s].
    pub time_unit: f64,
    /// First contact [s].
    pub contact_time: Option<f64>,
    /// End [s].
    pub end_time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Steps times particles.
    pub particle_steps: u64,
    /// Mean step [s].
    pub mean_step: f64,
    /// Integral of (1 - a) / dt.
    pub damping: f64,
    /// Steps tried and refused.
    pub rejected_steps: u64,
    /// Times the watchdog went back.
    pub watchdog_restores: u64,
    /// Applications of the implicit steps' operators.
    #[serde(default)]
    pub iterations: u64,
    /// The most of them in a step.
    #[serde(default)]
    pub most_iterations: u32,
    /// The largest residual left by a solve, over its right side.
    #[serde(default)]
    pub largest_residual: f64,
    /// Times a particle's J_P met a bound.
    pub clamps: u64,
    /// Particles whose J_P ever met a bound.
    pub clamped_particles: usize,
    /// Ledgers at each frame.
    pub history: Vec<HistoryRow>,
    /// BLAKE3 of the final state, particles in the order of their ids.
    pub digest: String,
}

impl RunRecord {
    /// The record of a case that ended with `outcome` before it had a particle.
    pub fn without_particles(outcome: Outcome) -> Self {
        RunRecord {
            outcome,
            made: Made::default(),
            time_unit: 0.0,
            contact_time: None,
            end_time: 0.0,
            steps: 0,
            particle_steps: 0,
            mean_step: 0.0,
            damping: 0.0,
            rejected_steps: 0,
            watchdog_restores: 0,
            iterations: 0,
            most_iterations: 0,
            largest_residual: 0.0,
            clamps: 0,
            clamped_particles: 0,
            history: Vec::new(),
            digest: String::new(),
        }
    }

    /// Whether there were particles to run.
    pub fn was_built(&self) -> bool {
        self.made.particles > 0
    }

    /// The record of a simulation that ended with `error`, or well.
    pub fn of<T: Real, const D: usize>(
        simulation: &Simulation<T, D>,
        made: Made,
        time_unit: f64,
        history: Vec<HistoryRow>,
        outcome: Outcome,
    ) -> Self {
        let state = simulation.state();
        let outcome = match outcome {
            Outcome::Ok if state.ledger.clamps > 0 => Outcome::OkWithClamps,
            other => other,
        };
        RunRecord {
            outcome,
            made,
            time_unit,
            contact_time: state.first_contact,
            end_time: state.time,
            steps: state.steps,
            particle_steps: state.steps * state.len() as u64,
            mean_step: if state.steps > 0 { state.time / state.steps as f64 } else { 0.0 },
            damping: state.ledger.damping,
            rejected_steps: state.ledger.rejected_steps,
            watchdog_restores: state.ledger.watchdog_restores,
            iterations: state.ledger.iterations,
            most_iterations: state.ledger.most_iterations,
            largest_residual: state.ledger.largest_residual,
            clamps: state.ledger.clamps,
            clamped_particles: state.clamped_particles(),
            history,
            digest: digest(state),
        }
    }
}

impl RunRecord {
    /// The share of the particles whose J_P ever met a bound, in [0, 1].
    pub fn clamp_share(&self) -> f64 {
        self.clamped_particles as f64 / self.made.particles.max(1) as f64
    }
}

/// An error with its causes.
pub fn in_full(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}

/// BLAKE3 over time, positions, velocities, deformation and J_P as f64, in the order of the ids.
pub fn digest<T: Real, const D: usize>(state: &State<T, D>) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut feed = |value: f64| {
        hasher.update(&value.to_le_bytes());
    };
    feed(state.time);
    for p in state.by_id() {
        state.motion.position[p].iter().for_each(|v| feed(v.as_f64()));
        state.motion.velocity[p].iter().for_each(|v| feed(v.as_f64()));
        state.motion.deformation[p].iter().for_each(|v| feed(v.as_f64()));
        feed(state.motion.plastic_ratio[p].as_f64());
    }
    hasher.finalize().to_hex()[..32].to_string()
}

/// JSON has no infinity: it is written as null.
pub(crate) mod maybe_infinite {
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        if value.is_finite() { serializer.serialize_some(value) } else { serializer.serialize_none() }
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
    }
}
