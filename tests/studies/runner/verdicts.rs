//! Verdicts from file to table.

use super::{ARMS, Desk, rows, study};

/// A second claim of the family.
const OTHER_CLAIM: &str = r#"
[[claim]]
id = "elastic-holds"
sentence = "Snow breaks into more pieces than an elastic ball."
contrast = { paired = { treated = "random", control = "elastic" } }
"#;

/// Each claim and control is calibrated by itself: arms of the same particles agree, a lattice holds together at stretches
/// at which random points of the same number fall apart.
#[test]
fn arms_that_seem_to_break_at_other_stretches_are_compared_by_flood_fill() {
    let text = study(&[ARMS, &OTHER_CLAIM.replace("claim", "control")].concat());
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 2");
    let printed = desk.expect(0, "report study.toml");
    let claims = rows(&desk.read("results/tiny/claims.csv"));
    let primaries: Vec<_> =
        claims.iter().map(|row| [row["claim"].as_str(), row["primary"].as_str()]).collect();
    assert_eq!(primaries, [["irregular-breaks-more", "flood fill"], ["elastic-holds", "friends-of-friends"]]);
    assert!(printed.contains("measured by flood fill; calibration by stretch does not agree"), "{printed}");
    assert!(
        printed.contains("calibration by stretch agrees at 300 particles, medians over 2 blocks: elastic")
    );
    assert!(printed.contains("figures/calibration.png"), "{printed}");
}

/// Twelve blocks are enough for a verdict, but nobody has asked at which speed the ball breaks.
#[test]
fn a_study_without_a_pilot_says_so() {
    let text = study(&[ARMS, OTHER_CLAIM].concat()).replace("count = 2\n", "count = 12\n");
    let desk = Desk::with(&[("study.toml", &text.replace("end = 1.0", "end = 0.5"))]);
    desk.expect(0, "run study.toml --jobs 2");
    let printed = desk.expect(0, "report study.toml");
    let claims = rows(&desk.read("results/tiny/claims.csv"));
    let elastic = claims.iter().find(|row| row["claim"] == "elastic-holds").unwrap();
    assert_eq!(elastic["verdict"], "inconclusive (no pilot)");
    assert_eq!(elastic["explanation"], "no pilot has looked for a speed at which the ball breaks");
    assert!(printed.contains("operating point: the study names no pilot"), "{printed}");
    assert!(printed.contains("noise floor: the study names no arm that nothing can break"), "{printed}");
}

/// Half the step and the other transfer are arms of the study, which count for the claims whose arms they run again.
#[test]
fn check_arms_are_the_checks_of_their_claims() {
    let rerun = |of: &str, by: &str, set: &str| {
        let check = format!("check = {{ of = \"{of}\", by = \"{by}\" }}");
        format!("[[arm]]\nid = \"{of}-{by}\"\n{check}\nset = {{ {set} }}\n")
    };
    let half = "\"numerics.wave_courant\" = 0.1, \"numerics.advective_courant\" = 0.1";
    let apic = "\"numerics.transfer\" = \"apic\"";
    let reruns = [
        rerun("random", "half-step", half),
        rerun("elastic", "half-step", half),
        rerun("random", "other-transfer", apic),
    ];
    let text = study(&[ARMS, &reruns.concat(), OTHER_CLAIM].concat());
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    // The elastic arm's check is elastic too: its own `set` stands behind that of the arm it checks.
    let cases = rows(&desk.read("results/tiny/cases.csv"));
    let case = |arm: &str| cases.iter().find(|case| case["arm"] == arm).unwrap();
    assert_eq!(case("elastic-half-step")["plastic_loss"], "0.0");
    let steps = |arm: &str| case(arm)["steps"].parse::<f64>().unwrap();
    assert!(steps("elastic-half-step") > 1.5 * steps("elastic"), "its steps are shorter");
    let claims = rows(&desk.read("results/tiny/claims.csv"));
    let checks = |id: &str| claims.iter().find(|row| row["claim"] == id).unwrap()["checks"].clone();
    let made = checks("elastic-holds");
    assert!(made.contains("dt/2") && made.contains("(n = 2)"), "{made}");
    assert!(!made.contains("other transfer"), "one arm's alone says nothing: {made}");
    assert!(!checks("irregular-breaks-more").contains("dt/2"), "the lattice has not been run again");
}

/// Two ids: intervals of 1 - 0.05/2, though the profile runs the arms of one claim only.
#[test]
fn a_family_is_as_large_as_the_file_says() {
    let profile = "[profile.part]\narms = [\"random\", \"lattice\"]\n";
    let desk = Desk::with(&[("study.toml", &study(&[ARMS, OTHER_CLAIM, profile].concat()))]);
    desk.expect(0, "run study.toml --profile part --jobs 2");
    desk.expect(0, "report study.toml --profile part");
    let claims = rows(&desk.read("results/tiny/part/claims.csv"));
    let ids: Vec<_> = claims.iter().map(|row| row["claim"].as_str()).collect();
    assert_eq!(ids, ["irregular-breaks-more"], "what the profile leaves out is left out");
    assert_eq!(claims[0]["confidence"], "0.975");
}
