//! Reports of studies in which there is little or nothing to draw.

use super::{ARMS, Desk, STOPPING_ARM, rows, study};

#[test]
fn a_study_of_one_block_without_claims_has_its_charts() {
    let text = study("[[arm]]\nid = \"random\"\n").replace("count = 2\n", "count = 1\n");
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 1");
    let printed = desk.expect(0, "report study.toml");
    assert!(printed.contains("figures/link-curves.png"), "{printed}");
}

/// Endpoints of all arms against the numbers of one axis, by the words that the study has for it.
#[test]
fn what_a_sweep_does_is_drawn() {
    let sweep =
        "[[sweep]]\nname = \"flip_step\"\npath = \"numerics.flip_reference_step\"\nvalues = [1e-5, 1e-4]\n";
    let words = "axis_label = \"steps <of [s]\"\n";
    let arms = "[[arm]]\nid = \"random\"\n";
    for (sweep, said) in [(sweep.to_string(), "flip_step"), ([sweep, words].concat(), "steps &lt;of [s]")] {
        let desk = Desk::with(&[("study.toml", &study(&[arms, &sweep].concat()))]);
        desk.expect(0, "run study.toml --jobs 2");
        let printed = desk.expect(0, "report study.toml");
        assert!(printed.contains("figures/flip-step.png"), "{printed}");
        assert!(desk.read("results/tiny/report.html").contains(&format!("Fragments along {said}")));
    }
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

/// In space as in the plane: a picture of each arm at each instant, and each says what it shows.
#[test]
fn frames_of_every_arm_are_shown() {
    let space = study(&[ARMS, STOPPING_ARM].concat())
        .replace("[scene.numerics]", "[scene]\ndimension = 3\n[scene.numerics]")
        .replace("[0.0, 0.3]", "[0.0, 0.3, 0.0]")
        .replace("[0.0, -8.0]", "[0.0, -8.0, 0.0]")
        .replace("[0.0, 0.0]", "[0.0, 0.0, 0.0]")
        .replace("[0.0, 1.0]", "[0.0, 1.0, 0.0]");
    for (text, of_space) in [(study(&[ARMS, STOPPING_ARM].concat()), false), (space, true)] {
        let desk = Desk::with(&[("study.toml", &text)]);
        desk.expect(3, "run study.toml --jobs 2");
        desk.expect(0, "report study.toml");
        let frames = rows(&desk.read("results/tiny/frames.csv"));
        let first = |arm: &str| frames.iter().filter(|row| row["arm"] == arm && row["block"] == "1").count();
        let page = desk.read("results/tiny/report.html");
        assert_eq!(page.matches("<figure class=\"strip\"").count(), 3, "the arm that stopped has none");
        for arm in ["random", "lattice", "elastic"] {
            assert!(first(arm) > 2);
            let said = page.matches(&format!("alt=\"{arm}, ")).count();
            assert_eq!(said, first(arm), "{arm}: a picture a frame");
        }
        assert!(page.contains("0.0 R&#x2f;v after contact: 1 fragment, largest 100\u{a0}% of the mass.\""));
        assert_eq!(page.contains("seen from before the walls"), of_space);
    }
}

/// Studies without results are named; a file that is no study is an error.
#[test]
fn an_index_is_of_what_there_is() {
    let other = study(ARMS).replace("\"tiny\"", "\"other\"") + "[profile.short]\narms = [\"random\"]\n";
    let desk =
        Desk::with(&[("study.toml", &study(ARMS)), ("other.toml", &other), ("broken.toml", "name = 3")]);
    desk.expect(0, "index study.toml other.toml");
    assert!(desk.read("results/index.html").contains("Without results: tiny, other."));
    desk.expect(0, "run other.toml --profile short --jobs 2");
    desk.expect(0, "index study.toml other.toml");
    let page = desk.read("results/index.html");
    assert!(page.contains("No report has been written."), "tables alone");
    assert!(
        page.contains("other&#x2f;short&#x2f;cases.csv")
            && page.contains(", profile short")
            && page.contains("2 cases")
    );
    desk.expect(0, "report other.toml --profile short");
    desk.expect(0, "index study.toml other.toml");
    let page = desk.read("results/index.html");
    assert!(
        page.contains("href=\"other&#x2f;short&#x2f;report.html\"")
            && page.contains("Without results: tiny.")
    );
    assert!(page.contains("src=\"other&#x2f;short&#x2f;figures&#x2f;"), "a figure");
    assert!(desk.expect(2, "index broken.toml").contains("broken.toml"));
    assert!(desk.expect(2, "index absent.toml").contains("absent.toml"));
    desk.expect(2, "index");
}
