//! The keys, types and defaults that the code accepts, asked of serde itself: what it says of a key it does not know, of
//! a table without its kind, of a value of the wrong type.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use toml::{Table, Value};

/// A key that no table has.
const STRANGER: &str = "zzz";

/// What a place in a document accepts.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// One of the page's words for single values and lists of them.
    Simple(&'static str),
    /// One of a closed set of names.
    Names(Vec<String>),
    /// A table of these keys.
    Table(BTreeMap<String, Shape>),
    /// A table with a key `kind`, and other keys for each kind.
    Kinds(BTreeMap<String, BTreeMap<String, Shape>>),
    /// A table with one of these keys.
    OneOf(BTreeMap<String, Shape>),
    /// A list.
    List(Box<Shape>),
    /// A table of any names.
    Named(Box<Shape>),
    /// A table or list like one it stands in.
    Again,
}

/// A place: the keys and indices that lead to it; `*` stands for the first entry of a list, `+` for an entry of a table
/// of names.
type Place = Vec<String>;

/// The shape of a whole document of type `S`.
pub fn shape_of<S: DeserializeOwned>() -> Shape {
    shape_at::<S>(&Vec::new(), &BTreeMap::new(), &mut Vec::new())
}

/// What serde says of a document that has `value` at `place` and nothing else, but for the kinds on the way.
fn verdict<S: DeserializeOwned>(place: &Place, kinds: &BTreeMap<Place, String>, value: Value) -> String {
    let mut document = value;
    for depth in (0..place.len()).rev() {
        document = match place[depth].as_str() {
            "*" => Value::Array(vec![document]),
            key => Value::Table(Table::from_iter([(key.to_string(), document)])),
        };
        if let (Some(kind), Value::Table(table)) = (kinds.get(&place[..depth]), &mut document) {
            table.insert("kind".into(), Value::String(kind.clone()));
        }
    }
    document.try_into::<S>().err().map_or(String::new(), |error| error.message().to_string())
}

fn shape_at<S: DeserializeOwned>(
    place: &Place,
    kinds: &BTreeMap<Place, String>,
    above: &mut Vec<Vec<String>>,
) -> Shape {
    let stranger = || Value::Table(Table::from_iter([(STRANGER.to_string(), Value::Integer(1))]));
    let said = verdict::<S>(place, kinds, stranger());
    let join = |key: &str| [place.as_slice(), &[key.to_string()]].concat();
    if said.starts_with(&format!("unknown field `{STRANGER}`")) {
        let mut keys = BTreeMap::new();
        for key in quoted(&said) {
            keys.insert(key.clone(), shape_at::<S>(&join(&key), kinds, above));
        }
        return Shape::Table(keys);
    }
    if said == "missing field `kind`" {
        return kinds_at::<S>(place, kinds, above);
    }
    if said.starts_with(&format!("unknown variant `{STRANGER}`")) {
        let variants = quoted(&said);
        // A name is a text; one of several tables is none.
        let text = verdict::<S>(place, kinds, Value::String(STRANGER.into()));
        if text.starts_with("unknown variant") && verdict_of_variant::<S>(place, kinds, &variants[0]) {
            return Shape::Names(variants);
        }
        let tables = variants.iter().map(|key| (key.clone(), shape_at::<S>(&join(key), kinds, above)));
        return Shape::OneOf(tables.collect());
    }
    for (expected, word) in [
        ("expected f64", "number"),
        ("expected u32", "whole number"),
        ("expected u64", "whole number"),
        ("expected usize", "whole number"),
        ("expected a boolean", "true or false"),
        ("expected a string", "text"),
    ] {
        if said.starts_with("invalid type: map") && said.ends_with(expected) {
            return Shape::Simple(word);
        }
    }
    if said.contains("expected a sequence") || said.contains("expected an array of length") {
        return list_at::<S>(place, kinds, above);
    }
    // A table of any names: in it, another one.
    let inner = verdict::<S>(&join("+"), kinds, stranger());
    if inner.starts_with("unknown field") || inner.starts_with("invalid type: map") {
        return Shape::Named(Box::new(shape_at::<S>(&join("+"), kinds, above)));
    }
    Shape::Simple("table")
}

