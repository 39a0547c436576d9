//! The report: self-contained, complete, and safe against what stands in names.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};
use snowlab_study::figure::Drawing;
use snowlab_study::figure::forest::{self, Forest, Outcome, Row};
use snowlab_study::report::index::{IndexData, IndexEntry, IndexFigure, IndexTable, IndexVerdicts, index};
use snowlab_study::report::{
    EffectSize, ReportArm, ReportData, ReportError, ReportFact, ReportFailure, ReportFigure, ReportMotion,
    ReportOutcome, ReportPicture, ReportStrip, ReportTable, ReportVerdict, html,
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
            contrast: "random-5k - random-30k".into(),
            effect: effect.into(),
            size: (!effect.is_empty()).then_some(EffectSize { effect: 0.6, lower: 0.4, upper: 0.8 }),
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
    let picture = |arm: &str, when: &str| ReportPicture {
        png: drawing().paint().indexed_png(16),
        caption: format!("{when}: 3 fragments"),
        alternative: format!("{arm}, {when}: 3 fragments."),
    };
    let strip = |name: &str, instants: &[&str], shown: &[usize]| ReportStrip {
        name: name.into(),
        pictures: instants.iter().map(|when| picture(name, when)).collect(),
        shown: shown.to_vec(),
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
        smallest_effect: 1.25_f64.ln(),
        figures: vec![figure("Claims"), figure("Controls")],
        motion: ReportMotion {
            note: "One ball of each arm.".into(),
            steps: words(&["0.4 R/v before contact", "1.0 R/v after contact", "2.0 R/v after contact"]),
            strips: vec![
                strip("random-5k", &["before", "1.0 R/v", "2.0 R/v"], &[0, 1, 2]),
                strip("random-30k", &["before", "2.0 R/v"], &[0, 1, 1]),
            ],
        },
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
    for external in
        ["http://", "https://", "src=\"/", "<link", "@import", "url(", "<iframe", " style=\"", " onclick="]
    {
        assert!(!page.contains(external), "the page refers to {external}");
    }
    let sources = page.matches(" src=\"").count();
    assert_eq!(sources, page.matches(" src=\"data:image/png;base64,").count());
    assert_eq!(sources, 7, "two figures and five pictures");
    assert_eq!(page.matches(" alt=\"").count(), sources, "every image has its words");
    assert_eq!(page.matches(" alt=\"Forest plot").count(), 2);
    assert!(page.contains("width=\"1600\""), "the width is read from the PNG header");
}

/// The text of the only element of a kind.
fn only<'a>(page: &'a str, kind: &str) -> &'a str {
    let (begin, end) = (format!("<{kind}>"), format!("</{kind}>"));
    assert_eq!((page.matches(&begin).count(), page.matches(&format!("<{kind}")).count()), (1, 1), "{kind}");
    page.split_once(&begin).and_then(|(_, rest)| rest.split_once(&end)).expect("it ends").0
}

/// The words of the page's policy.
fn policy(page: &str) -> &str {
    let rest = page.split_once("http-equiv=\"Content-Security-Policy\" content=\"").expect("a policy").1;
    rest.split_once('"').expect("it ends").0
}

