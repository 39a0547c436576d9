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

/// What the report warns of is what the study file says.
#[test]
fn caveats_come_from_the_study() {
    let text = study(ARMS).replace("[blocks]", "caveats = [\"Only at <8 m/s>.\"]\n[blocks]");
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    let page = desk.read("results/tiny/report.html");
    assert!(page.contains("Only at &lt;8 m&#x2f;s&gt;.") && !page.contains("PS17 gives no"), "the caveats");
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
