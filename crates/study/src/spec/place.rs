//! Where in a text a key stands.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The line, counted from 1, of the dotted key that `place` has between its first backticks, such as `body.0.placement`;
/// where the text has not the whole of it, that of the table or list it is missing from. `None` where not even its first
/// part is there.
pub fn line_of_key(text: &str, place: &str) -> Option<usize> {
    let path = place.split('`').nth(1)?;
    let document = DeTable::parse(text).ok()?;
    let mut found = None;
    step_into_table(document.get_ref(), path, &mut found);
    found.map(|start| text.get(..start).unwrap_or_default().matches('\n').count() + 1)
}

/// Follows `path`; `found` becomes the start of what it leads to, as far as it leads.
fn step(value: &Spanned<DeValue>, path: &str, found: &mut Option<usize>) {
    match value.get_ref() {
        DeValue::Table(table) => step_into_table(table, path, found),
        DeValue::Array(items) => {
            let (index, rest) = path.split_once('.').unwrap_or((path, ""));
            if let Some(item) = index.parse().ok().and_then(|index: usize| items.get(index)) {
                *found = Some(item.span().start);
                step(item, rest, found);
            }
        }
        _ => {}
    }
}

/// Keys may have dots themselves: the longest that fits is taken.
fn step_into_table(table: &DeTable, path: &str, found: &mut Option<usize>) {
    let fits = |key: &str| {
        let rest = path.strip_prefix(key)?;
        if rest.is_empty() { Some(rest) } else { rest.strip_prefix('.') }
    };
    let fitting = table.iter().filter_map(|(key, value)| Some((key, value, fits(key.get_ref())?)));
    if let Some((key, value, rest)) = fitting.max_by_key(|(key, ..)| key.get_ref().len()) {
        *found = Some(key.span().start);
        step(value, rest, found);
    }
}

#[cfg(test)]
mod tests {
    use super::line_of_key;

    const TEXT: &str = r#"
name = "x"
[numerics]
spacing = 1
[[body]]
region = { kind = "ball", radius = 1.0 }
[[body]]
placement = {
    count = 5,
}
[profile."a.b"]
blocks = 3
"#;

    #[test]
    fn keys_are_found_in_tables_and_lists() {
        let line = |place: &str| line_of_key(TEXT, place);
        assert_eq!(line("`numerics.spacing`"), Some(4));
        assert_eq!(line("arm `numerics.spacing`: and `name`"), Some(4), "the first is meant");
        assert_eq!(line("`body.0.region.radius`"), Some(6));
        assert_eq!(line("`body.1.placement.count`"), Some(9));
        assert_eq!(line("`profile.a.b.blocks`"), Some(12));
    }

    #[test]
    fn what_is_missing_is_missing_from_a_place() {
        let line = |place: &str| line_of_key(TEXT, place);
        assert_eq!(line("`numerics.kernel`"), Some(3));
        assert_eq!(line("`body.1.region.radius`"), Some(7));
        assert_eq!(line("`output.end`"), None);
        assert_eq!(line("scene"), None);
    }
}
