//! Distribution functions and quantiles. Quantiles are found by bisection on the distribution function, down to
//! neighbouring floating-point numbers: slow (microseconds) and never astray.

use super::incomplete::{incomplete_beta, incomplete_gamma};

/// Standard normal distribution function (DLMF 7.17 notation: erfc(-z/sqrt 2)/2).
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// Standard normal quantile at `probability` in (0, 1).
///
/// # Panics
/// If `probability` is not strictly between 0 and 1.
pub fn normal_quantile(probability: f64) -> f64 {
    check_probability(probability, "normal");
    symmetric_quantile(probability, |z| normal_cdf(-z))
}

/// Distribution function of Student's t with `freedom` > 0 degrees of freedom
/// (Johnson, Kotz & Balakrishnan 1995, vol. 2, ch. 28; Abramowitz & Stegun 26.7.1).
pub fn student_t_cdf(t: f64, freedom: f64) -> f64 {
    let tail = student_t_tail(t.abs(), freedom);
    if t > 0.0 { 1.0 - tail } else { tail }
}

/// Quantile of Student's t at `probability` in (0, 1) with `freedom` > 0 degrees of freedom.
///
/// # Panics
/// If `probability` is not strictly between 0 and 1, or `freedom` is not positive.
pub fn student_t_quantile(probability: f64, freedom: f64) -> f64 {
    check_probability(probability, "Student t");
    check_freedom(freedom, "Student t");
    symmetric_quantile(probability, |t| student_t_tail(t, freedom))
}

/// P(T > t), t >= 0: half of I_x(freedom/2, 1/2) at x = freedom/(freedom + t^2).
fn student_t_tail(t: f64, freedom: f64) -> f64 {
    0.5 * incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + t * t))
}

/// Chi-square distribution function with `freedom` > 0 degrees of freedom (Abramowitz & Stegun 26.4.1).
pub fn chi_square_cdf(value: f64, freedom: f64) -> f64 {
    incomplete_gamma(0.5 * freedom, 0.5 * value)
}

/// Chi-square quantile at `probability` in (0, 1) with `freedom` > 0 degrees of freedom.
///
/// # Panics
/// If `probability` is not strictly between 0 and 1, or `freedom` is not positive.
pub fn chi_square_quantile(probability: f64, freedom: f64) -> f64 {
    check_probability(probability, "chi-square");
    check_freedom(freedom, "chi-square");
    let above = doubled_until(|value| chi_square_cdf(value, freedom) >= probability);
    bisect(0.0, above, |value| chi_square_cdf(value, freedom) >= probability)
}

/// Quantile of the beta distribution with shapes `a`, `b` > 0 at `probability` in (0, 1).
///
/// # Panics
/// If `probability` is not strictly between 0 and 1.
pub fn beta_quantile(probability: f64, a: f64, b: f64) -> f64 {
    check_probability(probability, "beta");
    bisect(0.0, 1.0, |x| incomplete_beta(a, b, x) >= probability)
}

/// Quantile of a distribution symmetric about zero from its upper tail P(X > x), x >= 0.
fn symmetric_quantile(probability: f64, tail: impl Fn(f64) -> f64) -> f64 {
    if probability == 0.5 {
        return 0.0;
    }
    let wanted = probability.min(1.0 - probability);
    let reached = |x: f64| tail(x) <= wanted;
    let size = bisect(0.0, doubled_until(reached), reached);
    if probability < 0.5 { -size } else { size }
}

/// The first of 1, 2, 4, ... at which `reached` holds.
fn doubled_until(reached: impl Fn(f64) -> bool) -> f64 {
    let mut value = 1.0;
    while !reached(value) {
        value *= 2.0;
    }
    value
}

/// Smallest floating-point number of [`lower`, `upper`] at which the monotone `reached` holds.
fn bisect(mut lower: f64, mut upper: f64, reached: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (lower + upper);
        if middle <= lower || middle >= upper {
            return upper;
        }
        if reached(middle) {
            upper = middle;
        } else {
            lower = middle;
        }
    }
}

fn check_probability(probability: f64, distribution: &str) {
    assert!(
        probability > 0.0 && probability < 1.0,
        "{distribution} quantile: probability {probability} is not strictly between 0 and 1"
    );
}

fn check_freedom(freedom: f64, distribution: &str) {
    assert!(freedom > 0.0, "{distribution} quantile: {freedom} degrees of freedom; it takes more than none");
}
