//! An axis whose points fill a box of factors.

use snowlab_study::spec::scene::{MaterialSpec, VoidSpec};
use snowlab_study::sweep::Study;

use super::{Desk, rows};

const SAMPLED: &str = r#"
[[arm]]
id = "solid"
[[arm]]
id = "voids"
set = { "body.0.voids" = { kind = "circles", mean_radius = 0.04, judged_at = 0.01, gap = 0.01 } }
[[arm]]
id = "apart"
[[sweep]]
name = "point"
arms = ["solid", "voids"]
[sweep.sample]
points = 16
seed = 3
[[sweep.sample.factor]]
name = "speed"
path = "body.0.velocity"
range = [2.0, 12.0]
scale = "logarithmic"
along = [0.0, -1.0]
[[sweep.sample.factor]]
name = "void_porosity"
path = "body.0.voids.porosity"
range = [0.05, 0.3]
arms = ["voids"]
[[sweep.sample.factor]]
name = "xi"
path = "body.0.material.hardening"
range = [5.0, 15.0]
"#;

/// The usual study, whose ball names its material.
fn study(rest: &str) -> String {
    super::study(rest).replace("[[scene.body]]\n", "[[scene.body]]\nmaterial = { kind = \"snow\" }\n")
}

fn expanded(text: &str) -> Study {
    Study::parse(text, None).unwrap()
}

#[test]
fn points_fill_the_box_and_are_set() {
    let study = expanded(&study(SAMPLED));
    assert_eq!(study.cases.len(), 2 * (16 + 16 + 1));
    let of =
        |arm: &str| study.cases.iter().filter(|case| case.arm == arm && case.block == 1).collect::<Vec<_>>();
    for case in of("voids") {
        let number = |name: &str| case.number(name).unwrap();
        assert_eq!(case.scene.body[0].velocity, [0.0, -number("speed")]);
        let Some(VoidSpec::Circles(voids)) = &case.scene.body[0].voids else { panic!("voids") };
        assert_eq!(voids.porosity, number("void_porosity"));
        let MaterialSpec::Snow { hardening, .. } = case.scene.body[0].material else { panic!("snow") };
        assert_eq!(hardening, number("xi"));
    }
    for case in of("solid") {
        assert_eq!(case.number("void_porosity"), None, "the factor is of the other arm");
    }
    assert_eq!(of("apart")[0].point().count(), 0);
    // Of sixteen points of such a sequence one lies in each sixteenth of every factor's range.
    let mut strata: Vec<f64> =
        of("voids").iter().map(|case| (16.0 * (case.number("xi").unwrap() - 5.0) / 10.0).floor()).collect();
    strata.sort_by(f64::total_cmp);
    strata.dedup();
    assert!(strata.len() >= 15, "four digits may move one over an edge: {strata:?}");
    // The median of a range that is spread in the logarithm is the geometric mean.
    let below = of("solid").iter().filter(|case| case.number("speed").unwrap() < 24.0_f64.sqrt()).count();
    assert!((7..=9).contains(&below), "{below}");
}

#[test]
fn more_points_begin_with_the_same() {
    let more = expanded(&study(&SAMPLED.replace("points = 16", "points = 32")));
    let few = expanded(&study(SAMPLED));
    let speeds = |study: &Study| -> Vec<f64> {
        study
            .cases
            .iter()
            .filter(|c| c.arm == "solid" && c.block == 1)
            .map(|c| c.number("speed").unwrap())
            .collect()
    };
    assert_eq!(speeds(&more)[..16], speeds(&few));
    let other = expanded(&study(&SAMPLED.replace("seed = 3", "seed = 4")));
    assert_ne!(speeds(&other), speeds(&few));
}

#[test]
fn factors_are_columns_of_the_tables() {
    let text = study(SAMPLED).replace("points = 16", "points = 2").replace("count = 2\n", "count = 1\n");
    let desk = Desk::with(&[("study.toml", &text.replace("end = 1.0", "end = 0.2"))]);
    desk.expect(0, "run study.toml --jobs 2");
    let cases = rows(&desk.read("results/tiny/cases.csv"));
    assert_eq!(cases.len(), 5);
    let voids: Vec<_> = cases.iter().filter(|row| row["arm"] == "voids").collect();
    assert!(
        voids.iter().all(|row| !row["speed"].is_empty() && !row["void_porosity"].is_empty()),
        "{voids:?}"
    );
    assert!(!cases[0].contains_key("point"), "the axis itself is no column");
    let summary = rows(&desk.read("results/tiny/summary.csv"));
    assert!(summary[0].contains_key("xi"), "{summary:?}");
}
