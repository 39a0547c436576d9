//! Gate, equal counts, spread and sizes.

use crate::support::{RADIUS, SPACING, ball, masses, permutation};
use snowlab_solver::geometry::Vector;
use snowlab_study::metrics::gate::DUST_CUT;
use snowlab_study::metrics::sizes::distribution_at;
use snowlab_study::metrics::spread::LOOSENED;
use snowlab_study::metrics::thinning::thinned;
use snowlab_study::metrics::{
    FragmentAnalysis, Gate, GateVerdict, Ordinate, Spread, Thinning, distribution_band, friends_of_friends,
    mass_grid, mass_shares_above, mean_over_subsets,
};

#[test]
fn the_gate_passes_what_was_built_and_nothing_else() {
    let points = ball::<2>(5_000, RADIUS, 1);
    let masses = vec![0.01; points.len()];
    let cut = DUST_CUT * 50.0;
    let judge =
        |link: f64, bodies| Gate::judge(&friends_of_friends(&points, &masses, link).unwrap(), cut, bodies);

    let sound = judge(2.0 * SPACING, 1);
    assert!(sound.is_valid());
    assert_eq!((sound.bodies_seen, sound.dust_share), (1, 0.0));
    assert_eq!(judge(2.0 * SPACING, 2).verdict, GateVerdict::WrongNumberOfBodies);
    let short = judge(SPACING, 1);
    assert!(!short.is_valid() && short.bodies_seen > 1, "{short}");
    assert!(short.to_string().starts_with("metric-invalid"), "{short}");

    // One body and dust at the limit and above it: 5 and 6 particles of 1000.
    for (dust, verdict) in [(5, GateVerdict::Valid), (6, GateVerdict::TooMuchDust)] {
        let components: Vec<u32> = (0..1000).map(|i| if i < dust { i } else { 999 }).collect();
        let fragments = FragmentAnalysis::of_partition(&components, &[1.0; 1000]).unwrap();
        assert_eq!(Gate::judge(&fragments, 2.0, 1).verdict, verdict, "{dust} grains of dust");
    }
}

#[test]
fn a_prefix_goes_by_id_whatever_the_order_in_memory() {
    let points = ball::<2>(500, RADIUS, 2);
    let weights = masses(500, 3);
    let order = permutation(500, 4);
    let subsets = Thinning::Prefix.subsets(&order, 100).unwrap();
    assert_eq!(subsets.len(), 1);
    let mut ids: Vec<usize> = subsets[0].iter().map(|&place| order[place]).collect();
    ids.sort_unstable();
    assert_eq!(ids, (0..100).collect::<Vec<_>>());

    let (kept, rescaled) = thinned(&points, &weights, &subsets[0]).unwrap();
    assert_eq!(kept[7], points[subsets[0][7]]);
    let total: f64 = weights.iter().sum();
    assert!((rescaled.iter().sum::<f64>() / total - 1.0).abs() < 1e-12, "masses are rescaled to the whole");
    assert!((rescaled[3] / rescaled[9] - weights[subsets[0][3]] / weights[subsets[0][9]]).abs() < 1e-12);
}

#[test]
fn sixteen_random_subsets_are_even_and_named_by_their_seed() {
    let ids: Vec<usize> = (0..200).collect();
    let subsets = Thinning::RandomSubsets { seed: 9 }.subsets(&ids, 50).unwrap();
    assert_eq!(subsets.len(), 16);
    let mut drawn = [0; 4];
    for subset in &subsets {
        assert!(subset.len() == 50 && subset.is_sorted_by(|a, b| a < b) && subset[49] < 200);
        subset.iter().for_each(|&index| drawn[index / 50] += 1);
    }
    // 800 draws, 200 expected in each quarter with a standard deviation of 11.
    assert!(drawn.iter().all(|&n| (150..250).contains(&n)), "{drawn:?}");
    assert_ne!(subsets[0], subsets[1]);
    assert_eq!(subsets, Thinning::RandomSubsets { seed: 9 }.subsets(&ids, 50).unwrap());
    assert_ne!(subsets, Thinning::RandomSubsets { seed: 10 }.subsets(&ids, 50).unwrap());
    // Shuffled memory: the same particles.
    let order = permutation(200, 5);
    let shuffled = Thinning::RandomSubsets { seed: 9 }.subsets(&order, 50).unwrap();
    let mut first: Vec<usize> = shuffled[0].iter().map(|&place| order[place]).collect();
    first.sort_unstable();
    assert_eq!(first, subsets[0]);

    let all = Thinning::RandomSubsets { seed: 9 }.subsets(&ids, 200).unwrap();
    assert_eq!(all, vec![ids.clone()], "nothing to thin");
    assert!(Thinning::Prefix.subsets(&ids, 201).is_err());
    assert!(Thinning::Prefix.subsets(&ids, 0).is_err());
}

#[test]
fn the_mean_over_subsets_is_the_mean() {
    let points = ball::<2>(300, RADIUS, 6);
    let weights = masses(300, 7);
    let ids: Vec<u32> = (0..300).collect();
    let thinning = Thinning::RandomSubsets { seed: 1 };
    let endpoint = |points: &[Vector<f64, 2>], weights: &[f64]| {
        Ok(friends_of_friends(points, weights, 0.03)?.log_effective_number())
    };
    let mean = mean_over_subsets(thinning, 100, &ids, &points, &weights, endpoint).unwrap();
    let by_hand: Vec<f64> = thinning
        .subsets(&ids, 100)
        .unwrap()
        .iter()
        .map(|subset| {
            let (points, weights) = thinned(&points, &weights, subset).unwrap();
            endpoint(&points, &weights).unwrap()
        })
        .collect();
    assert!((mean - by_hand.iter().sum::<f64>() / 16.0).abs() < 1e-14);
    assert!(by_hand.iter().any(|&value| value != mean), "the subsets differ");
    assert!(mean_over_subsets(thinning, 100, &ids[1..], &points, &weights, endpoint).is_err());
}

