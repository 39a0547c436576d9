//! Targets of the Makefile, on tiny studies under the names of the project's own.

use std::path::Path;
use std::process::Command;

use super::{ARMS, Desk, study};

/// The command in place of the build, in a folder with its studies.
fn make(desk: &Desk, target: &str) -> (Option<i32>, String) {
    let makefile = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../Makefile");
    let output = Command::new("make")
        .arg("-f")
        .arg(makefile)
        .arg(format!("SNOWLAB={}", env!("CARGO_BIN_EXE_snowlab")))
        .arg(target)
        .current_dir(desk.folder.path())
        .output()
        .expect("make is there");
    let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("UTF-8"));
    (output.status.code(), printed.concat())
}

fn desk() -> Desk {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("studies")).unwrap();
    let names = [
        "pilot",
        "replicates",
        "damping",
        "stencil",
        "stencil3d",
        "knob",
        "knob-validation",
        "tradeoff",
        "tradeoff-fragments",
        "wall3d",
        "placement",
    ];
    for name in names {
        desk.write(&format!("studies/{name}.toml"), &study(ARMS).replace("\"tiny\"", &format!("{name:?}")));
    }
    desk
}

#[test]
fn reports_are_written_of_what_has_been_run() {
    let desk = desk();
    let (code, printed) = make(&desk, "report");
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains("placement has not been run; `make study` runs it"), "{printed}");
    desk.expect(0, "run studies/placement.toml --jobs 2");
    let (code, printed) = make(&desk, "report");
    assert_eq!(code, Some(0), "{printed}");
    assert!(desk.path("results/placement/report.html").exists(), "{printed}");
    assert!(printed.contains("knob has not been run; `make full` runs it"), "{printed}");
    let index = desk.read("results/index.html");
    assert!(
        index.contains("placement&#x2f;report.html") && index.contains("Without results: damping, knob"),
        "{index}"
    );
}
