//! Files that cannot be read, and files of particles that scenes name.

use std::path::Path;

use snowlab_study::assemble::assemble;
use snowlab_study::spec::{self, SceneSpec};
use tempfile::tempdir;

use super::{SCENE, hold_message};

/// The whole chain of causes, as the command prints it.
fn refusal_of(path: &Path) -> String {
    let error = spec::read::<SceneSpec>(path).expect_err("it is refused");
    format!("{:#}", anyhow::Error::from(error))
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("none.toml");
    hold_message(
        &refusal_of(&path),
        "no file",
        &["none.toml", "cannot be read", "check the path", "No such file"],
    );
    hold_message(&refusal_of(folder.path()), "a folder", &["cannot be read", "Is a directory"]);
}

#[test]
fn a_file_that_is_no_text_is_refused() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("bytes.toml");
    std::fs::write(&path, b"dimension = 2\n\xff\xfe").unwrap();
    hold_message(&refusal_of(&path), "bytes", &["bytes.toml", "UTF-8", "byte 15", "save it as"]);
}

#[test]
fn a_file_too_large_is_refused() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("large.toml");
    std::fs::write(&path, vec![b'#'; (16 << 20) + 1]).unwrap();
    hold_message(&refusal_of(&path), "17 MB", &["large.toml", "more than 16777216 bytes"]);
}

/// A device has no length that could be asked for before.
#[cfg(target_os = "linux")]
#[test]
fn a_file_without_end_is_refused() {
    hold_message(
        &refusal_of(Path::new("/dev/zero")),
        "/dev/zero",
        &["/dev/zero", "more than 16777216 bytes"],
    );
}

#[test]
fn a_message_names_the_file_and_the_line() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, SCENE.replace("spacing = 0.05", "spacing = -1.0")).unwrap();
    hold_message(&refusal_of(&path), "range", &["scene.toml: line 3, `numerics.spacing`: is -1.0"]);
    std::fs::write(&path, SCENE.replace("spacing = 0.05", "spacin = 1.0")).unwrap();
    hold_message(&refusal_of(&path), "key", &["scene.toml: line 3, `numerics.spacin`: unknown key"]);
}

/// A rest volume must come from somewhere, and from one place.
#[test]
fn rest_volumes_of_a_particle_file_are_asked_for_once() {
    let folder = tempdir().unwrap();
    let refusal = |name: &str, content: &str, numerics: &str| {
        std::fs::write(folder.path().join(name), content).unwrap();
        let placement = format!("placement = {{ kind = \"file\", path = \"{name}\" }}");
        let text = SCENE.replace("placement = { kind = \"random\", count = 50 }", &placement);
        let text =
            text.replace("region =", "#").replace("spacing = 0.05", &format!("spacing = 0.05{numerics}"));
        let scene: SceneSpec = spec::parse(&text).unwrap();
        assemble::<f64, 2>(&scene, folder.path()).expect_err(name).to_string()
    };
    let bare = refusal("bare.csv", "x,y\n0,0\n", "");
    hold_message(
        &bare,
        "no volume",
        &["`body.0.placement.filled_volume`", "is missing", "bare.csv", "`volume`"],
    );
    let full = refusal("full.csv", "x,y,volume\n0,0,1\n", "\nrest_volume = \"density\"");
    hold_message(&full, "by density", &["`body.0.placement.path`", "full.csv", "rest_volume", "uniform"]);
}

/// Half a megabyte of list before a mistake: the place is found, or an enclosing one, in a moment.
#[test]
fn a_long_file_with_a_mistake_is_refused_soon() {
    let list = vec!["0.5"; 100_000].join(", ");
    let text = SCENE.replace("spacing = 0.05", &format!("spacing = [{list}]"));
    let message = spec::parse::<SceneSpec>(&text).unwrap_err().to_string();
    hold_message(&message, "a long list", &["line 3", "`numerics", "is a list, expected a number"]);
}

#[test]
fn particle_files_are_refused_by_key_and_file() {
    let folder = tempdir().unwrap();
    let refusal = |name: &str, content: Option<&str>| {
        if let Some(content) = content {
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        let placement = format!("placement = {{ kind = \"file\", path = \"{name}\", filled_volume = 0.2 }}");
        let text = SCENE.replace("placement = { kind = \"random\", count = 50 }", &placement);
        let text = text.replace("region =", "#");
        let scene: SceneSpec = spec::parse(&text).unwrap();
        assemble::<f64, 2>(&scene, folder.path()).expect_err(name).to_string()
    };
    let key = "`body.0.placement.path`";
    hold_message(&refusal("none.csv", None), "no file", &[key, "none.csv", "No such file"]);
    hold_message(&refusal("empty.csv", Some("")), "empty", &[key, "empty.csv", "empty"]);
    hold_message(
        &refusal("header.csv", Some("x,y\n")),
        "no point",
        &[key, "header.csv", "no point", "one or more"],
    );
    hold_message(&refusal("space.csv", Some("x,y,z\n0,0,1\n")), "3D", &[key, "space.csv", "line 2", "3D"]);
    hold_message(&refusal("word.csv", Some("x,y\n0,up\n")), "a word", &[key, "word.csv", "line 2", "up"]);
    let twice = "x,y,volume\n0,0,1\n";
    let filled = "`body.0.placement.filled_volume`";
    hold_message(
        &refusal("twice.csv", Some(twice)),
        "volumes twice",
        &[filled, "0.2", "twice.csv", "leave out"],
    );
    let none = "x,y,jp\n0,0,0\n";
    hold_message(&refusal("none.csv", Some(none)), "J_P = 0", &[key, "none.csv", "line 2", "`jp` is 0.0"]);
    let half = "x,y,fxx,fyy\n0,0,1,1\n";
    hold_message(&refusal("half.csv", Some(half)), "half of F", &[key, "half.csv", "`fxy` is missing"]);
    let space = "x,y,fxx,fxy,fxz,fyx,fyy,fyz,fzx,fzy,fzz\n0,0,1,0,0,0,1,0,0,0,1\n";
    hold_message(
        &refusal("space.csv", Some(space)),
        "F in 3D",
        &[key, "space.csv", "9 columns", "fxx, fxy, fyx, fyy"],
    );
    let inside_out = "x,y,fxx,fxy,fyx,fyy\n0,0,1,0,0,-1\n";
    hold_message(
        &refusal("turned.csv", Some(inside_out)),
        "F inside out",
        &["particle 0", "determinant of the deformation is -1", "> 0"],
    );
    hold_message(&refusal("points.xyz", Some("0 0\n")), "format", &[key, "points.xyz", ".csv or .ply"]);
}
