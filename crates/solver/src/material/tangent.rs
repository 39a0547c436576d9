//! The tangent of the elastic law: how P = dPsi/dF answers to a change dF of the elastic deformation gradient.

use super::{ConstitutiveModel, Lame, Material};
use crate::geometry::{Matrix, Vector};
use crate::math::{SignedSvd, signed_svd};
use crate::real::Real;

/// Sums of two stretches nearer to 0 than this count as this: where they vanish (F inverted), the rotation of F jumps and has no
/// derivative (chosen: far from any stretch of material that is not turned inside out; the tangent stays below 400 mu).
pub(crate) const LEAST_SUM_OF_STRETCHES: f64 = 0.01;

/// dP(dF) of one particle at one F, ready to be applied many times.
///
/// In the principal axes F = U diag(s) V^T, with D = U^T dF V and P likewise, the derivative (S13 section 6;
/// dP = 2 mu (dF - dR) + lambda cof F (cof F : dF) + lambda (J - 1) d(cof F)) falls apart into the diagonal,
///
/// ```text
/// dP_ii = sum_j A_ij D_jj,   A = 2 mu I + lambda c c^T + lambda (J - 1) d2J/ds2,   c = dJ/ds
/// ```
///
/// and, for each pair of axes i, j (k the third one; s_k = 1 in 2D), the flip (D_ij + D_ji) / 2 and the twist (D_ij - D_ji) / 2 with
/// the factors 2 mu - lambda (J - 1) s_k and 2 mu (1 - 2 / (s_i + s_j)) + lambda (J - 1) s_k.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<T: Real, const D: usize> {
    u: Matrix<T, D>,
    v: Matrix<T, D>,
    diagonal: Matrix<T, D>,
    /// Flip and twist of each pair in the upper triangle.
    flip: Matrix<T, D>,
    twist: Matrix<T, D>,
}

impl<T: Real, const D: usize> Tangent<T, D> {
    /// Of a `material` with the factor `stiffness` on its Lame parameters, deformed by `f`. `definite` replaces negative eigenvalues by 0 (Teran et
    /// al. 2005), which gives the nearest tangent that no deformation gains energy from.
    pub fn new(material: &Material<T>, f: &Matrix<T, D>, stiffness: T, definite: bool) -> Self {
        let lame = ConstitutiveModel::<T, D>::lame(material);
        let SignedSvd { u, stretches: s, v } = signed_svd(f);
        let Lame { mu, lambda } = Lame { mu: lame.mu * stiffness, lambda: lame.lambda * stiffness };
        let (two, two_mu) = (T::of(2.0), mu + mu);
        let j = s.iter().fold(T::one(), |product, s| product * *s);
        let pressure = lambda * (j - T::one());
        let others = |i: usize, k: usize| {
            (0..D).filter(|&l| l != i && l != k).fold(T::one(), |product, l| product * s[l])
        };
        let cofactor = Vector::<T, D>::from_fn(|i, _| others(i, i));
        let mut diagonal = Matrix::from_fn(|i, k| {
            let shared = lambda * cofactor[i] * cofactor[k];
            shared + if i == k { two_mu } else { pressure * others(i, k) }
        });
        let (mut flip, mut twist) = (Matrix::<T, D>::zeros(), Matrix::<T, D>::zeros());
        for i in 0..D {
            for k in i + 1..D {
                let sum = away_from_zero(s[i] + s[k]);
                flip[(i, k)] = two_mu - pressure * others(i, k);
                twist[(i, k)] = two_mu * (T::one() - two / sum) + pressure * others(i, k);
            }
        }
        if definite {
            diagonal = positive_part(&diagonal);
            flip.apply(|entry| *entry = entry.max(T::zero()));
            twist.apply(|entry| *entry = entry.max(T::zero()));
        }
        Tangent { u, v, diagonal, flip, twist }
    }

