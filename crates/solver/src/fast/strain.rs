//! Deformation, stress and plastic flow of several particles at once, from H = F_E - I. With b = F F^T, V = b^(1/2) the left stretch and
//! J = det F, the fixed corotated stress needs no rotation: tau = P F^T = 2 mu (b - V) + lambda (J - 1) J I, since R F^T = V.
//!
//! H instead of F keeps, in f32, what F loses beside the ones on its diagonal.

use super::simd::Lanes;
use crate::real::Real;

/// A matrix, or a symmetric one with all its entries, for each particle.
pub(super) type Matrix<V, const D: usize> = [[V; D]; D];

/// What the constitutive law needs of the material, particle by particle.
#[derive(Clone, Copy)]
pub(super) struct Moduli<V> {
    pub mu: V,
    pub lambda: V,
}

/// Bounds on stretches less one, and what follows from passing them.
#[derive(Clone, Copy)]
pub(super) struct YieldSurface<V> {
    /// - theta_c and theta_s.
    pub least: V,
    pub greatest: V,
    pub hardening: V,
    /// Bounds on J_P.
    pub ratio: [V; 2],
    /// The greatest factor that hardening has.
    pub limit: V,
}

/// E = F F^T - I = H + H^T + H H^T.
#[inline(always)]
pub(super) fn left_strain<T: Real, V: Lanes<T>, const D: usize>(h: &Matrix<V, D>) -> Matrix<V, D> {
    let mut e = *h;
    for i in 0..D {
        for j in i..D {
            let mut sum = h[i][j] + h[j][i];
            for k in 0..D {
                sum = h[i][k].mul_add(h[j][k], sum);
            }
            e[i][j] = sum;
            e[j][i] = sum;
        }
    }
    e
}

/// det (I + H) - 1, without the one.
#[inline(always)]
pub(super) fn volume_change<T: Real, V: Lanes<T>, const D: usize>(h: &Matrix<V, D>) -> V {
    if D == 2 {
        let minor = h[0][0].mul_add(h[1][1], -(h[0][1] * h[1][0]));
        return h[0][0] + h[1][1] + minor;
    }
    let minors = [minor(h, 1, 2), minor(h, 0, 2), minor(h, 0, 1)];
    let second = minors[0] + minors[1] + minors[2];
    h[0][0] + h[1][1] + h[2][2] + second + determinant::<T, V, D>(h)
}

/// The principal minor of rows and columns `i` and `j`.
#[inline(always)]
fn minor<T: Real, V: Lanes<T>, const D: usize>(m: &Matrix<V, D>, i: usize, j: usize) -> V {
    m[i][j].neg_mul_add(m[j][i], m[i][i] * m[j][j])
}

#[inline(always)]
fn determinant<T: Real, V: Lanes<T>, const D: usize>(m: &Matrix<V, D>) -> V {
    if D == 2 {
        return minor(m, 0, 1);
    }
    let first = m[1][2].neg_mul_add(m[2][1], m[1][1] * m[2][2]);
    let second = m[1][2].neg_mul_add(m[2][0], m[1][0] * m[2][2]);
    let third = m[1][1].neg_mul_add(m[2][0], m[1][0] * m[2][1]);
    m[0][2].mul_add(third, m[0][1].neg_mul_add(second, m[0][0] * first))
}

/// (I + A)(I + H) - I = A + H + A H.
#[inline(always)]
pub(super) fn compose<T: Real, V: Lanes<T>, const D: usize>(
    a: &Matrix<V, D>,
    h: &Matrix<V, D>,
) -> Matrix<V, D> {
    let mut product = *a;
    for i in 0..D {
        for j in 0..D {
            let mut sum = a[i][j] + h[i][j];
            for k in 0..D {
                sum = a[i][k].mul_add(h[k][j], sum);
            }
            product[i][j] = sum;
        }
    }
    product
}

