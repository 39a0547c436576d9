//! Every metric against its definition over all pairs, and what must not change the answer.

use crate::support::{BEYOND_THE_RASTER, masses, permutation, placements, rotated, shifted};
use snowlab_solver::geometry::Vector;
use snowlab_study::metrics::oracle;
use snowlab_study::metrics::{
    BondGraph, FloodRaster, FragmentAnalysis, LinkCurve, flood_fill, friends_of_friends, kernel_graph,
};

/// Links round the spacing, with ties at 1 and sqrt(2) lattice pitches.
const FACTORS: [f64; 7] = [0.3, 0.7, 1.0, std::f64::consts::SQRT_2, 1.6, 2.5, 6.0];

fn all_metrics_equal_their_oracles<const D: usize>() {
    for (name, points, length) in placements::<D>() {
        let masses = masses(points.len(), 5);
        for factor in FACTORS {
            let link = factor * length;
            let case = format!("{name}, D = {D}, link {link}");
            let fast = friends_of_friends(&points, &masses, link).unwrap();
            assert_eq!(fast, oracle::friends_of_friends(&points, &masses, link).unwrap(), "friends: {case}");

            let origins = [Vector::zeros(), Vector::from_element(0.37 * length)];
            for origin in origins.into_iter().filter(|_| name != BEYOND_THE_RASTER) {
                let fast = kernel_graph(&points, &masses, 0.4 * link, origin).unwrap();
                let slow = oracle::kernel_graph(&points, &masses, 0.4 * link, origin).unwrap();
                assert_eq!(fast, slow, "kernel graph: {case}");
                let raster = FloodRaster { side: link, origin, rest_density: 3.0 / link.powi(D as i32) };
                let fast = flood_fill(&points, &masses, raster).unwrap();
                assert_eq!(fast, oracle::flood_fill(&points, &masses, raster).unwrap(), "flood fill: {case}");
            }

            let spacing = 0.5 * link;
            let torn: Vec<_> =
                points.iter().map(|point| point.map(|x| x * 1.3 + 0.2 * length * (7.0 * x).sin())).collect();
            let bonds = BondGraph::new(&points, spacing).unwrap().analyse(&torn, &masses).unwrap();
            let (fragments, cut) = oracle::bond_graph(&points, &torn, &masses, spacing).unwrap();
            assert_eq!((bonds.fragments, bonds.cut_bonds), (fragments, cut), "bonds: {case}");
        }
    }
}

#[test]
fn all_metrics_equal_their_oracles_in_2d() {
    all_metrics_equal_their_oracles::<2>();
}

#[test]
fn all_metrics_equal_their_oracles_in_3d() {
    all_metrics_equal_their_oracles::<3>();
}

/// The curve must be friends-of-friends at every link and N minus the edges of the spanning tree.
fn the_link_curve_is_friends_of_friends_at_every_link<const D: usize>() {
    for (name, points, length) in placements::<D>() {
        let masses = masses(points.len(), 6);
        let tree = oracle::spanning_tree(&points);
        let curve = LinkCurve::new(&points, &masses, [0.3 * length, 6.0 * length]).unwrap();
        let links = (0..=60).map(|k| length * 0.3 * 20_f64.powf(f64::from(k) / 60.0).min(20.0));
        for link in links.chain(FACTORS.map(|factor| factor * length)) {
            let state = curve.at(link.clamp(0.3 * length, 6.0 * length)).unwrap();
            let fragments = friends_of_friends(&points, &masses, link).unwrap();
            let edges = tree.partition_point(|&squared| squared <= link * link);
            assert_eq!(state.components, fragments.components(), "{name}, D = {D}, link {link}");
            assert_eq!(state.components, points.len() - edges, "{name}, D = {D}, link {link}");
            assert!((state.largest_share - fragments.largest_share()).abs() < 1e-12);
            if !points.is_empty() {
                assert!((state.log_effective_number - fragments.log_effective_number()).abs() < 1e-10);
            }
        }
        let states: Vec<_> = curve.steps().collect();
        for pair in states.windows(2) {
            assert!(pair[0].0 < pair[1].0 && pair[0].1.components > pair[1].1.components, "{name}");
            assert!(pair[0].1.largest_share <= pair[1].1.largest_share, "{name}");
            assert!(pair[0].1.log_effective_number > pair[1].1.log_effective_number, "{name}");
        }
    }
}

