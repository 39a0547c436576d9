//! `docs/input.md` against the code: every key, type, default and range, both ways, and every example.

mod page;
mod schema;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use page::{Part, Row, backticked};
use schema::{Keys, Shape};
use serde::Serialize;
use serde::de::DeserializeOwned;
use snowlab_study::assemble::assemble;
use snowlab_study::spec::scene::{CountSpec, LatticeSpec, PlacementSpec};
use snowlab_study::spec::{self, SceneSpec, StudySpec, scene_rules, study_rules};
use snowlab_study::sweep::Study;
use toml::{Table, Value};

#[test]
fn the_page_has_the_keys_of_the_code_and_no_others() {
    for (part, shape) in both() {
        let (code, page) = (schema::tables(&shape), page::tables(part));
        let paths = |tables: BTreeSet<&String>| tables.into_iter().cloned().collect::<Vec<_>>();
        assert_eq!(paths(page.keys().collect()), paths(code.keys().collect()), "tables of {part:?}");
        for (path, keys) in &code {
            for (kind, keys) in &keys.kinds {
                let documented: BTreeSet<&str> = page[path]
                    .iter()
                    .filter(|row| row.key != "kind" && (row.kinds.is_empty() || row.kinds.contains(kind)))
                    .map(|row| row.key.as_str())
                    .collect();
                let accepted: BTreeSet<&str> = keys.keys().map(String::as_str).collect();
                assert_eq!(documented, accepted, "{part:?} `{path}` of kind `{kind}`");
            }
            for row in &page[path] {
                for kind in &row.kinds {
                    assert!(keys.kinds.contains_key(kind), "{part:?} `{path}.{}`: no kind `{kind}`", row.key);
                }
            }
        }
    }
}

#[test]
fn the_page_has_the_types_and_names_of_the_code() {
    for (part, shape) in both() {
        for_each_row(part, &shape, |path, row, kind, keys| {
            let place = format!("{part:?} `{path}.{}`", row.key);
            if row.key == "kind" {
                let kinds: BTreeSet<String> = keys.kinds.keys().cloned().collect();
                assert_eq!(kinds, backticked(&row.allowed).into_iter().collect(), "{place}");
                return;
            }
            let shape = &keys.kinds[kind][&row.key];
            assert_eq!(row.word, schema::word(shape), "{place}");
            if let Shape::Names(names) = shape {
                assert_eq!(&backticked(&row.allowed), names, "{place}");
            }
        });
    }
}

#[test]
fn defaults_are_those_of_the_code() {
    defaults_hold::<SceneSpec>(Part::Scene);
    defaults_hold::<StudySpec>(Part::Study);
}

/// `required` keys are missed; a default written out is what is taken without the key; `none` is nothing.
fn defaults_hold<S: DeserializeOwned + Serialize>(part: Part) {
    let shape = schema::shape_of::<S>();
    for_each_row(part, &shape, |path, row, kind, keys| {
        let place = format!("{part:?} `{path}.{}` ({kind})", row.key);
        let (mut document, mut steps) = document_with(&shape, path, kind);
        steps.push(row.key.clone());
        let json = |document: &Value| -> Result<serde_json::Value, String> {
            let spec: S =
                document.clone().try_into().map_err(|e: toml::de::Error| e.message().to_string())?;
            Ok(serde_json::to_value(spec).expect("a spec is plain data"))
        };
        if keys.one_of {
            // That one of them alone will do is shown by the documents of the tables below them.
            return assert_eq!(row.default, "none", "{place}");
        }
        let whole = json(&document).unwrap_or_else(|error| panic!("{place}: {error} in\n{document}"));
        if row.default == "required" {
            remove(&mut document, &steps);
            assert_eq!(json(&document), Err(format!("missing field `{}`", row.key)), "{place}");
        } else if let Some(literal) =
            backticked(&row.default).first().filter(|_| row.default.starts_with('`'))
        {
            let value =
                toml::from_str::<Table>(&format!("value = {literal}")).expect(literal)["value"].clone();
            *entry(&mut document, &steps) = value;
            assert_eq!(json(&document).as_ref(), Ok(&whole), "{place}: {literal} is not the default");
            *entry(&mut document, &steps) = Value::Array(Vec::new());
            assert_ne!(json(&document).as_ref(), Ok(&whole), "{place}: the key does nothing");
        } else {
            assert!(row.default.starts_with("none"), "{place}: the default is `{}`", row.default);
            let empty = |value: &serde_json::Value| {
                value.is_null()
                    || value.as_array().is_some_and(Vec::is_empty)
                    || value.as_object().is_some_and(serde_json::Map::is_empty)
            };
            let found = steps.iter().try_fold(&whole, |value, step| match step.parse::<usize>() {
                Ok(index) => value.get(index),
                Err(_) => value.get(step),
            });
            assert!(found.is_none_or(empty), "{place}: without it there is {found:?}");
        }
    });
}

