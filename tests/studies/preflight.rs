//! What is told of a scene before it is run: every cliff by its key, and no cliff where there is none.

use std::path::Path;

use snowlab_study::preflight::{Advice, facts, hazards, preflight};
use snowlab_study::run::{Unobserved, run_scene};
use snowlab_study::spec::{self, SceneSpec};

use super::runner::desk::{Desk, SCENE, study};

/// A ball of 24 cells with four particles to each that falls on a floor.
const SOUND: &str = r#"
gravity = [0.0, -9.81]
[numerics]
spacing = 0.02
[[body]]
region = { kind = "ball", centre = [0.0, 0.29], radius = 0.25 }
placement = { kind = "jittered", count = 2000 }
velocity = [0.0, -3.0]
[[collider]]
shape = { kind = "half-space", point = [0.0, 0.0], normal = [0.0, 1.0] }
friction = 0.5
[output]
frame_interval = 0.1
end = 0.2
"#;

fn scene(text: &str) -> SceneSpec {
    spec::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn hazards_of(text: &str) -> Vec<Advice> {
    let scene = scene(text);
    hazards(&scene, &facts(&scene, Path::new(".")).unwrap())
}

/// The sound scene changed: from, to, the key that is named, words of what is said.
type Cliff = (&'static str, &'static str, &'static str, &'static [&'static str]);

const CLIFFS: &[Cliff] = &[
    (
        "spacing = 0.02",
        "spacing = 0.02\nfixed_step = 1e-3",
        "numerics.fixed_step",
        &["dt c / h = 1.1", "unstable", "set it to 3"],
    ),
    (
        "spacing = 0.02",
        "spacing = 0.02\nwave_courant = 0.9",
        "numerics.wave_courant",
        &["0.90", "limit of 0.80", "set it to 0.40"],
    ),
    (
        "spacing = 0.02",
        "spacing = 0.02\nfixed_step = 1e-4",
        "numerics.fixed_step",
        &["hardens", "leave it out"],
    ),
    ("[0.0, -3.0]", "[0.0, -15.0]", "body.0.velocity", &["Mach 0.76", "nearly as fast", "below 9.86 m/s"]),
    ("[0.0, -3.0]", "[0.0, -60.0]", "body.0.velocity", &["Mach 3.0", "faster than"]),
    ("end = 0.2", "end = 0.01", "output.end", &["nothing meets", "before the run ends"]),
    (
        "point = [0.0, 0.0]",
        "point = [0.0, 0.1]",
        "collider.0.shape",
        &["of 2000 particles lie inside", "apart"],
    ),
    (
        "count = 2000",
        "count = 300",
        "body.0.placement.count",
        &["0.61 particles to a cell", "without a crack"],
    ),
    ("count = 2000", "count = 20000", "body.0.placement.count", &["40.", "does not resolve"]),
    (
        "\"jittered\", count = 2000",
        "\"random\", count = 700",
        "body.0.placement.count",
        &["24 % of the cells empty", "`jittered`"],
    ),
    ("spacing = 0.02", "spacing = 0.08", "numerics.spacing", &["6.2 cells across", "no room"]),
    (
        "velocity = ",
        "voids = { kind = \"circles\", porosity = 0.1, mean_radius = 0.04, gap = 0.02 }\nvelocity = ",
        "body.0.voids",
        &["thinnest bridge", "1.0 cells", "gap wider"],
    ),
    (
        "velocity = ",
        "material = { kind = \"snow\", poisson = 0.45 }\nvelocity = ",
        "body.0.material.poisson",
        &["is 0.45", "makes energy", "at most 0.4"],
    ),
    (
        "[output]",
        "[[collider]]\nshape = { kind = \"half-space\", point = [0.0, 0.6], normal = [0.0, -1.0] }\nvelocity = [0.0, -4.0]\n[output]",
        "collider.1.velocity",
        &["`collider.0` and `collider.1` meet after 1.500e-1 s", "crushed"],
    ),
    (
        "velocity = ",
        "material = { kind = \"snow\", hardening = 30.0 }\nvelocity = ",
        "body.0.material.hardening",
        &["e^15", "`hardening_limit`"],
    ),
    (
        "spacing = 0.02",
        "spacing = 0.02\nintegrator = { kind = \"semi-implicit\" }",
        "numerics.wave_courant",
        &["left out", "plastic loss out of nothing"],
    ),
    (
        "spacing = 0.02\n",
        "spacing = 0.02\nprecision = \"f32\"\n[[body]]\nregion = { kind = \"ball\", centre = [900.0, 0.3], radius = 0.2 }\nplacement = { kind = \"jittered\", count = 1300 }\n",
        "numerics.precision",
        &["cells apart", "`f64`"],
    ),
    (
        "friction = 0.5",
        "[[collider]]\nshape = { kind = \"box\", centre = [0.4, -0.4], half_extent = [0.1, 0.1], angle = 45.0 }",
        "collider.1.shape",
        &["line of nodes", "fraction of a cell"],
    ),
];

#[test]
fn a_sound_scene_has_no_hazard() {
    assert_eq!(hazards_of(SOUND), []);
    let beside = |shape: &str| {
        SOUND.replace("friction = 0.5", &format!("[[collider]]\nshape = {{ kind = \"box\", {shape} }}"))
    };
    // On edge between lines of nodes, once for its centre and once for its length; flat.
    for shape in [
        "centre = [0.405, -0.405], half_extent = [0.1, 0.1], angle = 45.0",
        "centre = [0.4, -0.4], half_extent = [0.1, 0.107], angle = 45.0",
        "centre = [0.4, -0.4], half_extent = [0.1, 0.1]",
    ] {
        assert_eq!(hazards_of(&beside(shape)), [], "{shape}");
    }
}

#[test]
fn every_cliff_is_named_with_its_remedy() {
    for (from, to, key, words) in CLIFFS {
        assert!(SOUND.contains(from), "`{from}` is in the scene");
        let found = hazards_of(&SOUND.replacen(from, to, 1));
        let told: Vec<String> = found.iter().map(Advice::to_string).collect();
        let own: Vec<&String> = told.iter().filter(|line| line.starts_with(&format!("`{key}`: "))).collect();
        assert!(own.iter().any(|line| words.iter().all(|word| line.contains(word))), "{to}: {told:#?}");
    }
}

#[test]
fn particles_at_one_place_are_counted() {
    let desk = Desk::with(&[("points.csv", "x,y,volume\n0,0.3,1e-4\n0.01,0.3,1e-4\n0,0.3,1e-4\n")]);
    let text =
        SOUND.replace("{ kind = \"jittered\", count = 2000 }", "{ kind = \"file\", path = \"points.csv\" }");
    let scene = scene(&text.replace("region =", "#"));
    let facts = facts(&scene, desk.folder.path()).unwrap();
    assert_eq!(facts.coincident, 1);
    let found = hazards(&scene, &facts);
    assert!(
        found
            .iter()
            .any(|advice| advice.key == "body.0.placement" && advice.finding.contains("exactly where")),
        "{found:?}"
    );
}

/// Numbers that can be worked out by hand.
#[test]
fn the_facts_are_those_of_a_hand_calculation() {
    let facts = facts(&scene(SOUND), Path::new(".")).unwrap();
    // (lambda + 2 mu) / rho of S13's snow: 1.5556e5 / 400.
    assert!((facts.wave_speed - 19.72).abs() < 0.01, "{}", facts.wave_speed);
    // The lowest point falls from a little above 0.04 m.
    let speed = (9.0_f64 + 2.0 * 9.81 * 0.04).sqrt();
    assert!((facts.impact_speed / speed - 1.0).abs() < 0.05, "{} for {speed}", facts.impact_speed);
    assert!((facts.first_meeting / 0.0128 - 1.0).abs() < 0.1, "{}", facts.first_meeting);
    assert!((facts.mach - facts.impact_speed / facts.wave_speed).abs() < 1e-12);
    let yields = facts.impact_speed / (7.5e-3 * facts.wave_speed);
    assert!((facts.speed_over_yield.unwrap() / yields - 1.0).abs() < 1e-12);
    assert!((facts.particles_per_cell - 2000.0 * 4e-4 / (std::f64::consts::PI * 0.0625)).abs() < 0.02);
    assert_eq!(facts.empty_cells, None, "jittered cells are not left to chance");
}

/// Steps do not depend on the machine: what is predicted lies within a third of what is taken, hardened or not.
#[test]
fn steps_are_predicted_within_a_third() {
    let hard = SOUND.replace("[0.0, -3.0]", "[0.0, -8.0]");
    let elastic = SOUND.replace("velocity = ", "material = { kind = \"elastic\" }\nvelocity = ");
    for text in [SOUND, &hard, &elastic] {
        let scene = scene(text);
        let predicted = preflight(&scene, Path::new("."), 1).unwrap().predicted.unwrap().steps;
        let taken = run_scene::<2>(&scene, Path::new("."), 1, &mut Unobserved).unwrap().record.steps as f64;
        let error = (predicted / taken).ln().abs();
        assert!(error < (4.0_f64 / 3.0).ln(), "{predicted} predicted, {taken} taken");
    }
}

/// A mirror lies on a row of nodes of the scene's grid, and not on one of every coarser grid.
#[test]
fn a_scene_that_has_no_coarser_grid_is_looked_at_all_the_same() {
    let mirrored = SOUND.replace("[output]", "[[collider]]\ncontact = \"mirror\"\nshape = { kind = \"half-space\", point = [-0.38, 0.0], normal = [1.0, 0.0] }\n[output]");
    let found = preflight(&scene(&mirrored), Path::new("."), 1).unwrap();
    assert!(found.rehearsals.is_empty(), "{:?}", found.rehearsals);
    let first = found.facts.duration / found.facts.first_step;
    assert_eq!(found.predicted.unwrap().steps, first, "as if all steps were as long as the first");
}

#[test]
fn what_a_scene_does_not_need_is_named() {
    let needless = |text: &str| -> Vec<String> {
        let found = preflight(&scene(text), Path::new("."), 1).unwrap();
        found.needless.into_iter().map(|feature| feature.advice.key).collect()
    };
    let gentle = SOUND
        .replace("[0.0, -9.81]", "[0.0, 0.0]")
        .replace("-3.0]", "-0.02]")
        .replace("end = 0.2", "end = 2.5");
    assert!(needless(&gentle).contains(&"body.0.material.kind".to_string()), "nothing yields at 0.02 m/s");
    let lean = SOUND.replace(
        "spacing = 0.02",
        "spacing = 0.02\nprecision = \"f32\"\nenergy_budget = false\nwatchdog = false",
    );
    assert_eq!(needless(&lean), [""; 0], "it names nothing that it does not need");
    let slow = lean.replace("precision", "engine = \"reference\"\nprecision");
    let far = "end = 0.2\n[[collider]]\nshape = { kind = \"ball\", centre = [50.0, 0.0], radius = 1.0 }";
    let cluttered = slow.replace("end = 0.2", far);
    let expected = if snowlab_solver::Engine::Fast.is_available() {
        vec!["numerics.engine", "collider.1"]
    } else {
        vec!["collider.1"]
    };
    assert_eq!(needless(&cluttered), expected);
}

#[test]
fn runs_warn_with_the_same_words() {
    let fast = SCENE.replace("-8.0", "-18.0").replace("end = 1.0", "end = 0.2");
    let desk = Desk::with(&[
        ("scene.toml", &fast),
        (
            "study.toml",
            &study(
                "[[arm]]\nid = \"fast\"\nset = { \"body.0.velocity\" = [0.0, -18.0] }\n[[arm]]\nid = \"usual\"\n",
            ),
        ),
    ]);
    let words =
        "`body.0.velocity`: an impact at 18.000 m/s is nearly as fast as waves in the material (19.720";
    let told = |line: &str| String::from_utf8(desk.snowlab(line).stderr).unwrap();
    assert!(told("simulate scene.toml --out frames").contains(&format!("snowlab: {words}")));
    let of_study = told("run study.toml");
    assert!(of_study.contains(&format!("snowlab: fast: {words}")), "{of_study}");
    let printed = desk.expect(0, "preflight scene.toml");
    assert!(printed.contains(&format!("  {words}")), "{printed}");
    desk.write("short.toml", &fast.replace("spacing = 0.05", "spacing = 0.05\nmax_steps = 3"));
    let printed = desk.expect(0, "preflight short.toml");
    assert!(printed.contains("`numerics.max_steps`: is 3, and the run takes about"), "{printed}");
    let json: serde_json::Value =
        serde_json::from_str(&desk.expect(0, "preflight scene.toml --json")).unwrap();
    assert_eq!(json["hazards"][0]["key"], "body.0.velocity");
    // It takes 10 steps.
    let steps = json["predicted"]["steps"].as_f64().unwrap();
    assert!((7.0..14.0).contains(&steps), "{steps}");
}
