//! `docs/notation.md` against the code: every name stands in the file it is said to.

use std::path::Path;

const PAGE: &str = include_str!("../../docs/notation.md");

/// What stands in backticks.
fn backticked(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

#[test]
fn every_name_stands_in_its_file() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut names = 0;
    for line in PAGE.lines().filter(|line| line.starts_with('|') && line.contains(".rs`")) {
        // A bar within a cell is escaped.
        let line = line.trim_matches('|').replace("\\|", "");
        let cells: Vec<&str> = line.split('|').collect();
        let [_, _, _, named, file, _] = cells[..] else { panic!("six columns: {line}") };
        let [file] = backticked(file)[..] else { panic!("one file: {line}") };
        let source =
            std::fs::read_to_string(crates.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(!backticked(named).is_empty(), "a name: {line}");
        for name in backticked(named) {
            names += 1;
            let (owner, member) = name.split_once('.').unwrap_or(("", name));
            let is_owner = |kind: &str| source.contains(&format!("pub {kind} {owner}"));
            assert!(
                owner.is_empty() || ["struct", "enum", "trait"].into_iter().any(is_owner),
                "{owner} in {file}"
            );
            let forms = [
                format!("{member}:"),
                format!("fn {member}(",),
                format!("fn {member}<"),
                format!("const {member}:"),
            ];
            assert!(forms.iter().any(|form| source.contains(form)), "{member} in {file}");
        }
    }
    assert!(names > 50, "{names} names were found");
}
