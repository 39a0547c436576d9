//! One step, in the order of S13 section 4.1.

use crate::collision::{Contact, Interval, MirrorPlane, collide_grid, collide_particles};
use crate::deformation::{internal_stress, update_deformation};
use crate::diagnostics::kinetic_energy;
use crate::error::{Rejection, RejectionReason, SceneError};
use crate::fast::Fast;
use crate::geometry::{Matrix, Vector, is_zero};
use crate::grid::Grid;
use crate::implicit::{Implicit, ImplicitStep, add_implicit_forces};
use crate::ledger::StepLedger;
use crate::mirror::{self, Fold};
use crate::momentum::{back_to_the_middle, kinetic_of_motion, kinetic_of_sums, update_grid_velocity};
use crate::particles::ParticleMotion;
use crate::real::Real;
use crate::scene::{Advection, Engine, Integrator, Scene};
use crate::state::State;
use crate::transfer::{
    Gathered, add_body_forces, grid_to_particles, particles_to_grid, place_stencils, transfer_velocity,
};

/// Scratch memory with no meaning between steps.
#[derive(Clone, Debug)]
pub struct Workspace<T: Real, const D: usize> {
    /// Where the scene asks for the fast engine and the CPU has what it takes.
    pub(crate) fast: Option<Box<Fast<T, D>>>,
    pub(crate) grid: Grid<T, D>,
    stress: Vec<Matrix<T, D>>,
    gathered: Gathered<T, D>,
    next: ParticleMotion<T, D>,
    /// What the grid tells about the middle of a trapezoidal step.
    midway: Gathered<T, D>,
    mirrors: Vec<(usize, MirrorPlane)>,
    folds: Vec<Fold<T, D>>,
    implicit: Implicit<T, D>,
    empty_mass: T,
}

impl<T: Real, const D: usize> Workspace<T, D> {
    /// Scratch memory for `state` in `scene`, for one thread.
    ///
    /// # Errors
    /// What [`Scene::validate`] and [`State::validate`] find.
    pub fn new(scene: &Scene<T, D>, state: &State<T, D>) -> Result<Self, SceneError> {
        Self::with_threads(scene, state, 1)
    }

    /// As [`Workspace::new`], for so many threads; the reference engine uses one.
    ///
    /// # Errors
    /// As [`Workspace::new`].
    pub fn with_threads(
        scene: &Scene<T, D>,
        state: &State<T, D>,
        threads: usize,
    ) -> Result<Self, SceneError> {
        scene.validate()?;
        state.validate(scene)?;
        let fast = match scene.engine {
            Engine::Fast => Fast::new(scene, threads)?.map(Box::new),
            Engine::Reference => None,
        };
        let lightest = state.constants.mass.iter().fold(f64::INFINITY, |m, mass| m.min(mass.as_f64()));
        let lightest = if state.is_empty() { 0.0 } else { lightest };
        Ok(Workspace {
            fast,
            grid: Grid::new(scene.spacing),
            stress: Vec::new(),
            gathered: Gathered::default(),
            midway: Gathered::default(),
            next: state.motion.like(),
            mirrors: mirror::planes(scene)?,
            folds: Vec::new(),
            implicit: Implicit::default(),
            empty_mass: T::of(lightest * T::EMPTY_NODE_SHARE),
        })
    }

    /// The grid of the latest step of the reference engine.
    pub fn grid(&self) -> &Grid<T, D> {
        &self.grid
    }
}

/// Advances `state` by `dt` [s].
///
/// # Errors
/// A step that inverts an element, moves a particle more than a cell, or whose linear system is not solved is rejected; the state is then unchanged.
pub fn step<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    state: &mut State<T, D>,
    workspace: &mut Workspace<T, D>,
    dt: f64,
) -> Result<StepLedger<D>, Rejection> {
    if let Some(fast) = &mut workspace.fast {
        fast.load(scene, state);
        let ledger = fast.step(scene, state.time, dt, true)?;
        let order = std::mem::take(&mut state.constants.id);
        fast.write(scene, state);
        state.reorder_as(&order);
        accept(scene, state, &ledger, dt);
        return Ok(ledger);
    }
    let Workspace { grid, stress, gathered, midway, next, mirrors, folds, implicit, empty_mass, .. } =
        workspace;
    let State { motion, constants, body_acceleration, time, .. } = &mut *state;
    let mut ledger = StepLedger::new(scene.colliders.len());
    let (now, empty, dt_t) = (*time, *empty_mass, T::of(dt));
    let share = scene.transfer.flip_share(dt);
    ledger.damping = share.map_or(0.0, |a| 1.0 - a);
    ledger.kinetic_particles_before = kinetic_energy(scene, motion, constants);

    place_stencils(scene, motion, grid);
    internal_stress(scene, motion, constants, stress);
    particles_to_grid(scene, motion, constants, stress, grid);
    add_body_forces(scene, motion, constants, body_acceleration, grid);
    mirror::fold(mirrors, grid, &scene.gravity, folds);
    ledger.kinetic_grid_before = kinetic_of_sums(grid, empty);
    let implicit_step = ImplicitStep { scene, motion, constants, mirrors, empty };
    add_implicit_forces(implicit_step, [now, dt], grid, folds, implicit, &mut ledger)?;
    update_grid_velocity(grid, &scene.gravity, dt_t, empty, &mut ledger);
    collide_grid(scene, grid, now, empty, &mut ledger);
    mirror::unfold(folds, grid, &scene.gravity, dt_t, T::of(share.unwrap_or(0.0)), &mut ledger);
    ledger.kinetic_grid_after = kinetic_of_motion(grid);
    grid_to_particles(scene, motion, grid, gathered);
    transfer_velocity(scene, motion, gathered, T::of(share.unwrap_or(0.0)), next);
    // What moves particles and deforms them: the motion at the end of the step, or in its middle.
    let mover = if matches!(scene.integrator, Integrator::Trapezoidal { .. }) {
        back_to_the_middle(scene, grid, now);
        grid_to_particles(scene, motion, grid, midway);
        midway
    } else {
        gathered
    };
    update_deformation(scene, motion, constants, &mover.gradient, dt_t, next, &mut ledger)?;
    let advecting = advection_velocity(scene, &mut mover.velocity, &next.velocity);
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
        .map_err(|(p, reason)| Rejection { particle: Some(constants.id[p]), reason })?;

    std::mem::swap(motion, next);
    accept(scene, state, &ledger, dt);
    Ok(ledger)
}

/// Kinetic energy of `state` as the reference engine's grid sees it after particles to grid, which is where the next step begins [J].
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

/// Books an accepted step.
pub(crate) fn accept<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    state: &mut State<T, D>,
    step: &StepLedger<D>,
    dt: f64,
) {
    let velocities: Vec<_> = scene.colliders.iter().map(|c| c.velocity.map(|v| v.as_f64())).collect();
    state.ledger.add(step, &velocities, scene.energy_budget);
    let mut obstacles =
        scene.colliders.iter().zip(&step.colliders).filter(|(c, _)| c.contact != Contact::Mirror);
    if state.first_contact.is_none() && obstacles.any(|(_, entry)| !is_zero(&entry.impulse)) {
        state.first_contact = Some(state.time);
    }
    state.time += dt;
    state.steps += 1;
}
