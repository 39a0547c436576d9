//! Poisson-disk placements: the least distance, the pair correlation below it, and no part left empty.

use snowlab_sampler::quality::{nearest_neighbour_spacing, pair_correlation};
use snowlab_sampler::{InclusionField, Placement, Region, Sampler, Streams, VoidField, draw_voids, place};
use snowlab_solver::geometry::Vector;

use crate::support::{ball, snowball};

fn least_pair<const D: usize>(positions: &[Vector<f64, D>]) -> f64 {
    let mut least = f64::INFINITY;
    for (index, point) in positions.iter().enumerate() {
        for other in &positions[..index] {
            least = least.min((point - other).norm_squared());
        }
    }
    least.sqrt()
}

/// Checked over all pairs. The distance itself must be large: a set without order could keep none, and random
/// sequential addition, which fills less, ends at a packing (`n r^D` over the volume) of 0.696 in 2D and 0.73 in 3D.
fn keeps_its_distance<const D: usize>(count: usize, least_packing: f64, most_packing: f64) {
    for seed in 0..3 {
        let Placement { positions, filled_volume, spacing, .. } =
            place(&snowball::<D>(), &Sampler::PoissonDisk, None, count, &Streams::new(seed)).unwrap();
        let distance = spacing.unwrap();
        assert_eq!(positions.len(), count);
        assert!(least_pair(&positions) >= distance);
        let packing = count as f64 * distance.powi(D as i32) / filled_volume;
        assert!((least_packing..most_packing).contains(&packing), "packing {packing}");
    }
}

#[test]
fn points_keep_their_distance_in_2d() {
    keeps_its_distance::<2>(4_000, 0.59, 0.70);
}

#[test]
fn points_keep_their_distance_in_3d() {
    keeps_its_distance::<3>(4_000, 0.54, 0.73);
}

fn correlation_starts_at_the_distance<const D: usize>(count: usize) {
    let region = snowball::<D>();
    let placement = place(&region, &Sampler::PoissonDisk, None, count, &Streams::new(1)).unwrap();
    let distance = placement.spacing.unwrap();
    let density = count as f64 / placement.filled_volume;
    let correlation = pair_correlation(&placement.positions, &region, density, 4.0 * distance, 40).unwrap();
    // Bins are a tenth of the distance wide; the first ten lie below it.
    assert!(correlation[..10].iter().all(|bin| bin.value == 0.0), "{correlation:?}");
    let peak = correlation[10..13].iter().map(|bin| bin.value).fold(0.0, f64::max);
    assert!(peak > 1.5, "neighbours crowd just beyond the distance: {peak}");
    let far = correlation[30..].iter().map(|bin| bin.value).sum::<f64>() / 10.0;
    assert!((far - 1.0).abs() < 0.05, "no order far away: {far}");
}

#[test]
fn correlation_starts_at_the_distance_in_2d() {
    correlation_starts_at_the_distance::<2>(10_000);
}

#[test]
fn correlation_starts_at_the_distance_in_3d() {
    correlation_starts_at_the_distance::<3>(20_000);
}

/// A fill grown from one seed would never cross a gap wider than twice the distance.
#[test]
fn bodies_apart_are_filled_alike() {
    let region = Region::Union(vec![ball::<2>(-1.0, 0.2), ball::<2>(1.0, 0.2)]);
    let placement = place(&region, &Sampler::PoissonDisk, None, 2_000, &Streams::new(1)).unwrap();
    let left = placement.positions.iter().filter(|point| point[0] < 0.0).count();
    assert!((960..1_040).contains(&left), "{left} of 2000 in the left half");
}

/// Voids spared, no part of the solid is left empty: no point of it is farther than two distances from a particle.
#[test]
fn the_solid_between_voids_is_filled() {
    let (region, h, streams) = (snowball::<2>(), 0.0072, Streams::new(1));
    let field = VoidField::Inclusions(InclusionField::ellipses(h));
    let voids = draw_voids(&region, &field, h, &streams).unwrap();
    let placement = place(&region, &Sampler::PoissonDisk, Some(&voids), 5_000, &streams).unwrap();
    let distance = placement.spacing.unwrap();
    let probes = place(&region, &Sampler::Random, Some(&voids), 2_000, &Streams::new(2)).unwrap();
    let widest = probes
        .positions
        .iter()
        .map(|probe| {
            placement.positions.iter().map(|point| (point - probe).norm()).fold(f64::INFINITY, f64::min)
        })
        .fold(0.0, f64::max);
    assert!(widest < 2.0 * distance, "a gap of {widest}, distance {distance}");
    let nearest = nearest_neighbour_spacing(&placement.positions).unwrap();
    assert!(nearest.least >= distance && nearest.relative_spread < 0.15, "{nearest:?}");
}
