//! The scripts, word by word.

use std::path::Path;

use snowlab_study::slurm::ArrayJob;

use crate::desk::{ARMS, Desk, study};
use crate::list_of;

#[test]
fn the_scripts_are_those_of_the_page() {
    let keys = ["0123456789abcdef0123", "123456789abcdef01234", "23456789abcdef012345"].map(String::from);
    let elements = [keys[..2].to_vec(), keys[2..].to_vec()];
    let study = ["studies/placement.toml", "--profile", "full", "--out", "my results"].map(String::from);
    let job = ArrayJob {
        name: "snowlab-placement",
        directory: Path::new("/home/ada/snow"),
        folder: Path::new("/home/ada/snow/my results/placement/full/slurm"),
        program: "/home/ada/bin/snowlab",
        study: &study,
        elements: &elements,
        threads: 2,
        seconds: 3100.0,
        memory: 1.2e9,
        collect_memory: 3.5e8,
    };
    assert_eq!(job.element_list(), "0123456789abcdef0123 123456789abcdef01234\n23456789abcdef012345\n");
    assert_eq!(job.array_script(), include_str!("array.sh"));
    assert_eq!(job.collect_script(), include_str!("collect.sh"));
}

#[test]
fn a_dry_run_submits_nothing_and_tells_what_it_would() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    let told = desk.expect(0, "submit study.toml --dry-run --element-time 0s --most-elements 4");
    assert!(told.contains("6 cases in ") && told.contains("nothing is submitted"), "{told}");
    let script = desk.read("results/tiny/slurm/array.sh");
    assert!(script.contains("#SBATCH --array=0-") && script.contains("#SBATCH --requeue"), "{script}");
    let list = list_of(&desk, &script);
    assert!(list.lines().count() <= 4 && list.split_whitespace().count() == 6, "{list}");
    // The same cases for whoever has no Slurm.
    let keys = desk.expect(0, "plan study.toml --keys");
    assert_eq!(keys.split_whitespace().count(), 6);
    assert!(keys.split_whitespace().all(|key| list.contains(key)), "{keys}\n{list}");
    desk.expect(0, "run study.toml --jobs 2");
    assert!(desk.expect(0, "submit study.toml").contains("6 cases, none to submit"));
    let told = desk.expect(0, "submit study.toml --json");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&told).expect("JSON")["cases"], 0);
    let refused = desk.expect(2, "submit study.toml --executor pbs");
    assert!(refused.contains("possible values: slurm"), "{refused}");
}

/// Slurm has its own copy of a script from when it was handed in; elements that start later must find their list as it was.
#[test]
fn what_is_submitted_later_changes_no_element_of_before() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    let submitted = |words: &str| {
        desk.expect(0, &format!("submit study.toml --dry-run {words}"));
        desk.read("results/tiny/slurm/array.sh")
    };
    let first = submitted("--element-time 0s");
    let before = list_of(&desk, &first);
    let second = submitted("--element-time 1h");
    assert_eq!((before.lines().count(), list_of(&desk, &second).lines().count()), (6, 1));
    assert_eq!(list_of(&desk, &first), before);
    // An element without a line runs nothing, and above all not the whole study.
    desk.write("array.sh", &second);
    let element = |number: &str| {
        let mut command = std::process::Command::new("bash");
        command.arg("array.sh").env("SLURM_ARRAY_TASK_ID", number).current_dir(desk.folder.path());
        command.output().expect("a shell")
    };
    let output = element("5");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("element 5 has no cases in"), "{output:?}");
    assert!(!desk.path("results/tiny/cases").exists());
}
