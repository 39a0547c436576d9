//! The report: self-contained, complete, and safe against what stands in names.

use snowlab_study::figure::Drawing;
use snowlab_study::figure::forest::{self, Forest, Outcome, Row};
use snowlab_study::report::{
    ReportArm, ReportData, ReportError, ReportFact, ReportFailure, ReportFigure, ReportOutcome, ReportTable,
    ReportVerdict, html,
};

fn drawing() -> Drawing {
    let row = |claim, effect: f64, half: f64, verdict, outcome| Row {
        claim,
        contrast: "treated \u{2212} control",
        effect: Some(effect),
        interval: Some([effect - half, effect + half]),
        verdict,
        outcome,
    };
    let rows = [
        row("coarse-breaks-more", 0.62, 0.21, "supported", Outcome::Supported),
        row("circular-voids-finer", 0.05, 0.12, "refuted (smaller than 1.25\u{d7})", Outcome::Refuted),
        row("ellipsoidal-voids-finer", 0.3, 0.35, "inconclusive", Outcome::Inconclusive),
    ];
    let figure = Forest { title: "", label: "difference of A", delta: 1.25_f64.ln(), rows: &rows, note: "" };
    forest::forest(&figure).expect("the data is sound")
}

fn words(list: &[&str]) -> Vec<String> {
    list.iter().map(|word| (*word).to_owned()).collect()
}

fn example() -> ReportData {
    let verdict =
        |claim: &str, sentence: &str, effect: &str, interval: &str, verdict: &str, outcome| ReportVerdict {
            claim: claim.into(),
            sentence: sentence.into(),
            effect: effect.into(),
            interval: interval.into(),
            verdict: verdict.into(),
            outcome,
            conditions: words(&["24 blocks, 5 m/s, h = 5 mm", "link 3 h: same; flood fill: same"]),
        };
    let figure = |title: &str| {
        ReportFigure {
        png: drawing().png(),
        title: title.into(),
        caption: "Mean effect of each claim on A = ln N_eff with its simultaneous 99 % interval. The grey zone holds \
                  effects smaller than a ratio of 1.25."
            .into(),
        alternative: "Forest plot: coarse-breaks-more lies right of the grey zone, the other two touch it.".into(),
    }
    };
    let fact = |name: &str, value: &str| ReportFact { name: name.into(), value: value.into() };
    ReportData {
        title: "Placement and the breaking of snowballs".into(),
        subtitle: "Four snowballs of Park & Shen (2017), measured with uncertainty.".into(),
        question: words(&[
            "Does the placement of particles decide how a simulated snowball breaks? Four arms are \
            dropped on a floor and the fragments are counted in the same metres.",
        ]),
        caveats: words(&[
            "The paper gives no grid spacing, time step, speed or friction. \u{201c}Refuted\u{201d} \
            reads: not reproduced under these conditions.",
        ]),
        arms: vec![
            ReportArm {
                name: "random-5k".into(),
                description: "5,000 particles at random".into(),
                cases: "24 of 24".into(),
            },
            ReportArm {
                name: "random-30k".into(),
                description: "30,000 particles at random".into(),
                cases: "23 of 24".into(),
            },
        ],
        verdicts: vec![
            verdict(
                "coarse-breaks-more",
                "5k random has more crack sites than 30k random.",
                "0.62 (1.86\u{d7})",
                "[0.41, 0.83]",
                "supported",
                ReportOutcome::Supported,
            ),
            verdict(
                "circular-voids-finer",
                "Circular voids give much finer fragments.",
                "0.05 (1.05\u{d7})",
                "[\u{2212}0.07, 0.17]",
                "refuted (smaller than 1.25\u{d7})",
                ReportOutcome::Refuted,
            ),
            verdict(
                "ellipsoidal-voids-finer",
                "Ellipsoidal voids likewise.",
                "0.30 (1.35\u{d7})",
                "[\u{2212}0.05, 0.65]",
                "inconclusive",
                ReportOutcome::Inconclusive,
            ),
            verdict(
                "stencil-ratio",
                "Sensitive to particles per grid stencil.",
                "",
                "",
                "not-run (7 of 12 blocks)",
                ReportOutcome::NotRun,
            ),
        ],
        figures: vec![figure("Claims"), figure("Controls")],
        tables: vec![ReportTable {
            title: "Summary".into(),
            note: "Mean over blocks with its 95 % interval.".into(),
            columns: words(&["arm", "A = ln N_eff", "D", "N_f", "crack length [m]"]),
            rows: vec![
                words(&[
                    "random-5k",
                    "0.82 \u{b1} 0.10",
                    "0.31 \u{b1} 0.04",
                    "3.1 \u{b1} 0.4",
                    "2.7 \u{b1} 0.3",
                ]),
                words(&[
                    "random-30k",
                    "0.20 \u{b1} 0.08",
                    "0.11 \u{b1} 0.03",
                    "1.8 \u{b1} 0.3",
                    "1.2 \u{b1} 0.2",
                ]),
            ],
        }],
        failures: vec![ReportFailure {
            case: "random-30k/block-17".into(),
            status: "stopped".into(),
            reason: "time step 3.1e-9 s below the least allowed 1e-8 s at t = 0.083 s".into(),
        }],
        provenance: vec![
            fact("git revision", "9f3fa1c"),
            fact("rustc", "1.95.0"),
            fact("study digest (BLAKE3)", "a1e6c7b15d0f4f2e9b8a7c6d5e4f30211a2b3c4d5e6f708192a3b4c5d6e7f809"),
            fact("seeds", "1\u{2013}24"),
        ],
    }
}

