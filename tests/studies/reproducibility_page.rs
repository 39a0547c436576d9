//! `docs/reproducibility.md` against the code: every test it rests on is there.

use std::path::Path;

const PAGE: &str = include_str!("../../docs/reproducibility.md");

/// Names of tests: words of the page in backticks that are held together by underscores, three at least.
fn tests_named() -> Vec<&'static str> {
    let is_name = |text: &&str| {
        text.matches('_').count() >= 3 && text.chars().all(|c| c == '_' || c.is_ascii_alphanumeric())
    };
    PAGE.split('`').skip(1).step_by(2).filter(is_name).collect()
}

/// The text of all Rust files below a folder.
fn sources(folder: &Path, text: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, text);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            text.push_str(&std::fs::read_to_string(&path).expect("a source can be read"));
        }
    }
}

#[test]
fn every_test_that_the_page_names_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut text = String::new();
    ["crates", "tests"].into_iter().for_each(|folder| sources(&root.join(folder), &mut text));
    let names = tests_named();
    assert!(names.len() >= 14, "{names:?}");
    for name in names {
        assert!(text.contains(&format!("#[test]\nfn {name}()")), "no test `{name}`");
    }
}
