//! What is wrong with a document that serde refuses, and at which key: serde itself tells the key of a value only
//! outside tables with a `kind`.

use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::Value;

use super::brief;
use super::range::Shown;

/// Documents are tried again with values left out or one put in; in all so many bytes at most are read so (chosen: a
/// second), after which the place found is that of an enclosing table.
const MOST_BYTES_TRIED: usize = 50 << 20;
/// What the parser says of a table with two keys where one of several is meant.
const ONE_OF_SEVERAL: &str = "wanted exactly 1 element, more than 1 element";
/// The key that tells the variants of a table apart.
const KIND: &str = "kind";

/// Bytes of a value that are shown (chosen: a line).
const MOST_OF_VALUE: usize = 100;
/// What the parser says of tables and lists within one another without end.
const TOO_DEEP: [&str; 2] = ["recursion limit", "cannot recurse further"];

/// Turns `document`, of about so many bytes, into `S`.
///
/// # Errors
/// The dotted key of the first value that is refused, empty where it is the document itself, and what is wrong with it.
pub fn parse<S: Serialize + DeserializeOwned>(
    document: &Value,
    bytes: impl FnOnce() -> usize,
) -> Result<S, (String, String)> {
    match document.clone().try_into::<S>() {
        Ok(spec) => match list_for_table(document, &Value::try_from(&spec).expect("what was TOML is TOML")) {
            Some(path) => Err((path.join("."), "is a list, expected a table".into())),
            None => Ok(spec),
        },
        Err(error) => {
            let message = error.message().to_string();
            let mut search = Search {
                document: document.clone(),
                tries: MOST_BYTES_TRIED / bytes().max(1),
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

/// The first list that was taken for a table with its values in order, which no page tells of.
fn list_for_table(written: &Value, read: &Value) -> Option<Vec<String>> {
    let below = |key: &str, written: &Value, read: &Value| {
        list_for_table(written, read).map(|path| [vec![key.to_string()], path].concat())
    };
    match (written, read) {
        (Value::Array(_), Value::Table(_)) => Some(Vec::new()),
        (Value::Table(written), Value::Table(read)) => {
            written.iter().find_map(|(key, value)| below(key, value, read.get(key)?))
        }
        (Value::Array(written), Value::Array(read)) => written
            .iter()
            .zip(read)
            .enumerate()
            .find_map(|(k, (value, read))| below(&k.to_string(), value, read)),
        _ => None,
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
    if TOO_DEEP.iter().any(|words| message.starts_with(words)) {
        return "tables or lists are nested too deep to be followed; use fewer levels".into();
    }
    if message.contains("value was too large") || message.contains("` as i128") {
        return "the number is too large; whole numbers go up to 9223372036854775807".into();
    }
    let message = &with_short_value(message);
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
        ("floating-point number overflowed", "the number is too large; numbers go up to 1.8e308"),
        ("duplicate key", "duplicate key; remove one of them"),
        ("wanted exactly 1 element, found 0 elements", "is empty; give it a name or one key"),
        ("expected fewer elements in array", "expected a shorter list"),
        ("expected variant identifier", "expected a name in quotes"),
        ("unit variant, expected string only", "no name; expected a name in quotes"),
        ("unit variant", "a name alone"),
        ("invalid type: ", "is "),
        ("invalid value: ", "is "),
        ("invalid length", "has length"),
        ("is integer", "is the whole number"),
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

/// The message with its value, which stands before what is expected, cut to what is read; numbers with few digits.
fn with_short_value(message: &str) -> String {
    let Some((value, expected)) = message.rsplit_once(", expected ") else { return message.into() };
    let number = value.strip_prefix("invalid type: floating point `").and_then(|rest| rest.strip_suffix('`'));
    // chosen: as many digits as a number of f64 needs.
    let long = number.filter(|digits| digits.len() > 24);
    let value = match long.and_then(|digits| digits.parse().ok()) {
        Some(number) => format!("invalid type: floating point `{}`", Shown(number)),
        None => brief(value, MOST_OF_VALUE),
    };
    format!("{value}, expected {expected}")
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

    /// The innermost value that makes the message what it is.
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

    /// Values are taken in the order in which they stand: as long as the culprit is among the first ones that are left, the message stays.
    fn culprit_below<S: DeserializeOwned>(&mut self, path: &[String]) -> Option<Vec<String>> {
        let here = at(&self.document, path);
        let all = keys(here);
        // A list of the wrong length changes with each of its values: the list is meant. Without its kind every table is refused.
        let may_go = |key: &&String| !self.is_of_length() || is_container(step(here, key));
        let others: Vec<String> = all.iter().filter(|key| *key != KIND).filter(may_go).cloned().collect();
        let (mut fewest, mut enough) = (0, others.len());
        while fewest < enough {
            let middle = (fewest + enough) / 2;
            if self.is_said_without::<S>(path, &others[middle..])? {
                enough = middle;
            } else {
                fewest = middle + 1;
            }
        }
        let culprit = match enough.checked_sub(1) {
            Some(last) => others[last].clone(),
            None if all.iter().any(|key| key == KIND) && !self.is_said_without::<S>(path, &all)? => {
                KIND.into()
            }
            None => return None,
        };
        Some([path, &[culprit]].concat())
    }

    fn is_of_length(&self) -> bool {
        self.message.starts_with("invalid length")
    }

    /// Whether the message is the same without some keys below `path`, which stand in their order; `None` once too much has been tried.
    fn is_said_without<S: DeserializeOwned>(&mut self, path: &[String], keys: &[String]) -> Option<bool> {
        self.spend()?;
        let mut without = self.document.clone();
        let here = at_mut(&mut without, path);
        keys.iter().rev().for_each(|key| remove(here, key));
        Some(verdict::<S>(without) == self.message)
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

fn remove(value: &mut Value, key: &str) {
    match value {
        Value::Table(table) => {
            table.remove(key);
        }
        Value::Array(items) => {
            items.remove(key.parse().expect("keys of a list are numbers"));
        }
        _ => {}
    }
}
