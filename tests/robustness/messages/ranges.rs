//! Every range of `scene_rules` and `study_rules`: what lies just outside is refused, by key and value.

use snowlab_study::spec::range::Range;
use snowlab_study::spec::{override_path, scene_of, scene_rules, study_rules};
use toml::{Table, Value};

use super::{STUDY, hold_message, study};

/// Scenes that have, together, every number a scene can have.
pub const SCENES: [&str; 4] = [
    r#"
gravity = [0.0, -9.81]
seed = 1
numerics = { spacing = 0.05, flip_share = 0.5, flip_reference_step = 1e-5, fixed_step = 1e-5, wave_courant = 0.1, advective_courant = 0.1, greatest_step = 0.1, max_steps = 9 }
output = { frame_interval = 0.01, end = 0.05 }
[[body]]
region = { kind = "ball", centre = [0.0, 0.3], radius = 0.25 }
placement = { kind = "jittered", count = 50, angle = 10.0 }
voids = { kind = "circles", porosity = 0.1, mean_radius = 0.1, radius_spread = 0.1, irregularity = 0.1, aspect = 2.0, angle = 1.0, gap = 0.1, judged_at = 0.1 }
material = { kind = "snow", density = 400.0, young = 1e5, poisson = 0.2, critical_compression = 0.1, critical_stretch = 0.1, hardening = 10.0, hardening_limit = 64.0 }
velocity = [0.0, 1.0]
spin = [1.0]
phase_shift = 0.1
stiffness_scale = 1.0
heterogeneity = { kind = "correlated", of = "stiffness", spread = 0.5, correlation_length = 0.1 }
[[collider]]
shape = { kind = "half-space", point = [0.0, 0.0], normal = [0.0, 1.0] }
friction = 0.5
velocity = [0.0, 1.0]
"#,
    r#"
numerics = { spacing = 0.05 }
output = { frame_interval = 0.01, end = 0.05 }
[[body]]
region = { kind = "ellipsoid", centre = [0.0, 0.3], semi_axes = [0.1, 0.2], angle = 1.0 }
placement = { kind = "lattice", count = 50, angle = 10.0 }
voids = { kind = "gaussian-field", porosity = 0.1, correlation_length = 0.1, judged_at = 0.1 }
material = { kind = "elastic", density = 400.0, young = 1e5, poisson = 0.2 }
heterogeneity = { kind = "shell", of = "stiffness", factor = 2.0, thickness = 0.1 }
[[collider]]
shape = { kind = "ball", centre = [0.0, 0.0], radius = 0.1 }
"#,
    r#"
dimension = 3
numerics = { spacing = 0.05, integrator = { kind = "semi-implicit", beta = 0.5, tolerance = 1e-2, max_iterations = 9 } }
output = { frame_interval = 0.01, end = 0.05 }
[[body]]
region = { kind = "box", centre = [0.0, 0.3, 0.0], half_extent = [0.1, 0.1, 0.1], angle = 1.0 }
placement = { kind = "random", count = 50 }
spin = [0.0, 0.0, 1.0]
[[body]]
region = { kind = "mesh", path = "a.obj", scale = 0.1, up = "y", rotation = [0.0, 0.0, 90.0], centre = [0.0, 0.3, 0.0] }
placement = { kind = "random", count = 50 }
[[body]]
placement = { kind = "file", path = "a.csv", filled_volume = 1.0 }
[[collider]]
shape = { kind = "box", centre = [0.0, 0.0, 0.0], half_extent = [0.1, 0.1, 0.1], angle = 1.0 }
"#,
    // Regions within regions keep the rules of regions.
    r#"
numerics = { spacing = 0.05 }
output = { frame_interval = 0.01, end = 0.05 }
[[body]]
placement = { kind = "random", count = 50 }
[body.region]
kind = "difference"
solid = { kind = "union", parts = [{ kind = "box", centre = [0.0, 0.3], half_extent = [0.1, 0.1], angle = 1.0 }] }
removed = { kind = "ellipsoid", centre = [0.0, 0.3], semi_axes = [0.1, 0.2], angle = 1.0 }
"#,
];

