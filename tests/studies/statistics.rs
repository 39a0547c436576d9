//! The statistics against published values, closed forms, counts by hand and small simulations.

use approx::assert_abs_diff_eq;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use snowlab_study::statistics::*;

/// Darwin's maize: height differences of 15 pairs in eighths of an inch (Fisher 1935, sec. 17).
const DARWIN: [f64; 15] = [49., -67., 8., 16., 6., 23., 28., 41., 14., 29., 56., 24., 75., 60., -48.];

/// The spatial test data, sample A (Efron & Tibshirani 1993, table 14.1).
const SPATIAL: [f64; 26] = [
    48., 36., 20., 29., 42., 42., 20., 42., 22., 41., 45., 14., 6., 0., 33., 28., 34., 4., 32., 24., 47.,
    41., 24., 26., 30., 41.,
];

#[test]
fn quantiles_of_student_t_match_published_tables() {
    // (probability, degrees of freedom, quantile): Abramowitz & Stegun table 26.10, to its printed digits.
    let table = [
        (0.975, 1.0, 12.706, 5e-4),
        (0.975, 10.0, 2.228, 5e-4),
        (0.95, 5.0, 2.015, 5e-4),
        (0.995, 11.0, 3.106, 5e-4),
        (0.995, 23.0, 2.807, 5e-4),
        (0.995, 1.0, 63.657, 5e-4),
        (0.9995, 30.0, 3.646, 5e-4),
        (0.975, 120.0, 1.980, 5e-4),
    ];
    for (probability, freedom, expected, tolerance) in table {
        assert_abs_diff_eq!(student_t_quantile(probability, freedom), expected, epsilon = tolerance);
        assert_abs_diff_eq!(student_t_quantile(1.0 - probability, freedom), -expected, epsilon = tolerance);
    }
    assert_eq!(student_t_quantile(0.5, 7.0), 0.0);
}

#[test]
fn student_t_matches_its_closed_forms() {
    for t in [-40.0, -3.0, -0.4, 0.0, 1e-3, 0.7, 1.0, 2.5, 90.0] {
        let cauchy = 0.5 + f64::atan(t) / std::f64::consts::PI;
        assert_abs_diff_eq!(student_t_cdf(t, 1.0), cauchy, epsilon = 1e-14);
        let two = 0.5 + 0.5 * t / f64::sqrt(2.0 + t * t);
        assert_abs_diff_eq!(student_t_cdf(t, 2.0), two, epsilon = 1e-13);
    }
    // Four degrees of freedom: the finite sum of Abramowitz & Stegun 26.7.4.
    let t: f64 = 1.3;
    let cos2 = 4.0 / (4.0 + t * t);
    let sin = (1.0 - cos2).sqrt();
    assert_abs_diff_eq!(student_t_cdf(t, 4.0), 0.5 + 0.5 * sin * (1.0 + 0.5 * cos2), epsilon = 1e-14);
    // Many degrees of freedom: normal.
    assert_abs_diff_eq!(student_t_cdf(1.3, 1e6), normal_cdf(1.3), epsilon = 1e-6);
}

#[test]
fn normal_and_chi_square_quantiles_match_published_values() {
    assert_abs_diff_eq!(normal_quantile(0.975), 1.959_963_984_540_054, epsilon = 1e-13);
    assert_abs_diff_eq!(normal_quantile(0.995), 2.575_829_303_548_9, epsilon = 1e-13);
    assert_abs_diff_eq!(normal_quantile(0.2), -0.841_621_233_572_914, epsilon = 1e-13);
    // Abramowitz & Stegun table 26.8.
    assert_abs_diff_eq!(chi_square_quantile(0.95, 10.0), 18.3070, epsilon = 1e-4);
    assert_abs_diff_eq!(chi_square_quantile(0.05, 7.0), 2.167_35, epsilon = 1e-5);
    assert_abs_diff_eq!(chi_square_quantile(0.99, 1.0), 6.634_90, epsilon = 1e-5);
    // Two degrees of freedom: exponential of mean 2.
    for p in [1e-6_f64, 0.2, 0.5, 0.999] {
        assert_abs_diff_eq!(chi_square_quantile(p, 2.0), -2.0 * (-p).ln_1p(), epsilon = 1e-10);
        assert_abs_diff_eq!(chi_square_cdf(chi_square_quantile(p, 47.0), 47.0), p, epsilon = 1e-12);
    }
    // beta(a, 1): F = x^a.
    assert_abs_diff_eq!(beta_quantile(0.3, 5.0, 1.0), 0.3_f64.powf(0.2), epsilon = 1e-14);
}

