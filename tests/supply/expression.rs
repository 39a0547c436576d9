//! Licence expressions (SPDX 2.3, annex D): AND binds closer than OR, WITH closer than either. A slash is the OR of old manifests.

/// Whether an expression can be satisfied with the licences for which `allows` is true.
///
/// # Errors
/// Text that is no expression, with what is wrong.
pub fn is_satisfied(text: &str, allows: &dyn Fn(&str) -> bool) -> Result<bool, String> {
    let spaced = text.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut rest = words.as_slice();
    let satisfied = any_of(&mut rest, allows)?;
    match rest {
        [] => Ok(satisfied),
        [word, ..] => Err(format!("`{word}` is not expected where it stands")),
    }
}

fn any_of(rest: &mut &[&str], allows: &dyn Fn(&str) -> bool) -> Result<bool, String> {
    let mut satisfied = all_of(rest, allows)?;
    while take(rest, "OR") {
        satisfied |= all_of(rest, allows)?;
    }
    Ok(satisfied)
}

fn all_of(rest: &mut &[&str], allows: &dyn Fn(&str) -> bool) -> Result<bool, String> {
    let mut satisfied = one(rest, allows)?;
    while take(rest, "AND") {
        satisfied &= one(rest, allows)?;
    }
    Ok(satisfied)
}

fn one(rest: &mut &[&str], allows: &dyn Fn(&str) -> bool) -> Result<bool, String> {
    if take(rest, "(") {
        let satisfied = any_of(rest, allows)?;
        return if take(rest, ")") { Ok(satisfied) } else { Err("a parenthesis is left open".into()) };
    }
    let licence = name(rest)?;
    if take(rest, "WITH") {
        return Ok(allows(&format!("{licence} WITH {}", name(rest)?)));
    }
    Ok(allows(licence))
}

fn name<'a>(rest: &mut &[&'a str]) -> Result<&'a str, String> {
    match **rest {
        [word, ref after @ ..] if !["AND", "OR", "WITH", "(", ")"].contains(&word) => {
            *rest = after;
            Ok(word)
        }
        [word, ..] => Err(format!("`{word}` stands where a licence should")),
        [] => Err("it ends where a licence should stand".into()),
    }
}

fn take(rest: &mut &[&str], word: &str) -> bool {
    let found = rest.first() == Some(&word);
    if found {
        *rest = &rest[1..];
    }
    found
}

#[test]
fn expressions_are_satisfied_as_they_are_written() {
    let allows = |licence: &str| ["A", "B", "A WITH X"].contains(&licence);
    for (text, expected) in [
        ("A", true),
        ("C", false),
        ("A OR C", true),
        ("C OR C", false),
        ("A AND B", true),
        ("A AND C", false),
        ("C AND C OR A", true),
        ("A OR C AND C", true),
        ("(A OR C) AND C", false),
        ("C AND (A OR C)", false),
        ("(C OR B) AND A", true),
        ("((A))", true),
        ("A WITH X", true),
        ("B WITH X", false),
        ("B WITH X OR B", true),
        ("C/A", true),
        ("C / D", false),
        ("A+", false),
        ("a", false),
    ] {
        assert_eq!(is_satisfied(text, &allows), Ok(expected), "{text}");
    }
}

#[test]
fn what_is_no_expression_is_refused() {
    for text in ["", "A OR", "AND A", "A B", "(A", "A)", "()", "A WITH", "A WITH OR", "A or B"] {
        assert!(is_satisfied(text, &|_| true).is_err(), "{text}");
    }
}