#[test]
fn the_link_curve_is_friends_of_friends_at_every_link_in_2d() {
    the_link_curve_is_friends_of_friends_at_every_link::<2>();
}

#[test]
fn the_link_curve_is_friends_of_friends_at_every_link_in_3d() {
    the_link_curve_is_friends_of_friends_at_every_link::<3>();
}

/// Equal up to which particle carries which label.
fn same_numbers(a: &FragmentAnalysis, b: &FragmentAnalysis) -> bool {
    let sorted = |fragments: &FragmentAnalysis| {
        let mut counts = fragments.particle_counts().to_vec();
        counts.sort_unstable();
        counts
    };
    a.masses() == b.masses() && sorted(a) == sorted(b) && a.total_mass() == b.total_mass()
}

fn neither_order_nor_frame_matters<const D: usize>() {
    for (name, points, length) in placements::<D>() {
        let masses = masses(points.len(), 7);
        let link = 0.9973 * length;
        let before = friends_of_friends(&points, &masses, link).unwrap();

        let order = permutation(points.len(), 8);
        let moved: Vec<_> = order.iter().map(|&i| points[i]).collect();
        let moved_masses: Vec<_> = order.iter().map(|&i| masses[i]).collect();
        let after = friends_of_friends(&moved, &moved_masses, link).unwrap();
        assert!(same_numbers(&before, &after), "permuted {name}");
        assert_eq!(before.log_effective_number().to_bits(), after.log_effective_number().to_bits(), "{name}");
        for (place, &index) in order.iter().enumerate() {
            assert_eq!(after.labels()[place], before.labels()[index], "permuted {name}");
        }

        let raster =
            FloodRaster { side: link, origin: Vector::zeros(), rest_density: 4.0 / link.powi(D as i32) };
        let filled = flood_fill(&points, &masses, raster).unwrap();
        let refilled = flood_fill(&moved, &moved_masses, raster).unwrap();
        assert!(same_numbers(&filled, &refilled), "permuted flood fill of {name}");

        if !name.contains("debris") {
            let turned = friends_of_friends(&rotated(&points, 0.7), &masses, link).unwrap();
            assert_eq!(before, turned, "rotated {name}");
            let shifted = friends_of_friends(&shifted(&points, 1234.5), &masses, link).unwrap();
            assert_eq!(before, shifted, "shifted {name}");
        }
    }
}

#[test]
fn neither_order_nor_frame_matters_in_2d() {
    neither_order_nor_frame_matters::<2>();
}

#[test]
fn neither_order_nor_frame_matters_in_3d() {
    neither_order_nor_frame_matters::<3>();
}

#[test]
fn masses_add_up_and_fewer_fragments_remain_as_the_link_grows() {
    for (name, points, length) in placements::<2>() {
        let masses = masses(points.len(), 9);
        let total: f64 = masses.iter().sum();
        let mut before = usize::MAX;
        for step in 1..40 {
            let fragments = friends_of_friends(&points, &masses, 0.1 * f64::from(step) * length).unwrap();
            assert!((fragments.masses().iter().sum::<f64>() - total).abs() <= 1e-12 * total, "{name}");
            assert_eq!(fragments.particle_counts().iter().sum::<usize>(), points.len(), "{name}");
            assert!(fragments.masses().is_sorted_by(|a, b| a >= b), "{name}");
            assert!(fragments.components() <= before, "{name} at step {step}");
            before = fragments.components();
        }
    }
}
