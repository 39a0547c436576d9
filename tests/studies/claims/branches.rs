//! A table that walks through every branch of the rule for a paired contrast. delta = ln 1.25 = 0.2231.

use snowlab_study::claims::*;

use super::arms::*;

/// Observations whose rows are changed one by one; the checks keep the unchanged rows.
fn with(differences: &[f64], change: impl Fn(&mut ArmValue)) -> Observations {
    let mut observations = differing(differences);
    observations.rows.iter_mut().for_each(change);
    observations
}

/// Both cases of the last `lost` blocks end badly.
fn losing(differences: &[f64], lost: usize) -> Observations {
    let first_lost = (differences.len() - lost) as u64;
    with(differences, |row| {
        if row.block >= first_lost {
            row.status = CaseStatus::Stopped;
            row.value = f64::NAN;
        }
    })
}

fn under(conditions: Conditions) -> Observations {
    Observations { conditions, ..differing(&around(1.0, 0.05, 12)) }
}

/// The primary differences with some checks replaced by others.
fn checked(primary: &[f64], replaced: &[(Check, Vec<f64>)]) -> Observations {
    let mut observations = differing(primary);
    for (check, differences) in replaced {
        observations.checks.insert(*check, rows(differences));
    }
    observations
}

fn without(primary: &[f64], missing: &[Check]) -> Observations {
    let mut observations = differing(primary);
    observations.checks.retain(|check, _| !missing.contains(check));
    observations
}

fn check_table(table: Vec<(&str, Observations, &str)>) {
    for (what, observations, expected) in table {
        let assessment = judged(&observations);
        assert_eq!(assessment.verdict.to_string(), expected, "{what}: {assessment}");
    }
}

const STRONG: f64 = 1.0;

#[test]
fn rule_1_counts_complete_and_lost_blocks() {
    let strong = |blocks| around(STRONG, 0.05, blocks);
    let clamped = |clamp_share| {
        move |row: &mut ArmValue| {
            if row.block == 0 && row.arm == "5k" {
                row.status = CaseStatus::OkWithClamps { clamp_share };
            }
        }
    };
    let invalid = |row: &mut ArmValue| {
        if row.block == 0 && row.arm == "30k" {
            row.status = CaseStatus::MetricInvalid;
        }
    };
    check_table(vec![
        ("nothing run", differing(&[]), "not-run (n < 12)"),
        ("11 blocks", differing(&strong(11)), "not-run (n < 12)"),
        ("12 blocks", differing(&strong(12)), "supported"),
        ("12 blocks, one stopped", losing(&strong(12), 1), "not-run (n < 12)"),
        ("12 blocks, one metric-invalid", with(&strong(12), invalid), "not-run (n < 12)"),
        ("12 blocks, one clamped at 0.2 %", with(&strong(12), clamped(0.002)), "not-run (n < 12)"),
        ("12 blocks, one clamped at 0.1 %", with(&strong(12), clamped(0.001)), "supported"),
        ("3 of 21 lost", losing(&strong(21), 3), "not-run (over 10 % lost)"),
        ("2 of 20 lost: 10 %, not over", losing(&strong(20), 2), "supported"),
    ]);
}

#[test]
fn rule_1_asks_the_answer_to_hold_with_lost_cases_at_their_worst() {
    // Worst d of a lost block: smallest less largest value seen, about -(mean + spread).
    check_table(vec![
        ("d = 0.4 -+ 0.35, none lost", differing(&around(0.4, 0.35, 18)), "supported"),
        ("the same, 2 of 20 lost at -0.75", losing(&around(0.4, 0.35, 20), 2), "inconclusive (lost cases)"),
        ("d = 0.05 -+ 0.3, none lost", differing(&around(0.05, 0.3, 18)), "refuted (smaller than 1.25x)"),
        ("the same, 2 of 20 lost at +0.6", losing(&around(0.05, 0.3, 20), 2), "inconclusive (lost cases)"),
        ("d = 0, 2 of 20 lost at +0.1", losing(&around(0.0, 0.05, 20), 2), "refuted (smaller than 1.25x)"),
        ("d = -0.4 -+ 0.35, none lost", differing(&around(-0.4, 0.35, 18)), "refuted (reversed)"),
        ("no longer reversed", losing(&around(-0.4, 0.35, 20), 2), "refuted (smaller than 1.25x)"),
    ]);
}

