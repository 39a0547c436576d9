//! What is refused, and in which words: file or place, key, value, what is allowed or to do. Nothing panics, hangs or is
//! let pass.

mod files;
mod maps;
mod questions;
mod ranges;
mod scenes;
mod studies;

pub use ranges::SCENES;

use std::path::Path;

use snowlab_study::assemble::assemble;
use snowlab_study::spec::{self, SceneSpec, SpecError};
use snowlab_study::sweep::Study;

/// Words of the implementation that no user should have to understand.
const JARGON: [&str; 8] = ["usize", "u64", "f64", "struct", "variant", "sequence", "serde", "field `"];

/// Bytes of a message that is still read.
pub const MOST_SAID: usize = 600;

/// A scene that is accepted.
pub const SCENE: &str = r#"
[numerics]
spacing = 0.05

[[body]]
region = { kind = "ball", centre = [0.0, 0.3], radius = 0.25 }
placement = { kind = "random", count = 50 }

[[collider]]
shape = { kind = "half-space", point = [0.0, 0.0], normal = [0.0, 1.0] }

[output]
frame_interval = 0.01
end = 0.05
"#;

/// A study that is accepted.
pub const STUDY: &str = r#"
name = "tiny"
question = "Is it refused?"
[blocks]
first = 1
count = 2
[measure]
largest_spacing = 0.05
[scene.numerics]
spacing = 0.05
[[scene.body]]
region = { kind = "ball", centre = [0.0, 0.3], radius = 0.25 }
placement = { kind = "random", count = 50 }
velocity = [0.0, -1.0]
[scene.output]
frame_interval = 0.01
end = 0.05
[[arm]]
id = "one"
[[arm]]
id = "two"
"#;

/// A text in which `from` is replaced, and what the refusal must say.
struct Refused {
    from: &'static str,
    to: &'static str,
    says: &'static [&'static str],
}

/// One line of a table.
const fn refused(from: &'static str, to: &'static str, says: &'static [&'static str]) -> Refused {
    Refused { from, to, says }
}

/// Parses and assembles a scene.
fn scene(text: &str) -> Result<(), SpecError> {
    let scene: SceneSpec = spec::parse(text)?;
    match scene.dimension {
        3 => assemble::<f64, 3>(&scene, Path::new(".")).map(|_| ()),
        _ => assemble::<f64, 2>(&scene, Path::new(".")).map(|_| ()),
    }
}

/// Parses and expands a study.
fn study(text: &str) -> Result<(), SpecError> {
    Study::parse(text, None).map(|_| ())
}

/// Holds each line of a table against what `read` says of the changed `base`.
fn hold(base: &str, read: fn(&str) -> Result<(), SpecError>, table: &[Refused]) {
    read(base).expect("the base is accepted");
    let mut faults = Vec::new();
    for Refused { from, to, says } in table {
        assert!(base.contains(from), "`{from}` is not in the base");
        match read(&base.replacen(from, to, 1)) {
            Ok(()) => faults.push(format!("accepted: {to}")),
            Err(error) => faults.extend(fault(&error.to_string(), to, says)),
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

/// A refusal of `what` that says what it must, in words of the user, and briefly.
pub fn hold_message(message: &str, what: &str, says: &[&str]) {
    assert_eq!(fault(message, what, says), None);
}

fn fault(message: &str, what: &str, says: &[&str]) -> Option<String> {
    let of_it = |fault: String| Some(format!("of `{what}` it is said: {message}\n{fault}"));
    if let Some(said) = says.iter().find(|said| !message.contains(**said)) {
        return of_it(format!("but not: {said}"));
    }
    // The names of precisions are the user's.
    let words = message.replace("`f64` or `f32`", "").replace("\"f64\"", "").replace("`f64`", "");
    if let Some(word) = JARGON.iter().find(|word| words.contains(**word)) {
        return of_it(format!("with the word {word}"));
    }
    if message.len() > MOST_SAID { of_it("which is long".into()) } else { None }
}
