//! Fixed corotated elasticity (Stomakhin et al. 2012): snow's elastic law without its yield surface.

use super::{ConstitutiveModel, Lame, PlasticFlow};
use crate::geometry::Matrix;
use crate::math::determinant;
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

    /// Forces act through P F^T grad w: a stretch s raises the shear stiffness by s^2, which the largest row sum of
    /// F^T F bounds (Gershgorin), and a change of volume the bulk stiffness by J d/dJ (J^2 - J) = 2 J^2 - J.
    #[inline]
    fn wave_modulus(&self, f: &Matrix<T, D>) -> T {
        let metric = f.transpose() * f;
        let stretch_squared = (0..D)
            .map(|i| (0..D).fold(T::zero(), |sum, j| sum + metric[(i, j)].abs()))
            .fold(T::one(), |largest, row| largest.max(row));
        let j = determinant(f);
        self.lame.wave_modulus::<D>() * stretch_squared.max(j * (j + j - T::one()))
    }
}
