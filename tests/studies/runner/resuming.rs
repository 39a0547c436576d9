//! What has been run is not run again, and gives the same bytes whenever and wherever it runs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::{ARMS, Desk, STOPPING_ARM, study};

#[test]
fn a_study_run_again_changes_no_byte() {
    let desk = Desk::with(&[("study.toml", &study(&[ARMS, STOPPING_ARM].concat()))]);
    assert!(desk.expect(0, "plan study.toml").ends_with("8 cases: 0 finished, 8 to run\n"));
    desk.expect(3, "run study.toml --jobs 2");
    let (before, times) = (desk.files("results"), run_times(&desk));
    assert_eq!(times.len(), 8, "a folder for each case");
    assert!(desk.expect(0, "plan study.toml").ends_with("8 cases: 8 finished, 0 to run\n"));
    desk.expect(3, "run study.toml --jobs 2");
    let after = desk.files("results");
    assert_eq!(after.keys().collect::<Vec<_>>(), before.keys().collect::<Vec<_>>());
    for (path, bytes) in &before {
        assert_eq!(&after[path], bytes, "{}", path.display());
    }
    assert_eq!(run_times(&desk), times, "no case is written again");
}

#[test]
fn a_case_that_is_missing_is_run_again_to_the_same_bytes() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 1");
    let before = desk.files("results");
    // Where a run is interrupted, its record is not there yet.
    let record = before.keys().find(|path| path.ends_with("run.json")).unwrap();
    std::fs::remove_file(desk.path("results").join(record)).unwrap();
    assert!(desk.expect(0, "plan study.toml").ends_with("6 cases: 5 finished, 1 to run\n"));
    desk.expect(0, "run study.toml --jobs 1");
    let after = desk.files("results");
    assert_eq!(after.keys().collect::<Vec<_>>(), before.keys().collect::<Vec<_>>());
    for (path, bytes) in before.iter().filter(|(path, _)| !knows_a_clock(path)) {
        assert_eq!(&after[path], bytes, "{}", path.display());
    }
}

#[test]
fn results_do_not_hang_on_the_number_of_jobs() {
    let desk = Desk::with(&[("study.toml", &study(&[ARMS, STOPPING_ARM].concat()))]);
    for jobs in [1, 2] {
        desk.expect(3, &format!("run study.toml --jobs {jobs} --out jobs-{jobs}"));
        desk.expect(0, &format!("report study.toml --out jobs-{jobs}"));
    }
    let (one, two) = (desk.files("jobs-1"), desk.files("jobs-2"));
    assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
    let compared = one.iter().filter(|(path, _)| !knows_a_clock(path));
    for (path, bytes) in compared.clone() {
        assert_eq!(&two[path], bytes, "{}", path.display());
    }
    let tables = compared.filter(|(path, _)| path.extension().is_some_and(|ending| ending == "csv"));
    let names: Vec<String> =
        tables.map(|(path, _)| path.file_name().unwrap().display().to_string()).collect();
    let of_cases = ["cases.csv", "dictionary.csv", "fragments.csv", "frames.csv", "summary.csv"];
    // Two blocks are too few for a plan of replicates.
    let of_claims = ["claims.csv", "robustness.csv"];
    assert_eq!(
        names.into_iter().collect::<BTreeSet<_>>(),
        [&of_cases[..], &of_claims].concat().into_iter().map(String::from).collect()
    );
}

#[test]
fn a_changed_measurement_measures_again_and_simulates_nothing() {
    let text = study(ARMS);
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 2");
    let (before, times) = (desk.files("results"), run_times(&desk));
    desk.write("study.toml", &text.replace("[measure]\n", "[measure]\nlink_ratio = 0.5\n"));
    assert!(desk.expect(0, "plan study.toml").ends_with("6 cases: 6 finished, 0 to run\n"));
    desk.expect(0, "run study.toml --jobs 2");
    let after = desk.files("results");
    assert_eq!(run_times(&desk), times, "no case is simulated again");
    let new: Vec<&PathBuf> = after.keys().filter(|path| !before.contains_key(*path)).collect();
    assert_eq!(new.len(), 6, "{new:?}");
    assert!(new.iter().all(|path| path.to_str().is_some_and(|path| path.contains("/metrics-"))), "{new:?}");
    // At a quarter of the link even the ball at the start is in pieces: the tables must tell.
    let cases = PathBuf::from("tiny/cases.csv");
    assert_ne!(after[&cases], before[&cases]);
}

/// When the frames and the record of each case were written.
fn run_times(desk: &Desk) -> Vec<(PathBuf, SystemTime, SystemTime)> {
    let written = |path: PathBuf| std::fs::metadata(path).and_then(|file| file.modified()).unwrap();
    let mut times = Vec::new();
    for entry in std::fs::read_dir(desk.path("results/tiny/cases")).unwrap() {
        let case = entry.unwrap().path();
        times.push((case.clone(), written(case.join("frames.bin")), written(case.join("run.json"))));
    }
    times.sort();
    times
}

fn knows_a_clock(path: &Path) -> bool {
    ["timings.csv", "manifest.json", "log.txt"].iter().any(|name| path.ends_with(name))
}
