//! Lattices and jittered lattices: spacing, angle, one point a cell, how even they are.

use snowlab_sampler::quality::{MeasuringGrid, nearest_neighbour_spacing, particles_per_cell_spread};
use snowlab_sampler::{LATTICE_ANGLE, Sampler, Streams, lattice_rotation, place};
use snowlab_solver::geometry::Vector;

use crate::support::snowball;

fn sites_are_on_a_turned_lattice<const D: usize>(count: usize, angle: f64) {
    let placement =
        place(&snowball::<D>(), &Sampler::Lattice { angle }, None, count, &Streams::new(1)).unwrap();
    let spacing = placement.spacing.unwrap();
    // The count of sites in a ball scatters by less than its surface: here under 1 %.
    let mean = (placement.filled_volume / count as f64).powf(1.0 / D as f64);
    assert!((spacing / mean - 1.0).abs() < 0.01, "spacing {spacing}, mean {mean}");
    let nearest = nearest_neighbour_spacing(&placement.positions).unwrap();
    assert!((nearest.least / spacing - 1.0).abs() < 1e-9 && (nearest.greatest / spacing - 1.0).abs() < 1e-9);
    // In the frame of the lattice all offsets are whole.
    let frame = lattice_rotation::<D>(angle).transpose();
    for point in &placement.positions {
        let steps = frame * (point - placement.positions[0]) / spacing;
        assert!(steps.iter().all(|step| (step - step.round()).abs() < 1e-8), "{steps}");
    }
}

#[test]
fn sites_are_on_a_turned_lattice_in_2d() {
    for angle in [0.0, LATTICE_ANGLE, -1.2, 7.0] {
        sites_are_on_a_turned_lattice::<2>(5_000, angle);
    }
}

#[test]
fn sites_are_on_a_turned_lattice_in_3d() {
    sites_are_on_a_turned_lattice::<3>(20_000, LATTICE_ANGLE);
}

/// The angle is a rotation of the first two axes: at 27 degrees a neighbour lies at (cos 27, sin 27) spacings.
#[test]
fn the_angle_is_measured_from_the_first_axis() {
    let placement =
        place(&snowball::<2>(), &Sampler::Lattice { angle: LATTICE_ANGLE }, None, 2_000, &Streams::new(1))
            .unwrap();
    let step = Vector::<f64, 2>::new(LATTICE_ANGLE.cos(), LATTICE_ANGLE.sin()) * placement.spacing.unwrap();
    let inner = placement.positions.iter().find(|point| point.norm() < 0.1).unwrap();
    assert!(placement.positions.iter().any(|point| (point - inner - step).norm() < 1e-9));
}

/// Over seeds the origin is uniform in a cell: its mean offset is half a cell and its variance a twelfth.
#[test]
fn the_origin_is_uniform_in_a_cell() {
    let phases: Vec<f64> = (0..400)
        .map(|seed| {
            let lattice =
                place(&snowball::<2>(), &Sampler::Lattice { angle: 0.0 }, None, 300, &Streams::new(seed))
                    .unwrap();
            (lattice.positions[0][0] / lattice.spacing.unwrap()).rem_euclid(1.0)
        })
        .collect();
    let mean = phases.iter().sum::<f64>() / 400.0;
    let variance = phases.iter().map(|phase| (phase - mean).powi(2)).sum::<f64>() / 400.0;
    assert!((mean - 0.5).abs() < 0.06, "mean {mean}");
    assert!((variance - 1.0 / 12.0).abs() < 0.02, "variance {variance}");
}

/// The outermost sites make up the count: all sites of the lattice that lie deeper than the shallowest one kept are kept.
#[test]
fn no_inner_site_is_missing() {
    let placement =
        place(&snowball::<2>(), &Sampler::Lattice { angle: LATTICE_ANGLE }, None, 3_000, &Streams::new(2))
            .unwrap();
    let spacing = placement.spacing.unwrap();
    let frame = lattice_rotation::<2>(LATTICE_ANGLE);
    let outermost = placement.positions.iter().map(|point| point.norm()).fold(0.0, f64::max);
    let mut sites = 0;
    for i in -200..200 {
        for j in -200..200 {
            let site =
                placement.positions[0] + frame * Vector::<f64, 2>::new(f64::from(i), f64::from(j)) * spacing;
            sites += usize::from(site.norm() <= outermost * (1.0 + 1e-9));
        }
    }
    assert_eq!(sites, 3_000);
}

fn one_jittered_point_a_cell<const D: usize>(count: usize) {
    let placement =
        place(&snowball::<D>(), &Sampler::Jittered { angle: LATTICE_ANGLE }, None, count, &Streams::new(1))
            .unwrap();
    let spacing = placement.spacing.unwrap();
    // Points in the frame of the lattice, whose origin is the first number of the stream on every axis.
    let local: Vec<Vector<f64, D>> = placement
        .positions
        .iter()
        .map(|point| lattice_rotation::<D>(LATTICE_ANGLE).transpose() * point / spacing)
        .collect();
    // Points are uniform over the axis modulo one, wherever the origin lies.
    for axis in 0..D {
        let low = local.iter().filter(|point| point[axis].rem_euclid(1.0) < 0.5).count() as f64;
        let expected = 0.5 * count as f64;
        assert!((low - expected).abs() < 4.0 * (0.25 * count as f64).sqrt(), "axis {axis}: {low} of {count}");
    }
    let nearest = nearest_neighbour_spacing(&placement.positions).unwrap();
    assert!(nearest.least < 0.2 * spacing, "jitter spans whole cells, so some points come close");
    let origin = snowlab_sampler::rng::uniform_vector::<D>(
        &mut Streams::new(1).stream(snowlab_sampler::Purpose::Placement),
    );
    let mut cells: Vec<Vec<i64>> = local
        .iter()
        .map(|point| (point - origin).iter().map(|coordinate| coordinate.floor() as i64).collect())
        .collect();
    cells.sort();
    cells.dedup();
    assert_eq!(cells.len(), count, "two points share a cell of the lattice");
}

#[test]
fn one_jittered_point_a_cell_in_2d() {
    one_jittered_point_a_cell::<2>(5_000);
}

#[test]
fn one_jittered_point_a_cell_in_3d() {
    one_jittered_point_a_cell::<3>(10_000);
}

/// Counts per cell: Poisson for random points, so 1/sqrt(PPC); jittered points err only along the edges of cells.
#[test]
fn jittered_points_are_more_even_than_random_ones_and_lattices_most() {
    let region = snowball::<2>();
    let grid = MeasuringGrid {
        h: 0.0072,
        origin: Vector::<f64, 2>::new(0.001, 0.002),
        region: &region,
        voids: None,
    };
    let spread = |sampler: Sampler| {
        let placement = place(&region, &sampler, None, 30_000, &Streams::new(3)).unwrap();
        particles_per_cell_spread(&placement.positions, &grid).unwrap()
    };
    let random = spread(Sampler::Random);
    let jittered = spread(Sampler::Jittered { angle: LATTICE_ANGLE });
    let lattice = spread(Sampler::Lattice { angle: LATTICE_ANGLE });
    let poisson = 1.0 / random.mean.sqrt();
    // About 3500 cells: the standard error of a standard deviation is 1.2 %.
    assert!((random.relative_spread / poisson - 1.0).abs() < 0.05, "{random:?}, Poisson {poisson}");
    assert!(jittered.relative_spread < 0.7 * random.relative_spread, "{jittered:?}");
    assert!(lattice.relative_spread < 0.7 * jittered.relative_spread, "{lattice:?}");
}
