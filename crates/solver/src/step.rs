//! One explicit step, in the order of S13 section 4.1.

use crate::collision::{Contact, Interval, MirrorPlane, collide_grid, collide_particles};
use crate::deformation::{internal_stress, update_deformation};
use crate::diagnostics::kinetic_energy;
use crate::error::{Rejection, RejectionReason, SceneError};
use crate::geometry::{Matrix, Vector, is_zero};
use crate::grid::Grid;
use crate::ledger::StepLedger;
use crate::mirror::{self, Fold};
use crate::momentum::{kinetic_of_motion, kinetic_of_sums, update_grid_velocity};
use crate::particles::ParticleMotion;
use crate::real::Real;
use crate::scene::{Advection, Scene, Transfer};
use crate::state::State;
use crate::transfer::{
    Gathered, add_body_forces, grid_to_particles, particles_to_grid, place_stencils, transfer_velocity,
};

/// Scratch memory with no meaning between steps.
#[derive(Clone, Debug)]
pub struct Workspace<T: Real, const D: usize> {
    pub(crate) grid: Grid<T, D>,
    stress: Vec<Matrix<T, D>>,
    gathered: Gathered<T, D>,
    next: ParticleMotion<T, D>,
    mirrors: Vec<(usize, MirrorPlane)>,
    folds: Vec<Fold<T, D>>,
    empty_mass: T,
}

impl<T: Real, const D: usize> Workspace<T, D> {
    /// Scratch memory for `state` in `scene`.
    ///
    /// # Errors
    /// What [`Scene::validate`] and [`State::validate`] find.
    pub fn new(scene: &Scene<T, D>, state: &State<T, D>) -> Result<Self, SceneError> {
        scene.validate()?;
        state.validate(scene)?;
        let lightest = state.constants.mass.iter().fold(f64::INFINITY, |m, mass| m.min(mass.as_f64()));
        let lightest = if state.is_empty() { 0.0 } else { lightest };
        Ok(Workspace {
            grid: Grid::new(scene.spacing),
            stress: Vec::new(),
            gathered: Gathered { velocity: vec![], change: vec![], gradient: vec![], affine: vec![] },
            next: state.motion.like(),
            mirrors: mirror::planes(scene)?,
            folds: Vec::new(),
            empty_mass: T::of(lightest * T::EMPTY_NODE_SHARE),
        })
    }

    /// The grid of the latest step.
    pub fn grid(&self) -> &Grid<T, D> {
        &self.grid
    }
}

/// Advances `state` by `dt` [s].
///
/// # Errors
/// A step that inverts an element or moves a particle more than a cell is rejected; the state is then unchanged.
pub fn step<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    state: &mut State<T, D>,
    workspace: &mut Workspace<T, D>,
    dt: f64,
) -> Result<StepLedger<D>, Rejection> {
    let Workspace { grid, stress, gathered, next, mirrors, folds, empty_mass } = workspace;
    let State { motion, constants, body_acceleration, time, .. } = &mut *state;
    let mut ledger = StepLedger::new(scene.colliders.len());
    let (now, empty, dt_t) = (*time, *empty_mass, T::of(dt));
    let share = flip_share(scene.transfer, dt);
    ledger.damping = share.map_or(0.0, |a| 1.0 - a);
    ledger.kinetic_particles_before = kinetic_energy(scene, motion, constants);

    place_stencils(scene, motion, grid);
    internal_stress(scene, motion, constants, stress);
    particles_to_grid(scene, motion, constants, stress, grid);
    add_body_forces(scene, motion, constants, body_acceleration, grid);
    mirror::fold(mirrors, grid, &scene.gravity, folds);
    ledger.kinetic_grid_before = kinetic_of_sums(grid, empty);
    update_grid_velocity(grid, &scene.gravity, dt_t, empty, &mut ledger);
    collide_grid(scene, grid, now, empty, &mut ledger);
    mirror::unfold(folds, grid, &scene.gravity, dt_t, T::of(share.unwrap_or(0.0)), &mut ledger);
    ledger.kinetic_grid_after = kinetic_of_motion(grid);
    grid_to_particles(scene, motion, grid, gathered);
    update_deformation(scene, motion, constants, &gathered.gradient, dt_t, next, &mut ledger)?;
    transfer_velocity(scene, motion, gathered, T::of(share.unwrap_or(0.0)), next);
    let advecting = advection_velocity(scene, &mut gathered.velocity, &next.velocity);
    let grid_loss = ledger.contact_loss();
    collide_particles(
        scene,
        constants,
        &motion.position,
        next,
        advecting,
        Interval { arrival: now + dt, dt: dt_t },
        &mut ledger,
    );
    ledger.particle_contact_loss = ledger.contact_loss() - grid_loss;
    ledger.kinetic_particles_after = kinetic_energy(scene, next, constants);
    advect(scene, &motion.position, advecting, dt_t, &mut next.position)
        .map_err(|(p, reason)| Rejection { particle: constants.id[p], reason })?;

    std::mem::swap(motion, next);
    accept(scene, state, &ledger, dt);
    Ok(ledger)
}