#[test]
fn a_report_needs_nothing_else() {
    let page = html(&example()).expect("the data is sound");
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    std::fs::create_dir_all(&folder).expect("the target directory can be written");
    std::fs::write(folder.join("report.html"), &page).expect("the target directory can be written");
    assert_eq!(page, html(&example()).expect("the data is sound"), "same data, same bytes");
    assert!(page.contains("default-src 'none'; img-src data:; style-src 'unsafe-inline'"));
    for external in ["http://", "https://", "src=\"/", "<script", "<link", "@import", "url(", "<iframe"] {
        assert!(!page.contains(external), "the page refers to {external}");
    }
    let sources = page.matches(" src=\"").count();
    assert_eq!(sources, page.matches(" src=\"data:image/png;base64,").count());
    assert_eq!(sources, 2);
    assert_eq!(page.matches(" alt=\"Forest plot").count(), 2, "every figure has its words");
    assert!(page.contains("width=\"1600\""), "the width is read from the PNG header");
}

#[test]
fn every_section_is_there_and_filled() {
    let page = html(&example()).expect("the data is sound");
    for id in ["question", "verdicts", "figures", "tables", "failures", "provenance"] {
        assert!(page.contains(&format!("<section id=\"{id}\">")), "section {id} is missing");
        assert!(page.contains(&format!("href=\"#{id}\"")), "nothing leads to section {id}");
    }
    for text in
        ["block-17", "9f3fa1c", "[0.41, 0.83]", "link 3 h: same", "class=\"not-run\"", "1.2 \u{b1} 0.2"]
    {
        assert!(page.contains(text), "{text} is missing");
    }
    let empty = html(&ReportData::default()).expect("an empty study has a report");
    assert!(empty.contains("Every case ended without a failure."));
}

#[test]
fn names_are_escaped_everywhere() {
    let evil = "<b onload=\"x\">&'</b>";
    let mut data = example();
    data.title = evil.into();
    data.arms[0].name = evil.into();
    data.verdicts[0].claim = evil.into();
    data.verdicts[0].conditions[0] = evil.into();
    data.figures[0].alternative = evil.into();
    data.figures[0].caption = evil.into();
    data.tables[0].rows[0][0] = evil.into();
    data.failures[0].reason = evil.into();
    data.provenance[0].value = evil.into();
    let page = html(&data).expect("the data is sound");
    assert!(!page.contains("<b onload"), "markup in a name reached the page");
    assert_eq!(
        page.matches("&lt;b onload=&quot;x&quot;&gt;&amp;&#x27;").count(),
        10,
        "title twice, eight others"
    );
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let mut data = example();
    data.figures[1].alternative = " ".into();
    assert!(matches!(html(&data), Err(ReportError::NoAlternative { number: 2, .. })));
    let mut data = example();
    data.figures[0].png.truncate(10);
    assert!(matches!(html(&data), Err(ReportError::NotPng { number: 1, length: 10, .. })));
    let mut data = example();
    data.tables[0].rows[1].pop();
    assert!(matches!(html(&data), Err(ReportError::RaggedTable { row: 2, expected: 5, found: 4, .. })));
}
