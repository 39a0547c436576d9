//! The semi-implicit step (S13 section 6): forces at the end of the step, linearised about its beginning, instead of forces at its
//! beginning.
//!
//! With the grid's Hessian H of the elastic energy at F_E^n, the velocities v^n that particles give the nodes, and their explicit
//! change dt (f / m + g), the change D over the step solves
//!
//! ```text
//! (M + c H) D = dt (f + M g) - s H v^n
//!     c = s = beta dt^2             semi-implicit; the same as S13's (M + beta dt^2 H) v^{n+1} = M v*
//!     c = dt^2 / 4, s = dt^2 / 2    trapezoidal: (M + dt^2/4 H) v^{n+1} = M v^n + dt (f + M g) - dt^2/4 H v^n
//! ```
//!
//! Written for the change, the system does not feel a motion of the whole, its right side vanishes in equilibrium, and the guess D = 0 is the last
//! step's solution, carried over by the particles. What comes of it is a force: f - (s H v^n + c H D) / dt takes the place of f, and the
//! rest of the step, contact with friction and mirrors included, goes on as an explicit one does. So momentum is kept to round-off however
//! coarsely the system was solved, and Coulomb's law sees the whole normal impulse, the solver's reaction included.
//!
//! Nodes that an obstacle holds begin with its velocity along its normal (all of it where they stick), in place of v^n, and keep it during
//! the solve. Where it would have to pull at one that may leave, the node is released and the system solved again.

mod constraint;
pub mod krylov;
mod operator;
mod plain;
#[cfg(test)]
mod tests;

pub(crate) use constraint::{Held, Released, held_nodes, release};
use krylov::Goal;
pub use krylov::{LinearSystem, Method, Solution};
#[cfg(test)]
pub(crate) use plain::PlainStep;
pub(crate) use plain::{Implicit, ImplicitStep, add_implicit_forces};

use crate::error::{Rejection, RejectionReason};
use crate::ledger::StepLedger;
use crate::scene::{Integrator, LinearSolve};

/// c and s of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficients {
    /// Of H D [s^2].
    pub of_change: f64,
    /// Of H v^n [s^2].
    pub of_start: f64,
}

impl Coefficients {
    /// Of a step of `dt` [s]; `None` where it is explicit.
    pub fn of(integrator: &Integrator, dt: f64) -> Option<Self> {
        match *integrator {
            Integrator::Explicit => None,
            Integrator::SemiImplicit { beta: 0.0, .. } => None,
            Integrator::SemiImplicit { beta, .. } => {
                let both = beta * dt * dt;
                Some(Coefficients { of_change: both, of_start: both })
            }
            Integrator::Trapezoidal { .. } => {
                Some(Coefficients { of_change: 0.25 * dt * dt, of_start: 0.5 * dt * dt })
            }
        }
    }

    /// Of a step of `dt` [s], with how its system is solved; `None` where there is none.
    pub fn and_solve(integrator: &Integrator, dt: f64) -> Option<(Self, &LinearSolve)> {
        Some((Self::of(integrator, dt)?, integrator.solve()?))
    }
}

impl Solution {
    /// Books the solve in its step.
    ///
    /// # Errors
    /// A solve that has not converged.
    pub(crate) fn accept<const D: usize>(
        self,
        how: &LinearSolve,
        ledger: &mut StepLedger<D>,
    ) -> Result<(), Rejection> {
        ledger.solve = self;
        if self.converged {
            return Ok(());
        }
        let Solution { iterations, residual, .. } = self;
        let reason = RejectionReason::NotConverged { iterations, residual, tolerance: how.tolerance };
        Err(Rejection { particle: None, reason })
    }
}

/// The linear system of a step, as an engine keeps it. Fields are vectors with an entry for every node, 0 where it counts as empty.
pub(crate) trait StepSystem: LinearSystem {
    /// v^n [m/s].
    fn start(&self) -> Self::Vector;
    /// dt (f + M g) [kg m/s].
    fn pushed(&self) -> Self::Vector;
    /// `out` = H u as particles see it: nodes beyond mirrors have forces of their own.
    fn hessian(&mut self, u: &Self::Vector, out: &mut Self::Vector);
    /// As [`StepSystem::hessian`], with what falls on nodes beyond mirrors folded back.
    fn folded_hessian(&mut self, u: &Self::Vector, out: &mut Self::Vector);
    /// `out` = (M + c H) u, folded.
    fn matrix(&mut self, u: &Self::Vector, out: &mut Self::Vector);
    /// Has obstacles hold the nodes that they would stop in an explicit step, but for those `released`; by what that changes v^n, where it does.
    fn hold(&mut self, released: &Released) -> Option<Self::Vector>;
    /// Takes out what is held.
    fn project(&self, u: &mut Self::Vector);
    /// Releases the nodes that obstacles would have to pull at for them to change by `change`, where `image` is the Hessian's share of it; whether
    /// there are any.
    fn release(&self, change: &Self::Vector, image: &Self::Vector, released: &mut Released) -> bool;
}

/// What the step's forces change by, times - dt: s H v^n + c H D as particles see it, anything where the solve has not converged; and how it ended.
pub(crate) fn solve_step<S: StepSystem>(
    system: &mut S,
    coefficients: Coefficients,
    how: &LinearSolve,
) -> (S::Vector, Solution) {
    let Coefficients { of_change: c, of_start: s } = coefficients;
    let goal = Goal { tolerance: how.tolerance, max_iterations: how.max_iterations };
    let start = system.start();
    let mut image = start.clone();
    let mut released = Released::new();
    let mut iterations = 0;
    loop {
        let mut begin = start.clone();
        if let Some(known) = system.hold(&released) {
            system.combine(1.0, &known, 1.0, &mut begin);
        }
        let mut right = system.pushed();
        system.folded_hessian(&begin, &mut image);
        system.combine(-s, &image, 1.0, &mut right);
        system.project(&mut right);
        let (mut change, solution) = krylov::solve(system, how.method, &right, goal, |_| ());
        iterations += solution.iterations;
        if !solution.converged {
            return (image, Solution { iterations, ..solution });
        }
        let mut moved = begin.clone();
        system.combine(c, &change, s, &mut moved);
        system.hessian(&moved, &mut image);
        // From v^n on.
        system.combine(1.0, &begin, 1.0, &mut change);
        system.combine(-1.0, &start, 1.0, &mut change);
        if !system.release(&change, &image, &mut released) {
            return (image, Solution { iterations, ..solution });
        }
    }
}
