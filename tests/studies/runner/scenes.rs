//! `sample`, `simulate` and `fragments`, and what one writes as another reads it.

use std::path::Path;

use snowlab_solver::Vector;
use snowlab_study::assemble::assemble;
use snowlab_study::points;
use snowlab_study::spec::{self, SceneSpec};

use super::{Desk, SCENE};
use crate::made::shapes::icosphere;
use crate::made::written;

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
    // A file is put in the place of the one before, not written over it.
    std::fs::hard_link(desk.path("points.csv"), desk.path("before.csv")).unwrap();
    desk.write("other.toml", &SCENE.replace("count = 300", "count = 200"));
    desk.expect(0, "sample other.toml -o points.csv");
    assert_eq!(points::read::<2>(&desk.path("points.csv")).unwrap().positions.len(), 200);
    assert_eq!(points::read::<2>(&desk.path("before.csv")).unwrap().positions, csv);
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
    let placement = "placement = { kind = \"file\", path = \"frames/frame-00002.csv\" }\n#";
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
    assert_eq!(Some(state.motion.deformation), frame.deformations);
    assert_eq!(Some(&state.motion.plastic_ratio), frame.plastic_ratios.as_ref());
    assert_eq!(Some(state.constants.mass), frame.masses);
    assert_eq!(Some(state.constants.volume), frame.volumes);
    assert!(
        frame.plastic_ratios.unwrap().iter().any(|&ratio| ratio < 0.9),
        "something must have been packed"
    );

    // A velocity of the scene takes the place of the file's.
    let text = text.replace("[[collider]]", "velocity = [1.0, 0.0]\n[[collider]]");
    let moved = assemble::<f64, 2>(&spec::parse(&text).unwrap(), desk.folder.path()).unwrap().state;
    assert!(moved.motion.velocity.iter().all(|v| *v == Vector::<f64, 2>::new(1.0, 0.0)));
}

/// Every column of a frame but the particles' numbers is one that the page names as taken.
#[test]
fn the_page_names_the_columns_of_a_frame() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/input.md");
    let page = std::fs::read_to_string(page).unwrap();
    let columns =
        page.split("A file of points has columns").nth(1).unwrap().split("What a frame has not").next();
    let three =
        SCENE.replace("[numerics]", "dimension = 3\n[numerics]").replace("[0.0, 0.3]", "[0.0, 0.0, 0.3]");
    let three = three.replace("[0.0, -8.0]", "[0.0, 0.0, -8.0]").replace("[0.0, 0.0]", "[0.0, 0.0, 0.0]");
    let three =
        three.replace("[0.0, 1.0]", "[0.0, 0.0, 1.0]").replace("[numerics]", "[numerics]\nmax_steps = 1");
    let desk = Desk::with(&[("scene.toml", &three)]);
    desk.expect(3, "simulate scene.toml --out frames");
    let frame = desk.read("frames/frame-00000.csv");
    let names: Vec<&str> = frame.lines().next().unwrap().split(',').collect();
    assert_eq!((names[0], names.len()), ("id", 1 + 3 + 3 + 3 + 9));
    for name in &names[1..] {
        assert!(columns.unwrap().contains(&format!("`{name}`")), "`{name}` is not on the page");
    }
}

/// A run that is taken up from one of its frames ends as the whole run does, but for the round-off of sums in another order.
#[test]
fn a_run_goes_on_from_one_of_its_frames() {
    let whole = SCENE.replace("time_unit = \"crossing\"", "").replace("end_from = \"contact\"", "");
    let whole =
        whole.replace("frame_interval = 0.5", "frame_interval = 0.012").replace("end = 1.0", "end = 0.024");
    let desk = Desk::with(&[("whole.toml", &whole)]);
    desk.expect(0, "simulate whole.toml --out whole");
    let placement = "placement = { kind = \"file\", path = \"whole/frame-00001.csv\" }\n#";
    let rest = whole.replace("region =", "#").replace("placement =", placement).replace("velocity =", "#");
    desk.write("rest.toml", &rest.replace("end = 0.024", "end = 0.012"));
    desk.expect(0, "simulate rest.toml --out rest");
    let cloud = |name: &str| points::read::<2>(&desk.path(name)).unwrap();
    let (start, expected) = (cloud("whole/frame-00001.csv"), cloud("whole/frame-00002.csv"));
    let found = cloud("rest/frame-00001.csv");
    let flowed = start.plastic_ratios.unwrap().iter().filter(|&&ratio| ratio != 1.0).count();
    assert!(flowed > 50, "{flowed} of 300 particles have yielded by the frame");
    let apart = |a: &[Vector<f64, 2>], b: &[Vector<f64, 2>]| {
        a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    };
    assert!(apart(&found.positions, &expected.positions) < 1e-9);
    assert!(apart(&found.velocities.unwrap(), &expected.velocities.unwrap()) < 1e-6);
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

/// A mesh beside the scene is placed, looked into and simulated; one that is open is refused by line, key and file.
#[test]
fn a_mesh_is_a_body_of_a_scene() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("deep")).unwrap();
    let ball = icosphere(2).mapped(|v| v * 10.0);
    std::fs::write(desk.path("deep/ball.stl"), written::stl_binary(&ball)).unwrap();
    let region = "{ kind = \"mesh\", path = \"ball.stl\", scale = 0.025, centre = [0.0, 0.0, 0.3] }";
    let text = format!(
        "dimension = 3\n[numerics]\nspacing = 0.05\n[[body]]\nregion = {region}\n\
         placement = {{ kind = \"poisson-disk\", count = 1000 }}\nvelocity = [0.0, 0.0, -8.0]\n[[collider]]\n\
         shape = {{ kind = \"half-space\", point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}\n\
         [output]\ntime_unit = \"crossing\"\nframe_interval = 0.5\nend = 1.0\n"
    );
    desk.write("deep/scene.toml", &text);
    let printed = desk.expect(0, "sample deep/scene.toml -o points.ply");
    assert!(printed.contains("1000 particles"), "{printed}");
    let centre = Vector::<f64, 3>::new(0.0, 0.0, 0.3);
    let points = points::read::<3>(&desk.path("points.ply")).unwrap().positions;
    assert!(points.len() == 1000 && points.iter().all(|x| (x - centre).norm() < 0.25));
    let printed = desk.expect(0, "preflight deep/scene.toml");
    assert!(printed.contains("1000 particles in 3D"), "{printed}");
    let printed = desk.expect(0, "simulate deep/scene.toml --out frames");
    assert!(printed.contains("3 frames"), "{printed}");

    let mut open = ball;
    open.triangles.truncate(300);
    std::fs::write(desk.path("deep/ball.stl"), written::stl_binary(&open)).unwrap();
    let printed = desk.expect(2, "sample deep/scene.toml -o points.ply");
    for said in
        ["deep/scene.toml: line 5, `body.0.region.path`", "ball.stl: the mesh does not close", "Fill Holes"]
    {
        assert!(printed.contains(said), "{said}: {printed}");
    }
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