#[test]
fn t_interval_of_darwins_maize_is_fishers() {
    // Fisher 1935: mean 20.933, t = 2.148 on 14 degrees of freedom, 5 % point 2.145.
    let interval = t_interval(&DARWIN, 0.95).unwrap();
    assert_abs_diff_eq!(mean(&DARWIN).unwrap(), 314.0 / 15.0, epsilon = 1e-12);
    assert_abs_diff_eq!(standard_deviation(&DARWIN).unwrap(), 37.744, epsilon = 1e-3);
    assert_abs_diff_eq!(interval.lower, 0.0312, epsilon = 1e-3);
    assert_abs_diff_eq!(interval.upper, 41.8355, epsilon = 1e-3);
    // The one-sided 97.5 % bounds are the ends of the two-sided 95 % interval.
    assert_abs_diff_eq!(t_lower_bound(&DARWIN, 0.975).unwrap(), interval.lower, epsilon = 1e-9);
    assert_abs_diff_eq!(t_upper_bound(&DARWIN, 0.975).unwrap(), interval.upper, epsilon = 1e-9);
    assert!(t_interval(&[1.0], 0.95).is_none());
}

#[test]
fn sign_flip_of_darwins_maize_is_fishers_count() {
    // Fisher 1935, sec. 21: 863 of the 32,768 patterns reach 314 or more; both sides: 1726.
    assert_eq!(sign_flip_p(&DARWIN, 0, 0), Some(1726.0 / 32768.0));
}

#[test]
fn sign_flip_of_small_cases_is_counted_by_hand() {
    // Sums of +-1 +-2 +-3: 6, 4, 2, 0, 0, -2, -4, -6; two reach 6 in size, four reach 4.
    assert_eq!(sign_flip_p(&[1.0, 2.0, 3.0], 0, 0), Some(2.0 / 8.0));
    assert_eq!(sign_flip_p(&[-1.0, 2.0, 3.0], 0, 0), Some(4.0 / 8.0));
    assert_eq!(sign_flip_p(&[1.0, 2.0, -3.0], 0, 0), Some(1.0));
    // Twelve of one sign: the two patterns of one sign of 4096, in spite of round-off in 0.1 + 0.1 + ...
    assert_eq!(sign_flip_p(&[0.1; 12], 0, 0), Some(2.0 / 4096.0));
    assert_eq!(sign_flip_p(&[0.0; 5], 0, 0), Some(1.0));
    assert_eq!(sign_flip_p(&[], 100, 0), None);
}

#[test]
fn drawn_sign_flips_agree_with_the_exact_count() {
    // 18 differences of size 1, 13 of them positive: |sum| >= 8 iff at most 5 or at least 13 are positive.
    let mut differences = [1.0; 18];
    differences[..5].fill(-1.0);
    let choose = |k: u64| (1..=k).fold(1.0, |c, i| c * (18 - k + i) as f64 / i as f64);
    let exact = 2.0 * (0..=5).map(choose).sum::<f64>() / 2_f64.powi(18);
    let drawn = sign_flip_p(&differences, 100_000, 3).unwrap();
    // Five standard errors of 100,000 draws.
    assert_abs_diff_eq!(drawn, exact, epsilon = 5.0 * (exact * (1.0 - exact) / 1e5).sqrt());
    assert_eq!(sign_flip_p(&differences, 1000, 3), sign_flip_p(&differences, 1000, 3));
}

#[test]
fn range_permutation_matches_the_exact_share() {
    // Six blocks of two arms, the second always larger by 1: the range is 1 only if all six agree, 2 of 64.
    let rows: Vec<Vec<f64>> = (0..6).map(|b| vec![b as f64, b as f64 + 1.0]).collect();
    assert_abs_diff_eq!(range_of_means(&rows).unwrap(), 1.0, epsilon = 1e-15);
    let p = range_permutation_p(&rows, 10_000, 5).unwrap();
    assert_abs_diff_eq!(p, 2.0 / 64.0, epsilon = 5.0 * (2.0 / 64.0 / 1e4_f64).sqrt());
    // Three arms in one block: every order has the same range.
    assert_eq!(range_permutation_p(&[vec![1.0, 2.0, 5.0]], 50, 5), Some(1.0));
    // Twelve blocks that agree on the order of three arms: out of reach of 1000 permutations.
    let ordered: Vec<Vec<f64>> = (0..12).map(|_| vec![0.3, 0.1, 0.2]).collect();
    assert_eq!(range_permutation_p(&ordered, 1000, 5), Some(1.0 / 1001.0));
}

