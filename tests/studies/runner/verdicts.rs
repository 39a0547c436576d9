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

/// Half the step and the other transfer are conditions, which count for the claims whose arms they run again.
#[test]
fn checks_are_made_of_the_arms_under_them() {
    let rerun = |id: &str, arms: &str, by: &str, set: &str| {
        format!("[[condition]]\nid = \"{id}\"\narms = [{arms}]\ncheck = \"{by}\"\nset = {{ {set} }}\n")
    };
    let half = "\"numerics.wave_courant\" = 0.1, \"numerics.advective_courant\" = 0.1";
    let reruns = [
        rerun("half", "\"random\", \"elastic\"", "half-step", half),
        rerun("apic", "\"random\"", "other-transfer", "\"numerics.transfer\" = \"apic\""),
    ];
    let text = study(&[ARMS, &reruns.concat(), OTHER_CLAIM].concat());
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    // The elastic arm is elastic under the condition too, whose `set` stands behind its own.
    let cases = rows(&desk.read("results/tiny/cases.csv"));
    let case = |arm: &str| cases.iter().find(|case| case["arm"] == arm).unwrap();
    assert_eq!(case("elastic@half")["plastic_loss"], "0.0");
    let steps = |arm: &str| case(arm)["steps"].parse::<f64>().unwrap();
    assert!(steps("elastic@half") > 1.5 * steps("elastic"), "its steps are shorter");
    let claims = rows(&desk.read("results/tiny/claims.csv"));
    let checks = |id: &str| claims.iter().find(|row| row["claim"] == id).unwrap()["checks"].clone();
    let made = checks("elastic-holds");
    assert!(made.contains("dt/2") && made.contains("(n = 2)"), "{made}");
    assert!(!made.contains("other transfer"), "one arm's alone says nothing: {made}");
    assert!(!checks("irregular-breaks-more").contains("dt/2"), "the lattice has not been run again");
}

/// What a claim is measured by may be its own: then it has the numbers of a study that measures all by that.
#[test]
fn a_claim_is_measured_by_its_own_spacing() {
    let rows_by = |measure: &str, claim: &str| {
        let text = study(ARMS).replace("largest_spacing = 0.05", &format!("largest_spacing = {measure}"));
        let desk =
            Desk::with(&[("study.toml", &text.replace("[[claim]]\n", &format!("[[claim]]\n{claim}")))]);
        desk.expect(0, "run study.toml --jobs 2");
        desk.expect(0, "report study.toml");
        let row = rows(&desk.read("results/tiny/claims.csv")).remove(0);
        ["largest_spacing", "primary", "effect", "checks", "blocks", "lost_blocks"]
            .map(|column| row[column].clone())
    };
    let by_study = rows_by("0.1", "");
    assert_eq!(by_study[0], "0.1");
    assert_eq!(by_study[4..], ["2", "0"]);
    // By the last, under the distance of neighbours, the balls are dust from the beginning: whether the claim's own sees them is another matter.
    for measure in ["0.05", "0.005"] {
        assert_eq!(rows_by(measure, "largest_spacing = 0.1\n"), by_study, "{measure}");
    }
    assert_ne!(rows_by("0.05", "")[3], by_study[3], "the spacing has a say in this scene");
}

/// Where grids differ, each arm is read as well by someone who has it alone: all particles, by the spacing of its own grid. Of the weak balls that of block 1
/// has a crumb by the finer grid and none by the coarser.
#[test]
fn arms_on_other_grids_are_read_by_their_own_grid_as_well() {
    let arms = r#"
[[arm]]
id = "weak"
set = { "body.0.material" = { kind = "snow", critical_stretch = 1e-4, hardening = 2.0 } }
[[arm]]
id = "stiff"
[[arm]]
id = "coarse"
set = { "numerics.spacing" = 0.1, "body.0.placement.count" = 200 }
[[claim]]
id = "strength"
sentence = "Weak snow breaks more."
contrast = { paired = { treated = "weak", control = "stiff" } }
[[claim]]
id = "grid"
sentence = "The grid decides."
contrast = { paired = { treated = "coarse", control = "weak" } }
"#;
    let by = |measure: &str| {
        let text = study(arms)
            .replace("largest_spacing = 0.05", &format!("largest_spacing = {measure}\nlink_ratio = 1.0"))
            .replace("[scene.numerics]", "[scene.numerics]\nflip_reference_step = 5e-4")
            .replace("end = 1.0", "end = 6.0");
        let desk = Desk::with(&[("study.toml", &text)]);
        desk.expect(0, "run study.toml --jobs 2");
        desk.expect(0, "report study.toml");
        (rows(&desk.read("results/tiny/cases.csv")), rows(&desk.read("results/tiny/robustness.csv")))
    };
    let of = |cases: &[std::collections::BTreeMap<String, String>], arm: &str| -> f64 {
        let own = cases.iter().filter(|case| case["arm"] == arm);
        let values: Vec<f64> = own.map(|case| case["ln_neff"].parse().unwrap()).collect();
        assert_eq!(values.len(), 2);
        values.iter().sum::<f64>() / 2.0
    };
    let (by_coarse, readings) = by("0.1");
    let (by_fine, _) = by("0.05");
    let own: Vec<_> =
        readings.iter().filter(|row| row["variation"] == "each by its own grid, all particles").collect();
    assert_eq!(own.len(), 1, "the grids of the other claim's arms are the same");
    assert_eq!(own[0]["claim"], "grid");
    let effect: f64 = own[0]["effect"].parse().unwrap();
    assert!((effect - (of(&by_coarse, "coarse") - of(&by_fine, "weak"))).abs() < 1e-9, "{effect}");
    assert!(
        (of(&by_fine, "weak") - of(&by_coarse, "weak")).abs() > 1e-3,
        "the ruler has a say in this scene"
    );
}

