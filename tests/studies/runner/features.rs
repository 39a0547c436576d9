//! `snowlab features`: costs by turns, effects from the tables, and what it says where there is nothing to measure.

use super::{Desk, rows, study};
use snowlab_study::statistics::{mean, standard_deviation};

/// Fixed steps beside steps half as long, and steps as long as waves allow beside fixed ones.
const PAIRS: &str = r#"
[[arm]]
id = "usual"
[[arm]]
id = "short"
set = { "numerics.fixed_step" = 1e-4 }
[[arm]]
id = "shorter"
set = { "numerics.fixed_step" = 5e-5 }
[[feature]]
name = "half the step"
on = "shorter"
off = "short"
[[feature]]
name = "steps of the length waves allow"
on = "usual"
off = "short"
"#;

fn desk(rest: &str) -> Desk {
    Desk::with(&[("study.toml", &study(rest).replace("count = 2\n", "count = 3\n"))])
}

fn number(row: &std::collections::BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("`{column}` in {row:?}"))
}

#[test]
fn costs_and_effects_are_those_of_the_cases() {
    let desk = desk(PAIRS);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "features study.toml --rounds 2");
    let cases = rows(&desk.read("results/tiny/cases.csv"));
    let found = rows(&desk.read("results/tiny/features.csv"));
    assert_eq!(found.len(), 2);
    for row in &found {
        let of = |arm: &str, column: &str| -> Vec<f64> {
            cases.iter().filter(|case| case["arm"] == row[arm]).map(|case| number(case, column)).collect()
        };
        assert_eq!(row["rounds"], "2");
        assert!(number(row, "time_least") <= number(row, "time"), "{row:?}");
        assert!(number(row, "time") <= number(row, "time_greatest"), "{row:?}");
        let steps = of("on", "steps")[0] / of("off", "steps")[0];
        assert!((number(row, "steps") / steps - 1.0).abs() < 1e-12, "{row:?}: {steps}");
        let (on, off) = (of("on", "ln_extent"), of("off", "ln_extent"));
        let changes: Vec<f64> = on.iter().zip(&off).map(|(on, off)| on - off).collect();
        let effect = mean(&changes).unwrap() / standard_deviation(&off).unwrap();
        assert!(
            (number(row, "ln_extent") - effect).abs() < 1e-9 * effect.abs().max(1.0),
            "{row:?}: {effect}"
        );
        assert!(number(row, "ln_extent_lower") < number(row, "ln_extent"), "{row:?}");
        assert!(number(row, "ln_extent") < number(row, "ln_extent_upper"), "{row:?}");
    }
    // Half as long to within the last step, and the longer run takes longer.
    assert!((number(&found[0], "steps") - 2.0).abs() < 0.02, "{found:?}");
    assert!(number(&found[0], "time") > 1.0, "{found:?}");
}

#[test]
fn it_says_what_is_missing() {
    let unnamed = desk("[[arm]]\nid = \"usual\"\n");
    let told = unnamed.expect(2, "features study.toml");
    assert!(told.contains("study.toml: has no [[feature]]; name pairs of arms"), "{told}");
    let unrun = desk(PAIRS);
    let told = unrun.expect(2, "features study.toml");
    assert!(told.contains("nothing has been run; run `snowlab run study.toml` first"), "{told}");
    let typo = desk(&PAIRS.replace("off = \"short\"", "off = \"shrt\""));
    let told = typo.expect(2, "features study.toml");
    assert!(told.contains("shrt"), "{told}");
}

#[test]
fn a_scene_takes_as_many_steps_as_are_asked_for() {
    let desk = Desk::with(&[("scene.toml", super::SCENE)]);
    desk.expect(0, "steps scene.toml --count 3");
    let told = desk.expect(2, "steps none.toml --count 3");
    assert!(told.contains("none.toml"), "{told}");
}
