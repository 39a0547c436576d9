//! Particles that are not alike: moments of the factors, how far they reach, and what is refused.

use snowlab_sampler::{Heterogeneity, Sampler, SamplerError, Streams, place};
use snowlab_solver::geometry::Vector;

use crate::support::snowball;

const COUNT: usize = 20_000;

fn factors(heterogeneity: Heterogeneity, seed: u64) -> (Vec<Vector<f64, 2>>, Vec<f64>) {
    let (region, streams) = (snowball::<2>(), Streams::new(seed));
    let positions = place(&region, &Sampler::Random, None, COUNT, &streams).unwrap().positions;
    let factors = heterogeneity.factors(&region, &positions, &streams).unwrap();
    (positions, factors)
}

fn moments(factors: &[f64]) -> (f64, f64) {
    let n = factors.len() as f64;
    let mean = factors.iter().sum::<f64>() / n;
    (mean, (factors.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / n).sqrt())
}

#[test]
fn independent_factors_have_mean_one_and_the_spread_asked_for() {
    for spread in [0.0, 0.25, 0.5, 1.0, 1.4] {
        let (_, factors) = factors(Heterogeneity::Independent { spread }, 3);
        let (mean, found) = moments(&factors);
        assert!((mean - 1.0).abs() < 1e-12, "{mean}");
        // The spread of a sample of 20000 of the widest law here has a standard error of 2 %.
        assert!((found - spread).abs() <= 0.06 * spread, "{found} for {spread}");
        assert!(factors.iter().all(|&factor| factor > 0.0));
    }
    // Of neighbours in the stream none says anything of the next: r has a standard error of 0.007.
    let (_, factors) = factors(Heterogeneity::Independent { spread: 1.0 }, 3);
    let product: f64 = factors.windows(2).map(|w| (w[0] - 1.0) * (w[1] - 1.0)).sum::<f64>() / COUNT as f64;
    assert!(product.abs() < 0.03, "{product}");
}

/// Particles closer than a fifth of the correlation length are alike, those three lengths apart are not.
#[test]
fn correlated_factors_are_alike_as_far_as_they_should_be() {
    let (length, spread) = (0.02, 0.5);
    let (mut near, mut far, mut square) = ((0.0, 0), (0.0, 0), 0.0);
    for seed in 0..8 {
        let (positions, factors) =
            factors(Heterogeneity::Correlated { spread, correlation_length: length }, seed);
        let (mean, found) = moments(&factors);
        assert!((mean - 1.0).abs() < 1e-12, "{mean}");
        square += found * found / 8.0;
        for i in 0..400 {
            for j in 0..i {
                let apart = (positions[i] - positions[j]).norm();
                let product = (factors[i] - 1.0) * (factors[j] - 1.0);
                let sum = match apart / length {
                    r if r < 0.2 => &mut near,
                    r if (3.0..5.0).contains(&r) => &mut far,
                    _ => continue,
                };
                *sum = (sum.0 + product, sum.1 + 1);
            }
        }
    }
    assert!((square.sqrt() - spread).abs() < 0.15 * spread, "{}", square.sqrt());
    let (near, far) = (near.0 / f64::from(near.1), far.0 / f64::from(far.1));
    assert!(near > 0.6 * spread * spread && far.abs() < 0.15 * spread * spread, "{near} and {far}");
}

#[test]
fn a_shell_is_as_thick_as_was_asked_for() {
    let (positions, factors) = factors(Heterogeneity::Shell { factor: 3.0, thickness: 0.05 }, 1);
    for (position, factor) in positions.iter().zip(factors) {
        assert_eq!(factor, if 0.25 - position.norm() < 0.05 { 3.0 } else { 1.0 });
    }
}

#[test]
fn the_same_seed_gives_the_same_factors_and_leaves_the_placement() {
    let noise = Heterogeneity::Independent { spread: 1.0 };
    let (one, two) = (factors(noise, 5), factors(noise, 5));
    assert_eq!(one, two);
    assert_ne!(one.1, factors(noise, 6).1);
}

#[test]
fn what_means_nothing_is_refused() {
    let refused = [
        Heterogeneity::Independent { spread: -0.1 },
        Heterogeneity::Independent { spread: f64::NAN },
        Heterogeneity::Correlated { spread: 3.1, correlation_length: 0.1 },
        Heterogeneity::Correlated { spread: 0.5, correlation_length: 0.0 },
        Heterogeneity::Shell { factor: 0.0, thickness: 0.1 },
        Heterogeneity::Shell { factor: 2.0, thickness: f64::INFINITY },
    ];
    for heterogeneity in refused {
        let error = heterogeneity
            .factors(&snowball::<2>(), &[Vector::<f64, 2>::zeros()], &Streams::new(1))
            .unwrap_err();
        assert!(matches!(error, SamplerError::OutOfRange { .. }), "{heterogeneity:?}: {error}");
    }
}
