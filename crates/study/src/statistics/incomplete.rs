//! Regularised incomplete beta and gamma functions by their series of positive terms: no cancellation, and as
//! many terms as the precision asks for.

/// Relative size below which a further term of a positive, by then geometrically falling, series is dropped.
const NEGLIGIBLE: f64 = 1e-17;

/// Regularised incomplete beta function I_x(a, b), a > 0, b > 0, x in [0, 1].
///
/// DLMF 8.17.8: B_x(a,b) = x^a (1-x)^b / a * F(a+b, 1; a+1; x), whose terms are all positive; the symmetry
/// I_x(a,b) = 1 - I_{1-x}(b,a) (DLMF 8.17.4) is used above the mean, where the series converges slowly.
pub(super) fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let log_beta = libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
    let front = libm::exp(a * libm::log(x) + b * libm::log1p(-x) - log_beta) / a;
    front * positive_series(|n| x * (a + b + n) / (a + 1.0 + n))
}

/// Regularised lower incomplete gamma function P(a, x), a > 0, x >= 0.
///
/// DLMF 8.7.1 with 8.2.6: P(a,x) = x^a e^-x sum_k x^k / Gamma(a+k+1).
pub(super) fn incomplete_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let front = libm::exp(a * libm::log(x) - x - libm::lgamma(a + 1.0));
    (front * positive_series(|n| x / (a + 1.0 + n))).min(1.0)
}

/// 1 + r(0) + r(0) r(1) + ..., where the ratio r(n) > 0 of a term to the one before it ends below one.
fn positive_series(ratio: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut term, mut n) = (1.0, 1.0, 0.0);
    loop {
        let step = ratio(n);
        term *= step;
        sum += term;
        n += 1.0;
        if step < 1.0 && term < NEGLIGIBLE * sum {
            return sum;
        }
    }
}
