//! Dotted paths into a scene, such as `body.0.placement.count`: how arms, sweeps and profiles vary it.

use toml::Value;

/// Parts of a path (chosen: twice what the deepest scene of the studies has; what is set is walked recursively).
const MOST_PARTS: usize = 32;

/// Sets `path` in `table` to `value`; tables on the way are made, arrays are indexed by number.
///
/// # Errors
/// What is in the way, in words.
pub fn set(table: &mut Value, path: &str, value: Value) -> Result<(), String> {
    if path.split('.').count() > MOST_PARTS {
        return Err(format!("the path has more than {MOST_PARTS} parts"));
    }
    let mut place = table;
    let mut walked = String::new();
    for part in path.split('.') {
        if part.is_empty() {
            return Err(format!("the path `{path}` has an empty part"));
        }
        place = match place {
            Value::Table(inner) => inner.entry(part).or_insert_with(|| Value::Table(toml::Table::new())),
            Value::Array(items) => {
                let length = items.len();
                let index: usize = part.parse().map_err(|_| {
                    format!(
                        "`{walked}` is a list; `{part}` must be a number from 0 to {}",
                        length.saturating_sub(1)
                    )
                })?;
                items
                    .get_mut(index)
                    .ok_or_else(|| format!("`{walked}` has {length} entries, so there is no entry {index}"))?
            }
            _ => return Err(format!("`{walked}` is a single value and has no `{part}`")),
        };
        if !walked.is_empty() {
            walked.push('.');
        }
        walked.push_str(part);
    }
    *place = value;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Value {
        toml::from_str::<toml::Table>("a = 1\n[[body]]\n[body.placement]\ncount = 5\n").unwrap().into()
    }

    #[test]
    fn values_are_set_through_tables_and_lists() {
        let mut scene = scene();
        set(&mut scene, "body.0.placement.count", Value::Integer(7)).unwrap();
        set(&mut scene, "numerics.spacing", Value::Float(0.1)).unwrap();
        assert_eq!(scene["body"][0]["placement"]["count"].as_integer(), Some(7));
        assert_eq!(scene["numerics"]["spacing"].as_float(), Some(0.1));
    }

    #[test]
    fn what_is_in_the_way_is_named() {
        let refused = |path| set(&mut scene(), path, Value::Integer(1)).unwrap_err();
        assert!(refused("body.1.placement").contains("1 entries"));
        assert!(refused("body.x").contains("must be a number"));
        assert!(refused("a.b").contains("single value"));
        assert!(refused("body..x").contains("empty part"));
    }
}
