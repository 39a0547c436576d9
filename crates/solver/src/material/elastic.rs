//! Fixed corotated elasticity (Stomakhin et al. 2012): snow's elastic law without its yield surface.

use super::{ConstitutiveModel, Lame, PlasticFlow, stretch_factor};
use crate::geometry::Matrix;
use crate::real::Real;

/// An elastic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic<T> {
    /// Lame parameters [Pa].
    pub lame: Lame<T>,
}

impl<T: Real, const D: usize> ConstitutiveModel<T, D> for Elastic<T> {
    #[inline]
    fn lame(&self) -> Lame<T> {
        self.lame
    }

    #[inline]
    fn hardening(&self, _plastic_ratio: T) -> T {
        T::one()
    }

    #[inline]
    fn flow(&self, _trial: &Matrix<T, D>, _plastic_ratio: T) -> Option<PlasticFlow<T, D>> {
        None
    }

    #[inline]
    fn wave_modulus(&self, f: &Matrix<T, D>) -> T {
        self.lame.wave_modulus::<D>() * stretch_factor(f)
    }
}
