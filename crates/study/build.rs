//! Tells the program what compiled it: its manifests say so.

use std::process::Command;

fn main() {
    let variable = |name: &str| std::env::var(name).unwrap_or_else(|_| "unknown".into());
    let version = Command::new(variable("RUSTC")).arg("--version").output();
    let version =
        version.map_or("unknown".into(), |out| String::from_utf8_lossy(&out.stdout).trim().to_string());
    println!("cargo::rustc-env=SNOWLAB_RUSTC={version}");
    println!("cargo::rustc-env=SNOWLAB_TARGET={}", variable("TARGET"));
    println!("cargo::rerun-if-changed=build.rs");
}