/// V - I = (I + E)^(1/2) - I.
#[inline(always)]
fn left_stretch<T: Real, V: Lanes<T>, const D: usize>(h: &Matrix<V, D>, e: &Matrix<V, D>) -> Matrix<V, D> {
    if D == 2 { planar_stretch::<T, V, D>(h, e) } else { spatial_stretch::<T, V, D>(e) }
}

/// By V = (b + J I) / t, less I, where t^2 = tr b + 2 J = (F00 + F11)^2 + (F10 - F01)^2.
#[inline(always)]
fn planar_stretch<T: Real, V: Lanes<T>, const D: usize>(h: &Matrix<V, D>, e: &Matrix<V, D>) -> Matrix<V, D> {
    let one = V::splat(T::one());
    let volume = one + volume_change::<T, V, D>(h);
    let (sum, turn) = (one + one + h[0][0] + h[1][1], h[1][0] - h[0][1]);
    let root = sum.mul_add(sum, turn * turn).sqrt();
    // (1 + J)^2 - t^2 = det E: what E has to be complemented by, without its cancellation.
    let rest = minor(e, 0, 1) / (one + volume + root);
    let per_root = one / root;
    let mut s = *e;
    for i in 0..D {
        for j in 0..D {
            s[i][j] = if i == j { (e[i][j] + rest) * per_root } else { e[i][j] * per_root };
        }
    }
    // Next to F = 0 neither E nor det E knows V any more.
    let flat = V::splat(T::of(0.5)).above(root);
    if V::bits(flat) != 0 {
        let mut f = *h;
        for i in 0..D {
            f[i][i] = one + h[i][i];
        }
        let volume = minor(&f, 0, 1);
        let mut left = f;
        for i in 0..D {
            for j in 0..D {
                left[i][j] = f[i][0].mul_add(f[j][0], f[i][1] * f[j][1]);
            }
        }
        // t >= |F| wherever det F > 0; round-off of F itself may say otherwise where nothing else is left of it.
        let size = (left[0][0] + left[1][1]).sqrt();
        let per_root = one / root.max(size).max(V::splat(T::of(T::LEAST_SQUARE)));
        for i in 0..D {
            for j in 0..D {
                let stretch =
                    if i == j { (left[i][j] + volume) * per_root - one } else { left[i][j] * per_root };
                s[i][j] = V::select(flat, stretch, s[i][j]);
            }
        }
    }
    s
}

/// Coefficients of (1 + x)^(1/2) - 1 = sum c_n x^n, n = 1, 2, ...
const SERIES: [f64; 13] = [
    0.5,
    -1.0 / 8.0,
    1.0 / 16.0,
    -5.0 / 128.0,
    7.0 / 256.0,
    -21.0 / 1024.0,
    33.0 / 2048.0,
    -429.0 / 32768.0,
    715.0 / 65536.0,
    -2431.0 / 262_144.0,
    4199.0 / 524_288.0,
    -29393.0 / 4_194_304.0,
    52003.0 / 8_388_608.0,
];
/// |E| up to which the series is used: c_14 0.1^14 and, in f32 with 6 terms, c_7 0.1^7 are below round-off. Snow's yield surface lies
/// within |E| < 0.09.
const SERIES_REACH: f64 = 0.1;