#[test]
fn a_disc_spreads_as_geometry_says() {
    // 5 % of a disc lies beyond x = -0.8054 R: (theta - sin theta cos theta)/pi = 0.05 at theta = 0.6343.
    let points = ball::<2>(40_000, 1.0, 8);
    let weights = vec![1.0; points.len()];
    let spread = Spread::new(&points, &weights, 1, Vector::from([0.5, -1.0])).unwrap();
    for extent in spread.extents {
        assert!((extent.bulk_width() - 2.0 * 0.8054).abs() < 0.02, "{extent:?}");
        assert!(extent.full_width() > 1.98 && extent.full_width() <= 2.0, "{extent:?}");
    }
    assert_eq!(spread.height(), spread.extents[1]);
    assert!((spread.log_extent() - spread.extents[0].bulk_width().ln()).abs() < 1e-14);
    // Farther than d to the left of x = 0.5 lies 5 % where d = 0.5 + 0.8054; nothing that far to the right.
    assert!(
        (spread.run_out[0] - 1.3054).abs() < 0.02 && (spread.run_out[1] - 1.5).abs() < 0.01,
        "{spread:?}"
    );
}

#[test]
fn mass_not_number_sets_the_quantiles() {
    let line: Vec<Vector<f64, 3>> =
        (0..10).map(|k| Vector::from([f64::from(k), 0.0, 2.0 * f64::from(k)])).collect();
    let mut weights = vec![1e-6; 10];
    weights[3] = 1.0;
    let spread = Spread::new(&line, &weights, 1, Vector::zeros()).unwrap();
    assert_eq!((spread.extents[0].bulk, spread.extents[0].full), ([3.0, 3.0], [0.0, 9.0]));
    assert_eq!(spread.run_out, [45_f64.sqrt(), 405_f64.sqrt()]);
    weights = vec![1.0; 10];
    let even = Spread::new(&line, &weights, 1, Vector::zeros()).unwrap();
    assert_eq!(even.extents[2].bulk, [0.0, 18.0]);
    assert!(
        (even.log_extent() - 0.5 * (9_f64.ln() + 18_f64.ln())).abs() < 1e-14,
        "the mean of both horizontal axes"
    );
    assert!(Spread::<3>::new(&[], &[], 1, Vector::zeros()).is_err());
    assert!(Spread::new(&line, &weights, 3, Vector::zeros()).is_err());
}

#[test]
fn loosened_mass_is_counted_strictly_above() {
    let shares =
        mass_shares_above(&[1.0, 1.05, 1.2, 1.4, 2.5], &[1.0, 1.0, 1.0, 1.0, 4.0], LOOSENED).unwrap();
    assert_eq!(shares, [0.75, 0.625, 0.5]);
    assert_eq!(mass_shares_above(&[], &[], LOOSENED).unwrap(), [0.0; 3]);
    assert!(mass_shares_above(&[1.0, f64::NAN], &[1.0; 2], LOOSENED).is_err());
    assert!(mass_shares_above(&[1.0], &[1.0; 2], LOOSENED).is_err());
}

#[test]
fn size_distributions_and_their_band() {
    let case = [8.0, 1.0, 4.0, 1.0];
    let descending = [8.0, 4.0, 1.0, 1.0];
    for (mass, number, mass_share) in
        [(0.5, 4.0, 1.0), (1.0, 4.0, 1.0), (1.1, 2.0, 12.0 / 14.0), (8.1, 0.0, 0.0)]
    {
        assert_eq!(distribution_at(&descending, mass, Ordinate::Number), number);
        assert_eq!(distribution_at(&descending, mass, Ordinate::Share), number / 4.0);
        assert_eq!(distribution_at(&descending, mass, Ordinate::MassShare), mass_share);
    }
    assert_eq!(distribution_at(&[], 1.0, Ordinate::Share), 0.0);

    // Five cases with 1 to 5 fragments of 1 kg: at 1 kg the counts are 1..5.
    let cases: Vec<Vec<f64>> = (1..=5).map(|n| vec![1.0; n]).collect();
    let band = distribution_band(&cases, &[1.0, 2.0], Ordinate::Number, 0.5).unwrap();
    assert_eq!((band[0].mean, band[0].quantiles), (3.0, [2.0, 3.0, 4.0]));
    assert_eq!((band[1].mean, band[1].quantiles), (0.0, [0.0; 3]));
    let unsorted = distribution_band(&[case.to_vec()], &[4.0], Ordinate::Number, 0.9).unwrap();
    assert_eq!(unsorted[0].quantiles, [2.0; 3], "input in any order");

    let grid = mass_grid(&[case.to_vec(), vec![64.0]], 4);
    assert!(grid.iter().zip([1.0, 4.0, 16.0, 64.0]).all(|(a, b)| (a / b - 1.0).abs() < 1e-14), "{grid:?}");
    assert_eq!(grid[3], 64.0);
    assert_eq!((mass_grid(&[vec![2.0; 3]], 10), mass_grid(&[], 10)), (vec![2.0], vec![]));
    assert!(distribution_band(&[], &[1.0], Ordinate::Share, 0.9).is_err());
    assert!(distribution_band(&cases, &[1.0], Ordinate::Share, 1.1).is_err());
}
