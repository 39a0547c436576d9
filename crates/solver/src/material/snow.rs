//! Snow: fixed corotated elasticity, a box on the principal stretches as yield surface, exponential hardening
//! (S13 sections 5 and 5.1).

use super::{ConstitutiveModel, Lame, PlasticFlow, stretch_factor};
use crate::geometry::Matrix;
use crate::math::{ClampedStretches, clamp_stretches, stretches_within};
use crate::real::Real;

/// The critical stretch up to which the time step needs no look at F. Chosen: stretches of 1 % raise the modulus by 9 % at most
/// (2 J^2 - J at J = 1.01^3), the speed of waves by 4.6 %, of the 100 % that half the stability limit leaves; and no snow in
/// use has more (S13's artists: 0.5 to 0.75 %).
const COVERED_STRETCH: f64 = 0.01;

/// Snow's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snow<T> {
    /// Lame parameters at J_P = 1 [Pa].
    pub lame: Lame<T>,
    /// Critical compression theta_c: stretches below 1 - theta_c flow.
    pub critical_compression: T,
    /// Critical stretch theta_s: stretches above 1 + theta_s flow.
    pub critical_stretch: T,
    /// Hardening coefficient xi.
    pub hardening: T,
    /// Bounds on the plastic volume ratio J_P; a run in which one takes effect is marked. (0, infinity) is S13's model.
    pub plastic_ratio_bounds: (T, T),
    /// The greatest factor that hardening has on the Lame parameters, 1 or more; infinity is S13's model. A choice of the model for the sake
    /// of the time step, which the stiffest particle sets (docs/performance.md).
    pub hardening_limit: T,
}

impl<T: Real> Snow<T> {
    /// Whether J_P has bounds that can take effect.
    pub fn bounds_plastic_ratio(&self) -> bool {
        let (lower, upper) = self.plastic_ratio_bounds;
        lower > T::zero() || upper.as_f64() < f64::INFINITY
    }

    /// Whether the yield surface is so narrow that the time step needs no look at F.
    pub(crate) fn stretch_is_covered(&self) -> bool {
        self.critical_stretch <= T::of(COVERED_STRETCH)
    }
}

impl<T: Real, const D: usize> ConstitutiveModel<T, D> for Snow<T> {
    #[inline]
    fn lame(&self) -> Lame<T> {
        self.lame
    }

    #[inline]
    fn hardening(&self, plastic_ratio: T) -> T {
        (self.hardening * (T::one() - plastic_ratio)).exponential().min(self.hardening_limit)
    }

    /// s_i -> clamp(s_i, 1 - theta_c, 1 + theta_s), J_P <- J_P prod(s_i) / prod(clamped s_i) (S13 section 6.1.1; of F_P
    /// only its determinant enters the energy).
    #[inline]
    fn flow(&self, trial: &Matrix<T, D>, plastic_ratio: T) -> Option<PlasticFlow<T, D>> {
        let least = T::one() - self.critical_compression;
        let greatest = T::one() + self.critical_stretch;
        if stretches_within(trial, least, greatest) {
            return None;
        }
        let ClampedStretches { matrix, stretches, clamped } = clamp_stretches(trial, least, greatest);
        let mut ratio = plastic_ratio;
        for i in 0..D {
            ratio *= stretches[i] / clamped[i];
        }
        let (lower, upper) = self.plastic_ratio_bounds;
        let bounded = ratio.max(lower).min(upper);
        Some(PlasticFlow {
            deformation: matrix,
            plastic_ratio: bounded,
            clamped: bounded != ratio,
            trial_energy: self.lame.energy_of_stretches(&stretches),
            energy: self.lame.energy_of_stretches(&clamped),
        })
    }

    /// A yield surface within 1 % (`COVERED_STRETCH`) is left to the default safety factor; a wider one lets snow stretch as an elastic
    /// material does, and stiffen with it.
    #[inline]
    fn wave_modulus(&self, f: &Matrix<T, D>) -> T {
        let modulus = self.lame.wave_modulus::<D>();
        if self.stretch_is_covered() { modulus } else { modulus * stretch_factor(f) }
    }
}
