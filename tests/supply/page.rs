//! docs/supply-chain.md is what is found.

use std::collections::BTreeMap;

use super::allowed::ALLOWED;
use super::metadata::foreign;
use super::root;
use super::sources::locked_foreign;

const PAGE: &str = "docs/supply-chain.md";

fn page() -> String {
    let crates = foreign();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for licence in crates.iter().filter_map(|of| of.licence.clone()) {
        *counts.entry(licence).or_default() += 1;
    }
    let mut found: Vec<(String, usize)> = counts.into_iter().collect();
    found.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let allowed: String = ALLOWED.iter().map(|a| format!("| {} | {} |\n", a.licence, a.why)).collect();
    let found: String = found.iter().map(|(licence, count)| format!("| {licence} | {count} |\n")).collect();
    format!(
        "# Other people's code\n\n\
         This page is written and held by `tests/supply`, which is part of `make test` and needs no network.\n\n\
         ## The rule\n\n\
         - A crate comes from cargo's own registry or is one of our three. No repository, no folder elsewhere, no second registry.\n\
         - Cargo.lock is complete and has a checksum of every crate; all commands of Makefile, `.ci/run`, `tests/*/run` and README are `--locked`.\n\
         - A crate's licence expression (SPDX: AND, OR, WITH; a slash is an OR) can be satisfied from the table below. Licences that no crate needs are not in it.\n\n\
         A test that fails names the crate, its version, its licence and what to do.\n\n\
         ## What may be\n\n\
         | licence | why |\n|---|---|\n{allowed}\n\
         ## What there is\n\n\
         Cargo.lock names {} crates of other people's for all platforms; {} of them are fetched on x86_64 Linux. As their manifests have it:\n\n\
         | licence | crates |\n|---|---|\n{found}",
        locked_foreign(),
        crates.len()
    )
}

/// Elsewhere other crates are fetched.
#[cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]
#[test]
fn the_page_tells_what_there_is() {
    let (page, path) = (page(), root().join(PAGE));
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    if page != kept {
        let other = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("supply-chain.md");
        std::fs::write(&other, page).expect("cargo's folder for tests can be written");
        panic!("{PAGE} tells of other crates; look what has changed, then: cp {} {PAGE}", other.display());
    }
}
