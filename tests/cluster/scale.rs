//! Studies of many cases: planning, submitting and collecting them from records that are made up.
//!
//! A few hundred are part of the tests. The long form, whose figures stand in docs/scaling.md, prints its times:
//!
//! ```text
//! SNOWLAB_RECORDS=100000 cargo test --locked --release -p snowlab-study --test cluster -- many_cases --nocapture
//! ```

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use serde_json::Value;
use snowlab_study::results::Archive;
use snowlab_study::spec::{self, StudySpec};
use snowlab_study::store::{seal, unseal};
use snowlab_study::sweep::Study;

use crate::desk::{Desk, study};

/// Records of the short form.
const FEW: usize = 300;

#[test]
fn many_cases_are_planned_submitted_and_collected() {
    let told = std::env::var("SNOWLAB_RECORDS").ok();
    let count = told.as_deref().map_or(FEW, |text| text.parse().expect("SNOWLAB_RECORDS is a number"));
    let text = study("[[arm]]\nid = \"one\"\n").replace("count = 2", &format!("count = {count}"));
    let desk = Desk::with(&[("study.toml", &text)]);
    let timed = |what: &str, code: i32, words: &str| {
        let began = Instant::now();
        let printed = desk.expect(code, words);
        println!("{what}: {:.2} s of {count} cases", began.elapsed().as_secs_f64());
        printed
    };
    let planned = timed("plan, none run", 0, "plan study.toml --no-trials");
    assert!(planned.ends_with(&format!("{count} cases: 0 finished, {count} to run\n")));
    let submitted = timed("submit --dry-run", 0, "submit study.toml --dry-run");
    assert!(submitted.contains(&format!("{count} cases in ")), "{submitted}");
    desk.expect(0, "run study.toml --index 0");
    let began = Instant::now();
    multiply(&desk, &text);
    println!("records made up in {:.2} s", began.elapsed().as_secs_f64());
    let planned = timed("plan, all run", 0, "plan study.toml --no-trials");
    assert!(planned.ends_with(&format!("{count} cases: {count} finished, 0 to run\n")));
    let status = timed("status --quick", 0, "status study.toml --quick");
    assert!(status.contains(&format!("{count} finished")), "{status}");
    let collected = timed("collect", 0, "collect study.toml");
    assert!(collected.contains(&format!("{count} in the tables")), "{collected}");
    let rows = desk.read("results/tiny/cases.csv").lines().count();
    assert_eq!(rows, count + 1);
}

/// Gives every case the records of the first, under its own seal.
fn multiply(desk: &Desk, text: &str) {
    let study = Study::expand(spec::parse::<StudySpec>(text).expect("a study"), None).expect("cases");
    let out = desk.path("results");
    let archive = Archive::open(&study, &out, Path::new(".")).expect("keys");
    let first = archive.case_folder(0);
    let files =
        std::fs::read_dir(first.path()).expect("the first case").map(|entry| entry.expect("a file").path());
    let records: Vec<(String, Value)> = files
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .map(|path| {
            let bytes = std::fs::read(&path).expect("a record");
            let name = path.file_name().and_then(|name| name.to_str()).expect("a name").to_string();
            (name, unseal(archive.key(0), &bytes).expect("a record under seal"))
        })
        .collect();
    (1..study.cases.len()).into_par_iter().for_each(|index| {
        let folder = archive.case_folder(index);
        std::fs::create_dir_all(folder.path()).expect("a folder");
        for (name, record) in &records {
            std::fs::write(folder.path().join(name), seal(archive.key(index), record)).expect("a file");
        }
    });
}