/// Whether a name alone is accepted where a table with one of several keys might be meant.
fn verdict_of_variant<S: DeserializeOwned>(
    place: &Place,
    kinds: &BTreeMap<Place, String>,
    name: &str,
) -> bool {
    let said = verdict::<S>(place, kinds, Value::String(name.into()));
    !said.contains("expected struct variant") && !said.contains("invalid type")
}

fn kinds_at<S: DeserializeOwned>(
    place: &Place,
    kinds: &BTreeMap<Place, String>,
    above: &mut Vec<Vec<String>>,
) -> Shape {
    let unknown = Value::Table(Table::from_iter([("kind".to_string(), Value::String(STRANGER.into()))]));
    let names = quoted(&verdict::<S>(place, kinds, unknown));
    if above.contains(&names) {
        return Shape::Again;
    }
    above.push(names.clone());
    let mut shapes = BTreeMap::new();
    for kind in names {
        let mut kinds = kinds.clone();
        kinds.insert(place.clone(), kind.clone());
        let place_of_stranger = [place.as_slice(), &[STRANGER.to_string()]].concat();
        let said = verdict::<S>(&place_of_stranger, &kinds, Value::Integer(1));
        let mut keys = BTreeMap::new();
        for key in quoted(&said) {
            let inner = [place.as_slice(), std::slice::from_ref(&key)].concat();
            keys.insert(key, shape_at::<S>(&inner, &kinds, above));
        }
        shapes.insert(kind, keys);
    }
    above.pop();
    Shape::Kinds(shapes)
}

fn list_at<S: DeserializeOwned>(
    place: &Place,
    kinds: &BTreeMap<Place, String>,
    above: &mut Vec<Vec<String>>,
) -> Shape {
    let entry = [place.as_slice(), &["*".to_string()]].concat();
    match shape_at::<S>(&entry, kinds, above) {
        Shape::Simple("number") => Shape::Simple("list of numbers"),
        Shape::Simple("text") => Shape::Simple("list of texts"),
        Shape::Simple("table") => Shape::Simple("list of values"),
        other => Shape::List(Box::new(other)),
    }
}

/// The names in backticks but for the stranger.
fn quoted(message: &str) -> Vec<String> {
    message.split('`').skip(1).step_by(2).filter(|name| *name != STRANGER).map(String::from).collect()
}

/// A table at one path, with the keys of each of its kinds; tables without kinds have the one kind "".
#[derive(Clone, Debug, PartialEq)]
pub struct Keys {
    /// Keys by kind.
    pub kinds: BTreeMap<String, BTreeMap<String, Shape>>,
    /// Whether a document has one of the keys, rather than any.
    pub one_of: bool,
}

/// All tables of a shape by their path as the page writes it: `N` in lists, `NAME` in tables of names, "" for the document.
pub fn tables(shape: &Shape) -> BTreeMap<String, Keys> {
    let mut found = BTreeMap::new();
    collect(shape, String::new(), &mut found);
    found
}

fn collect(shape: &Shape, path: String, found: &mut BTreeMap<String, Keys>) {
    let join = |key: &str| if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
    let (kinds, one_of) = match shape {
        Shape::Table(keys) => (BTreeMap::from([(String::new(), keys.clone())]), false),
        Shape::OneOf(keys) => (BTreeMap::from([(String::new(), keys.clone())]), true),
        Shape::Kinds(kinds) => (kinds.clone(), false),
        Shape::List(entry) => return collect(entry, join("N"), found),
        Shape::Named(entry) => return collect(entry, join("NAME"), found),
        Shape::Simple(_) | Shape::Names(_) | Shape::Again => return,
    };
    for keys in kinds.values() {
        keys.iter().for_each(|(key, inner)| collect(inner, join(key), found));
    }
    found.insert(path, Keys { kinds, one_of });
}

/// The page's word for the type of a shape.
pub fn word(shape: &Shape) -> &'static str {
    match shape {
        Shape::Simple(word) => word,
        Shape::Names(_) => "name",
        Shape::List(_) => "list of tables",
        Shape::Table(_) | Shape::Kinds(_) | Shape::OneOf(_) | Shape::Named(_) | Shape::Again => "table",
    }
}
