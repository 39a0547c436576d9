//! What can go wrong, with the numbers.

use thiserror::Error;

/// A scene or an initial state that the method cannot take.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    /// A value out of range.
    #[error("{quantity} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// What.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A particle's field out of range.
    #[error("particle {particle}: {quantity} is {value}; allowed: {allowed}")]
    Particle {
        /// Index of the particle.
        particle: usize,
        /// Which field.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Fields of different lengths.
    #[error("{field} has {found} entries; expected: {expected}")]
    Length {
        /// Which field.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A checkpoint that is none of this scene.
    #[error("the checkpoint does not fit the scene: {reason}")]
    Checkpoint {
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A mirror that is not a plane of nodes.
    #[error("a mirror must be a static half-space whose plane is a row of nodes: {reason}")]
    Mirror {
        /// What is wrong with it.
        reason: String,
    },
}

/// Why one step was not taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RejectionReason {
    /// det(I + dt grad v) <= 0 or not a number.
    Inverted {
        /// The determinant.
        determinant: f64,
    },
    /// A particle would move further than a cell.
    TooFar {
        /// Distance in cells.
        cells: f64,
    },
    /// The linear system of an implicit step was not solved to its tolerance.
    NotConverged {
        /// Applications of the operator.
        iterations: u32,
        /// What was left of the residual.
        residual: f64,
        /// What may be left.
        tolerance: f64,
    },
}

impl std::fmt::Display for RejectionReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            RejectionReason::Inverted { determinant } if determinant.is_nan() => {
                write!(f, "velocities or forces outgrow the precision (det(I + dt grad v) is no number)")
            }
            RejectionReason::Inverted { determinant } => {
                write!(f, "the step turns an element inside out (det(I + dt grad v) = {determinant:e})")
            }
            RejectionReason::TooFar { cells } => write!(f, "a particle moves {cells:.3} cells in one step"),
            RejectionReason::NotConverged { iterations, residual, tolerance } => write!(
                f,
                "the linear system's residual is {residual:.3e} after {iterations} iterations, {tolerance:.3e} is asked for"
            ),
        }
    }
}

/// A step that was not taken; the state is as before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rejection {
    /// Number (`id`) of the particle that refused it; `None` where all did together.
    pub particle: Option<u32>,
    /// Why.
    pub reason: RejectionReason,
}

/// A run that stopped before its end. The state is the last one that was accepted.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SimulationError {
    /// Halving the step did not help.
    #[error(
        "{}t = {time:.6e} s: {reason}, also at dt = {dt:.3e} s after {halvings} halvings",
        particle.map_or_else(|| "at ".to_owned(), |particle| format!("particle {particle} at "))
    )]
    StepRejected {
        /// Number (`id`) of the particle, where one refused the step.
        particle: Option<u32>,
        /// Time [s].
        time: f64,
        /// The last step tried [s].
        dt: f64,
        /// Halvings tried.
        halvings: u32,
        /// Why.
        reason: RejectionReason,
    },
    /// The watchdog found energy from nowhere, and no smaller step is left to try.
    #[error(
        "energy rose from {before:.6e} J to {} by t = {time:.6e} s, more than {tolerance} of {scale:.3e} J, \
         at dt = {dt:.3e} s: the step is above the stability limit",
        if after.is_finite() { format!("{after:.6e} J") } else { "more than the precision holds".to_owned() }
    )]
    EnergyRise {
        /// Time [s].
        time: f64,
        /// Energy less the colliders' work at the last accepted check [J].
        before: f64,
        /// Now [J].
        after: f64,
        /// The energy of the scene the rise is measured by [J].
        scale: f64,
        /// Allowed share.
        tolerance: f64,
        /// Latest step [s].
        dt: f64,
    },
    /// More steps than the scene allows.
    #[error("{steps} steps taken by t = {time:.6e} s, the most the scene allows (max_steps)")]
    TooManySteps {
        /// Steps taken.
        steps: u64,
        /// Time [s].
        time: f64,
    },
}
