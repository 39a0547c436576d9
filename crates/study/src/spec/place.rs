//! Where in a text a key stands.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::study::StudySpec;

/// The line, counted from 1, of the dotted key that `place` has between its first backticks, such as `body.0.placement`;
/// where the text has not the whole of it, that of the table or list it is missing from. `None` where not even its first
/// part is there.
pub fn line_of_key(text: &str, place: &str) -> Option<usize> {
    let path = place.split('`').nth(1)?;
    find(&DeTable::parse(text).ok()?, path).map(|found| line_at(text, found.start))
}

/// The line, counted from 1, that a refusal of one of a study's scenes is about, whose `place` names an arm and then a key
/// of the scene: where the study under `profile` sets that key last. Without a key that is set anywhere it is the arm's.
pub fn line_in_study(text: &str, spec: &StudySpec, profile: &str, place: &str) -> Option<usize> {
    let mut names = place.strip_prefix("arm `")?.split('`');
    let (name, key) = (names.next()?, names.nth(1).unwrap_or_default());
    let (id, condition) = name.split_once('@').map_or((name, None), |(id, condition)| (id, Some(condition)));
    let condition = condition.and_then(|id| spec.condition.iter().position(|condition| condition.id == id));
    let arm = spec.arm.iter().position(|arm| arm.id == id)?;
    let document = DeTable::parse(text).ok()?;
    let under = condition
        .into_iter()
        .flat_map(|index| [format!("condition.{index}.arm_set.{id}"), format!("condition.{index}.set")]);
    let own = [format!("profile.{profile}.arm_set.{id}"), format!("arm.{arm}.set")];
    let axes = || spec.sweep.iter().enumerate().filter(|(_, axis)| axis.takes(id));
    let swept = axes().filter_map(|(index, axis)| {
        let path = axis.path.as_ref()?;
        let sets =
            key.strip_prefix(path.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        sets.then(|| find(&document, &format!("sweep.{index}.values")))?
    });
    let points = axes()
        .filter(|(_, axis)| axis.path.is_none())
        .flat_map(|(index, axis)| (0..axis.values.len()).map(move |k| format!("sweep.{index}.values.{k}")));
    let set = points
        .chain(under)
        .chain(own)
        .chain([format!("profile.{profile}.set"), "scene".into()])
        // Without any part of the key the table is there, and does not set it.
        .filter_map(|table| {
            find(&document, &format!("{table}.{key}")).filter(|found| found.left < key.len())
        });
    let arm = find(&document, &condition.map_or(format!("arm.{arm}"), |index| format!("condition.{index}")));
    swept.chain(set).next().or(arm).map(|found| line_at(text, found.start))
}

fn line_at(text: &str, start: usize) -> usize {
    text.get(..start).unwrap_or_default().matches('\n').count() + 1
}

/// Where a path leads to.
#[derive(Clone, Copy)]
struct Found {
    /// The byte at which that starts.
    start: usize,
    /// Bytes of the path that lead nowhere.
    left: usize,
}

/// Follows `path` as far as it leads.
fn find(document: &Spanned<DeTable>, path: &str) -> Option<Found> {
    let mut found = None;
    step_into_table(document.get_ref(), path, &mut found);
    found
}

fn step(value: &Spanned<DeValue>, path: &str, found: &mut Option<Found>) {
    match value.get_ref() {
        DeValue::Table(table) => step_into_table(table, path, found),
        DeValue::Array(items) => {
            let (index, rest) = path.split_once('.').unwrap_or((path, ""));
            if let Some(item) = index.parse().ok().and_then(|index: usize| items.get(index)) {
                *found = Some(Found { start: item.span().start, left: rest.len() });
                step(item, rest, found);
            }
        }
        _ => {}
    }
}

/// Keys may have dots themselves: the longest that fits is taken.
fn step_into_table(table: &DeTable, path: &str, found: &mut Option<Found>) {
    let fits = |key: &str| {
        let rest = path.strip_prefix(key)?;
        if rest.is_empty() { Some(rest) } else { rest.strip_prefix('.') }
    };
    let fitting = table.iter().filter_map(|(key, value)| Some((key, value, fits(key.get_ref())?)));
    if let Some((key, value, rest)) = fitting.max_by_key(|(key, ..)| key.get_ref().len()) {
        *found = Some(Found { start: key.span().start, left: rest.len() });
        step(value, rest, found);
    }
}

#[cfg(test)]
mod tests {
    use super::{line_in_study, line_of_key};
    use crate::spec::StudySpec;

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

    /// An axis sets a key for the arms that take it, and for no other.
    #[test]
    fn a_key_of_an_arm_is_where_the_arm_gets_it() {
        let text = r#"
name = "x"
question = "?"
[blocks]
first = 1
count = 1
[measure]
largest_spacing = 0.05
[scene.numerics]
spacing = 0.05
[[scene.body]]
region = { kind = "ball", centre = [0.0, 0.3], radius = 0.25 }
placement = { kind = "random", count = 300 }
[scene.output]
frame_interval = 0.5
end = 1.0
[[arm]]
id = "swept"
[[arm]]
id = "usual"
[[sweep]]
name = "h"
path = "numerics.spacing"
values = [0.05, 0.06]
arms = ["swept"]
"#;
        let study: StudySpec = toml::from_str(text).unwrap();
        let line = |place: &str| line_in_study(text, &study, "", place);
        assert_eq!(line("arm `swept`: `numerics.spacing`"), Some(24));
        assert_eq!(line("arm `usual`: `numerics.spacing`"), Some(10));
    }
}
