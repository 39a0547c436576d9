//! Measures of a placement, against theory and against plain sums over all pairs.

use snowlab_sampler::quality::{
    MeasuringGrid, grid_density_spread, nearest_neighbour_spacing, pair_correlation,
    particles_per_cell_spread, radial_spectrum,
};
use snowlab_sampler::rng::unit_mean_gamma;
use snowlab_sampler::{
    InclusionField, LATTICE_ANGLE, Purpose, Region, Sampler, SamplerError, Streams, VoidField, draw_voids,
    place,
};
use snowlab_solver::geometry::Vector;

use crate::support::snowball;

fn grid<const D: usize>(region: &Region<D>, h: f64) -> MeasuringGrid<'_, D> {
    MeasuringGrid { h, origin: Vector::<f64, D>::repeat(0.001), region, voids: None }
}

/// Root mean square over seeds of the relative spread of the grid density.
fn density_spread<const D: usize>(sampler: Sampler, count: usize, h: f64, weight_spread: f64) -> (f64, f64) {
    let region = snowball::<D>();
    let (mut square, mut mean) = (0.0, 0.0);
    for seed in 0..8 {
        let positions = place(&region, &sampler, None, count, &Streams::new(seed)).unwrap().positions;
        let mut rng = Streams::new(seed).stream(Purpose::Noise);
        let weights: Vec<f64> = positions.iter().map(|_| unit_mean_gamma(&mut rng, weight_spread)).collect();
        let spread = grid_density_spread(&positions, Some(&weights), &grid(&region, h)).unwrap();
        square += spread.relative_spread * spread.relative_spread / 8.0;
        mean += spread.mean / 8.0;
    }
    (square.sqrt(), mean)
}

/// `(151/315)^(D/2) / sqrt(PPC)`: 0.479 in 2D, 0.332 in 3D. A node's density is correlated with that of about nine
/// neighbours, so the 2000 to 3000 nodes of 8 seeds give the spread to about 2 %.
#[test]
fn random_density_spreads_by_the_formula_in_2d() {
    for count in [5_000, 30_000] {
        let (spread, mean) = density_spread::<2>(Sampler::Random, count, 0.0072, 0.0);
        let cells = std::f64::consts::PI * 0.25 * 0.25 / (0.0072 * 0.0072);
        assert!((mean / (f64::from(count as u32) / cells) - 1.0).abs() < 0.02, "mean {mean}");
        assert!((spread * mean.sqrt() / 0.479 - 1.0).abs() < 0.06, "{} at {count}", spread * mean.sqrt());
    }
}

#[test]
fn random_density_spreads_by_the_formula_in_3d() {
    let (spread, mean) = density_spread::<3>(Sampler::Random, 30_000, 0.02, 0.0);
    assert!((spread * mean.sqrt() / 0.332 - 1.0).abs() < 0.06, "{}", spread * mean.sqrt());
}

/// Weights of spread 1 on a lattice have the spread of random placement; the lattice itself has next to none.
#[test]
fn weights_on_a_lattice_spread_like_random_points() {
    let lattice = Sampler::Lattice { angle: LATTICE_ANGLE };
    let (weighted, mean) = density_spread::<2>(lattice, 30_000, 0.0072, 1.0);
    assert!((weighted * mean.sqrt() / 0.479 - 1.0).abs() < 0.08, "{}", weighted * mean.sqrt());
    let (plain, _) = density_spread::<2>(lattice, 30_000, 0.0072, 0.0);
    assert!(plain < 0.005, "{plain}");
}

/// A jittered lattice cuts the spread about 2 times at PPC 0.6 and 10 times at PPC 24.
#[test]
fn jitter_cuts_the_density_spread_more_with_more_particles() {
    let ratio = |count, h| {
        density_spread::<2>(Sampler::Random, count, h, 0.0).0
            / density_spread::<2>(Sampler::Jittered { angle: LATTICE_ANGLE }, count, h, 0.0).0
    };
    let (sparse, dense) = (ratio(2_300, 0.0072), ratio(30_000, 0.0125));
    assert!((1.6..2.6).contains(&sparse), "{sparse} at PPC 0.6");
    assert!((7.0..13.0).contains(&dense), "{dense} at PPC 24");
}

fn neighbours_by_all_pairs<const D: usize>(positions: &[Vector<f64, D>]) -> Vec<f64> {
    positions
        .iter()
        .enumerate()
        .map(|(index, point)| {
            let others = positions.iter().enumerate().filter(|(other, _)| *other != index);
            others.map(|(_, other)| (point - other).norm()).fold(f64::INFINITY, f64::min)
        })
        .collect()
}

