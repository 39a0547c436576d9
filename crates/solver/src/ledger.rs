//! Where momentum and energy went: by step, and over a run. All in f64, whatever the run's precision.

use serde::{Deserialize, Serialize};

use crate::geometry::Vector;
use crate::implicit::Solution;
use crate::real::Real;

/// What an obstacle received and did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ColliderLedger<const D: usize> {
    /// Impulse of the material on the obstacle [kg m/s].
    pub impulse: Vector<f64, D>,
    /// Work of the obstacle on the material [J]; 0 for one at rest.
    pub work: f64,
    /// Energy lost in contact, friction and inelastic impact together [J].
    pub loss: f64,
}

/// Energies of one step, and its events.
#[derive(Clone, Debug, PartialEq)]
pub struct StepLedger<const D: usize> {
    /// One for each obstacle.
    pub colliders: Vec<ColliderLedger<D>>,
    /// Kinetic energy of the particles before the step [J].
    pub kinetic_particles_before: f64,
    /// Kinetic energy of the grid after particles to grid [J].
    pub kinetic_grid_before: f64,
    /// Kinetic energy of the grid at the end of the step [J].
    pub kinetic_grid_after: f64,
    /// Kinetic energy of the particles after the step [J].
    pub kinetic_particles_after: f64,
    /// What of the obstacles' losses fell on particles, after the grid's energy was taken [J].
    pub particle_contact_loss: f64,
    /// Energy lost to plastic flow, Psi(trial, old J_P) - Psi(new, new J_P) [J].
    pub plastic_loss: f64,
    /// Mass on nodes that counted as empty [kg].
    pub dropped_mass: f64,
    /// Particles whose J_P met a bound.
    pub clamps: u64,
    /// 1 - a of the step's FLIP share, 0 for transfers without one.
    pub damping: f64,
    /// How an implicit step's linear system was solved.
    pub solve: Solution,
}

/// The energy of an impulse that takes material from velocity `before` to `after` [J]: momentum . (before + after) / 2.
#[inline]
pub(crate) fn impulse_energy<T: Real, const D: usize>(
    momentum: &Vector<T, D>,
    before: &Vector<T, D>,
    after: &Vector<T, D>,
) -> f64 {
    (0..D).map(|k| 0.5 * momentum[k].as_f64() * (before[k].as_f64() + after[k].as_f64())).sum()
}

/// Sums over a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ledger<const D: usize> {
    /// One for each obstacle.
    pub colliders: Vec<ColliderLedger<D>>,
    /// Kinetic energy lost from particles to grid [J] (negative: gained).
    pub particles_to_grid_loss: f64,
    /// Kinetic energy lost from grid to particles [J] (negative: gained).
    pub grid_to_particles_loss: f64,
    /// Energy lost to plastic flow [J].
    pub plastic_loss: f64,
    /// Largest mass that one step left on nodes that counted as empty [kg].
    pub dropped_mass: f64,
    /// Times a particle's J_P met a bound.
    pub clamps: u64,
    /// Integral of (1 - a) / dt over time: the sum of 1 - a.
    pub damping: f64,
    /// Applications of implicit steps' operators, in steps that were accepted.
    pub iterations: u64,
    /// The most that one step took.
    pub most_iterations: u32,
    /// The largest residual that a solve has left.
    pub largest_residual: f64,
    /// Steps tried and refused.
    pub rejected_steps: u64,
    /// Times the watchdog went back to a snapshot.
    pub watchdog_restores: u64,
}

fn untouched<const D: usize>(colliders: usize) -> Vec<ColliderLedger<D>> {
    vec![ColliderLedger { impulse: Vector::zeros(), work: 0.0, loss: 0.0 }; colliders]
}

impl<const D: usize> StepLedger<D> {
    /// An empty ledger for so many obstacles.
    pub fn new(colliders: usize) -> Self {
        StepLedger {
            colliders: untouched(colliders),
            kinetic_particles_before: 0.0,
            kinetic_grid_before: 0.0,
            kinetic_grid_after: 0.0,
            kinetic_particles_after: 0.0,
            particle_contact_loss: 0.0,
            plastic_loss: 0.0,
            dropped_mass: 0.0,
            clamps: 0,
            damping: 0.0,
            solve: Solution::default(),
        }
    }

    /// Books a contact that gave the material `momentum` [kg m/s] and `energy` [J].
    #[inline]
    pub(crate) fn push<T: Real>(&mut self, collider: usize, momentum: &Vector<T, D>, energy: f64) {
        let entry = &mut self.colliders[collider];
        for k in 0..D {
            entry.impulse[k] -= momentum[k].as_f64();
        }
        entry.loss -= energy;
    }

    /// Adds what obstacles did in a part of the scene.
    pub(crate) fn add_contact(&mut self, part: &StepLedger<D>) {
        for (total, entry) in self.colliders.iter_mut().zip(&part.colliders) {
            total.impulse += entry.impulse;
            total.loss += entry.loss;
        }
    }

    /// Energy that the material lost to obstacles so far in this step [J].
    pub(crate) fn contact_loss(&self) -> f64 {
        self.colliders.iter().map(|c| c.loss).sum()
    }
}

impl<const D: usize> Ledger<D> {
    /// An empty ledger for so many obstacles.
    pub fn new(colliders: usize) -> Self {
        Ledger {
            colliders: untouched(colliders),
            particles_to_grid_loss: 0.0,
            grid_to_particles_loss: 0.0,
            plastic_loss: 0.0,
            dropped_mass: 0.0,
            clamps: 0,
            damping: 0.0,
            iterations: 0,
            most_iterations: 0,
            largest_residual: 0.0,
            rejected_steps: 0,
            watchdog_restores: 0,
        }
    }

    /// Adds an accepted step. `velocities` are the obstacles'.
    /// Without `energies` those of transfers and contacts are not known any more.
    pub(crate) fn add(&mut self, step: &StepLedger<D>, velocities: &[Vector<f64, D>], energies: bool) {
        for ((total, entry), velocity) in self.colliders.iter_mut().zip(&step.colliders).zip(velocities) {
            let work = -entry.impulse.dot(velocity);
            total.impulse += entry.impulse;
            total.work += work;
            // What the contact took from the material beyond the work it put in.
            total.loss += entry.loss + work;
        }
        self.particles_to_grid_loss += step.kinetic_particles_before - step.kinetic_grid_before;
        self.grid_to_particles_loss +=
            step.kinetic_grid_after - step.kinetic_particles_after - step.particle_contact_loss;
        if !energies {
            (self.particles_to_grid_loss, self.grid_to_particles_loss) = (f64::NAN, f64::NAN);
            self.colliders.iter_mut().for_each(|collider| collider.loss = f64::NAN);
        }
        self.plastic_loss += step.plastic_loss;
        self.dropped_mass = self.dropped_mass.max(step.dropped_mass);
        self.clamps += step.clamps;
        self.damping += step.damping;
        self.iterations += u64::from(step.solve.iterations);
        self.most_iterations = self.most_iterations.max(step.solve.iterations);
        self.largest_residual = self.largest_residual.max(step.solve.residual);
    }

    /// Work of all obstacles on the material [J].
    pub fn collider_work(&self) -> f64 {
        self.colliders.iter().map(|c| c.work).sum()
    }
}
