//! Running parts of a study, going on with it, and what is told of it.

use serde_json::Value;
use snowlab_study::attempt::Attempt;
use snowlab_study::manifest::{CaseManifest, MANIFEST};
use snowlab_study::spec::study::DEFAULT_PROFILE;
use snowlab_study::store::{Asked, CASE, Hold, Lock, Store, seal, unseal};

use super::{ARMS, Desk, STOPPING_ARM, study};

fn json(text: &str) -> Value {
    // What is not JSON went to standard error, which stands behind it.
    let mut values = serde_json::Deserializer::from_str(text).into_iter::<Value>();
    values.next().expect("a value").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Folders of all cases.
fn folders(desk: &Desk) -> Vec<String> {
    let names = std::fs::read_dir(desk.path("results/tiny/cases")).expect("cases");
    names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn a_case_goes_on_from_its_checkpoint_to_the_same_bytes() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2 --out whole");
    let printed = desk.expect(3, "run study.toml --jobs 2 --step-limit 20");
    assert!(printed.contains("failed (step-limit): it has taken 20 steps"), "{printed}");
    let status = desk.expect(3, "status study.toml");
    assert!(status.contains("6 failed") && status.contains("% are kept"), "{status}");
    let plan = desk.expect(0, "plan study.toml");
    assert!(plan.contains("goes on at ") && plan.ends_with("6 cases: 0 finished, 6 to run\n"), "{plan}");
    let cases = super::rows(&desk.read("results/tiny/cases.csv"));
    assert!(cases.iter().all(|row| row["outcome"] == "stopped(step-limit)"), "a failure is a row");
    desk.expect(0, "run study.toml --jobs 2");
    let (whole, resumed) = (desk.files("whole"), desk.files("results"));
    assert_eq!(whole.keys().collect::<Vec<_>>(), resumed.keys().collect::<Vec<_>>(), "no mark is left");
    let knows_a_clock = |name: &str| ["timings.csv", "manifest.json", "log.txt"].contains(&name);
    for (path, bytes) in
        whole.iter().filter(|(path, _)| !knows_a_clock(path.file_name().unwrap().to_str().unwrap()))
    {
        assert!(&resumed[path] == bytes, "{}", path.display());
    }
    let key = &folders(&desk)[0];
    let manifest = desk.read(&format!("results/tiny/cases/{key}/{MANIFEST}"));
    let manifest: CaseManifest = unseal(key, manifest.as_bytes()).unwrap();
    assert_eq!(manifest.attempts, 2);
    let log = desk.read(&format!("results/tiny/cases/{key}/log.txt"));
    assert!(!log.contains("was killed"), "{log}");
    assert!(log.contains("goes on at ") && log.ends_with("finished\n"), "{log}");
}

/// What befell a case last is told, not what befell it before.
#[test]
fn a_kill_is_told_of_a_case_that_had_failed() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(3, "run study.toml --index 0 --step-limit 20");
    assert!(desk.expect(3, "status study.toml").contains("1 failed, 5 new"));
    // A runner that begins and is killed.
    let key = folders(&desk)[0].clone();
    Attempt::begin(&Store::new(&desk.path("results"), "tiny", DEFAULT_PROFILE).case(&key)).unwrap();
    let status = desk.expect(3, "status study.toml");
    assert!(status.contains("1 killed, 5 new") && status.contains("(attempt 2)"), "{status}");
    desk.expect(0, "run study.toml --index 0");
    let log = desk.read(&format!("results/tiny/cases/{key}/log.txt"));
    assert_eq!(log.matches("was killed on the way").count(), 1, "{log}");
}

#[test]
fn a_time_limit_puts_cases_away() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    let printed = desk.expect(3, "run study.toml --jobs 2 --time-limit 0s");
    assert!(
        printed.contains("failed (time-limit): it has run for 0s") && printed.contains("`--time-limit`"),
        "{printed}"
    );
    let printed = desk.expect(4, "run study.toml --jobs 2 --stop-after 0s");
    assert!(printed.contains("interrupted: ") && printed.contains("the same command goes on"), "{printed}");
    desk.expect(0, "run study.toml --jobs 2 --time-limit 1h");
}

/// A folder stands where the checkpoint should be written.
#[test]
fn a_checkpoint_that_cannot_be_written_is_told() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    let key = desk.expect(0, "plan study.toml --keys").split_whitespace().next().unwrap().to_string();
    let blocked = format!("results/tiny/cases/{key}/checkpoint.bin");
    std::fs::create_dir_all(desk.path(&blocked)).unwrap();
    desk.write(&format!("{blocked}/mine"), "in the way");
    // To stop without having put the case away is no pause.
    let printed = desk.expect(3, "run study.toml --index 0 --step-limit 20 --json");
    let run = json(&printed);
    assert_eq!(
        [run["unstored"].as_array().map(Vec::len), run["failed"].as_array().map(Vec::len)],
        [Some(1), Some(0)]
    );
    assert!(printed.contains("checkpoint.bin: cannot be written or read"), "{printed}");
    let status = desk.expect(0, "status study.toml");
    assert!(!status.contains("killed"), "it has ended: {status}");
    // Where it can go on it does, and says so once.
    let printed = desk.expect(3, "run study.toml --index 0 --checkpoint-every 0s");
    assert_eq!(printed.matches("cannot be put away, goes on: ").count(), 1, "{printed}");
    std::fs::remove_dir_all(desk.path(&blocked)).unwrap();
    desk.expect(0, "run study.toml --index 0");
}