fn spacing_agrees_with_all_pairs<const D: usize>() {
    let mut positions =
        place(&snowball::<D>(), &Sampler::Random, None, 800, &Streams::new(1)).unwrap().positions;
    // A far point, which a search of fixed radius would miss, and a pair of coincident ones.
    positions.push(Vector::<f64, D>::repeat(9.0));
    positions.push(positions[0]);
    let nearest = nearest_neighbour_spacing(&positions).unwrap();
    let plain = neighbours_by_all_pairs(&positions);
    let mean = plain.iter().sum::<f64>() / plain.len() as f64;
    assert_eq!(nearest.least, 0.0);
    assert_eq!(nearest.greatest, plain.iter().copied().fold(0.0, f64::max));
    assert!((nearest.mean / mean - 1.0).abs() < 1e-12);
}

#[test]
fn spacing_agrees_with_all_pairs_in_2d_and_3d() {
    spacing_agrees_with_all_pairs::<2>();
    spacing_agrees_with_all_pairs::<3>();
}

/// Chandrasekhar 1943: `1/(2 sqrt(n))` in 2D, `0.55396 n^(-1/3)` in 3D; the surface adds a per cent or a few.
#[test]
fn random_points_have_the_spacing_of_theory() {
    let flat = place(&snowball::<2>(), &Sampler::Random, None, 30_000, &Streams::new(2)).unwrap();
    let density = 30_000.0 / flat.filled_volume;
    let spacing = nearest_neighbour_spacing(&flat.positions).unwrap().mean;
    assert!((spacing * 2.0 * density.sqrt() - 1.0).abs() < 0.02);
    let solid = place(&snowball::<3>(), &Sampler::Random, None, 30_000, &Streams::new(2)).unwrap();
    let density = 30_000.0 / solid.filled_volume;
    let spacing = nearest_neighbour_spacing(&solid.positions).unwrap().mean;
    assert!((spacing / 0.553_96 * density.cbrt() - 1.0).abs() < 0.04);
}

fn random_points_are_uncorrelated<const D: usize>(reach: f64) {
    let region = snowball::<D>();
    let placement = place(&region, &Sampler::Random, None, 20_000, &Streams::new(3)).unwrap();
    let density = 20_000.0 / placement.filled_volume;
    let correlation = pair_correlation(&placement.positions, &region, density, reach, 10).unwrap();
    assert_eq!(correlation.len(), 10);
    assert!((correlation[3].distance / reach - 0.35).abs() < 1e-12);
    // The first bins hold few pairs; the third on at least a few thousand.
    assert!(correlation[2..].iter().all(|bin| (bin.value - 1.0).abs() < 0.06), "{correlation:?}");
}

#[test]
fn random_points_are_uncorrelated_in_2d_and_3d() {
    random_points_are_uncorrelated::<2>(0.02);
    random_points_are_uncorrelated::<3>(0.04);
}

/// On a square lattice the neighbours sit at 1, sqrt(2), 2 spacings and nowhere between.
#[test]
fn a_lattice_has_its_shells() {
    let region = snowball::<2>();
    let placement =
        place(&region, &Sampler::Lattice { angle: LATTICE_ANGLE }, None, 5_000, &Streams::new(3)).unwrap();
    let spacing = placement.spacing.unwrap();
    let density = 1.0 / (spacing * spacing);
    let width = 0.1 * spacing;
    let correlation = pair_correlation(&placement.positions, &region, density, 2.55 * spacing, 51).unwrap();
    // Bins of 0.05 spacings; shells at 20, 28.28, 40, 44.7 bins.
    for (bin, found) in correlation.iter().enumerate() {
        let on_shell = [19, 20, 28, 39, 40, 44, 45, 50].contains(&bin);
        assert!(on_shell || found.value == 0.0, "{found:?} in bin {bin}, width {width}");
    }
    let pairs = |bins: std::ops::Range<usize>| -> f64 {
        bins.map(|bin| {
            let inner = bin as f64 * 0.05 * spacing;
            let outer = inner + 0.05 * spacing;
            correlation[bin].value * density * std::f64::consts::PI * (outer * outer - inner * inner)
        })
        .sum()
    };
    assert!((pairs(19..21) - 4.0).abs() < 1e-9 && (pairs(28..29) - 4.0).abs() < 1e-9);
}

