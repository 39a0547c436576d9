//! What other people's code the project takes, from where and under which licence: asked of cargo, without a network.

mod allowed;
mod commands;
mod expression;
mod licences;
mod metadata;
mod page;
mod sources;

use std::path::PathBuf;

/// The folder of the workspace.
fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}
