//! `sample`, `simulate` and `fragments`, and what one writes as another reads it.

use std::path::Path;

use snowlab_solver::Vector;
use snowlab_study::assemble::assemble;
use snowlab_study::points;
use snowlab_study::spec::{self, SceneSpec};

use super::{Desk, SCENE};

#[test]
fn placements_are_written_as_csv_and_ply() {
    let desk = Desk::with(&[("scene.toml", SCENE)]);
    let printed = desk.expect(0, "sample scene.toml -o points.csv");
    assert!(printed.contains("300 particles"), "{printed}");
    desk.expect(0, "sample scene.toml -o points.ply");
    let csv = points::read::<2>(&desk.path("points.csv")).unwrap().positions;
    let ply = points::read::<2>(&desk.path("points.ply")).unwrap().positions;
    assert_eq!(csv.len(), 300);
    assert_eq!(csv, ply, "both have every digit");
    let centre = Vector::<f64, 2>::new(0.0, 0.3);
    assert!(csv.iter().all(|x| (x - centre).norm() <= 0.25), "all lie in the ball");
}

#[test]
fn frames_are_read_by_fragments() {
    let desk = Desk::with(&[("scene.toml", SCENE)]);
    desk.expect(0, "simulate scene.toml --out frames");
    // The start, perhaps one of flight, two after the contact.
    let frames: Vec<_> =
        desk.files("frames").into_keys().filter(|name| name.extension().unwrap() == "csv").collect();
    assert!((3..=4).contains(&frames.len()), "{frames:?}");
    let fragments = |frame: &str| -> serde_json::Value {
        let printed = desk.expect(0, &format!("fragments frames/{frame} --link 0.1 --json"));
        serde_json::from_str(&printed).unwrap()
    };
    let start = fragments("frame-00000.csv");
    assert_eq!(start["points"], 300);
    assert_eq!(start["dimension"], 2);
    assert_eq!(start["masses_from_file"], true);
    assert_eq!(start["fragments_above_cut"], 1, "before the impact it is one ball");
}

/// A frame taken up as a file of particles stands where it stood and moves as it moved, to the last bit.
#[test]
fn a_frame_is_a_placement_to_the_last_digit() {
    let desk = Desk::with(&[("scene.toml", SCENE)]);
    desk.expect(0, "simulate scene.toml --out frames");
    let placement =
        "placement = { kind = \"file\", path = \"frames/frame-00002.csv\", filled_volume = 0.2 }\n#";
    let text = SCENE.replace("region =", "#").replace("placement =", placement).replace("velocity =", "#");
    let text = text.replace("time_unit = \"crossing\"", "");
    desk.write("again.toml", &text);
    desk.expect(0, "sample again.toml -o again.csv");

    let columns = |name: &str, wanted: &[&str]| -> Vec<Vec<String>> {
        let rows = super::rows(&desk.read(name));
        rows.iter().map(|row| wanted.iter().map(|column| row[*column].clone()).collect()).collect()
    };
    assert_eq!(columns("again.csv", &["x", "y"]), columns("frames/frame-00002.csv", &["x", "y"]));

    let scene: SceneSpec = spec::parse(&text).unwrap();
    let state = assemble::<f64, 2>(&scene, desk.folder.path()).unwrap().state;
    let frame = points::read::<2>(&desk.path("frames/frame-00002.csv")).unwrap();
    assert_eq!(state.motion.velocity, frame.velocities.unwrap(), "velocities are taken with it");
    assert_eq!(state.motion.position, frame.positions);
}

#[test]
fn paths_are_relative_to_the_scene() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("deep")).unwrap();
    desk.write("deep/points.csv", "x,y\n0.0,0.2\n0.1,0.2\n");
    let placement = "placement = { kind = \"file\", path = \"points.csv\", filled_volume = 0.01 }\n#";
    let text = SCENE.replace("region =", "#").replace("placement =", placement);
    desk.write("deep/scene.toml", &text);
    assert!(desk.expect(0, "sample deep/scene.toml -o out.csv").contains("2 particles"));
    let scene: SceneSpec = spec::parse(&text).unwrap();
    assert!(assemble::<f64, 2>(&scene, Path::new("nowhere")).is_err());
}

#[test]
fn energies_and_forces_are_written_beside_the_frames() {
    let desk = Desk::with(&[("scene.toml", SCENE)]);
    desk.expect(0, "simulate scene.toml --out frames");
    let history = super::rows(&desk.read("frames/history.csv"));
    let number = |row: usize, column: &str| history[row][column].parse::<f64>().unwrap();
    let last = history.len() - 1;
    // Without gravity the floor takes what momentum there was: 8 m/s times 400 kg/m^2 times the area, and no more than that
    // and what the ball gives back by bouncing.
    let momentum = 8.0 * 400.0 * std::f64::consts::PI * 0.25 * 0.25;
    assert_eq!(number(0, "impulse_0_y"), 0.0);
    let impulse = -number(last, "impulse_0_y");
    assert!(impulse > 0.2 * momentum && impulse < 2.0 * momentum, "{impulse} of {momentum}");
    assert!((number(0, "kinetic") / (0.5 * 8.0 * momentum) - 1.0).abs() < 1e-9);
}
