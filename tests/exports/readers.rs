//! Every file in the readers of others.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use super::desk::Desk;
use super::{FRAMES, SCENE};

/// What is installed, by name and version.
const MODULES: [&str; 10] = [
    "ase==3.29.0",
    "duckdb==2.0.0",
    "meshio==5.3.5",
    "mitsuba==3.9.1",
    "numpy==2.4.6",
    "ovito==3.17.2",
    "plyfile==1.1.5",
    "pyarrow==26.0.1",
    "setuptools==80.9.0",
    "vtk==9.7.2",
];
const READERS: [&str; 10] =
    ["plyfile", "meshio", "vtk", "pvd", "ase", "ovito", "mitsuba", "pyarrow", "duckdb", "numpy"];
/// Debian's module is of Debian's Python.
const DEBIAN: &str = "/usr/bin/python3";
/// Linking length of the fragments [m]: twice the scene's spacing.
const LINK: &str = "0.04";

pub fn is_needed() -> bool {
    std::env::var_os("SNOWLAB_NEEDS_READERS").is_some()
}

fn succeeds(command: &mut Command) -> bool {
    command.output().is_ok_and(|output| output.status.success())
}

/// The Python that has the modules, which are installed once.
pub fn python() -> Option<PathBuf> {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _turn = ONE_AT_A_TIME.lock();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readers");
    let (python, stamp) = (folder.join("bin/python"), folder.join(MODULES.join(",")));
    if !stamp.is_file() {
        let made = succeeds(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder));
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        if !made || !succeeds(Command::new(&python).args(pip).args(MODULES)) {
            return None;
        }
        std::fs::write(&stamp, "").unwrap();
    }
    Some(python)
}

fn hold(python: &Path, folder: &Path, readers: &[&str]) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/exports/readers.py");
    let number = format!("{:05}", FRAMES - 1);
    let mut command = Command::new(python);
    command.arg(script).arg(folder).arg(number).arg(LINK).args(readers);
    // Without a screen.
    command.env("QT_QPA_PLATFORM", "offscreen").env("OVITO_GUI_MODE", "0");
    let output = command.output().unwrap();
    let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    for reader in readers {
        assert!(printed[0].contains(&format!("{reader} agrees")), "{reader}\n{}", printed.concat());
    }
}

#[test]
fn every_file_is_read_by_its_readers() {
    let desk = Desk::with(&[("scene.toml", SCENE)]);
    desk.expect(0, "simulate scene.toml --out run --export csv,ply,vtp,xyz,vol,vdb,parquet");
    let folder = desk.path("run");
    match python() {
        Some(python) => hold(&python, &folder, &READERS),
        None => {
            assert!(!is_needed(), "the readers cannot be installed");
            println!("SKIPPED: python3 with venv and pip cannot install {}", MODULES.join(" "));
        }
    }
    if succeeds(Command::new(DEBIAN).args(["-c", "import pyopenvdb, numpy"])) {
        hold(Path::new(DEBIAN), &folder, &["openvdb"]);
    } else {
        assert!(!is_needed(), "pyopenvdb is not installed");
        println!(
            "SKIPPED: pyopenvdb is not installed; `apt-get install --no-install-recommends python3-openvdb python3-numpy` has it"
        );
    }
}
