//! A pretended `sbatch` that runs elements in any order, some of them twice at once, some killed on the way: the tables are the local run's.

use std::os::unix::fs::PermissionsExt;
use std::process::Command;

use crate::desk::{ARMS, Desk, STOPPING_ARM, study};
use crate::hold_tables;

/// Every second element is killed by SIGKILL some hundredths of a second after its begin; then each is run twice at once, the last first.
const SBATCH: &str = r#"#!/bin/bash
echo "$@" >> sbatch.calls
script=${!#}
case $script in
*array.sh)
    last=$(sed -n 's/^#SBATCH --array=0-//p' "$script")
    for element in $(seq "$last" -1 0); do
        export SLURM_ARRAY_TASK_ID=$element
        if ((element % 2)); then timeout -s KILL 0.0$((element + 2)) bash "$script"; fi
        bash "$script" & bash "$script"
        wait
    done
    ;;
*) bash "$script" ;;
esac >> sbatch.log 2>&1
echo "4711;somewhere"
"#;

/// Puts a program into the folder that is searched first.
fn install(desk: &Desk, name: &str, script: &str) {
    std::fs::create_dir_all(desk.path("bin")).unwrap();
    let path = format!("bin/{name}");
    desk.write(&path, script);
    std::fs::set_permissions(desk.path(&path), PermissionsExt::from_mode(0o755)).unwrap();
}

#[test]
fn whatever_a_scheduler_does_the_tables_are_those_of_a_local_run() {
    let desk = Desk::with(&[("study.toml", &study(&[ARMS, STOPPING_ARM].concat()))]);
    desk.expect(3, "run study.toml --jobs 2 --out local");
    install(&desk, "sbatch", SBATCH);
    let path = format!("{}:{}", desk.path("bin").display(), std::env::var("PATH").unwrap());
    let snowlab = |words: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_snowlab"));
        command.args(words.split_whitespace()).current_dir(desk.folder.path()).env("PATH", &path);
        let output = command.output().unwrap();
        let printed =
            [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
        (output.status.code(), printed.concat())
    };
    let (code, printed) = snowlab("submit study.toml --element-time 0s -- --partition=long --qos=low");
    assert_eq!(code, Some(0), "{printed}");
    assert!(
        printed.contains("8 cases in 8 elements") && printed.contains("submitted: array 4711"),
        "{printed}"
    );
    let calls = desk.read("sbatch.calls");
    assert!(calls.lines().all(|call| call.contains("--partition=long --qos=low")), "{calls}");
    assert!(calls.contains("--dependency=afterany:4711"), "{calls}");
    hold_tables(&desk, "results", "local");
    // Of elements that wait or run nothing is submitted a second time.
    std::fs::remove_dir_all(desk.path("results/tiny/cases")).unwrap();
    install(&desk, "sbatch", "#!/bin/sh\necho 4712\n");
    install(
        &desk,
        "squeue",
        "#!/bin/sh\necho \"$@\" >> squeue.calls\nfor k in 0 1 2; do echo 4711_$k PENDING Priority; done\n",
    );
    let (code, printed) = snowlab("submit study.toml --element-time 0s");
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains("3 cases are left to elements that wait or run"), "{printed}");
    assert!(printed.contains("5 cases in 5 elements"), "{printed}");
    let (_, status) = snowlab("status study.toml");
    assert!(status.contains("queued       4711_1  PENDING Priority"), "{status}");
    let calls = desk.read("squeue.calls");
    assert!(calls.lines().last().unwrap().ends_with("-j 4711,4711,4712,4712"), "both submissions: {calls}");
    // A cluster that says no is told of in its words.
    install(&desk, "sbatch", "#!/bin/sh\necho 'no such partition' >&2\nexit 1\n");
    let (code, printed) = snowlab("submit study.toml");
    assert_eq!(code, Some(2));
    assert!(printed.contains("no such partition"), "{printed}");
}