/// A shorter run in the same folder leaves its own frames there, and whatever else there was.
#[test]
fn frames_of_an_earlier_run_are_deleted() {
    let desk = Desk::with(&[("scene.toml", SCENE), ("short.toml", &SCENE.replace("end = 1.0", "end = 0.5"))]);
    desk.expect(0, "simulate scene.toml --out frames");
    for name in ["frame-1.csv", "frame-00003.txt", "notes.csv", "frame-0000x.csv"] {
        desk.write(&format!("frames/{name}"), "mine");
    }
    desk.write("frames/frame-00012.csv", "an earlier run's");
    desk.expect(2, "simulate nowhere.toml --out frames");
    assert_eq!(desk.read("frames/frame-00012.csv"), "an earlier run's", "nothing was run");
    desk.expect(0, "simulate short.toml --out frames");
    let rows = super::rows(&desk.read("frames/history.csv")).len();
    let frames = (0..rows).map(|k| format!("frame-{k:05}.csv"));
    let others =
        ["frame-00003.txt", "frame-0000x.csv", "frame-1.csv", "frames.snowlab", "history.csv", "notes.csv"];
    let expected: std::collections::BTreeSet<String> = frames.chain(others.map(String::from)).collect();
    let found = desk.files("frames").into_keys().map(|name| name.to_string_lossy().into_owned());
    assert_eq!(found.collect::<std::collections::BTreeSet<_>>(), expected);
}

/// Where a run stops, its last state is a frame with a row, and no time comes twice.
#[test]
fn a_stopped_run_has_a_row_for_every_frame() {
    let text = SCENE.replace("spacing = 0.05", "spacing = 0.05\nmax_steps = 5");
    let desk = Desk::with(&[("scene.toml", &text)]);
    let printed = desk.expect(3, "simulate scene.toml --out frames");
    assert!(printed.contains("2 frames, 5 steps, stopped(too-many-steps)"), "{printed}");
    let history = super::rows(&desk.read("frames/history.csv"));
    let steps: Vec<&str> = history.iter().map(|row| row["steps"].as_str()).collect();
    assert_eq!(steps, ["0", "5"]);
    assert!(desk.path("frames/frame-00001.csv").is_file() && !desk.path("frames/frame-00002.csv").exists());
    assert!(history.iter().all(|row| !row["force_0_y"].is_empty()), "no force is 0/0");
}

/// The limits at which a run stops that would not end, or whose numbers would be none.
#[test]
fn a_run_that_cannot_go_on_says_why_and_what_helps() {
    let packed = "[numerics]\nspacing = 0.02\n[[body]]\n\
        region = { kind = \"ball\", centre = [0.0, 0.13], radius = 0.1 }\n\
        placement = { kind = \"jittered\", count = 300 }\nvelocity = [0.0, -300.0]\n\
        material = { kind = \"snow\", hardening = 100.0 }\n\
        [[collider]]\nshape = { kind = \"half-space\", point = [0.0, 0.0], normal = [0.0, 1.0] }\n\
        [output]\nframe_interval = 500.0\nend = 1000.0\n";
    let heavy = "gravity = [0.0, -1e6]\n[numerics]\nspacing = 0.02\nprecision = \"f32\"\nwatchdog = false\n[[body]]\n\
        region = { kind = \"ball\", centre = [0.0, 0.13], radius = 0.1 }\n\
        placement = { kind = \"jittered\", count = 300 }\n\
        material = { kind = \"elastic\", density = 1e36, young = 1e37 }\n\
        [output]\nframe_interval = 0.001\nend = 0.05\n";
    let watched = heavy.replace("watchdog = false\n", "");
    let rows: [(&str, &str, &[&str]); 3] = [
        (packed, "steps-too-short", &["steps of", "are left, more than 1e11", "set `hardening_limit`"]),
        (heavy, "overflow", &["energies outgrow the precision", "`numerics.precision` = \"f64\""]),
        (&watched, "energy-rise", &["to more than the precision holds", "`numerics.wave_courant`"]),
    ];
    for (scene, reason, words) in rows {
        let desk = Desk::with(&[("scene.toml", scene)]);
        let told = desk.expect(3, "simulate scene.toml --out frames");
        assert!(told.contains(&format!("stopped({reason})")), "{told}");
        assert!(words.iter().all(|word| told.contains(word)), "{reason}: {told}");
    }
}
