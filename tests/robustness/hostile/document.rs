//! Changes of a TOML document that leave it one: its values, keys and tables.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use toml::value::Datetime;
use toml::{Table, Value};

use super::telling::{NAMES, NUMBERS, WHOLE_NUMBERS, one_of};

/// One step from a table or list to a value in it.
type Path = Vec<String>;

/// `valid` with one to three changes, some of which bring in a value of one of `others`.
pub fn mutated(valid: &Table, others: &[Table], random: &mut ChaCha8Rng) -> Table {
    let mut document = Value::Table(valid.clone());
    for _ in 0..random.random_range(1..=3) {
        change(&mut document, others, random);
    }
    match document {
        Value::Table(table) => table,
        _ => unreachable!("only values below the document are replaced"),
    }
}

fn change(document: &mut Value, others: &[Table], random: &mut ChaCha8Rng) {
    let paths = paths(document);
    if paths.is_empty() {
        return;
    }
    let path = &paths[random.random_range(0..paths.len())];
    let (last, above) = path.split_last().expect("no path is empty");
    match random.random_range(0..16) {
        0..=5 => alter(at(document, path), random),
        6 => *at(document, path) = any_value(random),
        7 => *at(document, path) = value_of(others, random),
        8 => {
            let source = at(document, &paths[random.random_range(0..paths.len())]).clone();
            // A value within itself, again and again, would grow beyond all bounds.
            if paths.len() < 1000 {
                *at(document, path) = source;
            }
        }
        9 => nest(at(document, path), random),
        10 => lengthen(at(document, path), random),
        11 => add(at(document, above), value_of(others, random), random),
        12..=13 => drop(remove(at(document, above), last)),
        _ => rename(at(document, above), last, random),
    }
}

/// Paths of all values.
fn paths(document: &Value) -> Vec<Path> {
    let mut found: Vec<Path> = Vec::new();
    let mut waiting = vec![(Path::new(), document)];
    while let Some((path, value)) = waiting.pop() {
        let below: Vec<(String, &Value)> = match value {
            Value::Table(table) => table.iter().map(|(key, value)| (key.clone(), value)).collect(),
            Value::Array(items) => {
                items.iter().enumerate().map(|(k, value)| (k.to_string(), value)).collect()
            }
            _ => Vec::new(),
        };
        for (key, value) in below {
            let path = [path.as_slice(), &[key]].concat();
            found.push(path.clone());
            waiting.push((path, value));
        }
    }
    found
}

fn at<'a>(document: &'a mut Value, path: &[String]) -> &'a mut Value {
    path.iter().fold(document, |value, key| match value {
        Value::Array(items) => &mut items[key.parse::<usize>().expect("keys of a list are numbers")],
        table => &mut table[key.as_str()],
    })
}

/// Another value of the same kind.
fn alter(value: &mut Value, random: &mut ChaCha8Rng) {
    match value {
        Value::Integer(number) => *number = whole_number(random),
        Value::Float(number) => *number = NUMBERS[random.random_range(0..NUMBERS.len())],
        Value::String(text) => *text = name(random),
        Value::Boolean(flag) => *flag = !*flag,
        Value::Array(items) if !items.is_empty() => {
            let (first, second) = (random.random_range(0..items.len()), random.random_range(0..items.len()));
            items.swap(first, second);
        }
        other => *other = any_value(random),
    }
}

/// A value of any kind.
fn any_value(random: &mut ChaCha8Rng) -> Value {
    match random.random_range(0..12) {
        0..=1 => Value::Integer(whole_number(random)),
        2..=4 => Value::Float(NUMBERS[random.random_range(0..NUMBERS.len())]),
        5..=6 => Value::String(name(random)),
        7 => Value::Boolean(random.random()),
        8 => Value::Datetime("1979-05-27T07:32:00Z".parse::<Datetime>().expect("a date")),
        9 => Value::Array((0..random.random_range(0..4)).map(|_| any_value(random)).collect()),
        10 => Value::Array(Vec::new()),
        _ => {
            Value::Table((0..random.random_range(0..4)).map(|_| (name(random), any_value(random))).collect())
        }
    }
}

fn whole_number(random: &mut ChaCha8Rng) -> i64 {
    WHOLE_NUMBERS[random.random_range(0..WHOLE_NUMBERS.len())]
}

/// A name that leads elsewhere; now and then one without end.
pub fn name(random: &mut ChaCha8Rng) -> String {
    match random.random_range(0..20) {
        0 => "a".repeat(random.random_range(60..5000)),
        1 => vec!["a"; random.random_range(30..500)].join("."),
        _ => one_of(&NAMES, random).to_string(),
    }
}

/// Some value of some other document, with the key it has there.
fn value_of(others: &[Table], random: &mut ChaCha8Rng) -> Value {
    let mut other = Value::Table(others[random.random_range(0..others.len())].clone());
    let paths = paths(&other);
    let path = &paths[random.random_range(0..paths.len())];
    at(&mut other, path).clone()
}

/// Puts a value into tables or lists, up to more than any reader follows.
fn nest(value: &mut Value, random: &mut ChaCha8Rng) {
    let deepest = if random.random_range(0..8) == 0 { 100 } else { 4 };
    for _ in 0..random.random_range(1..=deepest) {
        let inner = std::mem::replace(value, Value::Boolean(false));
        *value = match random.random_range(0..3) {
            0 => Value::Array(vec![inner]),
            1 => Value::Table(Table::from_iter([("solid".to_string(), inner)])),
            _ => Value::Table(Table::from_iter([
                ("kind".to_string(), Value::String("union".into())),
                ("parts".to_string(), Value::Array(vec![inner])),
            ])),
        };
    }
}

/// Repeats the entries of a list, or makes one.
fn lengthen(value: &mut Value, random: &mut ChaCha8Rng) {
    let times = random.random_range(2..6);
    let items = match &*value {
        Value::Array(items) => (0..times).flat_map(|_| items.clone()).take(200).collect(),
        single => vec![single.clone(); times],
    };
    *value = Value::Array(items);
}

fn add(value: &mut Value, new: Value, random: &mut ChaCha8Rng) {
    match value {
        Value::Table(table) => drop(table.insert(name(random), new)),
        Value::Array(items) => items.insert(random.random_range(0..=items.len()), new),
        _ => unreachable!("what has values below is a table or a list"),
    }
}

fn remove(value: &mut Value, key: &str) -> Option<Value> {
    match value {
        Value::Table(table) => table.remove(key),
        Value::Array(items) => Some(items.remove(key.parse().expect("keys of a list are numbers"))),
        _ => None,
    }
}

/// A key mistyped, or another one; an entry of a list goes elsewhere.
fn rename(value: &mut Value, key: &str, random: &mut ChaCha8Rng) {
    let Some(inner) = remove(value, key) else { return };
    match value {
        Value::Table(table) => {
            let keys: Vec<String> = table.keys().cloned().collect();
            let other = match random.random_range(0..3) {
                0 => key.chars().skip(1).collect(),
                1 if !keys.is_empty() => keys[random.random_range(0..keys.len())].clone(),
                _ => name(random),
            };
            table.insert(other, inner);
        }
        other => add(other, inner, random),
    }
}
