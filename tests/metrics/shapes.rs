//! Shapes whose fragments are known, the derived numbers, and input that must be refused.

use crate::support::{SPACING, lattice};
use snowlab_solver::geometry::Vector;
use snowlab_study::metrics::{
    BondGraph, FloodRaster, FragmentAnalysis, LinkCurve, MetricError, equivalent_diameter, flood_fill,
    friends_of_friends, kernel_graph,
};

type Point = Vector<f64, 2>;

fn pieces(points: &[Point], link: f64) -> usize {
    friends_of_friends(points, &vec![1.0; points.len()], link).unwrap().components()
}

#[test]
fn discs_in_a_row_flip_to_one_piece_at_their_gap() {
    // Power-of-two pitch and gap: all distances are exact, so the flip is at the gap and not one bit away.
    let (pitch, gap) = (0.125, 0.375);
    let disc = lattice::<2>(pitch, 1.0, |point| point.norm() <= 1.0);
    for discs in [2, 5, 9] {
        let centres = (0..discs).map(|k| Point::new(f64::from(k) * (2.0 + gap), 0.0));
        let row: Vec<Point> =
            centres.flat_map(|centre| disc.iter().map(move |point| point + centre)).collect();
        let masses = vec![1.0; row.len()];
        assert_eq!(pieces(&row, gap), 1);
        assert_eq!(pieces(&row, gap.next_down()), discs as usize);
        assert_eq!(pieces(&row, pitch), discs as usize);

        let curve = LinkCurve::new(&row, &masses, [pitch, 1.0]).unwrap();
        let (from, to, components) = curve.plateau();
        assert_eq!((from, to, components), (pitch, gap, discs as usize));
        let apart = curve.at(0.3).unwrap();
        assert!((apart.log_effective_number - f64::from(discs).ln()).abs() < 1e-12);
        assert!((apart.largest_share - 1.0 / f64::from(discs)).abs() < 1e-12);
    }
}

#[test]
fn a_neck_holds_until_it_is_thinner_than_a_bond() {
    let dumbbell = |half_width: f64| {
        lattice::<2>(0.1, 3.0, |point| {
            (point.x.abs() - 2.0).hypot(point.y) < 0.95
                || (point.x.abs() < 2.0 && point.y.abs() <= half_width)
        })
    };
    assert_eq!(pieces(&dumbbell(0.0), 0.11), 1, "a neck one particle wide joins");
    assert_eq!(pieces(&dumbbell(-1.0), 0.11), 2, "without it there are two");
    // The gap between the discs: 2.2, from x = -1.1 to 1.1.
    assert_eq!(pieces(&dumbbell(-1.0), 2.19), 2);
    assert_eq!(pieces(&dumbbell(-1.0), 2.21), 1);
}

#[test]
fn a_ring_breaks_at_the_second_cut() {
    let ring = |cuts: &[f64]| {
        lattice::<2>(0.05, 1.0, |point| {
            let angle = point.y.atan2(point.x);
            (0.7..=1.0).contains(&point.norm()) && cuts.iter().all(|cut: &f64| (angle - cut).abs() > 0.2)
        })
    };
    assert_eq!(pieces(&ring(&[]), 0.06), 1);
    assert_eq!(pieces(&ring(&[0.5]), 0.06), 1);
    assert_eq!(pieces(&ring(&[0.5, -2.0]), 0.06), 2);
    assert_eq!(pieces(&ring(&[0.5, -2.0, 2.2]), 0.06), 3);
}

#[test]
fn a_slit_divides_only_where_it_goes_through() {
    let slit = |depth: f64| {
        lattice::<2>(0.05, 1.0, |point| {
            point.norm() <= 1.0 && !(point.x.abs() < 0.08 && point.y > 1.0 - depth)
        })
    };
    assert_eq!(pieces(&slit(1.0), 0.06), 1);
    assert_eq!(pieces(&slit(1.9), 0.06), 1);
    assert_eq!(pieces(&slit(2.1), 0.06), 2);
    assert_eq!(pieces(&slit(2.1), 0.21), 1, "the ruler spans the slit of 0.2");
}

