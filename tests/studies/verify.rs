//! `snowlab verify`: evidence, page and exit codes.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Runs `snowlab verify` with some words in a folder: exit code and what was printed.
fn verify(folder: &Path, words: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_snowlab"));
    let output =
        command.arg("verify").args(words).current_dir(folder).output().expect("the command can be started");
    let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("UTF-8"));
    (output.status.code(), printed.concat())
}

/// Names and bytes of the files in a folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("the folder is there").map(|entry| entry.unwrap());
    let files = entries.filter(|entry| entry.path().is_file());
    files
        .map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap()))
        .collect()
}

#[test]
fn experiments_leave_tables_figures_and_a_page_twice_the_same() {
    let desk = tempfile::tempdir().unwrap();
    let mut found = Vec::new();
    for out in ["one", "two"] {
        let words =
            ["--quick", "--out", out, "--page", "docs/page.md", "strain-path", "vibration", "incline"];
        std::fs::create_dir_all(desk.path().join("docs")).unwrap();
        let (code, printed) = verify(desk.path(), &words);
        assert_eq!(code, Some(0), "{printed}");
        assert!(printed.contains("0 outside their range"), "{printed}");
        found.push(files(&desk.path().join(out)));
    }
    assert_eq!(found[0], found[1]);
    let names: Vec<&str> = found[0].keys().map(String::as_str).collect();
    for name in ["checks.csv", "dictionary.csv", "incline.csv", "strain-path.csv", "vibration.csv"] {
        assert!(names.contains(&name), "{name} is not among {names:?}");
    }
    let page = std::fs::read_to_string(desk.path().join("docs/page.md")).unwrap();
    for heading in ["A strain path", "A vibrating bar", "A block on an inclined plane"] {
        assert!(page.contains(&format!("## {heading}")), "{heading}");
    }
    assert!(page.contains("../two/figures/vibration.png"), "paths are seen from the page");
    assert!(desk.path().join("two/figures/vibration.png").exists());
    assert!(!page.contains("{{") && !page.contains("{%") && !page.contains("fails"), "{page}");
}

#[test]
fn an_unknown_experiment_is_refused_with_the_names_of_all() {
    let desk = tempfile::tempdir().unwrap();
    let (code, printed) = verify(desk.path(), &["trebuchet"]);
    assert_eq!(code, Some(2), "{printed}");
    assert!(printed.contains("\"trebuchet\"") && printed.contains("manufactured, vibration"), "{printed}");
    assert!(!desk.path().join("results").exists());
    let (code, printed) = verify(desk.path(), &["--list"]);
    assert_eq!(code, Some(0), "{printed}");
    for experiment in snowlab_study::verify::EXPERIMENTS {
        assert!(printed.contains(experiment.id) && printed.contains(experiment.title), "{printed}");
    }
}

#[test]
fn the_committed_page_is_what_the_committed_tables_and_the_templates_give() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let rendered = snowlab_study::verify::page(&root.join("results/verify"), "../results/verify")
        .expect("the committed tables can be read");
    let committed = std::fs::read_to_string(root.join("docs/verification.md")).unwrap();
    assert!(rendered == committed, "docs/verification.md is out of date: `make verify` writes it");
}