#[test]
fn rule_1_fills_only_the_case_that_was_lost() {
    // Only the control of block 19 is lost; its worst value is the largest seen, 1.05 + 1 of the treated arm.
    let observations = with(&around(STRONG, 0.05, 20), |row| {
        if row.block == 19 && row.arm == "30k" {
            row.status = CaseStatus::Stopped;
        }
    });
    let assessment = judged(&observations);
    assert_eq!(assessment.verdict, Verdict::Supported);
    assert_eq!((assessment.evidence.blocks, assessment.lost_blocks), (19, 1));
}

#[test]
fn rule_2_stops_at_the_floor_the_plateau_the_metric_and_the_damping() {
    let met = Conditions::MET;
    let unbroken = |arm: &'static str, count: u64| {
        move |row: &mut ArmValue| {
            if (arm == "both" || arm == row.arm) && row.block < count {
                row.damage = 0.005;
            }
        }
    };
    let unsettled =
        |count: u64| move |row: &mut ArmValue| row.settled = row.arm == "30k" || row.block >= count;
    let damped = |factor: f64| {
        move |row: &mut ArmValue| {
            if row.arm == "5k" {
                row.damping *= factor;
            }
        }
    };
    let strong = |blocks| around(STRONG, 0.05, blocks);
    check_table(vec![
        (
            "no operating point",
            under(Conditions { operating_point_found: false, ..met }),
            "inconclusive (floor)",
        ),
        ("10 of 12 unbroken in both", with(&strong(12), unbroken("both", 10)), "inconclusive (floor)"),
        ("9 of 12 unbroken: 75 %, not over", with(&strong(12), unbroken("both", 9)), "supported"),
        ("control alone unbroken", with(&strong(12), unbroken("30k", 12)), "supported"),
        ("3 of 12 unsettled in one arm", with(&strong(12), unsettled(3)), "inconclusive (no plateau)"),
        ("4 of 20 unsettled: 20 %, not over", with(&strong(20), unsettled(4)), "supported"),
        ("calibration", under(Conditions { calibration_agrees: false, ..met }), "inconclusive (metric)"),
        ("noise floor", under(Conditions { noise_floor_holds: false, ..met }), "inconclusive (metric)"),
        ("damping 6 % higher", with(&strong(12), damped(1.06)), "inconclusive (damping)"),
        ("damping 6 % lower", with(&strong(12), damped(0.94)), "inconclusive (damping)"),
        ("damping 4 % higher", with(&strong(12), damped(1.04)), "supported"),
        ("damping in one arm only", with(&strong(12), damped(0.0)), "inconclusive (damping)"),
        ("no damping at all", with(&strong(12), |row| row.damping = 0.0), "supported"),
    ]);
}

#[test]
fn rules_are_asked_in_order() {
    let faulty =
        Conditions { operating_point_found: false, calibration_agrees: false, noise_floor_holds: false };
    let all_wrong = |blocks, conditions| {
        let spoil = |row: &mut ArmValue| {
            row.settled = false;
            row.damping = if row.arm == "5k" { 1.0 } else { 2.0 };
        };
        Observations { conditions, ..with(&around(STRONG, 0.05, blocks), spoil) }
    };
    let settle = |mut observations: Observations| {
        observations.rows.iter_mut().for_each(|row| row.settled = true);
        observations
    };
    let found = Conditions { operating_point_found: true, ..faulty };
    check_table(vec![
        ("rule 1 before rule 2", all_wrong(11, faulty), "not-run (n < 12)"),
        ("floor first", all_wrong(12, faulty), "inconclusive (floor)"),
        ("then plateau", all_wrong(12, found), "inconclusive (no plateau)"),
        ("then metric", settle(all_wrong(12, found)), "inconclusive (metric)"),
        ("then damping", settle(all_wrong(12, Conditions::MET)), "inconclusive (damping)"),
    ]);
}

