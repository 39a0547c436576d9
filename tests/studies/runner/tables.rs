//! What the tables of a study say.

use std::collections::BTreeSet;

use snowlab_study::tables::{CASE_NUMBERS, OWN_COLUMNS};

use super::{ARMS, Desk, STOPPING_ARM, rows, study};

const SWEEP: &str = "[[arm]]\nid = \"random\"\n[[sweep]]\nname = \"speed\"\npath = \"body.0.velocity\"\n\
                     values = [[0.0, -4.0], [0.0, -8.0]]\nnumbers = [4.0, 8.0]\n";

#[test]
fn a_case_that_stops_is_a_row_and_the_study_goes_on() {
    let desk = Desk::with(&[("study.toml", &study(&[STOPPING_ARM, ARMS].concat()))]);
    let printed = desk.expect(3, "run study.toml --jobs 1");
    assert!(printed.contains("leaping block 1 stopped: particle"), "{printed}");
    let cases = rows(&desk.read("results/tiny/cases.csv"));
    assert_eq!(cases.len(), 8);
    for case in &cases {
        let stops = case["arm"] == "leaping";
        assert_eq!(case["outcome"], if stops { "stopped(step-rejected)" } else { "ok" }, "{case:?}");
        // What has not been measured is empty, not zero.
        assert_eq!(case["damage"].is_empty(), stops, "{case:?}");
        assert_eq!(case["particles"], "300");
    }
    let summary = rows(&desk.read("results/tiny/summary.csv"));
    assert!(summary.iter().all(|row| row["arm"] != "leaping"), "nothing of it can be summarised");
}

#[test]
fn a_sweep_has_its_column_in_every_table() {
    let desk = Desk::with(&[("study.toml", &study(SWEEP))]);
    desk.expect(0, "run study.toml --jobs 2");
    let cases = rows(&desk.read("results/tiny/cases.csv"));
    let points: Vec<_> = cases.iter().map(|row| (row["speed"].as_str(), row["block"].as_str())).collect();
    assert_eq!(points, [("4.0", "1"), ("4.0", "2"), ("8.0", "1"), ("8.0", "2")]);
    // R/v halves where the speed doubles.
    let unit = |row: usize| cases[row]["time_unit"].parse::<f64>().unwrap();
    assert!((unit(0) / unit(2) - 2.0).abs() < 1e-12);
    for table in ["cases", "fragments", "frames", "summary", "timings"] {
        let text = desk.read(&format!("results/tiny/{table}.csv"));
        let header: BTreeSet<&str> = text.lines().next().unwrap().split(',').collect();
        assert!(header.contains("speed"), "{table}");
        // An axis of one of these names would be there twice.
        let others: Vec<_> =
            header.iter().filter(|name| **name != "speed" && !OWN_COLUMNS.contains(name)).collect();
        assert!(others.is_empty(), "{table}: {others:?} are no names in OWN_COLUMNS");
    }
}

/// Tables, figures and report of a profile stand beside those of the study; a case that both ask for is run once.
#[test]
fn a_profile_leaves_the_tables_of_the_study_alone() {
    let profile = "[profile.short]\narms = [\"random\", \"lattice\"]\n";
    let desk = Desk::with(&[("study.toml", &study(&[ARMS, profile].concat()))]);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    let before = desk.files("results/tiny");
    let printed = desk.expect(0, "run study.toml --profile short --jobs 2");
    assert!(printed.contains("4 cases, 0 to run"), "{printed}");
    desk.expect(0, "report study.toml --profile short");
    desk.expect(0, "check study.toml --profile short");
    let after = desk.files("results/tiny");
    assert!(before.iter().all(|(path, bytes)| after[path] == *bytes), "what was there is as it was");
    let new: Vec<_> = after.keys().filter(|path| !before.contains_key(*path)).collect();
    assert!(new.iter().all(|path| path.starts_with("short")), "{new:?}");
    assert_eq!(rows(&desk.read("results/tiny/cases.csv")).len(), 6);
    assert_eq!(rows(&desk.read("results/tiny/short/cases.csv")).len(), 4);
    assert!(desk.path("results/tiny/short/report.html").exists());
}

/// What an expectation can be held against: the columns in which every entry that is there is a number.
#[test]
fn the_numeric_columns_of_cases_are_known() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2");
    let text = desk.read("results/tiny/cases.csv");
    let cases = rows(&text);
    let numeric = |column: &&str| cases.iter().all(|case| case[*column].parse::<f64>().is_ok());
    let mut found: Vec<&str> = text.lines().next().unwrap().split(',').filter(numeric).collect();
    found.sort_unstable();
    assert_eq!(found, CASE_NUMBERS);
}

#[test]
fn blocks_share_their_seed_and_nothing_else() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2");
    let cases = rows(&desk.read("results/tiny/cases.csv"));
    let digests: BTreeSet<&String> = cases.iter().map(|case| &case["digest"]).collect();
    assert_eq!(digests.len(), 6, "no two cases end alike");
    // The same seed and count give the same particles to snow and to the elastic ball.
    let mass = |arm: &str| cases.iter().find(|case| case["arm"] == arm).unwrap()["mass"].clone();
    assert_eq!(mass("random"), mass("elastic"));
}

#[test]
fn every_column_is_in_the_dictionary() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "report study.toml");
    let dictionary = rows(&desk.read("results/tiny/dictionary.csv"));
    for table in ["cases", "fragments", "frames", "summary", "claims", "timings"] {
        let text = desk.read(&format!("results/tiny/{table}.csv"));
        for column in text.lines().next().unwrap().split(',') {
            let entry = dictionary.iter().find(|row| row["table"] == table && row["column"] == column);
            let entry = entry.unwrap_or_else(|| panic!("{table}: {column} is not in the dictionary"));
            assert!(!entry["meaning"].is_empty() && !entry["unit"].is_empty(), "{entry:?}");
        }
    }
    // Two blocks are too few for a verdict.
    let claims = rows(&desk.read("results/tiny/claims.csv"));
    assert_eq!(claims[0]["claim"], "irregular-breaks-more");
    assert!(claims[0]["verdict"].starts_with("not-run"), "{:?}", claims[0]);
}

#[test]
fn a_study_without_claims_has_no_table_of_them() {
    let desk = Desk::with(&[("study.toml", &study("[[arm]]\nid = \"one\"\n"))]);
    desk.expect(0, "run study.toml --jobs 2");
    // Of an earlier report, when it had some.
    desk.write("results/tiny/claims.csv", "claim\none\n");
    desk.expect(0, "report study.toml");
    assert!(!desk.path("results/tiny/claims.csv").exists());
    assert!(desk.path("results/tiny/summary.csv").exists());
}
