//! Every command of the project that resolves crates takes those of Cargo.lock.

use super::root;

/// Cargo's commands that would change Cargo.lock where it is not complete.
const RESOLVING: [&str; 12] = [
    "bench", "build", "check", "clippy", "doc", "fetch", "install", "metadata", "run", "rustc", "test",
    "tree",
];

/// The commands of a script or page that resolve crates without `--locked`, and how many resolve crates.
fn unlocked(text: &str) -> (Vec<String>, usize) {
    let joined = text.replace("\\\n", " ");
    let commands = joined.lines().filter(|line| !line.trim_start().starts_with('#')).filter(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.windows(2).any(|pair| {
            pair[0].to_lowercase().trim_end_matches(['"', '\'', '}', ')']).ends_with("cargo")
                && RESOLVING.contains(&pair[1])
        })
    });
    let commands: Vec<String> = commands.map(|line| line.trim().to_string()).collect();
    let count = commands.len();
    (commands.into_iter().filter(|line| !line.contains("--locked")).collect(), count)
}

#[test]
fn every_command_is_locked() {
    let mut files = vec!["Makefile".into(), ".ci/run".into(), "README.md".into()];
    for entry in std::fs::read_dir(root().join("tests")).expect("the folder of tests") {
        let script = entry.expect("an entry").path().join("run");
        files.extend(script.exists().then_some(script));
    }
    let mut counts = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(root().join(&file)).expect("it can be read");
        let (unlocked, count) = unlocked(&text);
        assert!(unlocked.is_empty(), "{}: give --locked to\n{}", file.display(), unlocked.join("\n"));
        counts.push(count);
    }
    // Of the Makefile: the variable SNOWLAB, test, clippy, doc, bench.
    assert!(counts[0] >= 5 && counts.len() >= 6, "commands by file: {counts:?}");
}

#[test]
fn commands_are_found_however_they_are_written() {
    for line in [
        "cargo build",
        "\t$(CARGO) test --workspace",
        "(cd x && CARGO_TARGET_DIR=y \"${CARGO:-cargo}\" run --release)",
        "alias snowlab='cargo run --release --'",
        "\"${CARGO:-cargo}\" build \\\n    --release",
    ] {
        assert_eq!(unlocked(line).0.len(), 1, "{line}");
        assert_eq!(unlocked(&format!("{line} --locked")), (Vec::new(), 1), "{line}");
    }
    for line in ["cargo fmt --all", "# cargo build", "CARGO ?= cargo", "what cargo tells", "$(CARGO) clean"] {
        assert_eq!(unlocked(line), (Vec::new(), 0), "{line}");
    }
}
