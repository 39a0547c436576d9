//! Crack lengths of straight cuts, and the interior they are scaled by.

use crate::support::{RADIUS, SPACING, ball, lattice, rotated};
use snowlab_solver::geometry::Vector;
use snowlab_study::metrics::BondGraph;
use snowlab_study::metrics::interior::interior;
use std::f64::consts::PI;

/// Moves what lies above `height` on the second axis up by a tenth of a metre.
fn cut_at<const D: usize>(points: &[Vector<f64, D>], height: f64) -> Vec<Vector<f64, D>> {
    let lift = |point: &Vector<f64, D>| {
        let mut lifted = *point;
        if point[1] > height {
            lifted[1] += 0.1;
        }
        lifted
    };
    points.iter().map(lift).collect()
}

/// The measured over the true measure of the crack, averaged over cuts at several heights and angles. The
/// truth is less by what the missing bonds at a free surface take: 3/16 of a bond at each end, 8/(15 pi) of
/// one along the rim in 3D.
fn mean_ratio<const D: usize>(points: &[Vector<f64, D>], spacing: f64, angles: &[f64]) -> f64 {
    let heights = [-0.1, -0.03, 0.04, 0.11];
    let masses = vec![1.0; points.len()];
    let mut ratios = Vec::new();
    for &angle in angles {
        let turned = rotated(points, angle);
        let bonds = BondGraph::new(&turned, spacing).unwrap();
        for height in heights {
            let chord = (RADIUS * RADIUS - height * height).sqrt();
            let bond = bonds.bond_length();
            let truth = match D {
                2 => 2.0 * (chord - 3.0 / 16.0 * bond),
                _ => PI * chord * (chord - 2.0 * 8.0 / (15.0 * PI) * bond),
            };
            let analysis = bonds.analyse(&cut_at(&turned, height), &masses).unwrap();
            assert_eq!(analysis.fragments.count(0.01 * points.len() as f64), 2);
            ratios.push(analysis.crack_measure.unwrap() / truth);
        }
    }
    ratios.iter().sum::<f64>() / ratios.len() as f64
}

#[test]
fn the_length_of_straight_cuts_is_free_of_ppc() {
    // One cut of a random disc scatters by 5 % at 30k (it counts pairs in a strip of 2,000 particles), 8 % at
    // 5k.
    let angles: Vec<f64> = (0..4).map(|k| 0.7 * f64::from(k)).collect();
    for (count, tolerance) in [(5_000, 0.05), (30_000, 0.03)] {
        let ratios: Vec<f64> =
            (0..3).map(|seed| mean_ratio(&ball::<2>(count, RADIUS, 40 + seed), SPACING, &angles)).collect();
        let mean = ratios.iter().sum::<f64>() / 3.0;
        assert!((mean - 1.0).abs() < tolerance, "{count} random particles: {ratios:?}");
    }
    // A lattice reads 3 % long: 96 sites lie within a bond where the area says 99, and the density enters
    // squared.
    let pitch = SPACING / 7.9_f64.sqrt();
    let regular = lattice::<2>(pitch, 1.1 * RADIUS, |point| point.norm() <= RADIUS);
    let ratio = mean_ratio(&regular, SPACING, &[27_f64.to_radians(), 0.9, 1.3]);
    assert!((ratio - 1.03).abs() < 0.015, "lattice: {ratio}");
}

#[test]
fn the_area_of_straight_cuts_in_3d() {
    // h such that PPC is 3.
    let count = 30_000;
    let spacing = (3.0 * 4.0 / 3.0 * PI * RADIUS.powi(3) / count as f64).cbrt();
    let ratio = mean_ratio(&ball::<3>(count, RADIUS, 50), spacing, &[0.0, 0.8]);
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
}

#[test]
fn an_undamaged_or_gently_strained_body_has_no_crack() {
    let points = ball::<2>(5_000, RADIUS, 60);
    let masses = vec![1.0; points.len()];
    let bonds = BondGraph::new(&points, SPACING).unwrap();
    for strain in [1.0, 1.4] {
        let strained: Vec<_> = points.iter().map(|point| point * strain).collect();
        let analysis = bonds.analyse(&strained, &masses).unwrap();
        assert_eq!((analysis.cut_bonds, analysis.crack_measure), (0, Some(0.0)));
    }
    let torn: Vec<_> = points.iter().map(|point| point * 1000.0).collect();
    let analysis = bonds.analyse(&torn, &masses).unwrap();
    assert_eq!(analysis.cut_bonds, bonds.bonds());
    assert_eq!(analysis.fragments.components(), points.len());
}

#[test]
fn the_number_density_is_that_of_the_interior() {
    for (count, tolerance) in [(5_000, 0.03), (30_000, 0.015)] {
        let bonds = BondGraph::new(&ball::<2>(count, RADIUS, 61), SPACING).unwrap();
        let truth = count as f64 / (PI * RADIUS * RADIUS);
        let ratio = bonds.number_density().unwrap() / truth;
        assert!((ratio - 1.0).abs() < tolerance, "{count}: {ratio}");
        // The whole body's mean degree is some 5 % lower: the edge would bias the density.
        let whole = 2.0 * bonds.bonds() as f64 / count as f64 / (PI * bonds.bond_length().powi(2)) / truth;
        assert!(whole < 0.98 * ratio, "{count}: {whole} with the edge, {ratio} without");
    }
}

/// No marked particle is nearer to the edge of a disc with a void than the depth, and nearly all that are
/// deep by a wide margin are marked.
#[test]
fn the_interior_keeps_clear_of_the_rim_and_of_voids() {
    let depth = 2.0 * SPACING;
    let (centre, hole) = (Vector::from([0.05, -0.03]), 3.0 * SPACING);
    for count in [5_000, 30_000] {
        let solid = ball::<2>(count, RADIUS, 62);
        let points: Vec<_> = solid.into_iter().filter(|point| (point - centre).norm() > hole).collect();
        let inside = interior(&points, depth).unwrap();
        let edge = |point: &Vector<f64, 2>| (RADIUS - point.norm()).min((point - centre).norm() - hole);
        let too_near =
            points.iter().zip(&inside).filter(|(point, inside)| **inside && edge(point) < depth).count();
        assert_eq!(too_near, 0, "{count}");
        let deep = points.iter().zip(&inside).filter(|(point, _)| edge(point) > 1.8 * depth);
        let (all, marked) =
            deep.fold((0, 0), |(all, marked), (_, inside)| (all + 1, marked + i32::from(*inside)));
        assert!(
            f64::from(marked) > 0.98 * f64::from(all),
            "{count}: {marked} of {all} deep particles are marked"
        );
    }
    let thin = lattice::<2>(0.3, 40.0, |point| point.y.abs() < 1.0);
    assert!(
        interior(&thin, 2.0).unwrap().iter().all(|inside| !inside),
        "a strip one bond wide has no interior"
    );
    let bonds = BondGraph::new(&thin, 1.0).unwrap();
    assert_eq!((bonds.interior_degree().particles, bonds.crack_measure(5)), (0, None));
}
