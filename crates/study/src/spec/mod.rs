//! What a user writes: scene and study files in TOML. Every key is documented in `docs/input.md`.

mod map_rules;
pub mod override_path;
mod place;
pub mod range;
mod refusal;
pub mod sample;
pub mod scene;
pub mod scene_rules;
pub mod study;
pub mod study_rules;

pub use scene::SceneSpec;
pub use study::StudySpec;

use std::fmt::Display;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;
use toml::Value;

/// A file that cannot be used as it is.
#[derive(Debug, Error)]
pub enum SpecError {
    /// The file cannot be read.
    #[error("{}: cannot be read; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file of particles or a mesh that a scene names cannot be read, just now or ever.
    #[error("{place}: {message}")]
    Particles {
        /// File or case, and key.
        place: String,
        /// Which file, and why.
        message: String,
    },
    /// Something that means nothing.
    #[error("{place}: {message}")]
    Value {
        /// File or case, and key.
        place: String,
        /// What is wrong, what is allowed, what to do.
        message: String,
    },
}

impl SpecError {
    /// A value at `place` that means nothing.
    pub fn value(place: impl Into<String>, message: impl Into<String>) -> Self {
        SpecError::Value {
            place: brief(&place.into(), MOST_OF_PLACE),
            message: brief(&message.into(), MOST_OF_MESSAGE),
        }
    }

    /// The same error with `place` before its own place.
    pub fn within(self, place: impl Display) -> Self {
        self.before(format!("{place}: "))
    }

    /// The same error with the line of the scene's or study's `text` that has its key.
    pub fn in_text(self, text: &str) -> Self {
        self.on_line(|place| place::line_of_key(text, place))
    }

    /// The same error, which one of the cases of a study under `profile` met, with the line of the study's `text` that
    /// set the key.
    pub fn in_study(self, text: &str, spec: &StudySpec, profile: &str) -> Self {
        self.on_line(|place| place::line_in_study(text, spec, profile, place))
    }

    fn on_line(self, line: impl FnOnce(&str) -> Option<usize>) -> Self {
        let (SpecError::Value { place, .. } | SpecError::Particles { place, .. }) = &self else {
            return self;
        };
        match line(place) {
            Some(line) => self.before(format!("line {line}, ")),
            None => self,
        }
    }

    fn before(self, text: String) -> Self {
        match self {
            SpecError::Value { place, message } => {
                SpecError::Value { place: format!("{text}{place}"), message }
            }
            SpecError::Particles { place, message } => {
                SpecError::Particles { place: format!("{text}{place}"), message }
            }
            other => other,
        }
    }
}

/// Bytes of a place that are shown (chosen: room for the deepest key).
const MOST_OF_PLACE: usize = 110;
/// Bytes of a message that are shown (chosen: room for the keys of the largest table).
const MOST_OF_MESSAGE: usize = 370;

/// Bytes of a single word that are shown (chosen: the longest key has 22).
const MOST_OF_WORD: usize = 60;

/// A text that long values have not made unreadable, without what a terminal would obey.
pub(crate) fn brief(text: &str, most: usize) -> String {
    let (mut shown, mut word) = (String::new(), 0);
    for character in text.chars() {
        if shown.len() >= most {
            return shown + "...";
        }
        word = if character == ' ' { 0 } else { word + character.len_utf8() };
        match character {
            _ if word > MOST_OF_WORD + character.len_utf8() => {}
            _ if word > MOST_OF_WORD => shown.push_str("..."),
            '"' | '\'' | '\\' => shown.push(character),
            other => shown.extend(other.escape_debug()),
        }
    }
    shown
}

/// Files longer than this are refused (chosen: a thousand times the largest study of the project).
const MOST_BYTES: u64 = 16 << 20;

/// What a file can hold.
pub trait Spec: Serialize + DeserializeOwned {
    /// Refuses values that no case can have.
    ///
    /// # Errors
    /// [`SpecError::Value`], naming the key.
    fn validate(&self) -> Result<(), SpecError>;
}

/// Reads a TOML file; its text comes with it.
///
/// # Errors
/// [`SpecError`], naming file, line and key.
pub fn read<S: Spec>(path: &Path) -> Result<(S, String), SpecError> {
    let text = read_text(path)?;
    let spec = parse::<S>(&text).map_err(|error| error.within(path.display()))?;
    Ok((spec, text))
}

fn read_text(path: &Path) -> Result<String, SpecError> {
    let failed = |source| SpecError::Read { path: path.into(), source };
    let refused = |message: String| Err(SpecError::value(path.display().to_string(), message));
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MOST_BYTES {
        return refused(format!("has more than {MOST_BYTES} bytes, the most a scene or study may have"));
    }
    String::from_utf8(bytes).or_else(|error| {
        let place = error.utf8_error().valid_up_to();
        refused(format!("is not text in UTF-8: byte {} cannot be read; save it as UTF-8", place + 1))
    })
}

/// Parses and validates the text of a file.
///
/// # Errors
/// [`SpecError::Value`], naming line and key.
pub fn parse<S: Spec>(text: &str) -> Result<S, SpecError> {
    let syntax = |error: toml::de::Error| {
        SpecError::value(line_of(text, &error), refusal::in_plain_words(error.message()))
    };
    let document: toml::Table = toml::from_str(text).map_err(syntax)?;
    let spec = refusal::parse::<S>(&Value::Table(document), || text.len()).map_err(|(key, message)| {
        // The text's own error tells the line, where it is the same one; else that of the key.
        let own = toml::from_str::<S>(text).err();
        let same = own.filter(|error| refusal::in_plain_words(error.message()) == message);
        let of_key = || Some(format!("line {}", place::line_of_key(text, &format!("`{key}`"))?));
        let places = [same.map(|error| line_of(text, &error)).or_else(of_key), named(&key)];
        SpecError::value(places.into_iter().flatten().collect::<Vec<_>>().join(", "), message)
    })?;
    spec.validate().map_err(|error| error.in_text(text))?;
    Ok(spec)
}

/// Turns a scene put together from a study's parts into a scene.
///
/// # Errors
/// [`SpecError::Value`], naming the key.
pub fn scene_of(document: &Value) -> Result<SceneSpec, SpecError> {
    let refused =
        |(key, message): (String, String)| SpecError::value(named(&key).unwrap_or("scene".into()), message);
    let scene = refusal::parse::<SceneSpec>(document, || document.to_string().len()).map_err(refused)?;
    scene.validate()?;
    Ok(scene)
}

fn named(key: &str) -> Option<String> {
    (!key.is_empty()).then(|| format!("`{key}`"))
}

fn line_of(text: &str, error: &toml::de::Error) -> String {
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    format!("line {}", before.matches('\n').count() + 1)
}