/// By the series of the root, each power of E brought down to the second by Cayley and Hamilton's E^3 = i1 E^2 - i2 E + i3; by
/// eigenvalues where E is large.
#[inline(always)]
fn spatial_stretch<T: Real, V: Lanes<T>, const D: usize>(e: &Matrix<V, D>) -> Matrix<V, D> {
    let zero = V::splat(T::zero());
    let i1 = e[0][0] + e[1][1] + e[2][2];
    let i2 = minor(e, 0, 1) + minor(e, 0, 2) + minor(e, 1, 2);
    let i3 = determinant::<T, V, D>(e);
    let (mut a, mut b, mut c) = (zero, zero, V::splat(T::of(SERIES[T::ROOT_TERMS - 1])));
    for n in (0..T::ROOT_TERMS).rev() {
        let next = if n > 0 { V::splat(T::of(SERIES[n - 1])) } else { zero };
        (a, b, c) = (a.mul_add(i1, b), a.neg_mul_add(i2, c), a.mul_add(i3, next));
    }
    let mut s = *e;
    let mut size = zero;
    for i in 0..D {
        for j in i..D {
            let mut square = zero;
            for k in 0..D {
                square = e[i][k].mul_add(e[k][j], square);
            }
            let rest = if i == j { c } else { zero };
            let entry = a.mul_add(square, b.mul_add(e[i][j], rest));
            s[i][j] = entry;
            s[j][i] = entry;
            if i == j {
                size = size + square;
            }
        }
    }
    let large = size.above(V::splat(T::of(SERIES_REACH * SERIES_REACH)));
    if V::bits(large) != 0 {
        let exact = large_stretch::<T, V, D>(e);
        for i in 0..D {
            for j in 0..D {
                s[i][j] = V::select(large, exact[i][j], s[i][j]);
            }
        }
    }
    s
}

#[inline(always)]
fn large_stretch<T: Real, V: Lanes<T>, const D: usize>(e: &Matrix<V, D>) -> Matrix<V, D> {
    let Spectrum { values, vectors } = spectrum::<T, V, D>(e);
    let mut roots = values;
    for i in 0..D {
        roots[i] = root_less_one::<T, V>(values[i]);
    }
    recompose::<T, V, D>(&vectors, &roots)
}

/// (1 + e)^(1/2) - 1.
#[inline(always)]
pub(super) fn root_less_one<T: Real, V: Lanes<T>>(e: V) -> V {
    let one = V::splat(T::one());
    e / (one + (one + e).max(V::splat(T::zero())).sqrt())
}

/// tau of stiffness 1 [Pa].
#[inline(always)]
pub(super) fn kirchhoff<T: Real, V: Lanes<T>, const D: usize>(
    h: &Matrix<V, D>,
    moduli: &Moduli<V>,
) -> Matrix<V, D> {
    let e = left_strain::<T, V, D>(h);
    let mut tau = left_stretch::<T, V, D>(h, &e);
    let change = volume_change::<T, V, D>(h);
    let pressure = moduli.lambda * change * (V::splat(T::one()) + change);
    let two_mu = moduli.mu + moduli.mu;
    for i in 0..D {
        for j in 0..D {
            let shear = two_mu * (e[i][j] - tau[i][j]);
            tau[i][j] = if i == j { shear + pressure } else { shear };
        }
    }
    tau
}

/// Psi of stiffness 1 [J/m^D]: mu |V - I|^2 + (lambda / 2)(J - 1)^2.
#[inline(always)]
pub(super) fn energy_density<T: Real, V: Lanes<T>, const D: usize>(
    h: &Matrix<V, D>,
    moduli: &Moduli<V>,
) -> V {
    let e = left_strain::<T, V, D>(h);
    let s = left_stretch::<T, V, D>(h, &e);
    let mut squares = V::splat(T::zero());
    for i in 0..D {
        for j in 0..D {
            squares = s[i][j].mul_add(s[i][j], squares);
        }
    }
    let change = volume_change::<T, V, D>(h);
    (moduli.lambda * V::splat(T::of(0.5)) * change).mul_add(change, moduli.mu * squares)
}

/// Where some stretch lies outside the bounds: (1 + greatest)^2 I - b or b - (1 + least)^2 I is not positive definite (Sylvester).
#[inline(always)]
pub(super) fn yields<T: Real, V: Lanes<T>, const D: usize>(
    e: &Matrix<V, D>,
    surface: &YieldSurface<V>,
) -> u32 {
    let upper = surface.greatest.mul_add(surface.greatest, surface.greatest + surface.greatest);
    let lower = surface.least.mul_add(surface.least, surface.least + surface.least);
    let (mut below, mut above) = (*e, *e);
    for i in 0..D {
        for j in 0..D {
            below[i][j] = if i == j { upper - e[i][j] } else { -e[i][j] };
            above[i][j] = if i == j { e[i][j] - lower } else { e[i][j] };
        }
    }
    let least = least_minor::<T, V, D>(&below).min(least_minor::<T, V, D>(&above));
    // What is not a number counts as outside; the step is refused for it elsewhere.
    !V::bits(least.above(V::splat(T::zero()))) & (u32::MAX >> (32 - V::COUNT))
}

