//! Where crates come from: ours from this workspace, all others from the registry that cargo takes where none is named.

use std::collections::BTreeSet;

use super::{metadata, root};

const OURS: [&str; 3] = ["snowlab-sampler", "snowlab-solver", "snowlab-study"];

/// Of all platforms, by Cargo.lock.
#[test]
fn every_locked_crate_is_ours_or_of_the_registry_with_its_checksum() {
    let crates = locked();
    let registries: BTreeSet<&str> = crates.iter().filter_map(|locked| locked.source.as_deref()).collect();
    assert_eq!(
        registries.len(),
        1,
        "crates come from {registries:?}; allowed: one registry, cargo's own. Take the others out of Cargo.toml"
    );
    for Locked { name, version, source, has_checksum } in &crates {
        match source {
            None => assert!(
                OURS.contains(&name.as_str()),
                "{name} {version} comes from a folder that is no crate of this workspace; take it from the registry"
            ),
            Some(source) => assert!(
                source.starts_with("registry+") && *has_checksum,
                "{name} {version} comes from {source}, checksum: {has_checksum}; allowed: a registry, with a checksum"
            ),
        }
    }
    let ours: Vec<&str> = crates.iter().filter(|c| c.source.is_none()).map(|c| c.name.as_str()).collect();
    assert_eq!(ours, OURS);
}

/// Cargo names the registry of a dependency only where it is not its own.
#[test]
fn no_manifest_names_another_registry_or_a_repository() {
    let packages = metadata::packages();
    assert!(packages.len() > OURS.len());
    for package in &packages {
        for dependency in package["dependencies"].as_array().expect("an array") {
            let (name, source) = (&dependency["name"], &dependency["source"]);
            let is_ours = name.as_str().is_some_and(|name| OURS.contains(&name));
            let of_registry = source.as_str().is_some_and(|source| source.starts_with("registry+"));
            assert!(
                dependency["registry"].is_null() && (of_registry || is_ours),
                "{} {} takes {name} from {source}; allowed: the registry that cargo takes where none is named",
                package["name"],
                package["version"]
            );
        }
    }
}

/// A crate of Cargo.lock.
struct Locked {
    name: String,
    version: String,
    source: Option<String>,
    has_checksum: bool,
}

fn locked() -> Vec<Locked> {
    let text = std::fs::read_to_string(root().join("Cargo.lock")).expect("Cargo.lock can be read");
    let lock: toml::Table = text.parse().expect("TOML");
    let packages = lock["package"].as_array().expect("an array of crates");
    packages
        .iter()
        .map(|package| {
            let entry = |key: &str| package.get(key).and_then(toml::Value::as_str).map(String::from);
            Locked {
                name: entry("name").expect("a name"),
                version: entry("version").expect("a version"),
                source: entry("source"),
                has_checksum: entry("checksum").is_some(),
            }
        })
        .collect()
}

/// Crates of others, for all platforms.
pub fn locked_foreign() -> usize {
    locked().iter().filter(|locked| locked.source.is_some()).count()
}