#[test]
fn ranges_are_those_of_the_code() {
    let mut documented = BTreeSet::new();
    for_each_row(Part::Scene, &schema::shape_of::<SceneSpec>(), |path, row, _, _| {
        let key = join(path, &row.key).replace(".N", ".*");
        if let Some(rule) = scene_rules::RULES.iter().find(|rule| rule.key == key) {
            let allowed = match rule.length {
                scene_rules::Length::Single => rule.range.to_string(),
                scene_rules::Length::Vector | scene_rules::Length::MaybeVector => {
                    format!("D numbers, each {}", rule.range)
                }
                scene_rules::Length::MaybeSpin => format!("1 number in 2D, 3 in 3D, each {}", rule.range),
            };
            assert!(row.allowed.starts_with(&allowed), "`{key}`: {} for {allowed}", row.allowed);
            documented.insert(key);
        } else if row.word.contains("number") {
            // Their ranges are no rule of one number each.
            let others = ["dimension", "body.*.material.plastic_ratio_bounds"];
            assert!(others.contains(&key.as_str()), "`{key}` has no rule in the code");
        }
    });
    assert_eq!(documented.len(), scene_rules::RULES.len(), "each rule of a scene has its row");
    let mut documented = BTreeSet::new();
    for_each_row(Part::Study, &schema::shape_of::<StudySpec>(), |path, row, _, _| {
        let key = join(path, &row.key).replace(".N", ".*").replace("profile.*AME.", "");
        if let Some((_, range)) = study_rules::RULES.iter().find(|(known, _)| *known == key) {
            assert_eq!(row.allowed, range.to_string(), "`{key}`");
            documented.insert(key);
        }
    });
    assert_eq!(documented.len(), study_rules::RULES.len(), "each rule of a study has its row");
}

/// Two scenes and two studies; counts are cut, so that scenes assemble quickly.
#[test]
fn every_example_is_accepted_and_assembles() {
    let examples = page::examples();
    assert_eq!(examples.iter().map(|(_, study)| *study).collect::<Vec<_>>(), [false, false, true, true]);
    for (text, is_study) in examples {
        let scenes = if is_study { scenes_of_study(&text) } else { vec![spec::parse(&text).expect(&text)] };
        for mut scene in scenes {
            for body in &mut scene.body {
                if let PlacementSpec::Random(CountSpec { count, .. })
                | PlacementSpec::Jittered(LatticeSpec { count, .. })
                | PlacementSpec::Lattice(LatticeSpec { count, .. }) = &mut body.placement
                {
                    *count = (*count).min(200);
                }
            }
            let made = match scene.dimension {
                2 => assemble::<f64, 2>(&scene, Path::new(".")).expect(&text).made,
                _ => assemble::<f64, 3>(&scene, Path::new(".")).expect(&text).made,
            };
            // The voids of the second 3D body take a fifth of its 200.
            assert!((1..=400).contains(&made.particles), "{} particles", made.particles);
        }
    }
}

/// The scenes of the first block of every arm, in every profile.
fn scenes_of_study(text: &str) -> Vec<SceneSpec> {
    let spec: StudySpec = spec::parse(text).expect(text);
    let profiles = spec.profile.keys().map(|name| Some(name.as_str())).chain([None]);
    let mut scenes = Vec::new();
    for profile in profiles {
        let study = Study::expand(spec.clone(), profile).expect(text);
        assert!(!study.cases.is_empty());
        let first = study.cases.iter().map(|case| case.block).min();
        scenes.extend(study.cases.into_iter().filter(|c| Some(c.block) == first).map(|case| case.scene));
    }
    scenes
}

fn both() -> [(Part, Shape); 2] {
    [(Part::Scene, schema::shape_of::<SceneSpec>()), (Part::Study, schema::shape_of::<StudySpec>())]
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.into() } else { format!("{path}.{key}") }
}

/// Every row of the page, with one kind of its table that has it.
fn for_each_row(part: Part, shape: &Shape, mut visit: impl FnMut(&str, &Row, &str, &Keys)) {
    let tables = schema::tables(shape);
    for (path, rows) in page::tables(part) {
        for row in rows {
            let keys = &tables[&path];
            let kinds =
                if row.kinds.is_empty() { keys.kinds.keys().cloned().collect() } else { row.kinds.clone() };
            kinds.iter().for_each(|kind| visit(&path, &row, kind, keys));
        }
    }
}

