//! Files that cannot be read, and files of particles and meshes that scenes name.

use std::path::Path;

use snowlab_study::assemble::assemble;
use snowlab_study::spec::{self, SceneSpec};
use tempfile::tempdir;

use super::{SCENE, hold_message};
use crate::made::shapes::{Point, cube};
use crate::made::written;

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

#[test]
fn meshes_are_refused_by_key_file_and_place() {
    let folder = tempdir().unwrap();
    let refusal = |name: &str, content: Option<Vec<u8>>| {
        if let Some(content) = content {
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        let text = SCENE.replace("[numerics]", "dimension = 3\n[numerics]").replace("0.0, ", "0.0, 0.0, ");
        let mesh = format!("{{ kind = \"mesh\", path = \"{name}\" }} #");
        let text = text.replace("region = ", &format!("region = {mesh}"));
        let scene: SceneSpec = spec::parse(&text).unwrap();
        assemble::<f64, 3>(&scene, folder.path()).expect_err(name).to_string()
    };
    let hold = |name: &str, content: &[u8], says: &[&str]| {
        let says = [&["`body.0.region.path`", name], says].concat();
        hold_message(&refusal(name, Some(content.to_vec())), name, &says);
    };
    hold_message(
        &refusal("none.obj", None),
        "no file",
        &["`body.0.region.path`", "none.obj", "No such file", "check the path"],
    );
    hold("mesh.fbx", b"", &["`.fbx` is not a format of meshes", ".obj, .stl or .ply"]);
    hold("mesh", b"", &["a name without ending", ".obj, .stl or .ply"]);

    hold("empty.obj", b"", &["has no faces"]);
    hold("empty.stl", b"", &["is no STL", "write the mesh again"]);
    hold("empty.ply", b"", &["is no PLY", "write the mesh again"]);
    let text = b"Dear reader,\nthis is no mesh.\n";
    hold("text.obj", text, &["has no faces", "triangles"]);
    hold("text.stl", text, &["`solid`", "84 + 50 n bytes, not 30"]);
    hold("text.ply", text, &["is no PLY"]);

    let mut open = cube();
    open.triangles.pop();
    for (name, content) in [
        ("open.obj", written::obj(&open)),
        ("open.stl", written::stl_binary(&open)),
        ("open.ply", written::ply_text(&open)),
    ] {
        hold(name, &content, &["3 edges of one triangle alone (holes)", "near [1.0, ", "Fill Holes"]);
    }
    let crossed = cube().and(&cube().mapped(|v| v.add_scalar(5.0)).turned());
    hold("inwards.obj", &written::obj(&crossed), &["inside out", "near [", "Recalculate Outside"]);
    let flat = cube().mapped(|v| Point::new(v.x, v.y, 0.0));
    hold("flat.obj", &written::obj(&flat), &["encloses no volume", "Solidify"]);
    let point = cube().mapped(|_| Point::zeros());
    hold("point.obj", &written::obj(&point), &["number of triangles of the mesh is 0"]);

    hold("word.obj", b"v 0 0 0\n# none\nv 1 up 0\nf 1 2 1\n", &["word.obj, line 3: `v`", "three numbers"]);
    hold("corner.obj", b"v 0 0 0\nf 1 2 x\n", &["corner.obj, line 2: `f`", "numbers of vertices"]);
    hold("beyond.obj", b"v 0 0 0\nf 1 2 3\n", &["a face `f` has no vertex, or one that is not there"]);
    hold(
        "nan.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n",
        &["vertex 2 (from 0) is at 0 NaN 0", "finite"],
    );
    hold("far.obj", b"v 0 0 0\nv 1e10 0 0\nv 0 1e10 0\nf 1 2 3\nf 3 2 1", &["coordinate", "-1e9 to 1e9"]);
    let solid = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n";
    hold("short.stl", solid, &["`solid` 1 times and `endsolid` 0 times"]);
    hold("short.stl", &[solid, &b"endsolid a\n"[..]].concat(), &["facet 0 (from 0)", "`vertex f32"]);
    let mut many = written::stl_binary(&cube());
    many[80..84].fill(0xff);
    hold("many.stl", &many, &["84 + 50 n bytes, not 684", "write the mesh again"]);
    let ply = |from: &str, to: &str| {
        let text = String::from_utf8(written::ply_text(&cube())).unwrap();
        assert!(text.contains(from));
        text.replace(from, to).into_bytes()
    };
    hold(
        "many.ply",
        &ply("element vertex 8", "element vertex 999999999999"),
        &["`vertex` has 999999999999 rows"],
    );
    hold("beyond.ply", &ply("3 0 2 3", "3 0 2 8"), &["a face has vertex 8 (from 0), but there are 8"]);
    hold("before.ply", &ply("list uchar uint", "list uchar float"), &["face 0 (from 0)", "`vertex_indices`"]);
    hold(
        "flat.ply",
        &ply("property float z", "property float w"),
        &["vertex 0 (from 0)", "`x`, `y` and `z`"],
    );
    hold("few.ply", &ply("element face 12", "element face 11"), &["data follow the last row"]);
    hold("word.ply", &ply("-1 -1 -1", "-1 up -1"), &["is no PLY: `Line"]);
}