/// 1 for independent points, and for independent weights on them; next to nothing for a lattice between its peaks.
#[test]
fn the_spectrum_tells_noise_from_order() {
    let region = snowball::<2>();
    let waves: Vec<f64> = (0..16).map(|step| 300.0 + 40.0 * f64::from(step)).collect();
    let mean = |spectrum: Vec<f64>| spectrum.iter().sum::<f64>() / spectrum.len() as f64;
    let at = |sampler| place(&region, &sampler, None, 5_000, &Streams::new(4)).unwrap().positions;
    let random = at(Sampler::Random);
    let lattice = at(Sampler::Lattice { angle: LATTICE_ANGLE });
    let mut rng = Streams::new(4).stream(Purpose::Noise);
    let weights: Vec<f64> = random.iter().map(|_| unit_mean_gamma(&mut rng, 1.0)).collect();
    // 240 values that are each exponential of mean 1: a standard error of 0.065.
    assert!((mean(radial_spectrum(&random, None, &waves).unwrap()) - 1.0).abs() < 0.25);
    assert!((mean(radial_spectrum(&random, Some(&weights), &waves).unwrap()) - 1.0).abs() < 0.25);
    assert!(mean(radial_spectrum(&lattice, None, &waves).unwrap()) < 0.05);
    // Weights of spread 1 and mean 1 on a lattice: half the power of sum w^2 is variance.
    let noisy = mean(radial_spectrum(&lattice, Some(&weights), &waves).unwrap());
    assert!((noisy - 0.5).abs() < 0.15, "{noisy}");
}

/// With voids, only cells and supports that meet none are counted, so that random points keep their spread.
#[test]
fn voids_are_left_out_of_the_grid_measures() {
    let (region, h, streams) = (snowball::<2>(), 0.0072, Streams::new(5));
    let voids =
        draw_voids(&region, &VoidField::Inclusions(InclusionField::ellipses(h)), h, &streams).unwrap();
    let placement = place(&region, &Sampler::Random, Some(&voids), 30_000, &streams).unwrap();
    let holed = MeasuringGrid { voids: Some(&voids), ..grid(&region, h) };
    let spread = grid_density_spread(&placement.positions, None, &holed).unwrap();
    let expected = 30_000.0 / placement.filled_volume * h * h;
    assert!((spread.mean / expected - 1.0).abs() < 0.03, "{spread:?}, expected {expected}");
    assert!((spread.relative_spread * expected.sqrt() / 0.479 - 1.0).abs() < 0.12, "{spread:?}");
    let counts = particles_per_cell_spread(&placement.positions, &holed).unwrap();
    assert!((counts.mean / expected - 1.0).abs() < 0.03, "{counts:?}");
    let blind = grid_density_spread(&placement.positions, None, &grid(&region, h)).unwrap();
    assert!(blind.relative_spread > 2.0 * spread.relative_spread, "{blind:?}");
}

#[test]
fn measures_without_anything_to_measure_say_so() {
    let region = snowball::<2>();
    let one = [Vector::<f64, 2>::zeros()];
    assert!(matches!(nearest_neighbour_spacing(&one), Err(SamplerError::TooFewSamples { found: 1, .. })));
    assert!(matches!(nearest_neighbour_spacing::<2>(&[]), Err(SamplerError::TooFewSamples { found: 0, .. })));
    assert!(matches!(
        particles_per_cell_spread(&one, &grid(&region, 1.0)),
        Err(SamplerError::TooFewSamples { .. })
    ));
    assert!(matches!(
        particles_per_cell_spread(&one, &grid(&region, 1e-9)),
        Err(SamplerError::RasterTooFine { .. })
    ));
    assert!(matches!(
        particles_per_cell_spread(&one, &grid(&region, f64::NAN)),
        Err(SamplerError::OutOfRange { .. })
    ));
    assert!(matches!(
        grid_density_spread(&one, Some(&[]), &grid(&region, 0.01)),
        Err(SamplerError::CountOutOfRange { .. })
    ));
    assert!(matches!(pair_correlation(&one, &region, 1.0, 0.3, 10), Err(SamplerError::TooFewSamples { .. })));
    assert!(matches!(
        pair_correlation(&one, &region, 1.0, 0.1, 0),
        Err(SamplerError::CountOutOfRange { .. })
    ));
    assert!(matches!(radial_spectrum::<2>(&[], None, &[1.0]), Err(SamplerError::TooFewSamples { .. })));
    assert!(matches!(radial_spectrum(&one, None, &[f64::NAN]), Err(SamplerError::OutOfRange { .. })));
}