#[test]
fn bonds_stay_cut_where_pieces_touch_again_but_friends_join() {
    let half = |sign: f64| lattice::<2>(0.3, 6.0, move |point| point.x * sign > 0.01);
    let reference: Vec<Point> = half(1.0).into_iter().chain(half(-1.0)).collect();
    let split = half(1.0).len();
    let masses = vec![1.0; reference.len()];
    let bonds = BondGraph::new(&reference, 1.0).unwrap();
    // The halves slide past each other by 9 h: they still touch, but no old bond is shorter than 3 h except
    // elsewhere.
    let slid: Vec<Point> = (0..reference.len())
        .map(|i| reference[i] + if i < split { Point::new(0.0, 9.0) } else { Point::zeros() })
        .collect();
    assert_eq!(friends_of_friends(&slid, &masses, 2.0).unwrap().components(), 1);
    assert_eq!(bonds.analyse(&slid, &masses).unwrap().fragments.components(), 2);
    assert_eq!(bonds.analyse(&reference, &masses).unwrap().fragments.components(), 1);
}

#[test]
fn the_flood_fill_joins_through_sides_and_counts_thin_cells_as_dust() {
    let raster = FloodRaster { side: 1.0, origin: Point::zeros(), rest_density: 4.0 };
    let fill = |points: &[Point]| flood_fill(points, &vec![1.0; points.len()], raster).unwrap();
    let cell = |x: f64, y: f64| [Point::new(x + 0.2, y + 0.5), Point::new(x + 0.7, y + 0.1)];
    assert_eq!(fill(&[cell(0.0, 0.0), cell(1.0, 0.0), cell(1.0, 1.0)].concat()).components(), 1);
    assert_eq!(fill(&[cell(0.0, 0.0), cell(1.0, 1.0)].concat()).components(), 2, "corners do not join");
    // A cell with mass 1 has density 0.25 rho0 exactly: not above the threshold.
    let thin = [&cell(0.0, 0.0)[..], &[Point::new(1.5, 0.5), Point::new(2.5, 0.5)]].concat();
    assert_eq!(fill(&thin).particle_counts(), [2, 1, 1]);
    let cloud = vec![Point::new(0.5, 0.5), Point::new(1.4, 0.5), Point::new(1.6, 0.5)];
    assert_eq!(fill(&cloud).labels(), [1, 0, 0], "the thin cell's particle is a component of its own");
}

#[test]
fn particles_share_a_node_up_to_the_reach_of_their_kernels() {
    let joined = |a: f64, b: f64| {
        let points = [Point::new(a, 0.3), Point::new(b, 0.3)];
        kernel_graph(&points, &[1.0; 2], 1.0, Point::zeros()).unwrap().components() == 1
    };
    assert!(joined(0.01, 3.99), "both reach node 2");
    assert!(!joined(0.0, 3.5), "from node 0 the support ends short of node 2");
    assert!(joined(0.0, 2.99));
    assert!(!joined(0.0, 4.0));
    assert!(joined(-0.5, 3.0) == joined(0.5, 4.0), "the graph moves with the grid");
    assert!(!joined(0.99, 4.01), "3.02 h apart, but no node within 2h of both");
}