#[test]
fn parts_of_a_study_make_the_whole() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2 --out whole");
    let plan = desk.expect(0, "plan study.toml --keys");
    let keys: Vec<&str> = plan.split_whitespace().collect();
    assert_eq!(keys.len(), 6);
    desk.expect(0, "run study.toml --index 5");
    desk.expect(0, &format!("run study.toml --case {} --case {}", &keys[0][..12], keys[3]));
    assert_eq!(desk.expect(0, "plan study.toml --keys").split_whitespace().count(), 3);
    assert!(!desk.path("results/tiny/cases.csv").exists(), "parts write no tables");
    for part in 1..=4 {
        desk.expect(0, &format!("run study.toml --shard {part}/4"));
    }
    let told = desk.expect(0, "collect study.toml");
    assert!(told.contains("6 cases: 6 in the tables, 0 have not been run"), "{told}");
    for table in ["cases", "fragments", "frames", "summary"] {
        let name = format!("tiny/{table}.csv");
        assert_eq!(desk.read(&format!("whole/{name}")), desk.read(&format!("results/{name}")));
    }
    // Without cases the tables of before stay.
    std::fs::remove_dir_all(desk.path("results/tiny/cases")).unwrap();
    let refused = desk.expect(2, "collect study.toml");
    assert!(refused.contains("tiny: nothing has been run"), "{refused}");
    assert_eq!(desk.read("whole/tiny/cases.csv"), desk.read("results/tiny/cases.csv"));
}

#[test]
fn failures_are_run_again_on_demand_and_may_stop_the_rest() {
    let desk = Desk::with(&[("study.toml", &study(&[STOPPING_ARM, ARMS].concat()))]);
    // At a step of 0.02 s the stopping arm is taken to be as long as the others: it comes first, as in the file.
    let printed = desk.expect(3, "run study.toml --jobs 1 --fail-fast --index 0");
    assert!(!printed.contains("panicked"), "{printed}");
    desk.expect(3, "run study.toml --jobs 2");
    assert!(desk.expect(3, "run study.toml").contains("8 cases, 0 to run"));
    let printed = desk.expect(3, "run study.toml --failed");
    assert!(
        printed.contains("8 cases, 2 to run")
            && printed.contains("leaping block 1 is run again: step-rejected"),
        "{printed}"
    );
    let status = desk.expect(3, "status study.toml");
    assert!(status.contains("tiny: 8 cases: 6 finished, 2 stopped"), "{status}");
    assert!(status.contains("log.txt") && status.contains("--failed"), "{status}");
}

#[test]
fn what_programs_read_is_json() {
    let desk = Desk::with(&[("study.toml", &study(&[ARMS, STOPPING_ARM].concat()))]);
    let plan = json(&desk.expect(0, "plan study.toml --json"));
    assert_eq!(
        [plan["to_run"].as_u64(), plan["cases"].as_array().map(|cases| cases.len() as u64)],
        [Some(8); 2]
    );
    assert!(plan["predicted_seconds"].as_f64().is_some_and(|seconds| seconds > 0.0), "{plan}");
    assert_eq!(plan["cases"][0]["state"], "new");
    let run = json(&desk.expect(3, "run study.toml --jobs 2 --json"));
    assert_eq!(run["run"], 8, "{run}");
    assert_eq!(run["stopped"].as_array().map(Vec::len), Some(2), "{run}");
    let status = json(&desk.expect(3, "status study.toml --json"));
    assert_eq!(status["counts"]["finished"], 6, "{status}");
    assert_eq!(json(&desk.expect(3, "collect study.toml --json"))["rows"], 8);
    let check = json(&desk.expect(1, "check study.toml --json"));
    assert!(check.as_array().is_some_and(|held| held.iter().any(|held| held["holds"] == true)), "{check}");
    assert_eq!(json(&desk.expect(0, "gc study.toml --json"))["deleted"], false);
}

/// What is not known of one point of a sweep is not taken from another.
#[test]
fn each_point_of_a_sweep_is_tried() {
    let sweep = "[[sweep]]\nname = \"count\"\npath = \"body.0.placement.count\"\nvalues = [300, 1200]\n";
    let desk = Desk::with(&[("study.toml", &study(&["[[arm]]\nid = \"random\"\n", sweep].concat()))]);
    let plan = json(&desk.expect(0, "plan study.toml --json --jobs 8"));
    let steps = |case: usize| plan["cases"][case]["particle_steps"].as_f64().expect("a number");
    assert_eq!([&plan["cases"][0]["axes"][0][1], &plan["cases"][2]["axes"][0][1]], [300.0, 1200.0]);
    // Steps of the first one's length: particles of both have the same density and stiffness.
    assert!((steps(2) / steps(0) - 4.0).abs() < 1e-6, "{} and {}", steps(0), steps(2));
    assert_eq!([&plan["jobs"], &plan["threads"]], [4, 2], "as `run` shares eight cores among four cases");
}

