//! Whatever a user may hand in: it is understood or refused in words that help, and nothing panics or hangs.

mod extremes;
mod hostile;
mod messages;
mod points;

#[path = "../meshes/mod.rs"]
mod made;