/// The least of the leading minors.
#[inline(always)]
fn least_minor<T: Real, V: Lanes<T>, const D: usize>(m: &Matrix<V, D>) -> V {
    let least = m[0][0].min(minor(m, 0, 1));
    if D == 2 { least } else { least.min(determinant::<T, V, D>(m)) }
}

/// What flow made of a trial state.
pub(super) struct Flow<V, const D: usize> {
    pub h: Matrix<V, D>,
    /// J_P before its bounds.
    pub ratio: V,
    /// Energy densities at stiffness 1 before and after [J/m^D].
    pub energies: [V; 2],
}

/// The return map of S13 section 6.1.1 on principal stretches: F <- Q diag(clamp(s) / s) Q^T F with b = Q diag(s^2) Q^T,
/// J_P <- J_P prod(s) / prod(clamp(s)).
#[inline(always)]
pub(super) fn flow<T: Real, V: Lanes<T>, const D: usize>(
    h: &Matrix<V, D>,
    e: &Matrix<V, D>,
    ratio: V,
    moduli: &Moduli<V>,
    surface: &YieldSurface<V>,
) -> Flow<V, D> {
    let one = V::splat(T::one());
    let Spectrum { values, vectors } = spectrum::<T, V, D>(e);
    let mut shortening = values;
    let (mut squares, mut volumes) = ([V::splat(T::zero()); 2], [one; 2]);
    for i in 0..D {
        let stretch = root_less_one::<T, V>(values[i]);
        let clamped = stretch.min(surface.greatest).max(surface.least);
        shortening[i] = (clamped - stretch) / (one + stretch);
        squares = [stretch.mul_add(stretch, squares[0]), clamped.mul_add(clamped, squares[1])];
        volumes = [volumes[0] * (one + stretch), volumes[1] * (one + clamped)];
    }
    let turned = recompose::<T, V, D>(&vectors, &shortening);
    let mut energies = squares;
    for k in 0..2 {
        let change = volumes[k] - one;
        energies[k] = (moduli.lambda * V::splat(T::of(0.5)) * change).mul_add(change, moduli.mu * squares[k]);
    }
    Flow { h: compose::<T, V, D>(&turned, h), ratio: ratio * (volumes[0] / volumes[1]), energies }
}

/// Eigenvalues and, as columns, eigenvectors of a symmetric matrix.
pub(super) struct Spectrum<V, const D: usize> {
    pub values: [V; D],
    pub vectors: Matrix<V, D>,
}

