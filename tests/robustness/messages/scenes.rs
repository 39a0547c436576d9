//! Scenes.

use std::path::Path;

use snowlab_study::assemble::assemble;
use snowlab_study::run::{Unobserved, run_scene};
use snowlab_study::spec::{self, SceneSpec, Spec};

use super::{Refused, SCENE, hold, hold_message, refused, scene};

const NUMBER: &str = "expected a number";
const WHOLE: &str = "expected a whole number, 0 or greater";
const BALL: &str = r#"{ kind = "ball", centre = [0.0, 0.3], radius = 0.25 }"#;
const PLACEMENT: &str = r#"{ kind = "random", count = 50 }"#;

/// (what stands in the scene, what is put in its place, what the refusal says)
const TABLE: &[Refused] = &[
    // Unknown keys and names.
    refused(
        "spacing = 0.05",
        "spacing = 0.05\nspacin = 0.05",
        &["line 4", "`numerics.spacin`", "unknown key", "`spacing`"],
    ),
    refused("[output]", "[outputs]\n[output]", &["`outputs`", "unknown key", "`dimension`, `seed`"]),
    refused(
        "radius = 0.25",
        "radius = 0.25, angle = 1.0",
        &["line 6", "`body.0.region.angle`", "`centre` or `radius`"],
    ),
    refused(
        "count = 50",
        "count = 50, angle = 1.0",
        &["`body.0.placement.angle`", "unknown key", "`count_of`"],
    ),
    refused(
        "spacing = 0.05",
        "spacing = 0.05\nkernel = \"linear\"",
        &["`numerics.kernel`", "`linear`", "`cubic` or `quadratic`"],
    ),
    refused("\"ball\"", "\"bal\"", &["line 6", "`body.0.region.kind`", "`bal`", "`ball`, `box`"]),
    refused("\"random\"", "\"grid\"", &["`body.0.placement.kind`", "`grid`", "`jittered`"]),
    // Missing keys.
    refused("spacing = 0.05", "", &["`numerics`", "`spacing` is missing", "add it"]),
    refused("[numerics]\nspacing = 0.05", "", &["`numerics` is missing"]),
    refused("radius = 0.25", "", &["`body.0.region`", "`radius` is missing"]),
    refused("count = 50", "", &["`body.0.placement`", "`count` is missing"]),
    refused("kind = \"ball\",", "", &["`body.0.region`", "`kind` is missing"]),
    refused("end = 0.05", "", &["`output`", "`end` is missing"]),
    refused("shape =", "#", &["`collider.0`", "`shape` is missing"]),
    refused("region =", "#", &["`body.0.region`", "is missing", "`file`"]),
    // Wrong types.
    refused("radius = 0.25", "radius = \"big\"", &["`body.0.region.radius`", "\"big\"", NUMBER]),
    refused("spacing = 0.05", "spacing = [0.05]", &["`numerics.spacing`", "is a list", NUMBER]),
    refused("centre = [0.0, 0.3]", "centre = 0.3", &["`body.0.region.centre`", "0.3", "expected a list"]),
    refused("centre = [0.0, 0.3]", "centre = [0.0, \"up\"]", &["`body.0.region.centre.1`", "\"up\"", NUMBER]),
    refused("count = 50", "count = 50.0", &["`body.0.placement.count`", "the number `50.0`", WHOLE]),
    refused("count = 50", "count = -50", &["`body.0.placement.count`", "`-50`", WHOLE]),
    refused("[numerics]", "seed = -1\n[numerics]", &["`seed`", "`-1`", WHOLE]),
    refused(
        "spacing = 0.05",
        "spacing = 0.05\nwatchdog = \"no\"",
        &["`numerics.watchdog`", "\"no\"", "true or false"],
    ),
    refused("[[collider]]", "[collider]", &["`collider`", "is a table", "expected a list"]),
    refused("[numerics]\nspacing = 0.05", "numerics = 1", &["`numerics`", "`1`", "expected a table"]),
    refused(BALL, "\"ball\"", &["`body.0.region`", "\"ball\"", "expected a table"]),
    refused("spacing = 0.05", "spacing = 0.05\nkernel = 3", &["`numerics.kernel`", "a name in quotes"]),
    refused("\"ball\"", "3", &["line 6", "`body.0.region.kind`", "`3`", "expected a name in quotes"]),
    refused(BALL, "[]", &["line 6", "`kind` is missing"]),
    refused(
        BALL,
        "[\"ball\", [0.0, 0.3], 0.25]",
        &["line 6", "`body.0.region`", "is a list, expected a table"],
    ),
    refused(
        "[numerics]\nspacing = 0.05",
        "numerics = [0.05]",
        &["line 2", "`numerics`", "is a list, expected a table"],
    ),
    refused("[numerics]\nspacing = 0.05", "numerics = []", &["line 2", "`numerics`", "expected a table"]),
    refused("end = 0.05", "end = 0.05\nend_from = {}", &["`output.end_from`", "is empty"]),
    refused(
        "radius = 0.25",
        "radius = 1e300",
        &["`body.0.region.radius`", "is 1e300", "above 0, at most 1e6"],
    ),
    refused("radius = 0.25", "radius = 1e-300, angle = 1e300", &["`body.0.region.angle`"]),
    refused("count = 50", "count = 1e300", &["`body.0.placement.count`", "`1e300`", WHOLE]),
    refused(
        "centre = [0.0, 0.3]",
        "centre = [0.0, 1e-300, 0.0, 0.0, 0.0]",
        &["`body.0.region.centre`", "[0.0, 1e-300, 0.0, ...]", "in 2D: 2 numbers"],
    ),
    refused(
        "[numerics]",
        "seed = 9223372036854775808\n[numerics]",
        &["line 2", "too large", "9223372036854775807"],
    ),
    // Ranges; all of them are asked of in `ranges.rs`.
    refused("[numerics]", "dimension = 4\n[numerics]", &["`dimension`", "is 4", "2 or 3"]),
    refused("[numerics]", "dimension = 1\n[numerics]", &["`dimension`", "is 1", "2 or 3"]),
    refused("spacing = 0.05", "spacing = nan", &["`numerics.spacing`", "is nan", "above 0"]),
    refused(
        "count = 50 }",
        "count = 50 }\nmaterial = { kind = \"snow\", poisson = 0.5 }",
        &["`body.0.material.poisson`", "is 0.5", "below 0.5"],
    ),
    refused(
        "count = 50 }",
        "count = 50 }\nmaterial = { kind = \"elastic\", young = 0.0 }",
        &["`body.0.material.young`", "is 0.0", "above 0"],
    ),
    refused(
        "count = 50 }",
        "count = 50 }\nmaterial = { kind = \"snow\", critical_compression = 1.0 }",
        &["`body.0.material.critical_compression`", "is 1.0", "below 1"],
    ),
    refused(
        "count = 50 }",
        "count = 50 }\nmaterial = { kind = \"snow\", plastic_ratio_bounds = [1.0, 0.5] }",
        &["`body.0.material.plastic_ratio_bounds`", "[1.0, 0.5]", "upper above 1"],
    ),
    refused(
        "count = 50 }",
        "count = 50 }\nmaterial = { kind = \"snow\", plastic_ratio_bounds = [0.5] }",
        &["`body.0.material.plastic_ratio_bounds`", "length 1", "length 2"],
    ),
    // Lists of the wrong length.
    refused(
        "centre = [0.0, 0.3]",
        "centre = [0.0, 0.3, 0.0]",
        &["`body.0.region.centre`", "[0.0, 0.3, 0.0]", "in 2D: 2 numbers"],
    ),
    refused("[numerics]", "gravity = [-9.81]\n[numerics]", &["`gravity`", "[-9.81]", "in 2D: 2 numbers"]),
    refused("[numerics]", "dimension = 3\n[numerics]", &["`body.0.region.centre`", "in 3D: 3 numbers"]),
    refused("count = 50 }", "count = 50 }\nspin = [0.0, 0.0, 1.0]", &["`body.0.spin`", "in 2D: 1 number"]),
    // What keys say of one another.
    refused(
        BALL,
        "{ kind = \"mesh\", path = \"a.obj\", rotation = [0.0, 0.0, 90.0] }",
        &["line 6", "`body.0.region`", "`mesh`", "`dimension = 3`"],
    ),
    refused(
        BALL,
        "{ kind = \"union\", parts = [{ kind = \"mesh\", path = \"a.obj\" }] }",
        &["line 6", "`body.0.region`", "`mesh`", "`dimension = 3`"],
    ),
    refused(
        BALL,
        "{ kind = \"mesh\", path = \"a.obj\", angle = 90.0 }",
        &["line 6", "`body.0.region.angle`", "unknown key", "`rotation`"],
    ),
    refused(
        PLACEMENT,
        r#"{ kind = "file", path = "a.csv", filled_volume = 1.0 }"#,
        &["`body.0.region`", "`file`", "remove it"],
    ),
    refused(
        "count = 50 }",
        "count = 50 }\n[[body]]\nplacement = { kind = \"file\", path = \"a.csv\" }\nvoids = { kind = \"circles\" }",
        &["`body.1.voids`", "`file`", "remove it"],
    ),
    refused(
        "count = 50 }",
        "count = 50 }\n[[body]]\nplacement = { kind = \"file\", path = \"a.csv\" }\nheterogeneity = { kind = \"independent\", of = \"mass\", spread = 0.5 }",
        &["`body.1.heterogeneity`", "`file`", "remove it"],
    ),
    refused(
        "spacing = 0.05",
        "spacing = 0.05\nadvection = \"blended\"\nintegrator = { kind = \"trapezoidal\" }",
        &["`numerics.advection`", "`blended`", "`trapezoidal`", "`interpolated`"],
    ),
    refused("count = 50", "count = 20000001", &["`body.0.placement.count`", "20000001", "1 to 2e7"]),
    refused("[0.0, 1.0]", "[0.0, 0.0]", &["`collider.0.shape.normal`", "[0.0, 0.0]", "not zero"]),
    refused(
        "[[collider]]",
        "[[collider]]\ncontact = \"mirror\"\nvelocity = [0.0, 1.0]",
        &["`collider.0`", "mirror", "it moves"],
    ),
    refused(
        "point = [0.0, 0.0], normal = [0.0, 1.0] }",
        "point = [0.0, 0.01], normal = [0.0, 1.0] }\ncontact = \"mirror\"",
        &["`collider.0`", "its plane lies at", "whole number"],
    ),
    refused(
        "end = 0.05",
        "end = 0.05\ntime_unit = \"crossing\"",
        &["`output.time_unit`", "does not move", "`second`"],
    ),
    refused(
        "frame_interval = 0.01",
        "frame_interval = 1e-9",
        &["`output.frame_interval`", "1e-9", "50000000 frames", "100000"],
    ),
    refused("spacing = 0.05", "spacing = 1e-12", &["`numerics.spacing`", "1e-12", "cells", "1073741824"]),
    refused(BALL, r#"{ kind = "union", parts = [] }"#, &["`body.0`", "at least one part"]),
    refused(
        BALL,
        r#"{ kind = "difference", solid = { kind = "ball", centre = [0.0, 0.0], radius = 1.0 }, removed = { kind = "ball", centre = [0.0, 0.0], radius = 2.0 } }"#,
        &["`body.0`", "empty", "enlarge the region"],
    ),
    refused(
        "count = 50 }",
        "count = 50 }\nvoids = { kind = \"circles\", mean_radius = 0.01 }",
        &["`body.0`", "mean radius of the voids", "0.01", "2 h or more"],
    ),
    refused(
        "count = 50 }",
        "count = 50 }\nvoids = { kind = \"circles\", porosity = 0.6, mean_radius = 0.1 }",
        &["`body.0`", "no void field", "porosity 0.6", "smaller gap"],
    ),
    // What is not TOML.
    refused("[numerics]", "[numerics", &["line 2", "unclosed"]),
    refused("spacing = 0.05", "spacing = 0.05\nspacing = 0.05", &["line 4", "duplicate key", "remove one"]),
    refused("spacing = 0.05", "spacing = 0,05", &["line 3"]),
];

#[test]
fn a_long_value_does_not_make_a_long_message() {
    let text = SCENE.replace("spacing = 0.05", &format!("spacing = \"{}\"", "0".repeat(1_000_000)));
    let message = scene(&text).unwrap_err().to_string();
    hold_message(&message, "a long text", &["`numerics.spacing`", "is string", NUMBER]);
    let text = SCENE.replace("spacing = 0.05", &format!("spacing = \"{}\"", "0 ".repeat(1_000_000)));
    let message = scene(&text).unwrap_err().to_string();
    hold_message(&message, "many words", &["`numerics.spacing`", "is string", NUMBER]);
    let text = SCENE.replace("spacing = 0.05", &format!("{} = 0.05", "spacing".repeat(1000)));
    let message = scene(&text).unwrap_err().to_string();
    hold_message(
        &message,
        "a long key",
        &["`numerics.spacing", "unknown key", "`spacing`, `kernel`", "`max_steps`"],
    );
}

#[test]
fn scenes_are_refused_with_key_value_and_remedy() {
    hold(SCENE, scene, TABLE);
}

#[test]
fn a_contact_needs_an_obstacle() {
    let text = SCENE.replace("end = 0.05", "end = 0.05\nend_from = \"contact\"");
    scene(&text).expect("there is an obstacle");
    let without = text.replace("[[collider]]\nshape", "[[collider]]\n#").replace("[[collider]]", "");
    let message = scene(&without).expect_err("there is none").to_string();
    hold_message(&message, "no obstacle", &["`output.end_from`", "`contact`", "no [[collider]]", "`start`"]);
}

#[test]
fn bodies_and_particles_have_their_limits() {
    let mut spec: SceneSpec = spec::parse(SCENE).unwrap();
    spec.body = vec![spec.body[0].clone(); 65_536];
    let message = spec.validate().unwrap_err().to_string();
    hold_message(&message, "bodies", &["`body`", "65536 entries", "1 to 65535"]);
    spec.body.clear();
    hold_message(&spec.validate().unwrap_err().to_string(), "no body", &["`body`", "0 entries"]);
    let many = SCENE.replace("count = 50", "count = 12000000");
    let body = many.split("[[collider]]").next().unwrap().split("[[body]]").nth(1).unwrap();
    let message = spec::parse::<SceneSpec>(&format!("{many}\n[[body]]{body}")).unwrap_err().to_string();
    hold_message(&message, "particles", &["`body`", "24000000 particles", "20000000"]);
}

#[test]
fn regions_may_be_nested_but_not_without_end() {
    let ball = r#"{ kind = "ball", centre = [0.0, 0.3], radius = 0.25 }"#;
    let nested = |depth: usize| {
        let region = (0..depth)
            .fold(ball.to_string(), |inner, _| format!("{{ kind = \"union\", parts = [{inner}] }}"));
        SCENE.replace(ball, &region)
    };
    scene(&nested(3)).expect("three levels are fine");
    hold_message(&scene(&nested(33)).unwrap_err().to_string(), "33 levels", &["`body.0`", "32 levels"]);
    let deep = ["line 6", "nested too deep", "fewer levels"];
    hold_message(&scene(&nested(5000)).unwrap_err().to_string(), "5000 levels", &deep);
    let key = format!("{}a = 1\n{SCENE}", "a.".repeat(5000));
    hold_message(&scene(&key).unwrap_err().to_string(), "a key of 5000 parts", &deep[1..]);
}

/// What f64 holds and f32 does not.
#[test]
fn what_is_too_large_for_the_precision_is_refused() {
    let text = SCENE.replace("spacing = 0.05", "spacing = 0.05\nprecision = \"f32\"");
    let text = text.replace("count = 50 }", "count = 50 }\nmaterial = { kind = \"elastic\", young = 1e40 }");
    let message = assemble::<f32, 2>(&spec::parse(&text).unwrap(), Path::new(".")).unwrap_err().to_string();
    hold_message(
        &message,
        "E = 1e40 in f32",
        &["shear modulus mu is inf", "finite and > 0", "stiffness", "`numerics.precision`"],
    );
}

/// The squares of its components are 0: it has a direction all the same.
#[test]
fn a_short_normal_has_a_direction() {
    scene(&SCENE.replace("normal = [0.0, 1.0]", "normal = [1e-200, -1e-200]")).unwrap();
    scene(&SCENE.replace("normal = [0.0, 1.0]", "normal = [5e-324, 0.0]")).unwrap();
}

/// Each of these would go on for years.
#[test]
fn a_run_without_end_is_refused() {
    let material = |keys: &str| {
        SCENE.replace("count = 50 }", &format!("count = 50 }}\nmaterial = {{ kind = \"elastic\", {keys} }}"))
    };
    for text in [
        material("young = 1e40"),
        material("density = 1e-40"),
        SCENE.replace("spacing = 0.05", "spacing = 0.05\nfixed_step = 1e-40"),
        SCENE.replace("spacing = 0.05", "spacing = 0.05\nwave_courant = 1e-40"),
    ] {
        let scene: SceneSpec = spec::parse(&text).unwrap();
        let message = run_scene::<2>(&scene, Path::new("."), 1, &mut Unobserved).unwrap_err().to_string();
        hold_message(&message, &text, &["`output.end`", "steps", "allowed: 1e11", "check spacing"]);
    }
}

#[test]
fn the_dimension_asked_for_must_be_the_scene_s() {
    let spec: SceneSpec = spec::parse(SCENE).unwrap();
    let message = assemble::<f64, 3>(&spec, Path::new(".")).unwrap_err().to_string();
    hold_message(&message, "2D as 3D", &["`dimension`", "is 2", "3 is asked for"]);
}
