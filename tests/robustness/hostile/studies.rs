//! Studies.

use std::path::{Component, Path};
use std::sync::LazyLock;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use snowlab_study::spec::{self, Spec, StudySpec};
use snowlab_study::sweep::{MOST_CASES, Study};
use toml::{Table, Value};

use super::corpus::{Corpus, documented, most_for};
use super::memory::most_held;
use super::telling::{WHOLE_NUMBERS, one_of};
use super::{document, hand_over, hold_refusal};
use crate::messages::STUDY;

static CORPUS: LazyLock<Corpus> =
    LazyLock::new(|| Corpus::new([STUDY, SMALL].into_iter().chain(documented(true))));

/// A study with every table of one, and few values.
const SMALL: &str = r#"
name = "small"
question = "?"
caveats = ["?"]
noise_floor = ["a"]
blocks = { first = 1, count = 1 }
measure = { largest_spacing = 0.05, link_ratio = 2.0, min_mass_share = 0.1, bodies = 1, settle_window = 1.0 }
pilot = { operating_point_found = true, source = "s" }
[scene]
numerics = { spacing = 0.05 }
output = { frame_interval = 0.01, end = 0.05 }
[[scene.body]]
region = { kind = "ball", centre = [0.0, 0.3], radius = 0.25 }
placement = { kind = "random", count = 50 }
[[arm]]
id = "a"
label = "A"
picture = "p"
[[arm]]
id = "b"
blocks = 2
set = { "body.0.placement.count" = 20 }
trade = { reference = "a", family = "f" }
[[condition]]
id = "c"
label = "C"
check = "other-transfer"
arms = ["a"]
set = { "numerics.transfer" = "apic" }
arm_set = { a = { "numerics.transfer" = "mls" } }
blocks = 2
[[density_noise]]
noisy = "a"
lattice = "b"
random = "a"
[[claim]]
id = "k"
sentence = "s"
contrast = { paired = { treated = "a", control = "b" } }
[[control]]
id = "l"
sentence = "s"
contrast = { weighted = { weights = { a = 1.0, b = -1.0 } } }
[[expect]]
metric = "damage"
arms = ["a"]
statistic = "mean"
range = [0.0, 1.0]
profiles = ["quick"]
why = "w"
[[sweep]]
name = "h"
values = [{ "numerics.spacing" = 0.05, "numerics.kernel" = "cubic" }]
labels = ["coarse"]
numbers = [1.0]
[[sweep]]
name = "s"
arms = ["a"]
[sweep.sample]
points = 1
seed = 1
[[sweep.sample.factor]]
name = "v"
path = "body.0.velocity"
range = [1.0, 2.0]
scale = "logarithmic"
along = [0.0, -1.0]
arms = ["a"]
[profile.quick]
arms = ["a", "b"]
conditions = ["c"]
blocks = { first = 1, count = 1 }
set = { "numerics.precision" = "f32" }
arm_set = { a = { "body.0.stiffness_scale" = 2.0 } }
measure = { largest_spacing = 0.1 }
"#;

#[test]
fn every_study_is_expanded_or_refused_in_words_that_help() {
    hand_over("studies", 30, |random| {
        let text = CORPUS.mutated(random, absurd);
        let (parsed, held) = most_held(|| spec::parse::<StudySpec>(&text));
        assert!(held < most_for(&text), "{held} bytes are held for {}: {text}", text.len());
        match &parsed {
            Ok(spec) => hold_accepted(spec, &text),
            Err(error) => hold_refusal(&error.to_string(), &text),
        }
        parsed.is_ok()
    });
}

/// What is accepted has few cases, each of a scene that is accepted, and writes nowhere but below its folder.
fn hold_accepted(spec: &StudySpec, text: &str) {
    for name in names(spec) {
        assert!(is_plain(name), "{name:?} becomes a file or folder: {text}");
    }
    for profile in [None].into_iter().chain(spec.profile.keys().take(3).map(|name| Some(name.as_str()))) {
        match Study::expand(spec.clone(), profile) {
            Err(error) => hold_refusal(&error.to_string(), text),
            Ok(study) => {
                assert!((1..=MOST_CASES).contains(&(study.cases.len() as u64)), "{text}");
                for case in study.cases.iter().take(5).chain(study.cases.last()) {
                    case.scene.validate().expect(text);
                    assert!(case.point().all(|(_, number)| number.is_finite()), "{text}");
                }
            }
        }
    }
}

/// All that names files, folders or columns.
fn names(spec: &StudySpec) -> impl Iterator<Item = &str> {
    let arms = spec.arm.iter().flat_map(|arm| [Some(&arm.id), arm.picture.as_ref()]).flatten();
    let axes = spec.sweep.iter().map(|axis| &axis.name);
    let conditions = spec.condition.iter().map(|condition| &condition.id);
    [&spec.name]
        .into_iter()
        .chain(arms)
        .chain(conditions)
        .chain(axes)
        .chain(spec.profile.keys())
        .map(String::as_str)
}

