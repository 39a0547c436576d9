//! What the report and the index have in common: the style, the policy, how a template is filled in.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::Value;
use minijinja::syntax::SyntaxConfig;
use sha2::{Digest, Sha256};

const STYLE: &str = include_str!("report.css");

/// What a page may do: show images of one source, and run one script.
pub(super) struct Policy<'a> {
    /// Where images may come from, in the words of the policy.
    pub images: &'a str,
    /// The script.
    pub script: Option<&'a str>,
}

impl Policy<'_> {
    /// The page's content-security policy (W3C, Content Security Policy Level 3): nothing is fetched, framed or sent, and what is inline must have the hash that is
    /// named here.
    fn words(&self) -> String {
        let script = self.script.map_or(String::new(), |script| format!("; script-src {}", source(script)));
        format!(
            "default-src 'none'; img-src {}; style-src {}{script}; base-uri 'none'; form-action 'none'",
            self.images,
            source(STYLE)
        )
    }
}

/// What lets an inline script or style be: `'sha256-…'` of its text between the tags.
fn source(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

/// Fills in a template that has `style`, `script` and `policy` beside the values of `context`. All text is escaped.
pub(super) fn render(
    name: &str,
    template: &str,
    policy: &Policy,
    context: Value,
) -> Result<String, minijinja::Error> {
    let mut environment = minijinja::Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    // The name ends in .html, which turns escaping on.
    debug_assert!(name.ends_with(".html"));
    environment.add_template(name, template)?;
    let plain = |text: &str| Value::from_safe_string(text.to_owned());
    let (style, script) = (plain(STYLE), policy.script.map(plain));
    let policy = plain(&policy.words());
    environment.get_template(name)?.render(minijinja::context! { style, script, policy, ..context })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the standard, 8.3: a script's hash.
    #[test]
    fn hashes_are_those_of_the_standard() {
        let hash = "'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='";
        assert_eq!(source("alert('Hello, world.');"), hash);
    }

    #[test]
    fn styles_and_scripts_cannot_end_their_element() {
        for text in [STYLE, super::super::SCRIPT] {
            assert!(!text.contains("</") && !text.contains("<!--") && !text.contains('\r'));
        }
    }
}