/// Kinetic energy of `state` as the grid sees it after particles to grid, which is where the next step begins [J].
pub(crate) fn kinetic_on_grid<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    state: &State<T, D>,
    workspace: &mut Workspace<T, D>,
) -> f64 {
    let Workspace { grid, stress, mirrors, folds, empty_mass, .. } = workspace;
    let State { motion, constants, .. } = state;
    place_stencils(scene, motion, grid);
    internal_stress(scene, motion, constants, stress);
    particles_to_grid(scene, motion, constants, stress, grid);
    mirror::fold(mirrors, grid, &scene.gravity, folds);
    kinetic_of_sums(grid, *empty_mass)
}

/// The FLIP share a of a step of `dt` [s], where the transfer has one.
fn flip_share(transfer: Transfer, dt: f64) -> Option<f64> {
    match transfer {
        Transfer::Flip(share) => Some(share.of_step(dt)),
        Transfer::Apic | Transfer::Mls => None,
    }
}

fn advection_velocity<'a, T: Real, const D: usize>(
    scene: &Scene<T, D>,
    interpolated: &'a mut [Vector<T, D>],
    kept: &[Vector<T, D>],
) -> &'a mut [Vector<T, D>] {
    if scene.advection == Advection::Blended {
        interpolated.copy_from_slice(kept);
    }
    interpolated
}

/// Stage 9: x += dt v.
fn advect<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    position: &[Vector<T, D>],
    velocity: &[Vector<T, D>],
    dt: T,
    next: &mut [Vector<T, D>],
) -> Result<(), (usize, RejectionReason)> {
    let reach_squared = scene.spacing * scene.spacing;
    for p in 0..position.len() {
        let moved = velocity[p] * dt;
        let squared = moved.norm_squared();
        // Written so that a NaN is refused as well.
        if !(squared <= reach_squared) {
            let cells = squared.as_f64().sqrt() / scene.spacing.as_f64();
            return Err((p, RejectionReason::TooFar { cells }));
        }
        next[p] = position[p] + moved;
    }
    Ok(())
}

fn accept<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    state: &mut State<T, D>,
    step: &StepLedger<D>,
    dt: f64,
) {
    let velocities: Vec<_> = scene.colliders.iter().map(|c| c.velocity.map(|v| v.as_f64())).collect();
    state.ledger.add(step, &velocities);
    let mut obstacles =
        scene.colliders.iter().zip(&step.colliders).filter(|(c, _)| c.contact != Contact::Mirror);
    if state.first_contact.is_none() && obstacles.any(|(_, entry)| !is_zero(&entry.impulse)) {
        state.first_contact = Some(state.time);
    }
    state.time += dt;
    state.steps += 1;
}