/// Cyclic Jacobi (Golub & Van Loan, Matrix Computations, section 8.5.3). What has converged in a particle is left alone, so that the
/// others in the register have no say in it.
#[inline(always)]
pub(super) fn spectrum<T: Real, V: Lanes<T>, const D: usize>(matrix: &Matrix<V, D>) -> Spectrum<V, D> {
    let (zero, one) = (V::splat(T::zero()), V::splat(T::one()));
    let mut m = *matrix;
    let mut vectors = [[zero; D]; D];
    let mut size = zero;
    for i in 0..D {
        vectors[i][i] = one;
        for j in 0..D {
            size = size.max(m[i][j].abs());
        }
    }
    // chosen: an entry off the diagonal this small moves no eigenvalue by more than round-off.
    let negligible = size * V::splat(T::default_epsilon() * T::of(0.125));
    for _ in 0..T::JACOBI_SWEEPS {
        let mut rotated = 0;
        for (p, q) in [(0, 1), (0, D - 1), (1, D - 1)] {
            if p == q || (D == 2 && p == 1) {
                continue;
            }
            let off = m[p][q];
            let mask = off.abs().above(negligible);
            rotated |= V::bits(mask);
            let divisor = V::select(mask, off + off, one);
            let cotangent = (m[q][q] - m[p][p]) / divisor;
            let length = cotangent.abs() + cotangent.mul_add(cotangent, one).sqrt();
            let tangent = one / length;
            let tangent = V::select(zero.above(cotangent), -tangent, tangent);
            let tangent = V::select(mask, tangent, zero);
            let cosine = one / tangent.mul_add(tangent, one).sqrt();
            let sine = tangent * cosine;
            m[p][p] = tangent.neg_mul_add(off, m[p][p]);
            m[q][q] = tangent.mul_add(off, m[q][q]);
            (m[p][q], m[q][p]) = (zero, zero);
            if D == 3 {
                let r = 3 - p - q;
                let (a, b) = (m[r][p], m[r][q]);
                let (x, y) = (sine.neg_mul_add(b, cosine * a), sine.mul_add(a, cosine * b));
                (m[r][p], m[p][r], m[r][q], m[q][r]) = (x, x, y, y);
            }
            for i in 0..D {
                let (a, b) = (vectors[i][p], vectors[i][q]);
                vectors[i][p] = sine.neg_mul_add(b, cosine * a);
                vectors[i][q] = sine.mul_add(a, cosine * b);
            }
            if D == 2 {
                break;
            }
        }
        if D == 2 || rotated == 0 {
            break;
        }
    }
    let mut values = [zero; D];
    for i in 0..D {
        values[i] = m[i][i];
    }
    Spectrum { values, vectors }
}

/// Q diag(values) Q^T.
#[inline(always)]
pub(super) fn recompose<T: Real, V: Lanes<T>, const D: usize>(
    q: &Matrix<V, D>,
    values: &[V; D],
) -> Matrix<V, D> {
    let mut m = *q;
    for i in 0..D {
        for j in i..D {
            let mut sum = V::splat(T::zero());
            for k in 0..D {
                sum = (q[i][k] * values[k]).mul_add(q[j][k], sum);
            }
            m[i][j] = sum;
            m[j][i] = sum;
        }
    }
    m
}

/// The factor on the modulus that carries waves, see `material::stretch_factor`: the largest row sum of F^T F, and 2 J^2 - J.
#[inline(always)]
pub(super) fn stretch_factor<T: Real, V: Lanes<T>, const D: usize>(h: &Matrix<V, D>) -> V {
    let one = V::splat(T::one());
    let volume = one + volume_change::<T, V, D>(h);
    let mut greatest = one.max(volume * (volume + volume - one));
    for i in 0..D {
        let mut row = V::splat(T::zero());
        for j in 0..D {
            let mut entry = h[i][j] + h[j][i];
            for k in 0..D {
                entry = h[k][i].mul_add(h[k][j], entry);
            }
            row = row + if i == j { entry + one } else { entry }.abs();
        }
        greatest = row.max(greatest);
    }
    greatest
}

/// e^x, by 2^n e^r with |r| <= ln 2 / 2 and Taylor's series; within 2 units in the last place. Where e^x is no normal number, the least or
/// the greatest power of two that is.
#[inline(always)]
pub(super) fn exponential<T: Real, V: Lanes<T>>(x: V) -> V {
    let reach = T::of(T::EXPONENT_REACH * std::f64::consts::LN_2);
    let x = x.max(V::splat(-reach)).min(V::splat(reach));
    let n = x.mul_add(V::splat(T::of(std::f64::consts::LOG2_E)), V::splat(T::of(0.5))).floor();
    let [high, low] = T::LN_2;
    let r = n.neg_mul_add(V::splat(low), n.neg_mul_add(V::splat(high), x));
    let mut sum = V::splat(T::one());
    for k in (1..=T::EXPONENTIAL_TERMS).rev() {
        sum = (sum * r).mul_add(V::splat(T::of(1.0 / k as f64)), V::splat(T::one()));
    }
    sum * n.power_of_two()
}
