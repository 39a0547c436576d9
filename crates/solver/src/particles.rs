//! Material points, one array per field.

use serde::{Deserialize, Serialize};

use crate::geometry::{Matrix, Vector};
use crate::real::Real;

/// What a step changes. All arrays have the same length; index p is the same particle in each.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct ParticleMotion<T: Real, const D: usize> {
    /// Position relative to the state's origin [m].
    pub position: Vec<Vector<T, D>>,
    /// Velocity [m/s].
    pub velocity: Vec<Vector<T, D>>,
    /// Affine velocity matrix C [1/s]; empty where the transfer keeps none.
    pub affine: Vec<Matrix<T, D>>,
    /// Elastic deformation gradient F_E.
    pub deformation: Vec<Matrix<T, D>>,
    /// Plastic volume ratio J_P = det F_P.
    pub plastic_ratio: Vec<T>,
    /// Stiffness factor: the particle's scale times the hardening at its J_P. Follows from J_P; kept so that an
    /// exponential is paid for only where J_P changes.
    pub stiffness: Vec<T>,
    /// Whether J_P ever met a bound; empty where no material has bounds.
    pub clamped: Vec<bool>,
}

/// What a step leaves alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct ParticleConstants<T: Real> {
    /// Mass [kg] (kg per metre of depth in 2D).
    pub mass: Vec<T>,
    /// Rest volume V_p [m^D].
    pub volume: Vec<T>,
    /// Per-particle factor on the Lame parameters.
    pub stiffness_scale: Vec<T>,
    /// Index into the scene's materials.
    pub material: Vec<u16>,
    /// Number of the particle in its initial order; it survives sorting.
    pub id: Vec<u32>,
}

impl<T: Real, const D: usize> ParticleMotion<T, D> {
    /// The number of particles.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Arrays of the same lengths as `self`'s, of which nothing but the length is meant.
    pub(crate) fn like(&self) -> Self {
        self.clone()
    }

    pub(crate) fn reorder(&mut self, order: &[u32]) {
        gather_in_order(&mut self.position, order);
        gather_in_order(&mut self.velocity, order);
        gather_in_order(&mut self.affine, order);
        gather_in_order(&mut self.deformation, order);
        gather_in_order(&mut self.plastic_ratio, order);
        gather_in_order(&mut self.stiffness, order);
        gather_in_order(&mut self.clamped, order);
    }
}

impl<T: Real> ParticleConstants<T> {
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        gather_in_order(&mut self.mass, order);
        gather_in_order(&mut self.volume, order);
        gather_in_order(&mut self.stiffness_scale, order);
        gather_in_order(&mut self.material, order);
        gather_in_order(&mut self.id, order);
    }
}

/// Element k of the result is element `order[k]` of the old array. An empty array (a field not in use) stays empty.
pub(crate) fn gather_in_order<V: Copy>(values: &mut Vec<V>, order: &[u32]) {
    if !values.is_empty() {
        *values = order.iter().map(|&p| values[p as usize]).collect();
    }
}
