//! What is wrong with a document that serde refuses, and at which key: serde itself tells the key of a value only
//! outside tables with a `kind`.

use serde::de::DeserializeOwned;
use toml::Value;

/// Documents are tried again with one value left out or put in; in all so many bytes at most are read so (chosen: a
/// second), after which the place found is that of an enclosing table.
const MOST_BYTES_TRIED: usize = 50 << 20;
/// What the parser says of a table with two keys where one of several is meant.
const ONE_OF_SEVERAL: &str = "wanted exactly 1 element, more than 1 element";
/// The key that tells the variants of a table apart.
const KIND: &str = "kind";

/// Turns `document`, of about `bytes` bytes, into `S`.
///
/// # Errors
/// The dotted key of the first value that is refused, empty where it is the document itself, and what is wrong with it.
pub fn parse<S: DeserializeOwned>(document: &Value, bytes: usize) -> Result<S, (String, String)> {
    match document.clone().try_into::<S>() {
        Ok(spec) => Ok(spec),
        Err(error) => {
            let message = error.message().to_string();
            let mut search = Search {
                document: document.clone(),
                tries: MOST_BYTES_TRIED / bytes.max(1),
                message: &message,
            };
            let path = match missing(&message) {
                Some(key) => search.table_without::<S>(key).unwrap_or_default(),
                None => search.culprit::<S>(),
            };
            Err((path.join("."), in_plain_words(&message)))
        }
    }
}

/// The words of a parser's message that only a programmer understands, in those of a user.
pub fn in_plain_words(message: &str) -> String {
    if let Some(key) = missing(message) {
        return format!("the key `{key}` is missing; add it");
    }
    if message == ONE_OF_SEVERAL {
        return "has several keys; give it one".into();
    }
    // Names of types follow.
    let message = ["struct", "internally tagged enum"].iter().fold(message.to_string(), |text, what| {
        match text.split_once(&format!("expected {what}")) {
            Some((before, _)) => format!("{before}expected a table"),
            None => text,
        }
    });
    let words = [
        ("unknown field", "unknown key"),
        ("unknown variant", "unknown name"),
        ("unit variant, expected string only", "no name; expected a name in quotes"),
        ("unit variant", "a name alone"),
        ("invalid type: ", "is "),
        ("invalid value: ", "is "),
        ("invalid length", "has length"),
        ("floating point", "the number"),
        ("expected f64", "expected a number"),
        ("expected u64", "expected a whole number, 0 or greater"),
        ("expected usize", "expected a whole number, 0 or greater"),
        ("expected a sequence", "expected a list in [ ]"),
        ("expected a boolean", "expected true or false"),
        ("is sequence", "is a list"),
        ("is map", "is a table"),
        ("expected a map", "expected a table"),
        ("expected an array of length", "expected a list of length"),
    ];
    words.iter().fold(message, |text, (theirs, ours)| text.replace(theirs, ours))
}

fn missing(message: &str) -> Option<&str> {
    message.strip_prefix("missing field `")?.strip_suffix('`')
}

struct Search<'a> {
    document: Value,
    tries: usize,
    message: &'a str,
}

impl Search<'_> {
    /// `None` once too much has been tried.
    fn spend(&mut self) -> Option<()> {
        self.tries = self.tries.checked_sub(1)?;
        Some(())
    }

    /// The innermost value without which the message is another one.
    fn culprit<S: DeserializeOwned>(&mut self) -> Vec<String> {
        let mut path = Vec::new();
        while let Some(longer) = self.culprit_below::<S>(&path) {
            path = longer;
        }
        if self.message == ONE_OF_SEVERAL {
            path.pop();
        }
        path
    }

    fn culprit_below<S: DeserializeOwned>(&mut self, path: &[String]) -> Option<Vec<String>> {
        let here = at(&self.document, path);
        let mut keys = keys(here);
        if self.message.starts_with("invalid length") {
            // A list of the wrong length changes with each of its values: the list is meant.
            keys.retain(|key| is_container(step(here, key)));
        }
        // Without its kind every table is refused: asked last.
        keys.sort_by_key(|key| key == KIND);
        for key in keys {
            self.spend()?;
            let candidate = [path, &[key]].concat();
            let mut without = self.document.clone();
            remove(&mut without, &candidate);
            if verdict::<S>(without) != self.message {
                return Some(candidate);
            }
        }
        None
    }

    /// The first table that lacks `key` and is not refused for its lack once it has it.
    fn table_without<S: DeserializeOwned>(&mut self, key: &str) -> Option<Vec<String>> {
        let mut waiting = vec![Vec::new()];
        while let Some(path) = waiting.pop() {
            let here = at(&self.document, &path);
            let children = keys(here).into_iter().rev().map(|child| [path.as_slice(), &[child]].concat());
            waiting.extend(children.filter(|child| is_container(at(&self.document, child))));
            if here.as_table().is_none_or(|table| table.contains_key(key)) {
                continue;
            }
            self.spend()?;
            let mut with = self.document.clone();
            if let Value::Table(table) = at_mut(&mut with, &path) {
                table.insert(key.into(), Value::Boolean(false));
            }
            let verdict = verdict::<S>(with);
            let elsewhere = verdict.starts_with("unknown field") || verdict == ONE_OF_SEVERAL;
            if verdict != self.message && !elsewhere {
                return Some(path);
            }
        }
        None
    }
}

/// What serde says of `document`.
fn verdict<S: DeserializeOwned>(document: Value) -> String {
    document.try_into::<S>().err().map_or(String::new(), |error| error.message().to_string())
}

fn is_container(value: &Value) -> bool {
    value.is_table() || value.is_array()
}

fn keys(value: &Value) -> Vec<String> {
    match value {
        Value::Table(table) => table.keys().cloned().collect(),
        Value::Array(items) => (0..items.len()).map(|index| index.to_string()).collect(),
        _ => Vec::new(),
    }
}

fn step<'a>(value: &'a Value, key: &str) -> &'a Value {
    match value {
        Value::Array(items) => &items[key.parse::<usize>().expect("keys of a list are numbers")],
        table => &table[key],
    }
}

fn at<'a>(document: &'a Value, path: &[String]) -> &'a Value {
    path.iter().fold(document, |value, key| step(value, key))
}

fn at_mut<'a>(document: &'a mut Value, path: &[String]) -> &'a mut Value {
    path.iter().fold(document, |value, key| match value {
        Value::Array(items) => &mut items[key.parse::<usize>().expect("keys of a list are numbers")],
        table => &mut table[key.as_str()],
    })
}

fn remove(document: &mut Value, path: &[String]) {
    let Some((last, before)) = path.split_last() else { return };
    match at_mut(document, before) {
        Value::Table(table) => {
            table.remove(last);
        }
        Value::Array(items) => {
            items.remove(last.parse().expect("keys of a list are numbers"));
        }
        _ => {}
    }
}