#[test]
fn bca_of_the_spatial_data_is_the_published_one() {
    let variance = |blocks: &[usize]| {
        let values: Vec<f64> = blocks.iter().map(|&b| SPATIAL[b]).collect();
        let centre = mean(&values).unwrap();
        values.iter().map(|v| (v - centre).powi(2)).sum::<f64>() / values.len() as f64
    };
    let bootstrap = Bootstrap::over_blocks(26, 10_000, 1, variance).unwrap();
    assert_abs_diff_eq!(bootstrap.estimate(), 171.5, epsilon = 0.05);
    // Efron & Tibshirani 1993, table 14.2: central 90 % (115.8, 259.6) from 2000 resamples; the percentile
    // interval there is (100.8, 233.9), so 5 units tell the two apart.
    let interval = bootstrap.interval(0.90);
    assert_abs_diff_eq!(interval.lower, 115.8, epsilon = 5.0);
    assert_abs_diff_eq!(interval.upper, 259.6, epsilon = 7.0);
    assert_eq!(bootstrap.lower_bound(0.95), interval.lower);
    assert_eq!(bootstrap.upper_bound(0.95), interval.upper);
}

#[test]
fn bca_covers_the_mean_of_a_skewed_distribution() {
    // Exponential of mean 1, 20 blocks, 90 %: the share of 400 intervals that contain 1 lies within 3 standard
    // errors (0.045) of 0.88, the coverage BCa is known to reach at this size.
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut covered, mut leans_right) = (0, 0);
    for trial in 0..400 {
        let sample: Vec<f64> = (0..20).map(|_| -(-rng.random::<f64>()).ln_1p()).collect();
        let bootstrap = Bootstrap::of_mean(&sample, 1000, trial).unwrap();
        let interval = bootstrap.interval(0.90);
        covered += usize::from(interval.contains(1.0));
        let centre = bootstrap.estimate();
        leans_right += usize::from(interval.upper - centre > centre - interval.lower);
    }
    let coverage = covered as f64 / 400.0;
    assert!((coverage - 0.88).abs() < 0.045, "coverage {coverage}");
    // A right-skewed distribution needs the longer arm on the right.
    assert!(leans_right > 370, "{leans_right} of 400 lean right");
}

#[test]
fn bca_of_equal_values_is_a_point_and_of_few_values_nothing() {
    let interval = Bootstrap::of_mean(&[0.1; 12], 500, 0).unwrap().interval(0.99);
    assert_eq!(interval.lower, interval.upper);
    assert_abs_diff_eq!(interval.lower, 0.1, epsilon = 1e-15);
    assert!(Bootstrap::of_mean(&[1.0], 500, 0).is_none());
    assert!(Bootstrap::of_mean(&[], 500, 0).is_none());
}

#[test]
fn bca_depends_on_the_seed_alone() {
    let limits = |seed| Bootstrap::of_mean(&DARWIN, 1000, seed).unwrap().interval(0.95);
    assert_eq!(limits(1), limits(1));
    assert_ne!(limits(1), limits(2));
}

#[test]
fn holm_by_hand() {
    // Sorted: 0.005 x 4, 0.01 x 3, 0.03 x 2, 0.04 x 1 -> 0.02, 0.03, 0.06, and 0.04 is raised to 0.06.
    let adjusted = holm_adjusted(&[0.01, 0.04, 0.03, 0.005]);
    for (found, expected) in adjusted.iter().zip([0.03, 0.06, 0.06, 0.02]) {
        assert_abs_diff_eq!(*found, expected, epsilon = 1e-15);
    }
    assert_eq!(holm_adjusted(&[0.6, 0.9]), [1.0, 1.0]);
    assert!(holm_adjusted(&[]).is_empty());
}

#[test]
fn cliffs_delta_by_hand() {
    // Pairs of {1, 2, 4} against {2, 3}: 2 greater (4>2, 4>3), 3 less (1<2, 1<3, 2<3), 1 tie.
    assert_abs_diff_eq!(cliffs_delta(&[1.0, 2.0, 4.0], &[2.0, 3.0]).unwrap(), -1.0 / 6.0, epsilon = 1e-15);
    assert_eq!(cliffs_delta(&[5.0, 6.0], &[1.0]), Some(1.0));
    assert_eq!(cliffs_delta(&[], &[1.0]), None);
}

