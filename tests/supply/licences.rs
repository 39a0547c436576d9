//! Under which licences other people's code stands.

use super::allowed::{ALLOWED, is_allowed};
use super::expression::is_satisfied;
use super::metadata::{Foreign, foreign};

/// Why a crate may not be used, if it may not.
fn objection(of: &Foreign, allows: &dyn Fn(&str) -> bool) -> Option<String> {
    let Foreign { name, version, licence } = of;
    let remedy = "take another crate, or, if its text asks for no more than the allowed ones do, add it with the reason to \
                  tests/supply/allowed.rs";
    let Some(licence) = licence else {
        return Some(format!("{name} {version} names no licence in its manifest; take another crate"));
    };
    match is_satisfied(licence, allows) {
        Ok(true) => None,
        Ok(false) => Some(format!("{name} {version} stands under {licence}, which is not allowed; {remedy}")),
        Err(error) => Some(format!(
            "{name} {version} stands under {licence:?}, which is no licence expression: {error}; {remedy}"
        )),
    }
}

#[test]
fn every_crate_has_a_licence_that_is_allowed() {
    let crates = foreign();
    assert!(crates.len() > 100, "only {} crates", crates.len());
    let objections: Vec<String> = crates.iter().filter_map(|of| objection(of, &is_allowed)).collect();
    assert!(objections.is_empty(), "{}", objections.join("\n"));
}

/// Of x86_64 Linux, for elsewhere other crates are built.
#[cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]
#[test]
fn no_licence_is_allowed_that_nobody_needs() {
    let crates = foreign();
    for without in &ALLOWED {
        let others = |licence: &str| is_allowed(licence) && licence != without.licence;
        assert!(
            crates.iter().any(|of| objection(of, &others).is_some()),
            "no crate needs {}; delete it from tests/supply/allowed.rs",
            without.licence
        );
    }
}

#[test]
fn objections_name_crate_version_licence_and_remedy() {
    for (licence, says) in [
        (Some("GPL-3.0-only"), "one 1.2.3 stands under GPL-3.0-only, which is not allowed; take another"),
        (Some("MIT AND GPL-3.0-only"), "one 1.2.3 stands under MIT AND GPL-3.0-only, which is not allowed"),
        (Some("MIT or so"), "no licence expression: `or` is not expected"),
        (None, "one 1.2.3 names no licence"),
    ] {
        let of = Foreign { name: "one".into(), version: "1.2.3".into(), licence: licence.map(String::from) };
        let said = objection(&of, &is_allowed).expect("an objection");
        assert!(said.contains(says), "{said}");
    }
}