fn source(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

/// What the policy lets run is what stands in the page, to the byte, and nothing else.
#[test]
fn the_policy_is_of_this_very_style_and_script() {
    let page = html(&example()).expect("the data is sound");
    let expected = format!(
        "default-src 'none'; img-src data:; style-src {}; script-src {}; base-uri 'none'; form-action 'none'",
        source(only(&page, "style")),
        source(only(&page, "script"))
    );
    assert_eq!(policy(&page), expected);
}

/// Of each arm the picture of the last instant is shown where no script runs, and each instant names a picture.
#[test]
fn pictures_of_all_arms_are_there() {
    let page = html(&example()).expect("the data is sound");
    assert_eq!(page.matches("<div class=\"picture\" hidden>").count(), 3);
    assert_eq!(page.matches("<div class=\"picture\">").count(), 2);
    assert!(page.contains("data-shown=\"[0,1,1]\"") && page.contains("max=\"2\""));
    let mut data = example();
    data.motion = ReportMotion { note: "Nothing is shown.".into(), ..ReportMotion::default() };
    let page = html(&data).expect("the data is sound");
    assert!(page.contains("Nothing is shown.") && !page.contains("type=\"range\""));
}

/// The index has no script, shows figures of its folder alone and leads to each report.
#[test]
fn an_index_says_what_there_is() {
    let evil = "<b onload=\"x\">&'</b>";
    let mut entry = IndexEntry {
        title: "placement".into(),
        question: words(&[evil]),
        cases: 96,
        stopped: 2,
        verdicts: vec![IndexVerdicts { outcome: ReportOutcome::Refuted, count: 3 }],
        report: "placement/report.html".into(),
        figure: Some(IndexFigure {
            path: "placement/figures/claims.png".into(),
            alternative: "Figure of placement: claims.".into(),
        }),
        tables: vec![IndexTable { name: "cases".into(), path: "placement/cases.csv".into() }],
        ..IndexEntry::default()
    };
    let data = IndexData { entries: vec![entry.clone(), IndexEntry::default()], without: words(&["knob"]) };
    let page = index(&data).expect("the data is sound");
    assert_eq!(page, index(&data).expect("the data is sound"), "same data, same bytes");
    let style = source(only(&page, "style"));
    assert_eq!(
        policy(&page),
        format!(
            "default-src 'none'; img-src 'self' file:; style-src {style}; base-uri 'none'; form-action 'none'"
        )
    );
    for text in [
        "96 cases, 2 stopped",
        "<b>3</b> refuted",
        "Without results: knob.",
        "placement&#x2f;report.html",
        "claims.png",
    ] {
        assert!(page.contains(text), "{text} is missing");
    }
    assert!(!page.contains("<script") && !page.contains("<b onload"));
    entry.figure = Some(IndexFigure { path: "a.png".into(), alternative: " ".into() });
    let data = IndexData { entries: vec![entry], without: Vec::new() };
    assert!(matches!(index(&data), Err(ReportError::NoAlternative { .. })));
    let empty = index(&IndexData::default()).expect("an empty folder has an index");
    assert!(empty.contains("No study has been run."));
}

#[test]
fn every_section_is_there_and_filled() {
    let page = html(&example()).expect("the data is sound");
    for id in ["question", "verdicts", "frames", "figures", "tables", "failures", "provenance"] {
        assert!(page.contains(&format!("<section id=\"{id}\" ")), "section {id} is missing");
        assert!(page.contains(&format!("href=\"#{id}\"")), "nothing leads to section {id}");
    }
    for text in
        ["block-17", "9f3fa1c", "[0.41, 0.83]", "link 3 h: same", "class=\"card not-run\"", "1.2 \u{b1} 0.2"]
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
    data.motion.steps[2] = evil.into();
    data.motion.strips[0].name = evil.into();
    data.motion.strips[0].pictures[0].alternative = evil.into();
    data.motion.strips[0].pictures[0].caption = evil.into();
    data.figures[0].caption = evil.into();
    data.tables[0].rows[0][0] = evil.into();
    data.failures[0].reason = evil.into();
    data.provenance[0].value = evil.into();
    let page = html(&data).expect("the data is sound");
    assert!(!page.contains("<b onload"), "markup in a name reached the page");
    assert_eq!(
        page.matches("&lt;b onload=&quot;x&quot;&gt;&amp;&#x27;").count(),
        14,
        "title twice, twelve others; the instants for the script are JSON"
    );
}

fn said(data: &ReportData) -> String {
    html(data).expect_err("it cannot be shown").to_string()
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let mut data = example();
    data.figures[1].alternative = " ".into();
    assert_eq!(
        said(&data),
        "report: figure 2 (`Controls`) has no alternative text; say in words what it shows"
    );
    let mut data = example();
    data.figures[0].png.truncate(10);
    assert_eq!(said(&data), "report: figure 1 (`Claims`) is not a PNG file (10 bytes)");
    let mut data = example();
    data.motion.strips[1].pictures[0].alternative = String::new();
    assert!(said(&data).starts_with("report: picture 1 of arm `random-30k` has no alternative text"));
    for shown in [vec![0, 1], vec![0, 1, 2]] {
        let mut data = example();
        data.motion.strips[1].shown = shown.clone();
        let expected = format!("one of its 2 pictures for each of 3 instants, and names {shown:?}");
        assert!(said(&data).contains(&expected), "{}", said(&data));
    }
    let mut data = example();
    data.tables[0].rows[1].pop();
    assert!(matches!(html(&data), Err(ReportError::RaggedTable { row: 2, expected: 5, found: 4, .. })));
}
