//! 0 done, 1 an expectation failed, 2 usage or bad input, 3 cases failed.

use super::{ARMS, Desk, SCENE, STOPPING_ARM, study};

#[test]
fn zero_where_all_is_done_and_as_expected() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2");
    let printed = desk.expect(0, "check study.toml");
    assert!(printed.contains("tiny: 3 expectations, 0 failed"), "{printed}");
    desk.expect(0, "--help");
}

#[test]
fn one_where_a_range_is_left() {
    let text = study(ARMS).replace("range = [300.0, 300.0]", "range = [301.0, 400.0]");
    let desk = Desk::with(&[("study.toml", &text)]);
    desk.expect(0, "run study.toml --jobs 2");
    let printed = desk.expect(1, "check study.toml");
    assert!(printed.contains("tiny: 3 expectations, 3 failed"), "{printed}");
    assert!(
        printed.contains("FAILED  random: each `particles` in [301, 400]: 300.0000, 300.0000"),
        "{printed}"
    );
}

#[test]
fn one_where_a_case_has_stopped() {
    let desk = Desk::with(&[("study.toml", &study(STOPPING_ARM))]);
    desk.expect(3, "run study.toml --jobs 2");
    let printed = desk.expect(1, "check study.toml");
    assert!(printed.contains("FAILED  leaping block 1: particle"), "{printed}");
}

#[test]
fn two_where_the_input_is_bad() {
    let text = study(ARMS);
    let wrong_metric = text.replace("\"particles\"", "\"partikels\"");
    let bad = SCENE.replace("radius = 0.25", "radius = -0.25");
    let files = [
        ("study.toml", text.as_str()),
        ("metric.toml", &wrong_metric),
        ("scene.toml", SCENE),
        ("bad.toml", &bad),
    ];
    let desk = Desk::with(&files);
    for (line, says) in [
        ("run", "required arguments"),
        ("run nowhere.toml", "nowhere.toml: cannot be read"),
        ("run study.toml --profile fast", "study.toml: profile `fast`"),
        ("run scene.toml", "scene.toml: line 4, `body`: unknown key"),
        ("simulate study.toml --out x", "`arm`: unknown key"),
        ("simulate bad.toml --out x", "bad.toml: line 5, `body.0.region.radius`: is -0.25"),
        ("sample bad.toml -o x.csv", "bad.toml: line 5, `body.0.region.radius`: is -0.25"),
        ("sample scene.toml -o points.xyz", "use .csv or .ply"),
        (
            "fragments nowhere.csv --link 0.1",
            "snowlab: nowhere.csv: No such file or directory (os error 2); check the path, its permissions",
        ),
        ("fragments nowhere.csv --link 0", "snowlab: `--link` is 0.0; allowed: above 0"),
        ("fragments nowhere.csv --link -1", "snowlab: `--link` is -1.0; allowed: above 0"),
        ("fragments nowhere.csv --link 1 --min-mass-share -1", "`--min-mass-share` is -1.0; allowed: 0 to 1"),
        (
            "run metric.toml",
            "`expect.0.metric`: is \"partikels\"; allowed: a numeric column of `cases.csv`, such as parti",
        ),
        (
            "run study.toml --case abc",
            "`--case` is \"abc\", which no case of the study begins with; `snowlab plan` lists",
        ),
        ("run study.toml --index 6", "`--index` is 6; allowed: 0 to 5"),
        ("run study.toml --shard 0/3", "allowed: K/N with 1 <= K <= N, such as 3/8"),
        ("run study.toml --shard 4/3", "allowed: K/N with 1 <= K <= N, such as 3/8"),
        ("run study.toml --time-limit soon", "invalid value 'soon' for '--time-limit <TIME>'"),
        ("run study.toml --fail-fast --keep-going", "cannot be used with"),
        ("submit study.toml --executor cloud", "[possible values: slurm]"),
        ("completions tcsh", "[possible values: bash"),
        ("report study.toml", "nothing has been run"),
        ("check study.toml", "has not been run"),
    ] {
        let printed = desk.expect(2, line);
        assert!(printed.contains(says), "snowlab {line}\n{printed}");
    }
}