/// A claim is read under the conditions that have all its arms; each effect is that of the arms' values there.
#[test]
fn claims_are_read_under_other_conditions() {
    let condition = "[[condition]]\nid = \"slow\"\nlabel = \"5 m/s\"\narms = [\"random\", \"elastic\"]\nblocks = 8\n\
        set = { \"body.0.velocity\" = [0.0, -5.0] }\narm_set = { elastic = { \"body.0.material.young\" = 1e5 } }\n";
    let profile = "[profile.part]\narms = [\"random\", \"elastic\"]\n[profile.both]\narms = [\"random\", \"elastic\"]\nconditions = [\"slow\"]\n";
    let text = study(&[ARMS, condition, OTHER_CLAIM, profile].concat()).replace("count = 2\n", "count = 8\n");
    let desk = Desk::with(&[("study.toml", &text.replace("end = 1.0", "end = 0.5"))]);
    assert!(
        desk.expect(0, "plan study.toml --profile part").contains("16 cases"),
        "no condition is run with arms named"
    );
    desk.expect(0, "run study.toml --profile both --jobs 2");
    let printed = desk.expect(0, "report study.toml --profile both");
    assert!(printed.contains("elastic-holds"), "{printed}");
    let cases = rows(&desk.read("results/tiny/both/cases.csv"));
    assert_eq!(cases.len(), 32);
    let robustness = rows(&desk.read("results/tiny/both/robustness.csv"));
    assert!(
        robustness.iter().all(|row| row["claim"] == "elastic-holds"),
        "the other claim's arms are not all there"
    );
    let row = |name: &str| {
        robustness.iter().find(|row| row["variation"] == name).unwrap_or_else(|| panic!("{name}"))
    };
    // As many particles in all: the endpoint is that of the cases.
    let effect = |treated: &str, control: &str| {
        let values = |arm: &str| -> Vec<f64> {
            cases
                .iter()
                .filter(|case| case["arm"] == arm)
                .map(|case| case["ln_neff"].parse().unwrap())
                .collect()
        };
        let (treated, control) = (values(treated), values(control));
        treated.iter().zip(&control).map(|(a, b)| a - b).sum::<f64>() / treated.len() as f64
    };
    let number =
        |row: &std::collections::BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    let (primary, slow) = (row("as claimed"), row("5 m/s"));
    assert_eq!([&primary["kind"], &slow["kind"], &slow["blocks"]], ["primary", "condition", "8"]);
    assert!((number(primary, "effect") - effect("random", "elastic")).abs() < 1e-9);
    assert!((number(slow, "effect") - effect("random@slow", "elastic@slow")).abs() < 1e-9);
    assert!(
        number(slow, "lower") <= number(slow, "effect") && number(slow, "effect") <= number(slow, "upper")
    );
    for name in
        ["link 3h", "link 4h", "without dust", "flood fill", "bond graph", "earlier time", "no thinning"]
    {
        assert_eq!(row(name)["kind"], "measurement", "{name}");
    }
    let plan = rows(&desk.read("results/tiny/both/replicates.csv"));
    assert_eq!(plan[0]["pilot_blocks"], "8");
    let page = desk.read("results/tiny/both/report.html");
    assert!(["What the findings hang on", "5 m", "Power"].iter().all(|words| page.contains(words)));
}

/// A path of `density-noise` is told with its ratio, and judged by the same rules as a claim.
#[test]
fn noise_on_a_lattice_is_held_against_random_placement() {
    let noise = "[[arm]]\nid = \"noisy\"\n[arm.set]\n\"body.0.placement\" = { kind = \"lattice\", count = 300 }\n\
        \"body.0.heterogeneity\" = { kind = \"independent\", of = \"weight\", spread = 1.0 }\n\
        [[density_noise]]\nnoisy = \"noisy\"\nlattice = \"lattice\"\nrandom = \"random\"\n";
    let desk = Desk::with(&[("study.toml", &study(&[ARMS, noise].concat()))]);
    desk.expect(0, "run study.toml --jobs 2");
    let printed = desk.expect(0, "report study.toml");
    assert!(printed.contains("density-noise, noisy: not-run (n < 12); n = "), "{printed}");
    let table = rows(&desk.read("results/tiny/density_noise.csv"));
    assert_eq!(
        [&table[0]["noisy"], &table[0]["lattice"], &table[0]["random"]],
        ["noisy", "lattice", "random"]
    );
    assert!(desk.read("results/tiny/report.html").contains("Density noise"));
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
