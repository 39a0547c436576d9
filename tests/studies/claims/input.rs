//! Claims as they stand in a study file, and what is refused.

use serde::Deserialize;
use snowlab_study::claims::*;

use super::arms::*;

#[derive(Deserialize)]
struct File {
    claim: Vec<Claim>,
}

const FAMILY: &str = r#"
[[claim]]
id = "coarse-breaks-more"
sentence = "a snowball of 5k random points shows more crack sites than one of 30k"
contrast = { paired = { treated = "random-5k", control = "random-30k" } }

[[claim]]
id = "homogenised"
sentence = "more points, fewer cracks"
contrast = { trend = { arms = [
    { arm = "random-5k", particles = 5000 },
    { arm = "random-30k", particles = 30000 },
] } }

[[claim]]
id = "stencil-ratio"
sentence = "sensitive to particles per grid stencil"
contrast = { range = { arms = ["ppc-1", "ppc-8", "ppc-48"] } }

[[claim]]
id = "regular-placement"
sentence = "only random placement cares for N"
contrast = { weighted = { weights = { r5 = 1, r30 = -1, j5 = -1, j30 = 1 } } }
"#;

#[test]
fn claims_are_lines_of_a_study_file() {
    let file: File = toml::from_str(FAMILY).unwrap();
    assert!(file.claim.iter().all(|claim| claim.validate().is_ok()));
    let arms: Vec<usize> = file.claim.iter().map(|claim| claim.arms().len()).collect();
    assert_eq!(arms, [2, 2, 3, 4]);
    let unknown = FAMILY.replace("treated =", "treatd =");
    assert!(toml::from_str::<File>(&unknown).is_err());
}

#[test]
fn contrasts_that_mean_nothing_are_refused() {
    let refused = |contrast| Claim { contrast, ..paired() }.validate().unwrap_err().to_string();
    let same = Contrast::Paired { treated: "a".into(), control: "a".into() };
    assert!(refused(same).contains(r#"arms ["a", "a"]"#));
    assert!(refused(Contrast::Range { arms: vec!["a".into()] }).contains("two or more arms"));
    let arm = |arm: &str, particles| TrendArm { arm: arm.into(), particles };
    assert!(
        refused(Contrast::Trend { arms: vec![arm("a", 5e3), arm("b", 5e3)] }).contains("[5000.0, 5000.0]")
    );
    assert!(
        refused(Contrast::Trend { arms: vec![arm("a", 5e3), arm("b", 0.0)] }).contains("positive counts")
    );
    let weights = [("a".to_string(), 1.0), ("b".to_string(), -0.5)].into();
    assert!(refused(Contrast::Weighted { weights }).contains("weights sum to 0.5"));
    let claim = Claim { contrast: Contrast::Range { arms: vec![] }, ..paired() };
    assert!(assess(&claim, &differing(&[]), 5, RESAMPLING).is_err());
}

#[test]
fn rows_that_contradict_themselves_are_refused() {
    let error = |observations: &Observations| assess(&paired(), observations, 5, RESAMPLING).unwrap_err();
    let mut twice = differing(&[0.1, 0.2]);
    twice.rows.push(case(1, "5k", 1.0));
    assert_eq!(
        error(&twice).to_string(),
        "claim `coarse-breaks-more`: block 1 has two rows of arm `5k`; give one row per case"
    );
    let mut not_finite = differing(&[0.1, 0.2]);
    not_finite.rows[2].value = f64::NAN;
    assert!(error(&not_finite).to_string().contains("block 1, arm `5k`: value = NaN"));
    let mut not_finite = differing(&[0.1, 0.2]);
    not_finite.checks.get_mut(&Check::HalfStep).unwrap()[1].damping = f64::INFINITY;
    assert!(error(&not_finite).to_string().contains("block 0, arm `30k`: damping = inf"));
    // Rows of arms the claim does not name are none of its business.
    let mut other = differing(&around(1.0, 0.05, 12));
    other.rows.push(case(0, "10k", f64::NAN));
    assert_eq!(judged(&other).verdict, Verdict::Supported);
}

#[test]
fn same_input_gives_the_same_bytes_in_any_order_of_the_rows() {
    let observations = differing(&around(0.3, 0.2, 20));
    let mut shuffled = observations.clone();
    shuffled.rows.reverse();
    let json = |o: &Observations| serde_json::to_string(&judged(o)).unwrap();
    assert_eq!(json(&observations), json(&shuffled));
}
