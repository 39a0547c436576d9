//! What cargo says of the crates that are built for this machine.

use std::process::{Command, Output};

use serde_json::Value;

use super::root;

/// A crate of somebody else's.
pub struct Foreign {
    pub name: String,
    pub version: String,
    /// As its manifest has it.
    pub licence: Option<String>,
}

/// What `cargo metadata` says. `--locked`: Cargo.lock must be complete. `--offline`: all has been fetched to build this test.
pub fn packages() -> Vec<Value> {
    let version = cargo(&["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("cargo names the host");
    let line = ["metadata", "--locked", "--offline", "--format-version", "1", "--filter-platform", host];
    let metadata: Value = serde_json::from_str(&cargo(&line)).expect("JSON");
    metadata["packages"].as_array().expect("an array of crates").clone()
}

/// The crates that are not ours.
pub fn foreign() -> Vec<Foreign> {
    let text = |value: &Value| value.as_str().map(String::from);
    let packages = packages().into_iter().filter(|package| !package["source"].is_null());
    packages
        .map(|package| Foreign {
            name: text(&package["name"]).expect("a name"),
            version: text(&package["version"]).expect("a version"),
            licence: text(&package["license"]),
        })
        .collect()
}

fn cargo(line: &[&str]) -> String {
    let program = std::env::var("CARGO").unwrap_or("cargo".into());
    let output = Command::new(program).args(line).current_dir(root()).output().expect("cargo can be started");
    let Output { status, stdout, stderr } = output;
    let said = String::from_utf8_lossy(&stderr);
    assert!(
        status.success(),
        "cargo {}: {said}\nwhere Cargo.lock has to change: build without --locked, look at the change and commit it; where crates have not \
         been fetched: cargo fetch --locked",
        line.join(" ")
    );
    String::from_utf8(stdout).expect("UTF-8")
}
