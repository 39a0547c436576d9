//! Gaussian random fields and their level cuts.

use snowlab_sampler::rng::{direction, uniform_vector};
use snowlab_sampler::{GaussianField, PlaneWaves, Purpose, Streams, VoidField, draw_voids};

use crate::support::snowball;

/// Over fields and places: mean 0, variance 1, and the correlation `exp(-r^2 / (2 l^2))` at every distance.
fn two_point_correlation_is_gaussian<const D: usize>() {
    let length = 0.03;
    let mut rng = Streams::new(1).stream(Purpose::Noise);
    let ratios = [0.0, 0.5, 1.0, 1.5, 2.0, 4.0];
    let mut products = [0.0; 6];
    let mut mean = 0.0;
    let (fields, places) = (100, 100);
    for _ in 0..fields {
        let field = PlaneWaves::<D>::draw(length, &mut rng);
        for _ in 0..places {
            let point = uniform_vector::<D>(&mut rng);
            let along = direction::<D>(&mut rng);
            let value = field.value(&point);
            mean += value;
            for (product, ratio) in products.iter_mut().zip(ratios) {
                *product += value * field.value(&(point + along * (ratio * length)));
            }
        }
    }
    let samples = f64::from(fields * places);
    assert!((mean / samples).abs() < 0.04, "mean {}", mean / samples);
    for (product, ratio) in products.into_iter().zip(ratios) {
        let (found, expected) = (product / samples, (-0.5 * ratio * ratio).exp());
        // Places lie a third of a metre apart on average: nearly independent, standard error 0.01 to 0.014.
        assert!((found - expected).abs() < 0.05, "correlation {found} at {ratio} l, expected {expected}");
    }
}

#[test]
fn two_point_correlation_is_gaussian_in_2d() {
    two_point_correlation_is_gaussian::<2>();
}

#[test]
fn two_point_correlation_is_gaussian_in_3d() {
    two_point_correlation_is_gaussian::<3>();
}

/// The fourth moment of a normal distribution is 3.
#[test]
fn values_are_normal() {
    let mut rng = Streams::new(2).stream(Purpose::Noise);
    let values: Vec<f64> = (0..200)
        .flat_map(|_| {
            let field = PlaneWaves::<2>::draw(0.01, &mut rng);
            (0..200).map(|_| field.value(&uniform_vector::<2>(&mut rng))).collect::<Vec<f64>>()
        })
        .collect();
    let fourth = values.iter().map(|value| value.powi(4)).sum::<f64>() / values.len() as f64;
    let above = values.iter().filter(|value| **value > 1.0).count() as f64 / values.len() as f64;
    assert!((fourth - 3.0).abs() < 0.2, "fourth moment {fourth}");
    assert!((above - 0.1587).abs() < 0.008, "share above one sigma {above}");
}

fn share_and_lengths<const D: usize>(h: f64, porosity: f64, seeds: u64) {
    for seed in 0..seeds {
        let field = VoidField::Gaussian(GaussianField { porosity, correlation_length: 4.0 * h });
        let voids = draw_voids(&snowball::<D>(), &field, h, &Streams::new(seed)).unwrap();
        assert!((voids.porosity / porosity - 1.0).abs() < 0.01, "{}", voids.porosity);
        assert!(voids.least_diameter >= 4.0 * h && voids.count > 0);
        assert!(voids.mean_radius >= 0.5 * voids.least_diameter);
        assert!(voids.inclusions().is_empty());
        let mut rng = Streams::new(99).stream(Purpose::Noise);
        let (mut inside, mut void) = (0.0, 0.0);
        for _ in 0..200_000 {
            let point = uniform_vector::<D>(&mut rng).add_scalar(-0.5) * 0.5;
            if snowball::<D>().contains(&point) {
                inside += 1.0;
                void += f64::from(voids.contains(&point));
            }
        }
        let share: f64 = void / inside;
        let error = (share * (1.0 - share) / inside).sqrt();
        assert!((share - voids.porosity).abs() < 4.0 * error, "{share} +- {error}, said {}", voids.porosity);
    }
}

#[test]
fn a_level_cut_has_its_porosity_and_no_small_void_in_2d() {
    share_and_lengths::<2>(0.0072, 0.15, 2);
    share_and_lengths::<2>(0.0072, 0.3, 1);
}

#[test]
fn a_level_cut_has_its_porosity_and_no_small_void_in_3d() {
    share_and_lengths::<3>(0.025, 0.1, 1);
}

/// The cut follows the correlation length: four times the length, far fewer voids.
#[test]
fn longer_correlations_make_fewer_voids() {
    let voids = |correlation_length| {
        (0..2)
            .map(|seed| {
                let field = VoidField::Gaussian(GaussianField { porosity: 0.2, correlation_length });
                draw_voids(&snowball::<2>(), &field, 0.0072, &Streams::new(seed)).unwrap().count
            })
            .sum::<usize>()
    };
    let (fine, coarse) = (voids(0.015), voids(0.06));
    assert!(fine > 2 * coarse, "{fine} voids at 15 mm, {coarse} at 60 mm");
}