#[test]
fn derived_numbers_follow_their_formulas() {
    // Fragments of 4, 2, 1, 1 kg.
    let fragments = FragmentAnalysis::of_partition(&[3, 0, 3, 2, 1], &[1.0, 1.0, 3.0, 2.0, 1.0]).unwrap();
    assert_eq!(fragments.labels(), [0, 2, 0, 1, 3]);
    assert_eq!(
        (fragments.masses(), fragments.particle_counts()),
        (&[4.0, 2.0, 1.0, 1.0][..], &[2, 1, 1, 1][..])
    );
    assert_eq!((fragments.count(2.0), fragments.count(2.1), fragments.count(0.0)), (2, 1, 4));
    assert_eq!(fragments.dust_share(2.0), 0.25);
    assert_eq!(fragments.largest_share(), 0.5);
    assert!((fragments.effective_number() - 64.0 / 22.0).abs() < 1e-14);
    assert!((fragments.log_effective_number() - (64.0_f64 / 22.0).ln()).abs() < 1e-14);
    assert_eq!(fragments.median_fragment_mass(), Some(4.0));
    let rest = FragmentAnalysis::of_partition(&[0, 1, 2], &[3.9, 2.0, 2.0]).unwrap();
    assert_eq!(rest.median_fragment_mass(), Some(2.0), "3.9 of 7.9 is less than half");

    let lost = fragments.relative_to(16.0).unwrap();
    assert_eq!((lost.largest_share(), lost.dust_share(2.0)), (0.25, 0.125));
    assert!((lost.effective_number() - 256.0 / 22.0).abs() < 1e-12);

    let disc = 400.0 * std::f64::consts::PI * 0.25;
    assert!((equivalent_diameter::<2>(disc, 400.0) - 1.0).abs() < 1e-14);
    let ball = 400.0 * std::f64::consts::PI / 6.0;
    assert!((equivalent_diameter::<3>(8.0 * ball, 400.0) - 2.0).abs() < 1e-14);
}

#[test]
fn equal_masses_are_ordered_by_their_first_particle() {
    let fragments = FragmentAnalysis::of_partition(&[4, 1, 4, 1, 0], &[1.0; 5]).unwrap();
    assert_eq!(fragments.labels(), [0, 1, 0, 1, 2]);
}

#[test]
fn no_particles_have_no_fragments() {
    let none = friends_of_friends::<3>(&[], &[], 1.0).unwrap();
    assert_eq!((none.components(), none.count(0.0), none.total_mass()), (0, 0, 0.0));
    assert_eq!((none.effective_number(), none.largest_share(), none.dust_share(1.0)), (0.0, 0.0, 0.0));
    assert_eq!(none.log_effective_number(), f64::NEG_INFINITY);
    assert_eq!(none.median_diameter::<3>(400.0), None);
    let bonds = BondGraph::<2>::new(&[], SPACING).unwrap();
    assert_eq!((bonds.bonds(), bonds.crack_measure(0)), (0, None));
}

#[test]
fn bad_input_is_refused_by_name_and_number() {
    let mut points = vec![Point::zeros(); 3];
    let masses = [1.0; 3];
    for link in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refusal = friends_of_friends(&points, &masses, link).unwrap_err();
        assert!(matches!(refusal, MetricError::Parameter { parameter: "link [m]", .. }), "{refusal}");
        assert!(kernel_graph(&points, &masses, link, Point::zeros()).is_err());
        assert!(BondGraph::new(&points, link).is_err());
        assert!(LinkCurve::new(&points, &masses, [link, 1.0]).is_err());
        let raster = FloodRaster { side: link, origin: Point::zeros(), rest_density: 1.0 };
        assert!(flood_fill(&points, &masses, raster).is_err());
    }
    let short = friends_of_friends(&points, &[1.0; 2], 1.0).unwrap_err();
    assert_eq!(short, MetricError::Length { quantity: "masses", expected: 3, actual: 2 });
    let weightless = friends_of_friends(&points, &[1.0, 0.0, 1.0], 1.0).unwrap_err();
    assert_eq!(weightless, MetricError::Mass { index: 1, value: 0.0 });
    assert!(LinkCurve::new(&points, &masses, [1.0, 0.5]).is_err());
    assert!(LinkCurve::new(&points, &masses, [0.5, 1.0]).unwrap().at(1.1).is_err());
    let bonds = BondGraph::new(&points, 1.0).unwrap();
    assert!(matches!(bonds.analyse(&points[..2], &masses[..2]), Err(MetricError::Length { .. })));
    for value in [f64::NAN, f64::INFINITY, -2e100] {
        points[2].y = value;
        let refusal = friends_of_friends(&points, &masses, 1.0).unwrap_err();
        assert!(matches!(refusal, MetricError::Position { index: 2, axis: 1, .. }), "{refusal}");
        assert!(refusal.to_string().contains("particle 2 on axis 1"), "{refusal}");
        assert!(bonds.analyse(&points, &masses).is_err());
    }
}
