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

#[test]
fn whatever_a_scheduler_does_the_tables_are_those_of_a_local_run() {
    let desk = Desk::with(&[("study.toml", &study(&[ARMS, STOPPING_ARM].concat())), ("bin-sbatch", SBATCH)]);
    desk.expect(3, "run study.toml --jobs 2 --out local");
    std::fs::create_dir(desk.path("bin")).unwrap();
    std::fs::rename(desk.path("bin-sbatch"), desk.path("bin/sbatch")).unwrap();
    std::fs::set_permissions(desk.path("bin/sbatch"), PermissionsExt::from_mode(0o755)).unwrap();
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
    // A cluster that says no is told of in its words.
    desk.write("bin/sbatch", "#!/bin/sh\necho 'no such partition' >&2\nexit 1\n");
    std::fs::remove_dir_all(desk.path("results/tiny/cases")).unwrap();
    let (code, printed) = snowlab("submit study.toml");
    assert_eq!(code, Some(2));
    assert!(printed.contains("no such partition"), "{printed}");
}