#[test]
fn rules_3_to_5_compare_the_effect_with_delta() {
    // One outlier widens the t interval beyond 0, while no resample of positive values has a mean below 0.
    let mut outlier = vec![0.05; 11];
    outlier.push(5.0);
    // The mirror image: the t bound U lies above delta, the BCa bound below 0.
    let mirrored: Vec<f64> = outlier.iter().map(|d| -d).collect();
    // Negative throughout: BCa calls it reversed, t does not.
    let mut deep = vec![-0.05; 11];
    deep.push(-1.0);
    // Two high values of 24: the 99 % t interval ends at -0.006, BCa follows the tail to above 0.
    let mut tailed = vec![-0.3; 22];
    tailed.extend([0.9, 0.9]);
    check_table(vec![
        ("t smaller, BCa reversed", differing(&deep), "refuted (smaller than 1.25x)"),
        ("t reversed, BCa smaller", differing(&tailed), "refuted (smaller than 1.25x)"),
        ("well above", differing(&around(0.5, 0.1, 24)), "supported"),
        ("d just above delta", differing(&around(0.224, 0.05, 24)), "supported"),
        ("I above 0, d just below delta", differing(&around(0.222, 0.05, 24)), "inconclusive (not resolved)"),
        ("d above delta, I contains 0", differing(&around(0.3, 0.8, 24)), "inconclusive (not resolved)"),
        (
            "between: 0 and delta both within",
            differing(&around(0.15, 0.5, 24)),
            "inconclusive (not resolved)",
        ),
        ("no effect", differing(&around(0.0, 0.1, 24)), "refuted (smaller than 1.25x)"),
        ("above 0 yet below delta", differing(&around(0.1, 0.05, 24)), "refuted (smaller than 1.25x)"),
        ("reversed", differing(&around(-0.5, 0.1, 24)), "refuted (reversed)"),
        ("negative, not clearly", differing(&around(-0.1, 0.5, 24)), "refuted (smaller than 1.25x)"),
        ("all equal and large", differing(&[0.5; 12]), "supported"),
        ("all equal and nil", differing(&[0.0; 12]), "refuted (smaller than 1.25x)"),
        ("t open, BCa supports", differing(&outlier), "inconclusive (t and BCa disagree)"),
        ("t open, BCa refutes", differing(&mirrored), "inconclusive (t and BCa disagree)"),
    ]);
    let reversed = |interval: Option<snowlab_study::statistics::Interval>| interval.unwrap().lies_below(0.0);
    let (deep, tailed) = (judged(&differing(&deep)).evidence, judged(&differing(&tailed)).evidence);
    assert!(!reversed(deep.interval_t) && reversed(deep.interval_bca));
    assert!(reversed(tailed.interval_t) && !reversed(tailed.interval_bca));
    let Verdict::Inconclusive(reason) = judged(&differing(&outlier)).verdict else { panic!("inconclusive") };
    assert_eq!(reason, Reason::MethodsDisagree { by_t: None, by_bca: Some(Finding::Supported) });
}

#[test]
fn rule_3_is_asked_at_the_family_s_confidence() {
    // t = mean/(s/sqrt n) = 0.3/(0.566/sqrt 24) = 2.6: between t(0.975, 23) = 2.07 and t(0.995, 23) = 2.81.
    let observations = differing(&around(0.3, 0.554, 24));
    let phrase = |size| assess(&paired(), &observations, size, RESAMPLING).unwrap().verdict.to_string();
    assert_eq!(phrase(1), "supported");
    assert_eq!(phrase(5), "inconclusive (not resolved)");
}

