//! The trend over N and the range over PPC.

use snowlab_study::claims::*;
use snowlab_study::statistics::least_squares_slope;

use super::arms::*;

const COUNTS: [f64; 4] = [5e3, 1e4, 2e4, 3e4];

fn trend() -> Claim {
    let arms = COUNTS.iter().map(|&particles| TrendArm { arm: particles.to_string(), particles }).collect();
    Claim {
        id: "homogenised".into(),
        sentence: "more points, fewer cracks".into(),
        contrast: Contrast::Trend { arms },
        largest_spacing: None,
    }
}

fn range() -> Claim {
    let arms = ["1", "4", "8", "16"].map(String::from).to_vec();
    Claim {
        id: "stencil-ratio".into(),
        sentence: "sensitive to particles per grid stencil".into(),
        contrast: Contrast::Range { arms },
        largest_spacing: None,
    }
}

/// Rows of 16 blocks; `value(block, index of the arm)`.
fn table(claim: &Claim, value: impl Fn(usize, usize) -> f64) -> Vec<ArmValue> {
    let arms = claim.arms();
    (0..16)
        .flat_map(|block| arms.iter().enumerate().map(move |(index, arm)| (block, index, *arm)))
        .map(|(block, index, arm)| case(block, arm, value(block, index)))
        .collect()
}

fn assessed(claim: &Claim, observations: &Observations) -> Assessment {
    assess(claim, observations, 5, RESAMPLING).unwrap()
}

/// A small scatter, fixed per block and arm, in [-1, 1].
fn scatter(block: usize, index: usize) -> f64 {
    ((block * 7 + index * 5) % 11) as f64 / 5.0 - 1.0
}

#[test]
fn trend_effect_is_the_negative_slope_times_log2_of_six() {
    let claim = trend();
    let value = |block: usize, index: usize| 3.0 - 0.2 * (index * index) as f64 + 0.1 * scatter(block, index);
    let logs: Vec<f64> = COUNTS.iter().map(|count| count.log2()).collect();
    let slopes = (0..16).map(|block| {
        let values: Vec<f64> = (0..4).map(|index| value(block, index)).collect();
        least_squares_slope(&logs, &values).unwrap()
    });
    let expected = -slopes.sum::<f64>() / 16.0 * 6.0_f64.log2();
    let found = assessed(&claim, &observed(table(&claim, value))).evidence.effect.unwrap();
    assert!((found - expected).abs() < 1e-12, "{found} against {expected}");
}

#[test]
fn trend_is_judged_like_a_difference() {
    let claim = trend();
    let phrase = |slope: f64, noise: f64| {
        let value =
            move |block, index: usize| 3.0 + slope * COUNTS[index].log2() + noise * scatter(block, index);
        assessed(&claim, &observed(table(&claim, value))).verdict.to_string()
    };
    assert_eq!(phrase(-0.3, 0.1), "supported");
    assert_eq!(phrase(0.0, 0.1), "refuted (smaller than 1.25x)");
    assert_eq!(phrase(0.3, 0.1), "refuted (reversed)");
    assert_eq!(phrase(-0.09, 1.0), "inconclusive (not resolved)");
}

#[test]
fn trend_fills_lost_cases_by_the_sign_of_their_arm() {
    // The fall is 0.09 log2 6 = 0.233 in every block, just above delta. With x = log2 N the weight of the 5k arm is
    // 0.929, so a 5k case at the smallest value seen lowers its block by 0.216; in two of 20 blocks that takes
    // the mean to 0.211, below delta. At the largest value seen, its own, it would change nothing.
    let claim = trend();
    let value = |_: usize, index: usize| 3.0 - 0.09 * COUNTS[index].log2();
    let mut rows = table(&claim, value);
    for block in 16..20 {
        rows.extend(
            claim.arms().iter().enumerate().map(|(index, arm)| case(block, arm, value(block, index))),
        );
    }
    let whole = observed(rows.clone());
    assert_eq!(assessed(&claim, &whole).verdict.to_string(), "supported");
    let mut holed = whole;
    holed.rows.iter_mut().filter(|row| row.block >= 18 && row.arm == "5000").for_each(|row| {
        row.status = CaseStatus::MetricInvalid;
    });
    let assessment = assessed(&claim, &holed);
    assert_eq!(assessment.verdict.to_string(), "inconclusive (lost cases)", "{assessment}");
}