/// The least document that has a table of the given kind at `path`, and the steps that lead to the table.
fn document_with(shape: &Shape, path: &str, kind: &str) -> (Value, Vec<String>) {
    let mut document = least(shape, "");
    let mut steps: Vec<String> = Vec::new();
    let mut here = shape.clone();
    for part in path.split('.').filter(|part| !part.is_empty()) {
        let (step, next) = match (&here, part) {
            (Shape::List(entry), "N") => ("0".to_string(), *entry.clone()),
            (Shape::Named(entry), "NAME") => ("any".to_string(), *entry.clone()),
            (Shape::Table(keys) | Shape::OneOf(keys), key) => (key.to_string(), keys[key].clone()),
            (other, key) => panic!("`{key}` of `{path}` in {other:?}"),
        };
        if let Shape::OneOf(_) = here {
            *entry(&mut document, &steps) = Value::Table(Table::new());
        }
        steps.push(step);
        let value = match &next {
            Shape::List(inner) => Value::Array(vec![least(inner, "")]),
            Shape::Named(inner) => Value::Table(Table::from_iter([("any".into(), least(inner, ""))])),
            other => least(other, ""),
        };
        *entry(&mut document, &steps) = value;
        here = next;
    }
    *entry(&mut document, &steps) = least(&here, kind);
    (document, steps)
}

/// The least value of a shape: a table has the keys that the page says are required, which serde then accepts or not.
fn least(shape: &Shape, kind: &str) -> Value {
    match shape {
        Shape::Simple("number") => Value::Float(1.0),
        Shape::Simple("whole number") => Value::Integer(1),
        Shape::Simple("true or false") => Value::Boolean(true),
        Shape::Simple("text") => Value::String("a".into()),
        Shape::Simple("table") => Value::Table(Table::new()),
        // As long as the one list of fixed length: [least, greatest].
        Shape::Simple("list of numbers") => Value::Array(vec![Value::Float(1.0), Value::Float(2.0)]),
        Shape::Simple(_) | Shape::List(_) => Value::Array(Vec::new()),
        Shape::Names(names) => Value::String(names[0].clone()),
        Shape::Table(keys) => required(keys, ""),
        Shape::Kinds(kinds) => {
            let kind = if kind.is_empty() { kinds.keys().next().expect("a kind") } else { kind };
            let mut table = required(&kinds[kind], kind);
            table.as_table_mut().expect("a table").insert("kind".into(), Value::String(kind.into()));
            table
        }
        Shape::OneOf(keys) => {
            let (key, inner) = keys.iter().next().expect("a key");
            Value::Table(Table::from_iter([(key.clone(), least(inner, ""))]))
        }
        Shape::Named(_) => Value::Table(Table::new()),
        Shape::Again => {
            toml::from_str::<Table>("kind = \"ball\"\ncentre = []\nradius = 1.0").expect("a ball").into()
        }
    }
}

/// The keys that the page's table with all of these keys requires, of the given kind where it has kinds.
fn required(keys: &BTreeMap<String, Shape>, kind: &str) -> Value {
    let all = [Part::Scene, Part::Study].map(page::tables);
    let of_kind = |row: &Row| row.kinds.is_empty() || row.kinds.iter().any(|own| own == kind);
    let fits = |row: &&Row| row.default == "required" && of_kind(row) && keys.contains_key(&row.key);
    let tables = all.iter().flat_map(BTreeMap::values);
    let rows = tables.filter(|rows| keys.keys().all(|key| rows.iter().any(|row| row.key == *key)));
    let wanted: BTreeSet<String> =
        rows.flat_map(|rows| rows.iter().filter(fits)).map(|r| r.key.clone()).collect();
    wanted.into_iter().map(|key| (key.clone(), least(&keys[&key], ""))).collect::<Table>().into()
}

fn entry<'a>(document: &'a mut Value, steps: &[String]) -> &'a mut Value {
    steps.iter().fold(document, |value, step| match value {
        Value::Array(items) => &mut items[step.parse::<usize>().expect("a number")],
        Value::Table(table) => table.entry(step.clone()).or_insert(Value::Boolean(false)),
        other => panic!("`{step}` of {other}"),
    })
}

fn remove(document: &mut Value, steps: &[String]) {
    let (last, before) = steps.split_last().expect("a key");
    entry(document, before).as_table_mut().expect("a table").remove(last);
}
