//! What changes in a run.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use crate::error::SceneError;
use crate::geometry::{Matrix, Vector};
use crate::kernel::{Cubic, Kernel, KernelKind, Quadratic};
use crate::ledger::Ledger;
use crate::material::ConstitutiveModel;
use crate::math::determinant;
use crate::particles::{ParticleConstants, ParticleMotion, gather_in_order};
use crate::real::Real;
use crate::scene::Scene;
use crate::stencil::Stencil;

/// Cells that a particle may be from the local origin: nodes are counted by 32 bits, with room to move.
const REACH: f64 = (1_u32 << 30) as f64;

/// Everything that a step reads and changes: saved and restored, a run goes on as if nothing had happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct State<T: Real, const D: usize> {
    /// World position of the local origin [m]; a node of the grid lies there.
    pub origin: Vector<f64, D>,
    /// Time [s].
    pub time: f64,
    /// Accepted steps.
    pub steps: u64,
    /// Fields that change.
    pub motion: ParticleMotion<T, D>,
    /// Fields that do not.
    pub constants: ParticleConstants<T>,
    /// Acceleration of each particle by a force of its own, beside gravity [m/s^2]; empty where there is none. A step leaves it
    /// alone: who drives the run sets it between steps.
    pub body_acceleration: Vec<Vector<T, D>>,
    /// Sums over the run.
    pub ledger: Ledger<D>,
    /// When an obstacle, mirrors not counted, first changed a velocity [s].
    pub first_contact: Option<f64>,
    /// Factor on C_wave; the watchdog halves it.
    pub step_factor: f64,
    /// The length up to which the latest step was free to go [s], from which an implicit one grows; 0 before the first.
    pub step_reach: f64,
}

/// A particle as a sampler or a file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialParticle<const D: usize> {
    /// World position [m].
    pub position: Vector<f64, D>,
    /// Velocity [m/s].
    pub velocity: Vector<f64, D>,
    /// Mass [kg].
    pub mass: f64,
    /// Rest volume [m^D].
    pub volume: f64,
    /// Factor on the Lame parameters.
    pub stiffness_scale: f64,
    /// Index into the scene's materials.
    pub material: u16,
    /// Elastic deformation gradient F_E; the identity for material that nothing has happened to.
    pub deformation: Matrix<f64, D>,
    /// Plastic volume ratio J_P; 1 for material that nothing has happened to.
    pub plastic_ratio: f64,
}

impl<T: Real, const D: usize> State<T, D> {
    /// Particles at t = 0, before any contact. `origin` is the world position that local coordinates count from.
    ///
    /// # Errors
    /// A particle with a value that is not finite, a mass, volume, stiffness, det F_E or J_P that is not positive, or a
    /// material that the scene does not have.
    pub fn at_rest(
        scene: &Scene<T, D>,
        origin: Vector<f64, D>,
        particles: &[InitialParticle<D>],
    ) -> Result<Self, SceneError> {
        scene.validate()?;
        for (number, particle) in particles.iter().enumerate() {
            particle.validate::<T>(number, scene.materials.len())?;
        }
        let field = |f: &dyn Fn(&InitialParticle<D>) -> f64| particles.iter().map(|p| T::of(f(p))).collect();
        let local = |v: Vector<f64, D>| v.map(T::of);
        let affine = if scene.transfer.keeps_affine() { particles.len() } else { 0 };
        let clamped = if scene.bounds_plastic_ratio() { particles.len() } else { 0 };
        Ok(State {
            origin,
            time: 0.0,
            steps: 0,
            motion: ParticleMotion {
                position: particles.iter().map(|p| local(p.position - origin)).collect(),
                velocity: particles.iter().map(|p| local(p.velocity)).collect(),
                affine: vec![Matrix::zeros(); affine],
                deformation: particles.iter().map(|p| p.deformation.map(T::of)).collect(),
                plastic_ratio: field(&|p| p.plastic_ratio),
                stiffness: particles.iter().map(|p| p.stiffness(scene)).collect(),
                clamped: vec![false; clamped],
            },
            constants: ParticleConstants {
                mass: field(&|p| p.mass),
                volume: field(&|p| p.volume),
                stiffness_scale: field(&|p| p.stiffness_scale),
                material: particles.iter().map(|p| p.material).collect(),
                id: (0..particles.len() as u32).collect(),
            },
            body_acceleration: Vec::new(),
            ledger: Ledger::new(scene.colliders.len()),
            first_contact: None,
            step_factor: 1.0,
            step_reach: 0.0,
        })
    }