#[test]
fn range_needs_both_the_permutation_and_the_bootstrap() {
    let claim = range();
    let phrase = |step: f64, noise: f64| {
        let value = move |block, index: usize| 2.0 + step * index as f64 + noise * scatter(block, index);
        assessed(&claim, &observed(table(&claim, value))).verdict.to_string()
    };
    // Range 0.9 of small scatter; none; 0.15, surely present yet below delta; 0.3 with delta inside I.
    assert_eq!(phrase(0.3, 0.1), "supported");
    assert_eq!(phrase(0.0, 0.05), "refuted (smaller than 1.25x)");
    assert_eq!(phrase(0.05, 0.02), "refuted (smaller than 1.25x)");
    assert_eq!(phrase(0.09, 0.3), "inconclusive (not resolved)");
    let steep = observed(table(&claim, |_, index| index as f64));
    let evidence = assessed(&claim, &steep).evidence;
    assert_eq!((evidence.effect, evidence.cliffs_delta), (Some(3.0), Some(1.0)));
    assert_eq!((evidence.interval_t, evidence.standard_deviation), (None, None));
    // No permutation of 2000 reaches a range on which all 16 blocks agree.
    assert_eq!(evidence.p_value, Some(1.0 / 2001.0));
    // Fifty permutations cannot show p < 0.01, however wide the range: 1/51.
    let coarse = assess(&claim, &steep, 5, Resampling { permutations: 50, ..RESAMPLING }).unwrap();
    assert_eq!(coarse.verdict.to_string(), "inconclusive (not resolved)");
}

#[test]
fn range_is_re_measured_between_the_same_two_arms() {
    let claim = range();
    let rising = |block, index: usize| 2.0 + 0.3 * index as f64 + 0.1 * scatter(block, index);
    let falling = |block, index: usize| 2.0 - 0.3 * index as f64 + 0.1 * scatter(block, index);
    let mut observations = observed(table(&claim, rising));
    observations.checks.insert(Check::LongLink, table(&claim, falling));
    // The range is as wide, but the arms stand the other way round.
    assert_eq!(assessed(&claim, &observations).verdict.to_string(), "inconclusive (measurement: link 3h)");
    // A refutation looks at the range whatever its order: two wide ones undo it.
    let mut observations = observed(table(&claim, |block, index| 2.0 + 0.05 * scatter(block, index)));
    observations.checks.insert(Check::LongLink, table(&claim, falling));
    assert_eq!(assessed(&claim, &observations).verdict.to_string(), "refuted (smaller than 1.25x)");
    observations.checks.insert(Check::FloodFill, table(&claim, rising));
    assert_eq!(
        assessed(&claim, &observations).verdict.to_string(),
        "inconclusive (measurement: link 3h, flood fill)"
    );
}

#[test]
fn weighted_contrast_is_the_difference_of_differences() {
    let weights = [("r5", 1.0), ("r30", -1.0), ("j5", -1.0), ("j30", 1.0)];
    let claim = Claim {
        id: "regular-placement".into(),
        sentence: "random placement breaks more by its irregularity".into(),
        contrast: Contrast::Weighted { weights: weights.map(|(arm, weight)| (arm.into(), weight)).into() },
        largest_spacing: None,
    };
    let level = |arm: &str| match arm {
        "r5" => 2.0,
        "r30" => 1.0,
        "j5" => 1.3,
        _ => 1.1,
    };
    let arms = claim.arms();
    let mut rows = Vec::new();
    for block in 0..16 {
        rows.extend(arms.iter().enumerate().map(|(index, arm)| {
            case(block, arm, level(arm) + 0.1 * scatter(block, index) - 0.1 * scatter(block, 0))
        }));
    }
    let assessment = assessed(&claim, &observed(rows.clone()));
    let by_hand: f64 = rows
        .iter()
        .map(|row| weights.iter().find(|(arm, _)| *arm == row.arm).unwrap().1 * row.value / 16.0)
        .sum();
    assert!((assessment.evidence.effect.unwrap() - by_hand).abs() < 1e-12);
    assert_eq!(assessment.verdict, Verdict::Supported);
}