#[test]
fn every_number_of_a_scene_keeps_its_range() {
    let mut asked = std::collections::BTreeSet::new();
    for text in SCENES {
        let document: Value = toml::from_str::<Table>(text).unwrap().into();
        scene_of(&document).expect(text);
        let mut numbers = Vec::new();
        collect(&document, String::new(), &mut numbers);
        for (path, is_whole) in numbers {
            let Some(rule) = scene_rules::RULES.iter().find(|rule| rule.key == rule_key(&path)) else {
                assert_eq!(path, "dimension", "has no rule");
                continue;
            };
            asked.insert(rule.key);
            for value in outside(&rule.range, is_whole) {
                let mut changed = document.clone();
                override_path::set(&mut changed, &path, value.clone()).unwrap();
                let message = scene_of(&changed).expect_err(&format!("{path} = {value}")).to_string();
                // A list is named as a whole.
                let key = path.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('.');
                hold_message(&message, &path, &[&format!("`{key}"), &value.to_string()]);
                let allowed = [&format!("{}", rule.range), "a whole number, 0 or greater"];
                assert!(allowed.iter().any(|allowed| message.contains(*allowed)), "{message}");
            }
        }
    }
    assert_eq!(asked.len(), scene_rules::RULES.len(), "{asked:?}");
}

#[test]
fn every_number_of_a_study_keeps_its_range() {
    let claim = |id: &str| {
        format!(
            "[[claim]]\nid = \"{id}\"\nsentence = \"s\"\ncontrast = {{ paired = {{ treated = \"one\", control = \"two\" }} }}\n"
        )
    };
    let profile = "[profile.quick]\nblocks = { first = 1, count = 1 }\n";
    let text = format!(
        "{STUDY}blocks = 3\ntrade = {{ reference = \"one\", family = \"f\" }}\n{}{}{profile}",
        claim("c0"),
        claim("c1")
    );
    study(&text).expect("the study is accepted");
    for (key, range) in study_rules::RULES {
        let path = key.replace('*', "1");
        let is_whole = ["first", "count", "blocks", "bodies"].iter().any(|end| key.ends_with(end));
        for value in outside(range, is_whole) {
            let mut document: Value = toml::from_str::<Table>(&text).unwrap().into();
            override_path::set(&mut document, &path, value.clone()).unwrap();
            let message = study(&toml::to_string(&document).unwrap())
                .expect_err(&format!("{path} = {value}"))
                .to_string();
            let shown =
                value.as_float().map_or(value.to_string(), |number| number.to_string().to_lowercase());
            hold_message(&message.to_lowercase(), &path, &[&format!("`{path}`"), &shown]);
        }
    }
}

#[test]
fn profiles_keep_the_ranges_of_what_they_replace() {
    let hold = |profile: &str, says: &[&str]| {
        let message = study(&format!("{STUDY}[profile.quick]\n{profile}\n")).expect_err(profile).to_string();
        hold_message(&message, profile, says);
    };
    hold("blocks = { first = 1, count = 0 }", &["`profile.quick.blocks.count`", "is 0", "1 or more"]);
    hold(
        "measure = { largest_spacing = 0.0 }",
        &["`profile.quick.measure.largest_spacing`", "is 0", "above 0"],
    );
}

/// Paths of all numbers, and whether they are whole.
fn collect(value: &Value, path: String, found: &mut Vec<(String, bool)>) {
    let join = |key: &str| if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, inner)| collect(inner, join(key), found)),
        Value::Array(items) => {
            items
                .iter()
                .enumerate()
                .for_each(|(index, inner)| collect(inner, join(&index.to_string()), found));
        }
        Value::Integer(_) => found.push((path, true)),
        Value::Float(_) => found.push((path, false)),
        _ => {}
    }
}

/// The key of a rule for the number at `path`.
fn rule_key(path: &str) -> String {
    let parts: Vec<&str> =
        path.split('.').filter(|part| !["parts", "solid", "removed"].contains(part)).collect();
    // The first number is that of a body or a collider; others stand in lists.
    let names = parts.iter().enumerate().filter(|(k, part)| *k == 1 || part.parse::<usize>().is_err());
    names
        .map(|(_, part)| if part.parse::<usize>().is_ok() { "*" } else { part })
        .collect::<Vec<_>>()
        .join(".")
        .trim_end_matches(".*")
        .to_string()
}

/// Numbers that lie outside, near the ends.
fn outside(range: &Range, is_whole: bool) -> Vec<Value> {
    let mut numbers = if is_whole { Vec::new() } else { vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY] };
    let beyond = |end: f64, included: bool, step: f64| {
        if included { end + step * end.abs().max(1.0) * 1e-6 } else { end }
    };
    let beyond_whole = |end: f64, included: bool, step: f64| if included { end + step } else { end };
    let past = if is_whole { beyond_whole } else { beyond };
    if range.least.is_finite() {
        numbers.push(past(range.least, range.from_least, -1.0));
    }
    if range.greatest.is_finite() {
        numbers.push(past(range.greatest, range.to_greatest, 1.0));
    }
    numbers
        .into_iter()
        .map(|number| if is_whole { Value::Integer(number as i64) } else { Value::Float(number) })
        .collect()
}
