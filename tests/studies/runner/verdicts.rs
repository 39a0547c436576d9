//! Verdicts from file to table.

use super::{ARMS, Desk, rows, study};

/// A second claim of the family.
const OTHER_CLAIM: &str = r#"
[[claim]]
id = "elastic-holds"
sentence = "Snow breaks into more pieces than an elastic ball."
contrast = { paired = { treated = "random", control = "elastic" } }
"#;

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
