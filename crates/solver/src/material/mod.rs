//! Constitutive models. A model works with one particle: its elastic deformation gradient F_E, and its stiffness
//! factor (per-particle scale times hardening).

mod elastic;
mod snow;
mod tangent;

pub use elastic::Elastic;
pub use snow::Snow;
pub(crate) use tangent::LEAST_SUM_OF_STRETCHES;
pub use tangent::Tangent;

use crate::geometry::{Matrix, Vector};
use crate::math::{cofactor, determinant, norm_squared, polar_rotation};
use crate::real::Real;

/// The Lame parameters of the unhardened material [Pa].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame<T> {
    /// Shear modulus mu0.
    pub mu: T,
    /// First Lame parameter lambda0.
    pub lambda: T,
}

impl<T: Real> Lame<T> {
    /// mu0 = E / (2 (1 + nu)), lambda0 = E nu / ((1 + nu)(1 - 2 nu)), from Young's modulus [Pa] and Poisson's ratio.
    pub fn from_young(young: f64, poisson: f64) -> Self {
        Lame {
            mu: T::of(young / (2.0 * (1.0 + poisson))),
            lambda: T::of(young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))),
        }
    }

    /// Psi from the principal stretches: mu sum (s_i - 1)^2 + (lambda / 2)(prod s_i - 1)^2 [J/m^D].
    pub fn energy_of_stretches<const D: usize>(&self, stretches: &Vector<T, D>) -> T {
        let (mut squares, mut volume) = (T::zero(), T::one());
        for s in stretches.iter() {
            squares += (*s - T::one()) * (*s - T::one());
            volume *= *s;
        }
        let j = volume - T::one();
        self.mu * squares + self.lambda * T::of(0.5) * j * j
    }

    /// 2 mu + D lambda: the largest eigenvalue of d2Psi/dF2 at F = I [Pa]; it bounds the speed of waves.
    pub fn wave_modulus<const D: usize>(&self) -> T {
        self.mu + self.mu + self.lambda * T::of(D as f64)
    }
}

/// What the return map made of a trial state.
#[derive(Clone, Copy, Debug)]
pub struct PlasticFlow<T: Real, const D: usize> {
    /// Elastic deformation gradient on the yield surface.
    pub deformation: Matrix<T, D>,
    /// Plastic volume ratio J_P after the flow.
    pub plastic_ratio: T,
    /// Whether a bound on J_P took effect.
    pub clamped: bool,
    /// Energy density of the trial state at stiffness 1 [J/m^D].
    pub trial_energy: T,
    /// Energy density on the yield surface at stiffness 1 [J/m^D].
    pub energy: T,
}

/// The contract of a material, for one particle. `stiffness` is the factor on both Lame parameters.
pub trait ConstitutiveModel<T: Real, const D: usize> {
    /// The Lame parameters at stiffness 1.
    fn lame(&self) -> Lame<T>;

    /// The factor e^(xi (1 - J_P)) on the Lame parameters (S13 section 5).
    fn hardening(&self, plastic_ratio: T) -> T;

    /// The return map: `None` where the trial deformation does not yield.
    fn flow(&self, trial: &Matrix<T, D>, plastic_ratio: T) -> Option<PlasticFlow<T, D>>;

    /// An upper bound of the elastic modulus that carries waves through a particle deformed by `f` [Pa], stiffness 1.
    fn wave_modulus(&self, f: &Matrix<T, D>) -> T;

    /// Psi = mu |F - R|^2 + (lambda / 2)(J - 1)^2 [J/m^D] (Stomakhin et al. 2012; S13 section 5).
    fn energy_density(&self, f: &Matrix<T, D>, stiffness: T) -> T {
        let Lame { mu, lambda } = self.lame();
        let j = determinant(f) - T::one();
        stiffness * (mu * norm_squared(&(f - polar_rotation(f))) + lambda * T::of(0.5) * j * j)
    }

    /// P = dPsi/dF = 2 mu (F - R) + lambda (J - 1) cof F [Pa].
    fn first_piola(&self, f: &Matrix<T, D>, stiffness: T) -> Matrix<T, D> {
        let Lame { mu, lambda } = self.lame();
        let deviation = f - polar_rotation(f);
        deviation * (stiffness * (mu + mu)) + cofactor(f) * (stiffness * lambda * (determinant(f) - T::one()))
    }

    /// tau = P F^T = 2 mu (F - R) F^T + lambda (J - 1) J I [Pa], the Kirchhoff stress.
    #[inline]
    fn kirchhoff(&self, f: &Matrix<T, D>, stiffness: T) -> Matrix<T, D> {
        let Lame { mu, lambda } = self.lame();
        let j = determinant(f);
        let pressure = stiffness * lambda * (j - T::one()) * j;
        let mut tau = (f - polar_rotation(f)) * f.transpose() * (stiffness * (mu + mu));
        for k in 0..D {
            tau[(k, k)] += pressure;
        }
        tau
    }
}

/// By how much a deformation raises the modulus that carries waves, over that at F = I: forces act through P F^T grad w, so that
/// a stretch s raises the shear stiffness by s^2, which the largest row sum of F^T F bounds (Gershgorin), and a change of
/// volume the bulk stiffness by J d/dJ (J^2 - J) = 2 J^2 - J.
#[inline]
fn stretch_factor<T: Real, const D: usize>(f: &Matrix<T, D>) -> T {
    let metric = f.transpose() * f;
    let stretch_squared = (0..D)
        .map(|i| (0..D).fold(T::zero(), |sum, j| sum + metric[(i, j)].abs()))
        .fold(T::one(), |largest, row| largest.max(row));
    let j = determinant(f);
    stretch_squared.max(j * (j + j - T::one()))
}

/// A material of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material<T> {
    /// Elastoplastic snow.
    Snow(Snow<T>),
    /// The same elastic law without a yield surface.
    Elastic(Elastic<T>),
}

impl<T: Real, const D: usize> ConstitutiveModel<T, D> for Material<T> {
    #[inline]
    fn lame(&self) -> Lame<T> {
        match self {
            Material::Snow(m) => m.lame,
            Material::Elastic(m) => m.lame,
        }
    }

    #[inline]
    fn hardening(&self, plastic_ratio: T) -> T {
        match self {
            Material::Snow(m) => ConstitutiveModel::<T, D>::hardening(m, plastic_ratio),
            Material::Elastic(m) => ConstitutiveModel::<T, D>::hardening(m, plastic_ratio),
        }
    }

    #[inline]
    fn flow(&self, trial: &Matrix<T, D>, plastic_ratio: T) -> Option<PlasticFlow<T, D>> {
        match self {
            Material::Snow(m) => m.flow(trial, plastic_ratio),
            Material::Elastic(m) => m.flow(trial, plastic_ratio),
        }
    }

    #[inline]
    fn wave_modulus(&self, f: &Matrix<T, D>) -> T {
        match self {
            Material::Snow(m) => m.wave_modulus(f),
            Material::Elastic(m) => m.wave_modulus(f),
        }
    }
}
