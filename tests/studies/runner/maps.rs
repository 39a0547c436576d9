//! A sweep of some arms alone, and a map of how its cases end beside the limit derived.

use std::collections::BTreeMap;

use snowlab_solver::timestep::wave_limit;
use snowlab_solver::{KernelKind, Transfer};

use super::{Desk, rows, study};

/// A ball at 22 m/s waves and spacing 0.05 m: fixed steps of 0.1, 0.2, 1.2 and 4 of the limit of the cubic MLS step, and an arm that is not
/// swept.
const MAPPED: &str = r#"
[[arm]]
id = "usual"
[[arm]]
id = "elastic"
label = "an elastic ball"
set = { "body.0.material" = { kind = "elastic" }, "numerics.transfer" = "mls" }
[[sweep]]
name = "share"
path = "numerics.fixed_step"
values = [2.6186e-4, 5.2372e-4, 3.1423e-3, 1.04744e-2]
numbers = [0.1, 0.2, 1.2, 4.0]
arms = ["elastic"]
[[sweep]]
name = "fall"
path = "body.0.velocity"
values = [[0.0, -1.0], [0.0, -2.0]]
numbers = [1.0, 2.0]
arms = ["elastic"]
[[map]]
id = "step"
title = "How long may a step be?"
x = "share"
y = "fall"
x_label = "dt over its limit"
"#;

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("`{column}` in {row:?}"))
}

#[test]
fn a_map_shows_the_limit_found_beside_the_limit_derived() {
    let desk = Desk::with(&[("study.toml", &study(MAPPED).replace("count = 2\n", "count = 1\n"))]);
    let printed = desk.expect(3, "run study.toml --jobs 2");
    assert!(printed.contains("9 cases, 9 to run"), "the arm that is not swept is run once: {printed}");
    let cases = rows(&desk.read("results/tiny/cases.csv"));
    let usual = &cases[0];
    assert_eq!([&usual["arm"], &usual["share"], &usual["fall"]], ["usual", "", ""]);
    let maps = rows(&desk.read("results/tiny/maps.csv"));
    assert_eq!(maps.iter().map(|row| number(row, "at")).collect::<Vec<_>>(), [1.0, 2.0]);
    for row in &maps {
        assert_eq!([&row["map"], &row["arm"], &row["x"], &row["y"]], ["step", "elastic", "share", "fall"]);
        // The steps are written with five digits.
        assert!((number(row, "derived") - 1.0).abs() < 1e-4, "{row:?}");
        assert!(number(row, "sound_to") < number(row, "fails_from"), "{row:?}");
        assert!(number(row, "sound_to_over_derived") >= 0.19, "{row:?}");
        assert!(number(row, "fails_from_over_derived") <= 4.01, "{row:?}");
        assert!(row["end"].starts_with("stopped("), "{row:?}");
    }
    desk.expect(0, "report study.toml");
    assert!(desk.path("results/tiny/figures/map-step.png").exists());
    let report = desk.read("results/tiny/report.html");
    assert!(report.contains("How long may a step be?") && report.contains("Limits found and derived"));
    let dictionary = desk.read("results/tiny/dictionary.csv");
    assert!(dictionary.contains("maps,fails_from_over_derived"), "{dictionary}");
}

/// What a study calls sound is asked of cases that ended well, and the first step of the default is half the limit.
#[test]
fn a_case_that_ended_well_may_be_unsound() {
    let sound = "sound = { metric = \"particles\", range = [0.0, 1.0], otherwise = \"crowded\" }\n";
    let text = study(&[MAPPED, sound].concat()).replace("count = 2\n", "count = 1\n");
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(3, "run study.toml --jobs 2");
    for row in rows(&desk.read("results/tiny/maps.csv")) {
        assert_eq!([&row["sound_to"], &row["end"]], ["", "ok, but crowded"]);
    }
}

/// A step beyond its limit is told of with the limit there, by how much it is beyond, and what to do.
#[test]
fn a_stop_names_the_limit_and_the_remedy() {
    let arm = "[[arm]]\nid = \"long\"\nset = { \"body.0.material\" = { kind = \"elastic\" }, \"numerics.fixed_step\" = 0.02 }\n";
    let desk = Desk::with(&[("study.toml", &study(arm).replace("count = 2\n", "count = 1\n"))]);
    let printed = desk.expect(3, "run study.toml --jobs 1");
    let told = printed.split("the stability limit there is ").nth(1).unwrap_or_else(|| panic!("{printed}"));
    let words: Vec<&str> = told.split_whitespace().collect();
    let (limit, share): (f64, f64) = (words[0].parse().unwrap(), words[4].parse().unwrap());
    // c >= 22.048 m/s: that of the material at rest.
    let flip = Transfer::Flip(snowlab_solver::FlipShare::PerStep(0.95));
    let at_rest = wave_limit(KernelKind::Cubic, flip) * 0.05 / 22.0479;
    assert!(limit > 0.2 * at_rest && limit <= 1.001 * at_rest, "{limit} of {at_rest}: {printed}");
    // The last step before a frame may be shorter than was asked for.
    assert!(share > 1.0 && share * limit < 1.01 * 0.02, "{printed}");
    assert!(printed.contains("make `numerics.fixed_step` shorter, or leave it out"), "{printed}");
}