#[test]
fn rule_6_asks_a_support_to_withstand_every_check() {
    let primary = around(0.6, 0.1, 24);
    // One check at or below 0 ends a support, whichever it is.
    for check in Check::ALL {
        let expected = format!("inconclusive (measurement: {check})");
        let observations = checked(&primary, &[(check, around(-0.01, 0.1, 24))]);
        assert_eq!(judged(&observations).verdict.to_string(), expected);
        let expected = format!("inconclusive (measurement: missing {check})");
        assert_eq!(judged(&without(&primary, &[check])).verdict.to_string(), expected);
        // One check between 0 and delta/2 is let pass.
        let observations = checked(&primary, &[(check, around(0.1, 0.1, 24))]);
        assert_eq!(judged(&observations).verdict.to_string(), "supported", "{check}");
    }
    let small = || around(0.1, 0.05, 24);
    let unclear = || around(0.3, 0.9, 24);
    check_table(vec![
        (
            "two checks below delta/2",
            checked(&primary, &[(Check::LongLink, small()), (Check::HalfStep, small())]),
            "inconclusive (measurement: link 3h, dt/2)",
        ),
        (
            "two checks between delta/2 and delta",
            checked(
                &primary,
                &[(Check::LongLink, around(0.15, 0.05, 24)), (Check::HalfStep, around(0.15, 0.05, 24))],
            ),
            "supported",
        ),
        (
            "flood fill not clear of 0, bond graph is",
            checked(&primary, &[(Check::FloodFill, unclear())]),
            "supported",
        ),
        (
            "neither flood fill nor bond graph clear of 0",
            checked(&primary, &[(Check::FloodFill, unclear()), (Check::BondGraph, unclear())]),
            "inconclusive (measurement: flood fill, bond graph)",
        ),
        (
            "eight blocks of a check are enough",
            checked(&primary, &[(Check::OtherTransfer, around(0.6, 0.1, 8))]),
            "supported",
        ),
        (
            "seven are as good as none",
            checked(&primary, &[(Check::OtherTransfer, around(0.6, 0.1, 7))]),
            "inconclusive (measurement: missing other transfer)",
        ),
        (
            "against and missing",
            {
                let mut observations = checked(&primary, &[(Check::NoThinning, around(-0.1, 0.1, 24))]);
                observations.checks.remove(&Check::HalfStep);
                observations
            },
            "inconclusive (measurement: no thinning; missing dt/2)",
        ),
        (
            "nothing checked",
            without(&primary, &Check::ALL),
            "inconclusive (measurement: missing no thinning, link 3h, flood fill, bond graph, earlier time, dt/2, \
             other transfer)",
        ),
    ]);
}

#[test]
fn rule_6_asks_a_refutation_to_withstand_all_checks_but_one() {
    let primary = around(0.0, 0.1, 24);
    let large = || around(0.3, 0.1, 24);
    for check in Check::ALL {
        let smaller = "refuted (smaller than 1.25x)";
        assert_eq!(judged(&checked(&primary, &[(check, large())])).verdict.to_string(), smaller, "{check}");
        assert_eq!(judged(&without(&primary, &[check])).verdict.to_string(), smaller, "{check}");
    }
    check_table(vec![
        (
            "two large",
            checked(&primary, &[(Check::LongLink, large()), (Check::BondGraph, large())]),
            "inconclusive (measurement: link 3h, bond graph)",
        ),
        (
            "two missing",
            without(&primary, &[Check::HalfStep, Check::OtherTransfer]),
            "inconclusive (measurement: missing dt/2, other transfer)",
        ),
        (
            "one large, one missing",
            {
                let mut observations = checked(&primary, &[(Check::NoThinning, large())]);
                observations.checks.remove(&Check::HalfStep);
                observations
            },
            "inconclusive (measurement: no thinning; missing dt/2)",
        ),
        (
            "a reversal is checked alike",
            without(&around(-0.5, 0.1, 24), &[Check::HalfStep]),
            "refuted (reversed)",
        ),
    ]);
}
