//! Energies and momenta of a state, for the watchdog and for records.

use crate::geometry::{Matrix, Vector, is_zero};
use crate::material::ConstitutiveModel;
use crate::math::norm_squared;
use crate::particles::{ParticleConstants, ParticleMotion};
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;

/// Energies of a state [J] (J per metre of depth in 2D).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Of the particles, with APIC's affine part.
    pub kinetic: f64,
    /// Elastic.
    pub elastic: f64,
    /// In the field of gravity, 0 at the world's origin.
    pub potential: f64,
}

/// All energies of `state`.
pub fn energies<T: Real, const D: usize>(scene: &Scene<T, D>, state: &State<T, D>) -> Energies {
    Energies {
        kinetic: kinetic_energy(scene, &state.motion, &state.constants),
        elastic: elastic_energy(scene, &state.motion, &state.constants),
        potential: potential_energy(scene, state),
    }
}

/// sum m |v|^2 / 2, plus sum m tr(C D C^T) / 2 for affine transfers, D = h^2 / 3 (cubic), h^2 / 4 (quadratic) [J].
pub fn kinetic_energy<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
) -> f64 {
    let linear: f64 =
        motion.velocity.iter().zip(&constants.mass).map(|(v, &m)| (v.norm_squared() * m).as_f64()).sum();
    let inverse_inertia = scene.kernel.inverse_inertia();
    let h = scene.spacing.as_f64();
    let affine: f64 =
        motion.affine.iter().zip(&constants.mass).map(|(c, &m)| (norm_squared(c) * m).as_f64()).sum();
    0.5 * (linear + affine * h * h / inverse_inertia)
}

/// sum V_p Psi_p [J].
pub fn elastic_energy<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
) -> f64 {
    (0..motion.len())
        .map(|p| {
            let material = &scene.materials[constants.material[p] as usize];
            let density = material.energy_density(&motion.deformation[p], motion.stiffness[p]);
            (density * constants.volume[p]).as_f64()
        })
        .sum()
}

/// - sum m g . x [J].
pub fn potential_energy<T: Real, const D: usize>(scene: &Scene<T, D>, state: &State<T, D>) -> f64 {
    if is_zero(&scene.gravity) {
        return 0.0;
    }
    let gravity = scene.gravity.map(|g| g.as_f64());
    -(0..state.len())
        .map(|p| state.constants.mass[p].as_f64() * gravity.dot(&state.world_position(p)))
        .sum::<f64>()
}

/// sum m [kg].
pub fn total_mass<T: Real, const D: usize>(state: &State<T, D>) -> f64 {
    state.constants.mass.iter().map(|m| m.as_f64()).sum()
}

/// sum m v [kg m/s].
pub fn linear_momentum<T: Real, const D: usize>(state: &State<T, D>) -> Vector<f64, D> {
    let terms = state.motion.velocity.iter().zip(&state.constants.mass);
    terms.fold(Vector::zeros(), |sum, (v, &m)| sum + v.map(|c| c.as_f64()) * m.as_f64())
}

/// sum m (x v^T - v x^T), plus APIC's affine part: the angular momentum about the local origin as a skew matrix [kg m^2/s]; in 2D its
/// (0, 1) entry is the scalar x v_y - y v_x (Jiang et al. 2015, section 5.3.1).
pub fn angular_momentum<T: Real, const D: usize>(scene: &Scene<T, D>, state: &State<T, D>) -> Matrix<f64, D> {
    let inertia = scene.spacing.as_f64().powi(2) / scene.kernel.inverse_inertia();
    let mut sum = Matrix::<f64, D>::zeros();
    for p in 0..state.len() {
        let mass = state.constants.mass[p].as_f64();
        let (x, v) =
            (state.motion.position[p].map(|c| c.as_f64()), state.motion.velocity[p].map(|c| c.as_f64()));
        let mut outer = x * v.transpose();
        if let Some(affine) = state.motion.affine.get(p) {
            outer += affine.map(|c| c.as_f64()).transpose() * inertia;
        }
        sum += (outer - outer.transpose()) * mass;
    }
    sum
}