#[test]
fn results_of_several_programs_and_versions_are_told() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2");
    let key = desk.expect(0, "plan study.toml").split_whitespace().nth(1).expect("a key").to_string();
    let path = desk.path(&format!("results/tiny/cases/{key}/{MANIFEST}"));
    let mut manifest: CaseManifest = unseal(&key, &std::fs::read(&path).unwrap()).unwrap();
    assert_eq!((manifest.attempts, manifest.seed, manifest.threads), (1, 1, 1));
    manifest.program.digest = "another".into();
    manifest.program.study_revision = Some("fedcba987654".into());
    // As programs of before have named it.
    let text = serde_json::to_string(&manifest).unwrap().replace("study_revision", "revision");
    std::fs::write(&path, seal(&key, &serde_json::from_str::<Value>(&text).unwrap())).unwrap();
    let printed = desk.expect(0, "collect study.toml");
    assert!(printed.contains("run by 2 programs") && printed.contains("another"), "{printed}");
    assert!(printed.contains("`snowlab gc FILE --all --delete`"), "{printed}");
    let tables: Value = serde_json::from_str(&desk.read("results/tiny/manifest.json")).unwrap();
    assert_eq!(tables["study_revisions"], serde_json::json!(["fedcba987654"]));

    // A folder of the same scene by an older solver.
    let old = "0123456789abcdef0123";
    let folder = desk.path(&format!("results/tiny/cases/{key}"));
    let mut asked: Asked = unseal(&key, &std::fs::read(folder.join(CASE)).unwrap()).unwrap();
    asked.solver_version = 1;
    std::fs::rename(&folder, desk.path(&format!("results/tiny/cases/{old}"))).unwrap();
    std::fs::write(desk.path(&format!("results/tiny/cases/{old}/{CASE}")), seal(old, &asked)).unwrap();
    let plan = desk.expect(0, "plan study.toml");
    assert!(
        plan.contains(&format!("stale        {key}")) && plan.contains("version 1 of the solver"),
        "{plan}"
    );
}

#[test]
fn what_no_case_needs_is_listed_and_goes_on_demand() {
    let text = study(&[ARMS, "[profile.quick]\nset = { \"output.end\" = 0.5 }\n"].concat());
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 2");
    desk.expect(0, "run study.toml --jobs 2 --profile quick");
    assert!(desk.expect(0, "gc study.toml").starts_with("0 files and folders"));
    desk.write("results/tiny/cases/notes.txt", "of the user");
    let first = folders(&desk)[0].clone();
    let halves =
        [&format!("cases/{first}/"), "", "quick/"].map(|name| format!("results/tiny/{name}.unfinished-a1b2"));
    halves.iter().for_each(|half| desk.write(half, "half a file"));
    desk.write("study.toml", &text.replace("count = 2", "count = 1"));
    let listed = desk.expect(0, "gc study.toml");
    assert!(
        listed.contains("of no case of the study's profiles") && listed.contains("`--delete` deletes it"),
        "{listed}"
    );
    let before = folders(&desk).len();
    desk.expect(0, "gc study.toml");
    assert_eq!(folders(&desk).len(), before, "listing deletes nothing");
    desk.expect(0, "gc study.toml --delete");
    assert_eq!(folders(&desk).len(), 7, "three cases of two profiles, and the user's notes");
    assert!(halves.iter().all(|half| !desk.path(half).exists()));
    desk.expect(0, "gc study.toml --all --delete");
    assert_eq!(folders(&desk), ["notes.txt"]);
    assert!(desk.path("results/tiny/cases.csv").exists(), "tables stay");
}

/// One who lists keeps nobody out; one who deletes is waited for.
#[test]
fn runners_wait_for_who_clears_the_study() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "gc study.toml");
    let path = desk.path("results/tiny/lock");
    assert!(!path.exists(), "a list takes no lock");
    let lock = Lock::take(&path, Hold::Alone).unwrap().expect("free");
    let waiting = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(500));
        drop(lock);
    });
    desk.expect(0, "run study.toml --index 0");
    waiting.join().unwrap();
    let _lock = Lock::take(&path, Hold::Shared).unwrap().expect("free");
    assert!(desk.expect(2, "gc study.toml --delete").contains("the study is in use; nothing is deleted"));
}

#[test]
fn shells_can_complete() {
    let desk = Desk::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = desk.expect(0, &format!("completions {shell}"));
        assert!(script.contains("snowlab") && script.contains("checkpoint-every"), "{shell}");
    }
}