#[test]
fn slope_and_quantiles_by_hand() {
    // x = 0, 1, 3 (mean 4/3), y = 1, 2, 2: Sxy = 4/3, Sxx = 14/3.
    assert_abs_diff_eq!(
        least_squares_slope(&[0.0, 1.0, 3.0], &[1.0, 2.0, 2.0]).unwrap(),
        2.0 / 7.0,
        epsilon = 1e-15
    );
    assert_eq!(least_squares_slope(&[1.0, 1.0], &[1.0, 2.0]), None);
    assert_eq!(least_squares_slope(&[1.0, 2.0, 3.0], &[1.0, 2.0]), None);
    let values = [9.0, 1.0, 4.0, 2.0];
    assert_eq!(quantile(&values, 0.25), Some(1.75));
    assert_eq!(median(&values), Some(3.0));
    assert_eq!(quantile(&values, 1.0), Some(9.0));
    assert_eq!(quantile(&[], 0.5), None);
    assert_eq!(mean(&[]), None);
    assert_eq!(standard_deviation(&[3.0]), None);
    let summary = summarise(&values, 0.95).unwrap();
    assert_eq!((summary.count, summary.mean, summary.minimum, summary.maximum), (4, 4.0, 1.0, 9.0));
    assert_eq!((summary.lower_quartile, summary.median, summary.upper_quartile), (1.75, 3.0, 5.25));
    assert_eq!(summary.interval, t_interval(&values, 0.95));
    assert_eq!(summarise(&[2.0], 0.95).unwrap().interval, None);
}

#[test]
fn shares_have_the_published_intervals() {
    // 8 of 10 at 95 %: Clopper-Pearson (0.4439, 0.9748), Wilson (0.4902, 0.9433) (Brown, Cai & DasGupta 2001).
    let exact = clopper_pearson(8, 10, 0.95).unwrap();
    assert_abs_diff_eq!(exact.lower, 0.4439, epsilon = 1e-4);
    assert_abs_diff_eq!(exact.upper, 0.9748, epsilon = 1e-4);
    let score = wilson(8, 10, 0.95).unwrap();
    assert_abs_diff_eq!(score.lower, 0.4902, epsilon = 1e-4);
    assert_abs_diff_eq!(score.upper, 0.9433, epsilon = 1e-4);
    // None of n: the exact upper limit is 1 - 0.025^(1/n).
    let none = clopper_pearson(0, 12, 0.95).unwrap();
    assert_eq!(none.lower, 0.0);
    assert_abs_diff_eq!(none.upper, 1.0 - 0.025_f64.powf(1.0 / 12.0), epsilon = 1e-12);
    assert_eq!(clopper_pearson(12, 12, 0.95).unwrap().upper, 1.0);
    assert_eq!(wilson(0, 12, 0.95).unwrap().lower, 0.0);
    assert_eq!(wilson(0, 0, 0.95), None);
    assert_eq!(clopper_pearson(3, 2, 0.95), None);
}

#[test]
fn replicate_plan_by_hand() {
    // Eight differences of +-0.5: s^2 = 2/7, chi2_{0.20, 7} = 3.8223, s_u^2 = 2/3.8223 = 0.52324;
    // n = 3.418^2 x 0.52324 / 0.405465^2 = 37.18 -> 38 + 2 = 40.
    let pilot: Vec<f64> = (0..8).map(|b| if b % 2 == 0 { 0.5 } else { -0.5 }).collect();
    let plan = replicate_plan(&pilot).unwrap();
    assert_abs_diff_eq!(plan.deviation_limit.powi(2), 0.523_24, epsilon = 1e-4);
    assert_eq!((plan.wanted, plan.blocks), (40, 40));
    assert!(plan.detectable_ratio < 1.5 && plan.detectable_ratio > 1.48, "{}", plan.detectable_ratio);
    assert_eq!(Some(plan.deviation_limit), standard_deviation_upper_limit(&pilot, 0.80));

    // A fifth of the spread: 37.18/25 = 1.49 -> 2 + 2 = 4, held at 24; twice: 148.7 -> 151, held at 48, where
    // exp(3.418 x 2 x 0.72335/sqrt 46) = 2.073 is what can be detected.
    let scaled = |factor: f64| pilot.iter().map(|d| d * factor).collect::<Vec<_>>();
    let narrow = replicate_plan(&scaled(0.2)).unwrap();
    assert_eq!((narrow.wanted, narrow.blocks), (4, 24));
    let wide = replicate_plan(&scaled(2.0)).unwrap();
    assert_eq!((wide.wanted, wide.blocks), (151, 48));
    assert_abs_diff_eq!(wide.detectable_ratio, 2.073, epsilon = 1e-3);
    assert_eq!(replicate_plan(&[0.3]), None);
}

