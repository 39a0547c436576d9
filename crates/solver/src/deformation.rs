//! Stages 2 and 6: stress from deformation, and the deformation's update with the return map.

use crate::error::{Rejection, RejectionReason};
use crate::geometry::Matrix;
use crate::ledger::StepLedger;
use crate::material::ConstitutiveModel;
use crate::math::determinant;
use crate::particles::{ParticleConstants, ParticleMotion};
use crate::real::Real;
use crate::scene::Scene;

/// V_p tau_p = V_p P F_E^T of every particle [J]: with it f_i = - sum V_p tau_p grad w.
pub(crate) fn internal_stress<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
    stress: &mut Vec<Matrix<T, D>>,
) {
    stress.resize(motion.len(), Matrix::zeros());
    for p in 0..motion.len() {
        let material = &scene.materials[constants.material[p] as usize];
        stress[p] = material.kirchhoff(&motion.deformation[p], motion.stiffness[p]) * constants.volume[p];
    }
}

/// Stage 6: F_E' = (I + dt grad v) F_E, then plastic flow.
pub(crate) fn update_deformation<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
    gradient: &[Matrix<T, D>],
    dt: T,
    next: &mut ParticleMotion<T, D>,
    ledger: &mut StepLedger<D>,
) -> Result<(), Rejection> {
    next.clamped.copy_from_slice(&motion.clamped);
    for p in 0..motion.len() {
        let increment = Matrix::<T, D>::identity() + gradient[p] * dt;
        let turned = determinant(&increment);
        // Written so that a NaN is refused as well.
        if !(turned > T::zero()) {
            let reason = RejectionReason::Inverted { determinant: turned.as_f64() };
            return Err(Rejection { particle: Some(constants.id[p]), reason });
        }
        let material = &scene.materials[constants.material[p] as usize];
        let (trial, ratio, stiffness) =
            (increment * motion.deformation[p], motion.plastic_ratio[p], motion.stiffness[p]);
        match material.flow(&trial, ratio) {
            None => {
                next.deformation[p] = trial;
                next.plastic_ratio[p] = ratio;
                next.stiffness[p] = stiffness;
            }
            Some(flow) => {
                let hardened = constants.stiffness_scale[p]
                    * ConstitutiveModel::<T, D>::hardening(material, flow.plastic_ratio);
                next.deformation[p] = flow.deformation;
                next.plastic_ratio[p] = flow.plastic_ratio;
                next.stiffness[p] = hardened;
                let released = flow.trial_energy * stiffness - flow.energy * hardened;
                ledger.plastic_loss += (released * constants.volume[p]).as_f64();
                if flow.clamped {
                    ledger.clamps += 1;
                    // Without bounds nobody asks, and J_P can only have left what numbers there are.
                    if let Some(clamped) = next.clamped.get_mut(p) {
                        *clamped = true;
                    }
                }
            }
        }
    }
    Ok(())
}
