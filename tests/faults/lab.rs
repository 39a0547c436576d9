//! A small study, what it gives when nobody disturbs it, and the runs that are disturbed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::desk::{Desk, study};

/// How the reason of a fault begins that cannot be injected on this machine.
pub const SKIPPED: &str = "skipped:";

/// Four cases of some tenths of a second, one of which stops.
const ARMS: &str = r#"
[[arm]]
id = "random"
set = { "body.0.placement.count" = 2500, "numerics.spacing" = 0.02, "output.end" = 0.5 }
[[arm]]
id = "elastic"
set = { "body.0.material" = { kind = "elastic" }, "body.0.placement.count" = 2000, "numerics.spacing" = 0.02, "numerics.engine" = "reference" }
[[arm]]
id = "leaping"
blocks = 1
set = { "numerics.fixed_step" = 0.02 }
"#;

/// The study in a folder, and its undisturbed results.
pub struct Lab {
    pub desk: Desk,
    reference: BTreeMap<PathBuf, Vec<u8>>,
    undisturbed: Duration,
    ends: usize,
}

impl Lab {
    /// Runs the study undisturbed.
    pub fn open() -> Self {
        let desk = Desk::with(&[("study.toml", &study(ARMS))]);
        let began = Instant::now();
        desk.expect(3, "run study.toml --jobs 2 --out undisturbed");
        let undisturbed = began.elapsed();
        let reference = lasting(desk.files("undisturbed"));
        assert_eq!(reference.keys().filter(|path| path.ends_with("run.json")).count(), 5);
        Lab { desk, reference, undisturbed, ends: 0 }
    }

    /// How often the study was run to its end.
    pub fn ends(&self) -> usize {
        self.ends
    }

    /// Time that a run takes which nobody disturbs.
    pub fn undisturbed(&self) -> Duration {
        self.undisturbed
    }

    /// A command on the study that keeps every step it can.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_snowlab"));
        command.args(words.split_whitespace()).current_dir(self.desk.folder.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Begins a run.
    pub fn begin(&self) -> Child {
        self.command(RUN).spawn().expect("the command can be started")
    }

    /// Runs to the end what is left, holds all files against the undisturbed ones, and begins a new study.
    pub fn finish(&mut self) -> Result<(), String> {
        self.finish_by(RUN)
    }

    /// As [`Lab::finish`], by the words of a command.
    pub fn finish_by(&mut self, words: &str) -> Result<(), String> {
        let output = self.command(words).output().expect("the command can be started");
        if output.status.code() != Some(3) {
            return Err(format!("{words} ends with {:?}: {}", output.status, said(&output)));
        }
        self.ended()
    }

    /// A run has come to its end: holds all files against the undisturbed ones, and begins a new study.
    pub fn ended(&mut self) -> Result<(), String> {
        let found = lasting(self.desk.files("results"));
        for (path, bytes) in &self.reference {
            match found.get(path) {
                None => return Err(format!("{} is not there", path.display())),
                Some(other) if other != bytes => return Err(format!("{} has other bytes", path.display())),
                Some(_) => {}
            }
        }
        if let Some(more) = found.keys().find(|path| !self.reference.contains_key(*path)) {
            return Err(format!("{} should not be there", more.display()));
        }
        self.ends += 1;
        std::fs::remove_dir_all(self.desk.path("results")).map_err(|error| error.to_string())
    }

    /// Result files that exist now, below `results`.
    pub fn results(&self) -> Vec<PathBuf> {
        if !self.desk.path("results").exists() {
            return Vec::new();
        }
        self.desk.files("results").into_keys().map(|path| self.desk.path("results").join(path)).collect()
    }
}

/// The command that is disturbed.
pub const RUN: &str = "run study.toml --jobs 2 --checkpoint-every 0s";

/// What a command printed.
pub fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned()).concat()
}

/// The files that follow from the study alone: no clocks, no marks, no logs.
fn lasting(files: BTreeMap<PathBuf, Vec<u8>>) -> BTreeMap<PathBuf, Vec<u8>> {
    let passing = ["timings.csv", "manifest.json", "log.txt", "lock"];
    let is_passing = |path: &Path| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        passing.contains(&name) || name.starts_with(".unfinished-")
    };
    files.into_iter().filter(|(path, _)| !is_passing(path)).collect()
}