/// Whether a name is that of an entry of the folder it is joined to, on any system, and no hidden one.
fn is_plain(name: &str) -> bool {
    let parts: Vec<Component> = Path::new(name).components().collect();
    matches!(parts[..], [Component::Normal(part)] if part == name)
        && name.len() <= 64
        && !name.starts_with('.')
        && name.bytes().all(|b| b.is_ascii_graphic() && !b"/\\:*?\"<>|~$%".contains(&b))
}

/// A change that only a study can have.
fn absurd(study: &mut Table, random: &mut ChaCha8Rng) {
    match random.random_range(0..9) {
        0 => drop(study.insert("sweep".into(), sweep(random))),
        1 => blocks(study.get_mut("blocks"), random),
        2 => circle(study, "check", random),
        3 => circle(study, "trade", random),
        4 => crowd(study, random),
        5 => drop(study.insert("name".into(), Value::String(document::name(random)))),
        6 => rename(study, random),
        7 => set(study, random),
        _ => {
            let profile = document::name(random);
            let content = Table::from_iter([("arms".to_string(), Value::Array(ids(study)))]);
            study
                .insert("profile".into(), Value::Table(Table::from_iter([(profile, Value::Table(content))])));
        }
    }
}

/// Few points, or by far too many axes, values, or points.
fn sweep(random: &mut ChaCha8Rng) -> Value {
    const PATHS: [&str; 6] = [
        "numerics.spacing",
        "body.0.stiffness_scale",
        "body.0.placement.count",
        "output.end",
        "body.0.phase_shift",
        "body.0.region.radius",
    ];
    let (axes, values) =
        [(1..7, 2), (1..5, 5), (1..100, 1), (20..30, 2), (3..7, 1000)][random.random_range(0..5)].clone();
    let axis = |k: usize| {
        let path = PATHS.get(k).map_or(format!("body.0.key-{k}"), |path| path.to_string());
        let values = (1..=values).map(|v| Value::Float(0.05 * v as f64)).collect();
        Value::Table(Table::from_iter([
            ("name".to_string(), Value::String(format!("axis-{k}"))),
            ("path".to_string(), Value::String(path)),
            ("values".to_string(), Value::Array(values)),
        ]))
    };
    Value::Array((0..random.random_range(axes)).map(axis).collect())
}

fn blocks(blocks: Option<&mut Value>, random: &mut ChaCha8Rng) {
    if let Some(Value::Table(blocks)) = blocks {
        for key in ["first", "count"] {
            if random.random() {
                let number = WHOLE_NUMBERS[random.random_range(0..WHOLE_NUMBERS.len())];
                blocks.insert(key.into(), Value::Integer(number));
            }
        }
    }
}

fn arms(study: &mut Table) -> Vec<&mut Table> {
    let arms = study.get_mut("arm").and_then(Value::as_array_mut);
    arms.into_iter().flatten().filter_map(Value::as_table_mut).collect()
}

fn ids(study: &mut Table) -> Vec<Value> {
    arms(study).iter().filter_map(|arm| arm.get("id").cloned()).collect()
}

/// Each arm points to another one, or to itself.
fn circle(study: &mut Table, key: &str, random: &mut ChaCha8Rng) {
    let ids = ids(study);
    let step = random.random_range(0..3);
    for (k, arm) in arms(study).into_iter().enumerate() {
        let Some(id) = ids.get((k + step) % ids.len().max(1)) else { continue };
        let pairs = if key == "check" {
            [("of", id.clone()), ("by", Value::String("half-step".into()))]
        } else {
            [("reference", id.clone()), ("family", Value::String(document::name(random)))]
        };
        let table = pairs.into_iter().map(|(key, value)| (key.to_string(), value)).collect();
        arm.insert(key.into(), Value::Table(table));
    }
}

/// Many arms, now and then more than any study has.
fn crowd(study: &mut Table, random: &mut ChaCha8Rng) {
    let count = if random.random_range(0..20) == 0 { 2000 } else { random.random_range(1..30) };
    let arm =
        |k: usize| Value::Table(Table::from_iter([("id".to_string(), Value::String(format!("arm-{k}")))]));
    study.insert("arm".into(), Value::Array((0..count).map(arm).collect()));
}

/// A name of an arm, a picture or an axis.
fn rename(study: &mut Table, random: &mut ChaCha8Rng) {
    let mut arms = arms(study);
    if !arms.is_empty() {
        let which = random.random_range(0..arms.len());
        arms[which].insert(
            one_of(&["id", "picture", "label"], random).into(),
            Value::String(document::name(random)),
        );
    }
}

/// A path into the scene that leads elsewhere.
fn set(study: &mut Table, random: &mut ChaCha8Rng) {
    const PATHS: [&str; 12] = [
        "seed",
        "seed.x",
        "body",
        "body.0",
        "body.99999999999999999999",
        "body.-1",
        "body..x",
        ".",
        "",
        "numerics.spacing.x",
        "body.0.region.parts.0.parts.0",
        "dimension",
    ];
    let path = if random.random() { one_of(&PATHS, random).to_string() } else { document::name(random) };
    let mut arms = arms(study);
    if !arms.is_empty() {
        let which = random.random_range(0..arms.len());
        let value = Value::Integer(WHOLE_NUMBERS[random.random_range(0..WHOLE_NUMBERS.len())]);
        arms[which].insert("set".into(), Value::Table(Table::from_iter([(path, value)])));
    }
}
