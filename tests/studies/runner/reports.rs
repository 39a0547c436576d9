//! Reports of studies in which there is little or nothing to draw.

use super::{ARMS, Desk, rows, study};

#[test]
fn a_study_of_one_block_without_claims_has_its_charts() {
    let text = study("[[arm]]\nid = \"random\"\n").replace("count = 2\n", "count = 1\n");
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 1");
    let printed = desk.expect(0, "report study.toml");
    assert!(printed.contains("figures/link-curves.png"), "{printed}");
}

/// At 0.4 h the ball is dust at the start: no case can be used, so no arm can be drawn.
#[test]
fn a_study_whose_gates_all_fail_has_a_report_without_charts() {
    let text = study(ARMS).replace("[measure]\n", "[measure]\nlink_ratio = 0.4\n");
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 2");
    assert!(rows(&desk.read("results/tiny/cases.csv")).iter().all(|case| case["gate"] == "false"));
    let printed = desk.expect(0, "report study.toml");
    assert!(!printed.contains("link-curves") && printed.contains("report.html"), "{printed}");
    assert!(desk.read("results/tiny/report.html").contains("metric-invalid"));
}
