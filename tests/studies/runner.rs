//! The command on tiny studies and scenes: 2D, a few hundred particles, a few dozen steps.

mod broken_results;
mod compare;
mod exit_codes;
mod makefile;
mod reports;
mod resuming;
mod scenes;
mod tables;
mod verdicts;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// The scene of all studies here: a ball about ten cells wide that falls on a floor.
const SCENE: &str = r#"
[numerics]
spacing = 0.05
[[body]]
region = { kind = "ball", centre = [0.0, 0.3], radius = 0.25 }
placement = { kind = "random", count = 300 }
velocity = [0.0, -8.0]
[[collider]]
shape = { kind = "half-space", point = [0.0, 0.0], normal = [0.0, 1.0] }
friction = 0.5
[output]
time_unit = "crossing"
frame_interval = 0.5
end = 1.0
end_from = "contact"
"#;

/// Three arms of two blocks that end well, a claim and an expectation that holds.
const ARMS: &str = r#"
[[arm]]
id = "random"
[[arm]]
id = "lattice"
set = { "body.0.placement" = { kind = "lattice", count = 300 } }
[[arm]]
id = "elastic"
set = { "body.0.material" = { kind = "elastic" } }
[[claim]]
id = "irregular-breaks-more"
sentence = "Random placement breaks into more pieces than a lattice."
contrast = { paired = { treated = "random", control = "lattice" } }
[[expect]]
metric = "particles"
range = [300.0, 300.0]
why = "as many as asked for"
"#;

/// An arm whose fixed step carries particles further than a cell.
const STOPPING_ARM: &str = "[[arm]]\nid = \"leaping\"\nset = { \"numerics.fixed_step\" = 0.02 }\n";

/// A study of the scene, with `rest` behind it.
fn study(rest: &str) -> String {
    let scene = SCENE.replace("[[", "[[scene.").replace("\n[n", "\n[scene.n").replace("\n[o", "\n[scene.o");
    let head = "name = \"tiny\"\nquestion = \"Does it run?\"\n[blocks]\nfirst = 1\ncount = 2\n";
    format!("{head}[measure]\nlargest_spacing = 0.05\nmin_mass_share = 0.01\n{scene}{rest}")
}

/// A folder with files, and the command run in it.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Self {
        Desk { folder: tempfile::tempdir().expect("a folder for the test") }
    }

    fn with(files: &[(&str, &str)]) -> Self {
        let desk = Desk::new();
        files.iter().for_each(|(name, text)| desk.write(name, text));
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("the test's folder can be written");
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Runs `snowlab` with the words of `line`.
    fn snowlab(&self, line: &str) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_snowlab"));
        command.args(line.split_whitespace()).current_dir(self.folder.path());
        command.output().expect("the command can be started")
    }

    /// Runs `snowlab`, expects an exit code, and returns what was printed.
    fn expect(&self, code: i32, line: &str) -> String {
        let output = self.snowlab(line);
        let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("UTF-8"));
        assert_eq!(output.status.code(), Some(code), "snowlab {line}\n{}", printed.concat());
        assert!(!printed[1].contains("panicked"), "snowlab {line}\n{}", printed[1]);
        printed.concat()
    }

    /// Every file below `name`, with its content.
    fn files(&self, name: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut found = BTreeMap::new();
        collect(&self.path(name), &mut found);
        let root = self.path(name);
        found
            .into_iter()
            .map(|(path, bytes)| (path.strip_prefix(&root).unwrap().to_path_buf(), bytes))
            .collect()
    }
}

fn collect(folder: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, found);
        } else {
            found.insert(path.clone(), std::fs::read(&path).unwrap());
        }
    }
}

/// Rows of a CSV as maps from column to entry.
fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(|row| row.expect("every row has the columns of the header")).collect()
}
