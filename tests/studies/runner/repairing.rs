//! Results that are damaged, cannot be read, or are made by two runners: what is sound stays.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use snowlab_study::case_run::CaseEnd;
use snowlab_study::keeper::Limits;
use snowlab_study::manifest::Program;
use snowlab_study::plan::{Look, statuses_of};
use snowlab_study::results::Archive;
use snowlab_study::schedule::{Account, Orders, Progress, Task, run_cases};
use snowlab_study::spec;
use snowlab_study::store::{Hold, Lock, StoreError, sign};
use snowlab_study::sweep::Study;

use super::{ARMS, Desk, STOPPING_ARM, study};

/// A study that has been run, and the folder of its first case.
fn finished(rest: &str, code: i32) -> (Desk, PathBuf) {
    let desk = Desk::with(&[("study.toml", &study(rest))]);
    let keys = desk.expect(0, "plan study.toml --keys");
    desk.expect(code, "run study.toml --jobs 2");
    let folder = desk.path(&format!("results/tiny/cases/{}", keys.split_whitespace().next().unwrap()));
    (desk, folder)
}

fn written(path: &Path) -> SystemTime {
    std::fs::metadata(path).and_then(|file| file.modified()).unwrap()
}

/// The question and the manifest are no reason to simulate; frames and metrics are made anew to the byte.
#[test]
fn repairing_runs_only_what_takes_a_run() {
    let (desk, folder) = finished(ARMS, 0);
    let (run, frames) = (folder.join("run.json"), folder.join("frames.bin"));
    let times = [written(&run), written(&frames)];
    let names = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let metrics = names.into_iter().find(|path| path.to_string_lossy().contains("/metrics-")).unwrap();
    for path in [folder.join("case.json"), folder.join("manifest.json")] {
        let before = std::fs::read(&path).unwrap();
        std::fs::write(&path, &before[..before.len() / 2]).unwrap();
        assert!(desk.expect(3, "status study.toml").contains("1 damaged"));
        let printed = desk.expect(0, "run study.toml --repair");
        assert!(
            printed.contains("random block 1 is made anew: ") && printed.contains("1 to run"),
            "{printed}"
        );
        assert!(desk.expect(0, "status study.toml").contains("6 finished"));
        // Who ran the case is not known any more.
        let is_manifest = path.ends_with("manifest.json");
        assert_eq!(std::fs::read(&path).ok(), (!is_manifest).then_some(before), "{}", path.display());
    }
    assert_eq!([written(&run), written(&frames)], times);
    for path in [metrics, frames] {
        let (before, time) = (std::fs::read(&path).unwrap(), written(&run));
        std::fs::write(&path, &before[..before.len() / 2]).unwrap();
        desk.expect(0, "run study.toml --repair");
        assert!(std::fs::read(&path).unwrap() == before && written(&run) > time, "{}", path.display());
    }
}

/// A disk that does not answer is no damage. A link to itself cannot be opened, whoever asks.
#[test]
fn a_record_that_cannot_be_read_is_not_deleted() {
    let (desk, folder) = finished(ARMS, 0);
    let run = folder.join("run.json");
    std::fs::rename(&run, folder.join("aside")).unwrap();
    std::os::unix::fs::symlink("run.json", &run).unwrap();
    let status = desk.expect(3, "status study.toml");
    assert!(status.contains("1 unreadable") && status.contains("check space and permissions"), "{status}");
    let printed = desk.expect(3, "run study.toml --json");
    assert!(printed.contains("run.json: cannot be written or read"), "{printed}");
    assert!(printed.contains("the tables are not written: "), "{printed}");
    let told: serde_json::Value =
        serde_json::Deserializer::from_str(&printed).into_iter().next().unwrap().unwrap();
    assert_eq!(
        [told["unstored"].as_array().map(Vec::len), told["tables"].as_array().map(Vec::len)],
        [Some(1), None]
    );
    assert!(run.is_symlink(), "it stays as it was");
    std::fs::rename(folder.join("aside"), &run).unwrap();
    assert!(desk.expect(0, "run study.toml").contains("0 to run"));
}

/// Nobody listens.
struct Unheard;

impl Progress for Unheard {
    fn advanced(&self, _share: f64, _cases: usize) {}
    fn not_put_away(&self, _index: usize, _error: &StoreError) {}
    fn ended(&self, _index: usize, _result: Result<&CaseEnd, &StoreError>) {}
}

/// Two runners look at a case that has stopped; the one that comes second finds the record of the first.
#[test]
fn two_that_try_a_stopped_case_again_try_it_once() {
    let (desk, folder) = finished(STOPPING_ARM, 3);
    let study = Study::expand(spec::parse(&desk.read("study.toml")).unwrap(), None).unwrap();
    let out = desk.path("results");
    let archive = Archive::open(&study, &out, desk.folder.path()).unwrap();
    let orders = Orders {
        side_by_side: 1,
        threads: 1,
        fail_fast: false,
        limits: Limits::default(),
        program: Program::this(desk.folder.path()),
    };
    let statuses = statuses_of(&archive, &[0], Look::Records);
    let tasks: Vec<Task> = statuses.into_iter().map(|status| Task { status, work: 1.0 }).collect();
    let run = || run_cases(&archive, tasks.clone(), &orders, &Unheard);
    assert!(matches!(run(), Account { finished: 1, elsewhere: 0, .. }));
    let time = written(&folder.join("run.json"));
    assert!(matches!(run(), Account { finished: 0, elsewhere: 1, .. }));
    assert_eq!(written(&folder.join("run.json")), time);
}

/// A part of a study leaves the rest alone, and nobody clears up where another runner is at work.
#[test]
fn what_killed_runners_leave_goes_when_nobody_is_at_the_case() {
    let (desk, folder) = finished(ARMS, 0);
    let left = folder.join("checkpoint.bin");
    std::fs::write(&left, "of a killed runner").unwrap();
    desk.expect(0, "run study.toml --index 1");
    assert!(left.exists(), "case 0 was not asked for");
    let lock = Lock::take(&folder.join("lock"), Hold::Alone).unwrap().expect("free");
    desk.expect(0, "run study.toml");
    assert!(left.exists(), "somebody is at it");
    drop(lock);
    desk.expect(0, "run study.toml");
    assert!(!left.exists());
    // Half a file goes when the case is run again.
    let half = folder.join(".unfinished-a1b2");
    std::fs::write(&half, "half a file").unwrap();
    std::fs::remove_file(folder.join("run.json")).unwrap();
    desk.expect(0, "run study.toml");
    assert!(!half.exists());
}

/// Frames without a record, as an older program leaves them that is killed before it has written the record.
#[test]
fn frames_of_no_record_are_written_over() {
    let (desk, folder) = finished(ARMS, 0);
    let frames = std::fs::read(folder.join("frames.bin")).unwrap();
    let key = folder.file_name().unwrap().to_str().unwrap();
    std::fs::write(folder.join("frames.bin"), sign(key, b"other frames".to_vec())).unwrap();
    std::fs::remove_file(folder.join("run.json")).unwrap();
    desk.expect(0, "run study.toml");
    assert!(std::fs::read(folder.join("frames.bin")).unwrap() == frames);
}