    /// The number of particles.
    pub fn len(&self) -> usize {
        self.motion.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.motion.is_empty()
    }

    /// Whether the state fits `scene`: one entry a particle in every field, one a collider in the ledger.
    ///
    /// # Errors
    /// The first field of another length.
    pub fn validate(&self, scene: &Scene<T, D>) -> Result<(), SceneError> {
        let (motion, constants, particles) = (&self.motion, &self.constants, self.len());
        let affine = if scene.transfer.keeps_affine() { particles } else { 0 };
        let clamped = if scene.bounds_plastic_ratio() { particles } else { 0 };
        let accelerated = if self.body_acceleration.is_empty() { 0 } else { particles };
        for (field, found, expected) in [
            ("velocity", motion.velocity.len(), particles),
            ("affine", motion.affine.len(), affine),
            ("deformation", motion.deformation.len(), particles),
            ("plastic_ratio", motion.plastic_ratio.len(), particles),
            ("stiffness", motion.stiffness.len(), particles),
            ("clamped", motion.clamped.len(), clamped),
            ("body_acceleration", self.body_acceleration.len(), accelerated),
            ("mass", constants.mass.len(), particles),
            ("volume", constants.volume.len(), particles),
            ("stiffness_scale", constants.stiffness_scale.len(), particles),
            ("material", constants.material.len(), particles),
            ("id", constants.id.len(), particles),
            ("ledger", self.ledger.colliders.len(), scene.colliders.len()),
        ] {
            if found != expected {
                return Err(SceneError::Length { field, found, expected });
            }
        }
        Ok(())
    }

    /// Whether all numbers are such as a run of `scene` can come to.
    pub(crate) fn is_possible(&self, scene: &Scene<T, D>) -> bool {
        let ParticleMotion { position, velocity, affine, deformation, plastic_ratio, stiffness, .. } =
            &self.motion;
        let constants = &self.constants;
        let finite = |values: &[T]| values.iter().all(|value| value.is_finite());
        let positive = |values: &Vec<T>| values.iter().all(|value| *value > T::zero() && value.is_finite());
        let vectors = [position, velocity, &self.body_acceleration];
        let known = |material: &u16| usize::from(*material) < scene.materials.len();
        let mut ids = constants.id.clone();
        ids.sort_unstable();
        let reach = scene.spacing.as_f64() * REACH;
        position.iter().all(|x| x.amax().as_f64() < reach)
            && vectors.iter().all(|vectors| vectors.iter().all(|v| finite(v.as_slice())))
            && affine.iter().chain(deformation).all(|matrix| finite(matrix.as_slice()))
            && [plastic_ratio, stiffness, &constants.mass, &constants.volume, &constants.stiffness_scale]
                .into_iter()
                .all(positive)
            && constants.material.iter().all(known)
            && ids.into_iter().eq(0..self.len() as u32)
            && [self.time, self.step_factor, self.step_reach].iter().all(|number| number.is_finite())
    }

    /// Puts the particles into the order of `ids`.
    pub(crate) fn reorder_as(&mut self, ids: &[u32]) {
        let places: HashMap<u32, u32> = self.constants.id.iter().copied().zip(0..).collect();
        let order: Vec<u32> = ids.iter().map(|id| places[id]).collect();
        self.reorder(&order);
    }