    /// dP of `df` [Pa].
    pub fn differential(&self, df: &Matrix<T, D>) -> Matrix<T, D> {
        let d = self.u.transpose() * df * self.v;
        let half = T::of(0.5);
        let mut p = Matrix::<T, D>::zeros();
        for i in 0..D {
            for k in 0..D {
                p[(i, i)] += self.diagonal[(i, k)] * d[(k, k)];
            }
            for k in i + 1..D {
                let flip = self.flip[(i, k)] * (d[(i, k)] + d[(k, i)]) * half;
                let twist = self.twist[(i, k)] * (d[(i, k)] - d[(k, i)]) * half;
                (p[(i, k)], p[(k, i)]) = (flip + twist, flip - twist);
            }
        }
        self.u * p * self.v.transpose()
    }
}

fn away_from_zero<T: Real>(sum: T) -> T {
    let least = T::of(LEAST_SUM_OF_STRETCHES);
    if sum >= T::zero() { sum.max(least) } else { sum.min(-least) }
}

/// A symmetric matrix with its negative eigenvalues replaced by 0: (m + |m|) / 2, where |m| = V |S| V^T of m = U S V^T.
fn positive_part<T: Real, const D: usize>(m: &Matrix<T, D>) -> Matrix<T, D> {
    let SignedSvd { stretches, v, .. } = signed_svd(m);
    let magnitude = v * Matrix::from_diagonal(&stretches.map(|s| s.abs())) * v.transpose();
    (m + magnitude) * T::of(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Elastic;
    use crate::math::determinant;

    const STIFFNESS: f64 = 1.7;

    fn material() -> Material<f64> {
        Material::Elastic(Elastic { lame: Lame::from_young(1.4e5, 0.2) })
    }

    /// Numbers in (-1, 1) that look random.
    fn number(k: usize) -> f64 {
        ((k as f64 * 12.9898).sin() * 43758.5453).fract()
    }

    fn matrix<const D: usize>(seed: usize) -> Matrix<f64, D> {
        Matrix::from_fn(|i, j| number(seed * 31 + i * 7 + j * 3 + 1))
    }

    /// Central differences of P along `df`, fourth order.
    fn difference<const D: usize>(f: &Matrix<f64, D>, df: &Matrix<f64, D>) -> Matrix<f64, D> {
        let material = material();
        let p = |s: f64| material.first_piola(&(f + df * s), STIFFNESS);
        let step = 1e-4;
        ((p(step) - p(-step)) * 8.0 - (p(2.0 * step) - p(-2.0 * step))) / (12.0 * step)
    }

    fn check<const D: usize>(f: &Matrix<f64, D>, what: &str) {
        for seed in 0..6 {
            let df = matrix::<D>(seed + 40);
            let expected = difference(f, &df);
            let found = Tangent::new(&material(), f, STIFFNESS, false).differential(&df);
            let error = (found - expected).norm() / expected.norm();
            assert!(error < 1e-7, "{what}: {found} is not {expected}, {error:e}");
        }
    }

    fn check_all<const D: usize>() {
        let one = Matrix::<f64, D>::identity();
        check(&one, "at rest");
        for seed in 0..8 {
            let f = one + matrix::<D>(seed) * 0.3;
            check(&f, "deformed");
            let mut inverted = f;
            inverted.column_mut(0).neg_mut();
            if D == 2 {
                // Away from s_0 = -s_1, where the rotation jumps.
                inverted.column_mut(1).scale_mut(2.0);
            }
            assert!(determinant(&inverted) < 0.0);
            check(&inverted, "turned inside out");
        }
        let mut equal = one * 0.8;
        check(&equal, "equal stretches");
        equal[(0, 0)] = 0.8 + 1e-9;
        check(&equal, "nearly equal stretches");
        let mut flat = one * 1.2;
        flat[(0, 0)] = 0.0;
        check(&flat, "flat");
    }

    #[test]
    fn the_tangent_is_the_derivative_of_stress() {
        check_all::<2>();
        check_all::<3>();
    }

    #[test]
    fn the_tangent_is_symmetric() {
        fn check<const D: usize>() {
            for seed in 0..10 {
                let f = Matrix::<f64, D>::identity() + matrix::<D>(seed) * 0.6;
                for definite in [false, true] {
                    let tangent = Tangent::new(&material(), &f, STIFFNESS, definite);
                    let (a, b) = (matrix::<D>(seed + 20), matrix::<D>(seed + 30));
                    let (ab, ba) = (a.dot(&tangent.differential(&b)), b.dot(&tangent.differential(&a)));
                    assert!((ab - ba).abs() < 1e-13 * tangent.differential(&b).norm(), "{ab} {ba}");
                }
            }
        }
        check::<2>();
        check::<3>();
    }

    /// physics.md: the twist of a compressed particle has the eigenvalue 2 mu (1 - 2 / (s_1 + s_2)) + lambda (J - 1) < 0.
    #[test]
    fn compression_makes_the_tangent_indefinite_and_projection_definite() {
        let Lame { mu, lambda } = Lame::<f64>::from_young(1.4e5, 0.2);
        let s = 0.975;
        let f = Matrix::<f64, 2>::identity() * s;
        let twist = Matrix::<f64, 2>::new(0.0, 1.0, -1.0, 0.0);
        let eigenvalue = 2.0 * mu * (1.0 - 1.0 / s) + lambda * (s * s - 1.0);
        let exact = Tangent::new(&material(), &f, 1.0, false).differential(&twist);
        assert!(eigenvalue < 0.0 && (exact - twist * eigenvalue).norm() < 1e-9 * mu);
        let definite = Tangent::new(&material(), &f, 1.0, true);
        assert!(definite.differential(&twist).norm() < 1e-9 * mu);
        // The others stay.
        let stretch = Matrix::<f64, 2>::new(1.0, 0.3, 0.3, -0.5);
        let exact = Tangent::new(&material(), &f, 1.0, false).differential(&stretch);
        assert!((definite.differential(&stretch) - exact).norm() < 1e-9 * exact.norm());
    }

    /// Stretched s times, a square gives 2 mu + lambda (1 - s^2) to a stretch along one axis that is taken back along the other.
    #[test]
    fn a_square_that_is_stretched_far_keeps_what_resists_and_loses_what_gives() {
        let Lame { mu, lambda } = Lame::<f64>::from_young(1.4e5, 0.2);
        let s = 3.0;
        let f = Matrix::<f64, 2>::identity() * s;
        let across = Matrix::<f64, 2>::new(1.0, 0.0, 0.0, -1.0);
        let eigenvalue = 2.0 * mu + lambda * (1.0 - s * s);
        let exact = Tangent::new(&material(), &f, 1.0, false).differential(&across);
        assert!(eigenvalue < 0.0 && (exact - across * eigenvalue).norm() < 1e-9 * mu, "{exact}");
        let definite = Tangent::new(&material(), &f, 1.0, true);
        assert!(definite.differential(&across).norm() < 1e-9 * mu);
        let whole = Matrix::<f64, 2>::identity();
        let kept = whole * (2.0 * mu + lambda * (3.0 * s * s - 1.0));
        assert!((definite.differential(&whole) - kept).norm() < 1e-9 * kept.norm());
    }

    #[test]
    fn the_projected_tangent_never_gives_energy() {
        fn check<const D: usize>() {
            for seed in 0..200 {
                let f = Matrix::<f64, D>::identity() + matrix::<D>(seed) * 0.9;
                let tangent = Tangent::new(&material(), &f, STIFFNESS, true);
                let a = matrix::<D>(seed + 500);
                assert!(a.dot(&tangent.differential(&a)) > -1e-9, "{f}");
            }
        }
        check::<2>();
        check::<3>();
    }
}
