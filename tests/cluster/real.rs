//! A study on two nodes of a real Slurm: the controller is killed, a node is killed, an element comes to its time limit; after another submission the tables
//! are those of a local run.

use std::process::Output;
use std::time::Duration;

use crate::desk::{Desk, study};
use crate::slurm::{Job, SAVE_DELAY, Slurm};
use crate::{hold_tables, list_of};

/// Time for any phase (chosen: the longest takes a minute on a free machine).
const LIMIT: Duration = Duration::from_secs(300);

/// A case that lasts a minute or so, to be ended by its time limit; one that outlasts the controller, which forgets what has only just begun; and some
/// of a few seconds, one of which loses its node.
const ARMS: &str = r#"
[[arm]]
id = "long"
blocks = 1
set = { "body.0.placement.count" = 6000, "numerics.spacing" = 0.02, "numerics.fixed_step" = 2e-6, "output.end" = 9.0 }
[[arm]]
id = "lasting"
blocks = 1
set = { "body.0.placement.count" = 3000, "numerics.spacing" = 0.02, "numerics.fixed_step" = 2e-6, "output.end" = 5.0 }
[[arm]]
id = "short"
blocks = 6
set = { "body.0.placement.count" = 3000, "numerics.spacing" = 0.02, "numerics.fixed_step" = 5e-6, "output.end" = 1.5 }
"#;

#[test]
fn a_real_cluster_gives_the_tables_of_a_local_run() {
    if !Slurm::is_installed() {
        assert!(std::env::var_os("SNOWLAB_NEEDS_SLURM").is_none(), "Slurm is not installed");
        println!(
            "SKIPPED: Slurm is not installed; `apt-get install --no-install-recommends slurm-wlm` has it"
        );
        return;
    }
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    let mut slurm = Slurm::start();
    let told = snowlab(&slurm, &desk, "submit study.toml --element-time 0s -- --mem=500");
    assert!(told.contains("8 cases in 8 elements"), "{told}");
    slurm.wait_until("two elements run", LIMIT, |slurm| running(slurm).len() == 2);

    std::thread::sleep(SAVE_DELAY);
    slurm.kill_controller();
    slurm.start_controller();
    let long = element_with(&slurm, &desk, "long");
    slurm.end_in(&long.id, 35);

    // One that has just begun, so that it is killed on the way.
    let before: Vec<String> = running(&slurm).into_iter().map(|job| job.id).collect();
    let is_new = |job: &Job| job.node != long.node && !before.contains(&job.id);
    slurm.wait_until("another element begins", LIMIT, |slurm| running(slurm).iter().any(is_new));
    let lost = running(&slurm).into_iter().find(is_new).expect("it runs");
    std::thread::sleep(Duration::from_millis(500));
    slurm.kill_node(&lost.node);
    slurm.declare_down(&lost.node);
    slurm.start_node(&lost.node);

    // What is left waits for a node that is back, or for that.
    let is_held =
        |job: &Job| job.state == "PENDING" && ["BeginTime", "Dependency"].contains(&job.reason.as_str());
    slurm.wait_until("only held elements are left", LIMIT, |slurm| slurm.jobs().iter().all(is_held));
    let status = snowlab(&slurm, &desk, "status study.toml");
    assert!(status.contains("queued"), "{status}");
    assert!(status.contains("interrupted") && status.contains("killed"), "{status}");
    for job in slurm.jobs() {
        slurm.run("scancel", &[&job.id]);
    }

    let told = snowlab(&slurm, &desk, "submit study.toml --element-time 0s -- --mem=500");
    assert!(told.contains("2 cases in 2 elements"), "{told}");
    slurm.wait_until_idle(LIMIT);
    let logs = desk.files("results").into_iter().filter(|(path, _)| path.ends_with("log.txt"));
    let logs: String = logs.map(|(_, text)| String::from_utf8_lossy(&text).into_owned()).collect();
    assert_eq!(logs.matches("interrupted: it goes on").count(), 1, "{logs}");
    assert_eq!(logs.matches("goes on at").count(), 1, "{logs}");
    assert_eq!(logs.matches("was killed on the way").count(), 1, "{logs}");

    desk.expect(0, "run study.toml --jobs 2 --out local");
    hold_tables(&desk, "results", "local");
}

/// Runs `snowlab` as on a machine of the cluster.
fn snowlab(slurm: &Slurm, desk: &Desk, words: &str) -> String {
    let mut command = slurm.command(env!("CARGO_BIN_EXE_snowlab"));
    let output = command.args(words.split_whitespace()).current_dir(desk.folder.path()).output();
    let Output { stdout, stderr, .. } = output.expect("the command can be started");
    String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr)
}

fn running(slurm: &Slurm) -> Vec<Job> {
    slurm.jobs().into_iter().filter(|job| job.state == "RUNNING").collect()
}

/// The element that runs the case of an arm.
fn element_with(slurm: &Slurm, desk: &Desk, arm: &str) -> Job {
    let plan = desk.expect(0, "plan study.toml --no-trials");
    let line = plan.lines().find(|line| line.contains(&format!("  {arm} block"))).expect("a case of the arm");
    let key = line.split_whitespace().nth(1).expect("a key");
    let list = list_of(desk, &desk.read("results/tiny/slurm/array.sh"));
    let element = list.lines().position(|line| line.contains(key)).expect("its element");
    let mut jobs = slurm.jobs().into_iter();
    jobs.rfind(|job| job.id.ends_with(&format!("_{element}"))).expect("a job of the element")
}