    /// Particle k becomes the one that was `order[k]`.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        self.motion.reorder(order);
        self.constants.reorder(order);
        gather_in_order(&mut self.body_acceleration, order);
    }

    /// Leaves all but the particles, which it returns the memory of.
    pub(crate) fn take_particles(&mut self) {
        self.motion = ParticleMotion::default();
        self.constants = ParticleConstants::default();
        self.body_acceleration = Vec::new();
    }

    /// Particles whose J_P ever met a bound.
    pub fn clamped_particles(&self) -> usize {
        self.motion.clamped.iter().filter(|&&clamped| clamped).count()
    }

    /// World position of particle `p` [m].
    pub fn world_position(&self, p: usize) -> Vector<f64, D> {
        self.origin + self.motion.position[p].map(|c| c.as_f64())
    }

    /// Indices of the particles in the order of their ids.
    pub fn by_id(&self) -> Vec<usize> {
        let mut order = vec![0; self.len()];
        for (p, &id) in self.constants.id.iter().enumerate() {
            order[id as usize] = p;
        }
        order
    }

    /// S13's rest volumes (section 4.1 step 2): V_p = m_p / rho(x_p), rho the grid's density at the particle. Their sum is not the
    /// body's volume: the density reads low near the surface and, for random placement, inside.
    pub fn assign_density_volumes(&mut self, scene: &Scene<T, D>) {
        match scene.kernel {
            KernelKind::Cubic => self.density_volumes::<Cubic>(scene.spacing),
            KernelKind::Quadratic => self.density_volumes::<Quadratic>(scene.spacing),
        }
    }

    fn density_volumes<K: Kernel>(&mut self, spacing: T) {
        let mut nodes = std::collections::BTreeMap::<[i32; D], T>::new();
        let stencils: Vec<_> = self
            .motion
            .position
            .iter()
            .map(|x| Stencil::<T, D>::at::<K, false>(x, spacing, T::one() / spacing))
            .collect();
        for (stencil, &mass) in stencils.iter().zip(&self.constants.mass) {
            for (node, weight) in stencil.nodes::<K>() {
                *nodes.entry(node).or_insert(T::zero()) += weight * mass;
            }
        }
        let cell_volume = (0..D).fold(T::one(), |v, _| v * spacing);
        for (p, stencil) in stencils.iter().enumerate() {
            let density =
                stencil.nodes::<K>().fold(T::zero(), |sum, (node, weight)| sum + weight * nodes[&node]);
            self.constants.volume[p] = self.constants.mass[p] * cell_volume / density;
        }
    }

    /// Sets every particle's plastic ratio, with the stiffness that follows from it: a pre-compacted or pre-damaged body.
    pub fn set_plastic_ratio(&mut self, scene: &Scene<T, D>, p: usize, ratio: T) {
        let material = &scene.materials[self.constants.material[p] as usize];
        self.motion.plastic_ratio[p] = ratio;
        self.motion.stiffness[p] =
            self.constants.stiffness_scale[p] * ConstitutiveModel::<T, D>::hardening(material, ratio);
    }
}

impl<const D: usize> InitialParticle<D> {
    /// The factor on the Lame parameters, hardening included.
    fn stiffness<T: Real>(&self, scene: &Scene<T, D>) -> T {
        let material = &scene.materials[self.material as usize];
        T::of(self.stiffness_scale)
            * ConstitutiveModel::<T, D>::hardening(material, T::of(self.plastic_ratio))
    }

    fn validate<T: Real>(&self, particle: usize, materials: usize) -> Result<(), SceneError> {
        let check = |holds: bool, quantity: &'static str, value: f64, allowed: &'static str| {
            if holds { Ok(()) } else { Err(SceneError::Particle { particle, quantity, value, allowed }) }
        };
        for k in 0..D {
            check(self.position[k].is_finite(), "position", self.position[k], "finite")?;
            check(self.velocity[k].is_finite(), "velocity", self.velocity[k], "finite")?;
        }
        for (quantity, value) in [
            ("mass", self.mass),
            ("volume", self.volume),
            ("stiffness scale", self.stiffness_scale),
            ("plastic ratio J_P", self.plastic_ratio),
            ("determinant of the deformation", determinant(&self.deformation)),
        ] {
            // In the run's precision: what is positive in f64 may be nothing in f32.
            let kept = T::of(value).as_f64();
            check(kept > 0.0 && kept.is_finite(), quantity, value, "finite and > 0")?;
        }
        check(
            (self.material as usize) < materials,
            "material",
            f64::from(self.material),
            "an index of the scene's",
        )
    }
}
