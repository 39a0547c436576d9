//! Mitsuba, wherever it is installed.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What is asked for, by the name of the Python registry. Chosen: the version that the pictures of the documentation were made with.
pub const PACKAGE: &str = "mitsuba==3.9.1";
const DRIVER: &str = include_str!("driver.py");

/// A Python that has Mitsuba.
#[derive(Clone, Debug)]
pub struct Mitsuba {
    python: PathBuf,
}

/// Pictures that cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum MitsubaError {
    /// It is not there.
    #[error(
        "pictures are made by Mitsuba 3, which `{}` does not have ({reason}); `{} -m pip install {PACKAGE}` installs it, and `--python` names another Python",
        python.display(), python.display()
    )]
    Absent {
        /// The Python that was asked.
        python: PathBuf,
        /// What it said.
        reason: String,
    },
    /// It failed.
    #[error("Mitsuba failed: {0}")]
    Failed(String),
    /// It could not be started.
    #[error("`{}` cannot be started: {source}", python.display())]
    NotStarted {
        /// The Python.
        python: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl Mitsuba {
    /// Looks for Mitsuba in this Python.
    ///
    /// # Errors
    /// [`MitsubaError::Absent`].
    pub fn find(python: &Path) -> Result<Self, MitsubaError> {
        let absent = |reason: String| MitsubaError::Absent { python: python.into(), reason };
        let test = "import mitsuba; mitsuba.set_variant('scalar_rgb')";
        let output = Command::new(python).args(["-c", test]).output();
        let output = output.map_err(|error| absent(error.to_string()))?;
        if output.status.success() {
            return Ok(Mitsuba { python: python.into() });
        }
        let told = String::from_utf8_lossy(&output.stderr);
        Err(absent(told.lines().next_back().unwrap_or("it says nothing").into()))
    }

    /// Renders scene files into pictures, one after the other, and says of each when it is done.
    ///
    /// # Errors
    /// [`MitsubaError`].
    pub fn render(
        &self,
        pictures: &[(PathBuf, PathBuf)],
        seed: u32,
        mut done: impl FnMut(&str),
    ) -> Result<(), MitsubaError> {
        let mut command = Command::new(&self.python);
        command.args(["-c", DRIVER]).arg(seed.to_string());
        pictures.iter().for_each(|(scene, picture)| {
            command.arg(scene).arg(picture);
        });
        let not_started = |source| MitsubaError::NotStarted { python: self.python.clone(), source };
        let mut errors = tempfile::tempfile().map_err(not_started)?;
        let written = errors.try_clone().map_err(not_started)?;
        let mut child = command.stdout(Stdio::piped()).stderr(written).spawn().map_err(not_started)?;
        let told = child.stdout.take().expect("it is piped");
        BufReader::new(told).lines().map_while(Result::ok).for_each(|line| done(&line));
        if child.wait().map_err(not_started)?.success() {
            return Ok(());
        }
        let mut text = String::new();
        let read = std::io::Seek::rewind(&mut errors)
            .and_then(|()| std::io::Read::read_to_string(&mut errors, &mut text));
        read.map_err(not_started)?;
        Err(MitsubaError::Failed(text.trim().lines().next_back().unwrap_or("it says nothing").into()))
    }
}
