//! `docs/input.md` as data.

use std::collections::BTreeMap;

/// The page's text.
pub const TEXT: &str = include_str!("../../../docs/input.md");

/// A row of a table of keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The key.
    pub key: String,
    /// Kinds that have it; none named means all.
    pub kinds: Vec<String>,
    /// Its type.
    pub word: String,
    /// Its default as written.
    pub default: String,
    /// What is allowed, as written.
    pub allowed: String,
}

/// Which half of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    Scene,
    Study,
}

/// The tables of keys of one half of the page, by path; the document's own has the path "".
pub fn tables(part: Part) -> BTreeMap<String, Vec<Row>> {
    let (scene, study) = TEXT.split_once("\n## Study files\n").expect("the page has two halves");
    let text = if part == Part::Scene { scene } else { study };
    let mut tables = BTreeMap::new();
    for section in text.split("\n### ").skip(1) {
        let (heading, body) = section.split_once('\n').expect("a heading is a line");
        let rows = rows(body);
        let paths = backticked(heading);
        let paths = if paths.is_empty() { vec![String::new()] } else { paths };
        for path in paths {
            assert!(tables.insert(path.clone(), rows.clone()).is_none(), "`{path}` is there twice");
        }
    }
    tables
}

fn rows(body: &str) -> Vec<Row> {
    let mut lines = body.lines().filter(|line| line.starts_with('|')).map(cells);
    let header = lines.next().expect("a section has a table");
    let column = |name: &str| header.iter().position(|cell| cell == name);
    let place = |name: &str| column(name).unwrap_or_else(|| panic!("no column {name} in {header:?}"));
    assert_eq!(place("Meaning") + 1, header.len());
    lines
        .skip(1)
        .map(|cells| {
            assert_eq!(cells.len(), header.len(), "{cells:?}");
            assert!(!cells[place("Meaning")].is_empty() || !cells[place("Allowed")].is_empty(), "{cells:?}");
            Row {
                key: backticked(&cells[0]).concat(),
                kinds: column("Kind").map_or(Vec::new(), |kind| backticked(&cells[kind])),
                word: cells[place("Type")].clone(),
                default: cells[place("Default")].clone(),
                allowed: cells[place("Allowed")].clone(),
            }
        })
        .collect()
}

fn cells(line: &str) -> Vec<String> {
    line.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_string()).collect()
}

/// What stands in backticks.
pub fn backticked(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(String::from).collect()
}

/// The TOML examples: text, and whether it is a study.
pub fn examples() -> Vec<(String, bool)> {
    let blocks = TEXT.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap_or_default());
    blocks.map(|text| (text.to_string(), text.contains("\nquestion = "))).collect()
}