/// Voids that find no room: the case cannot be built, which is a row as any other stop, and the others run all the same.
#[test]
fn cases_that_cannot_be_built_are_rows() {
    let crowded = "[[arm]]\nid = \"crowded\"\nset = { \"body.0.voids\" = { kind = \"circles\", porosity = 0.6, mean_radius = 0.1 } }\n";
    let claim = "[[claim]]\nid = \"crowded-breaks-more\"\nsentence = \"It does.\"\n\
                 contrast = { paired = { treated = \"crowded\", control = \"lattice\" } }\n";
    let desk = Desk::with(&[("study.toml", &study(&[crowded, ARMS, claim].concat()))]);
    let printed = desk.expect(3, "run study.toml --jobs 2");
    assert!(printed.contains("crowded block 1 stopped: `body.0`: no void field"), "{printed}");
    let cases = super::rows(&desk.read("results/tiny/cases.csv"));
    assert_eq!(cases.len(), 8);
    assert_eq!(cases[0]["outcome"], "stopped(not-built)");
    assert!(cases[0]["failure"].contains("no void field"), "{:?}", cases[0]);
    assert_eq!([&cases[0]["particles"], &cases[0]["mass"], &cases[0]["time_unit"]], ["", "", ""]);
    assert_eq!(cases[2]["failure"], "", "{:?}", cases[2]);
    // The scene is the same the next time: it is not tried again, and the check fails for the case, not for its lack.
    assert!(desk.expect(0, "plan study.toml").ends_with("8 cases: 8 finished, 0 to run\n"));
    let printed = desk.expect(1, "check study.toml");
    assert!(printed.contains("FAILED  crowded block 2: `body.0`: no void field"), "{printed}");
    // For a claim its blocks are lost.
    desk.expect(0, "report study.toml");
    let claims = super::rows(&desk.read("results/tiny/claims.csv"));
    let crowded = claims.iter().find(|row| row["claim"] == "crowded-breaks-more").unwrap();
    assert_eq!([&crowded["blocks"], &crowded["lost_blocks"]], ["0", "2"]);
}

/// Whether it stopped now or in an earlier run.
#[test]
fn three_where_a_case_of_a_study_has_stopped() {
    let desk = Desk::with(&[("study.toml", &study(STOPPING_ARM))]);
    for to_run in [2, 0] {
        let printed = desk.expect(3, "run study.toml --jobs 2");
        assert!(printed.contains(&format!("2 cases, {to_run} to run")), "{printed}");
        assert!(printed.contains("2 of 2 cases stopped"), "{printed}");
    }
}

#[test]
fn three_where_a_scene_stops() {
    let text = SCENE.replace("spacing = 0.05", "spacing = 0.05\nfixed_step = 0.02");
    let desk = Desk::with(&[("scene.toml", &text)]);
    let printed = desk.expect(3, "simulate scene.toml --out frames");
    assert!(printed.contains("stopped(step-rejected)") && printed.contains("cells in one step"), "{printed}");
}

/// `snowlab plan | head` ends as `ls | head` does: by the signal, without a word.
#[cfg(unix)]
#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    use std::os::unix::process::ExitStatusExt;
    use std::process::{Command, Stdio};
    let desk = Desk::with(&[("study.toml", &study(ARMS).replace("count = 2\n", "count = 2000\n"))]);
    let mut plan = Command::new(env!("CARGO_BIN_EXE_snowlab"))
        .args(["plan", "--no-trials", "study.toml"])
        .current_dir(desk.folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    // Many lines, of which no one reads any.
    drop(plan.stdout.take());
    let output = plan.wait_with_output().expect("it ends");
    assert_eq!(output.status.signal(), Some(signal_hook::consts::SIGPIPE), "{output:?}");
    assert!(output.stderr.is_empty(), "{output:?}");
}