#[test]
fn deviation_limit_covers_at_its_confidence() {
    // The upper 80 % limit lies above the true deviation in 80 % of samples: 2000 samples of 8, 4 standard
    // errors.
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut gauss = || normal_quantile(rng.random_range(1e-12..1.0 - 1e-12));
    let above = (0..2000)
        .filter(|_| {
            let sample: Vec<f64> = (0..8).map(|_| gauss()).collect();
            standard_deviation_upper_limit(&sample, 0.80).unwrap() > 1.0
        })
        .count();
    assert_abs_diff_eq!(above as f64 / 2000.0, 0.80, epsilon = 0.036);
}

#[test]
fn operating_speed_takes_the_usable_median_nearest_a_quarter() {
    let trial = |speed, damages: &[f64]| SpeedTrial { speed, damages: damages.to_vec() };
    let trials = [trial(8.0, &[0.5, 0.5]), trial(3.0, &[0.1, 0.15, 0.9]), trial(5.0, &[0.25, 0.375])];
    assert_eq!(operating_speed(&trials), OperatingSpeed::Found { speed: 5.0, median_damage: 0.3125 });
    // 0.04 is nearer 0.25 than 0.55 is, yet out of range: the usable one is taken.
    let trials = [trial(2.0, &[0.04]), trial(12.0, &[0.55])];
    assert_eq!(operating_speed(&trials), OperatingSpeed::Found { speed: 12.0, median_damage: 0.55 });
    // None usable: says so, with the nearest.
    let trials = [trial(2.0, &[0.0]), trial(12.0, &[0.04]), trial(5.0, &[])];
    assert_eq!(operating_speed(&trials), OperatingSpeed::NoneUsable { nearest: Some((12.0, 0.04)) });
    assert_eq!(operating_speed(&[]), OperatingSpeed::NoneUsable { nearest: None });
    // The ends of the range are usable; of two as near the slower is taken, in whatever order they come.
    let trials = [trial(9.0, &[0.3]), trial(4.0, &[0.2])];
    assert_eq!(operating_speed(&trials), OperatingSpeed::Found { speed: 4.0, median_damage: 0.2 });
    assert_eq!(
        operating_speed(&[trial(1.0, &[0.05])]),
        OperatingSpeed::Found { speed: 1.0, median_damage: 0.05 }
    );
}

#[test]
fn fieller_ends_are_where_the_difference_just_touches_zero() {
    let numerators = [1.0, 1.4, 0.7, 1.2, 0.9, 1.3];
    let denominators = [1.1, 1.9, 1.2, 1.5, 1.6, 1.4];
    let (ratio, set) = ratio_of_means(&numerators, &denominators, 0.95).unwrap();
    assert_abs_diff_eq!(ratio, 6.5 / 8.7, epsilon = 1e-14);
    let FiellerSet::Bounded(interval) = set else { panic!("bounded: the denominator is far from 0") };
    // By definition q is an end if the t interval of x - q y has 0 as an end.
    let residual =
        |q: f64| -> Vec<f64> { numerators.iter().zip(denominators).map(|(x, y)| x - q * y).collect() };
    assert_abs_diff_eq!(t_interval(&residual(interval.lower), 0.95).unwrap().lower, 0.0, epsilon = 1e-12);
    assert_abs_diff_eq!(t_interval(&residual(interval.upper), 0.95).unwrap().upper, 0.0, epsilon = 1e-12);
    // A constant denominator only scales the t interval.
    let (_, scaled) = ratio_of_means(&numerators, &[2.0; 6], 0.95).unwrap();
    let plain = t_interval(&numerators, 0.95).unwrap();
    let FiellerSet::Bounded(scaled) = scaled else { panic!("bounded: a constant") };
    assert_abs_diff_eq!(scaled.lower, 0.5 * plain.lower, epsilon = 1e-12);
    assert_abs_diff_eq!(scaled.upper, 0.5 * plain.upper, epsilon = 1e-12);
    // A denominator that may be zero bounds nothing.
    let unsure = [1.0, -1.0, 2.0, -1.5, 0.5, -0.4];
    assert_eq!(ratio_of_means(&numerators, &unsure, 0.95).unwrap().1, FiellerSet::Unbounded);
    assert_eq!(ratio_of_means(&numerators, &unsure[..3], 0.95), None);
}
