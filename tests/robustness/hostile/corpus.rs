//! Valid files to begin with, and what becomes of them.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use toml::Table;

use super::{bytes, document};

/// Valid documents, as text and as values.
pub struct Corpus {
    texts: Vec<String>,
    documents: Vec<Table>,
}

impl Corpus {
    pub fn new<'a>(texts: impl IntoIterator<Item = &'a str>) -> Self {
        let texts: Vec<String> = texts.into_iter().map(String::from).collect();
        let documents = texts.iter().map(|text| toml::from_str(text).expect(text)).collect();
        Corpus { texts, documents }
    }

    /// The text of one of them, changed: its values, often by `own` too, which knows what the document is; or its bytes; or both.
    pub fn mutated(&self, random: &mut ChaCha8Rng, own: fn(&mut Table, &mut ChaCha8Rng)) -> String {
        let which = random.random_range(0..self.texts.len());
        let way = random.random_range(0..8);
        let text = if way < 2 {
            self.texts[which].clone()
        } else {
            let mut document = self.documents[which].clone();
            if way < 5 {
                own(&mut document, random);
            }
            if way > 3 {
                document = document::mutated(&document, &self.documents, random);
            }
            toml::to_string(&document).expect("a document is plain data")
        };
        if (2..7).contains(&way) {
            return text;
        }
        let others: Vec<&[u8]> = self.texts.iter().map(String::as_bytes).collect();
        String::from_utf8_lossy(&bytes::mutated(text.as_bytes(), &others, random)).into_owned()
    }
}

/// The examples of `docs/input.md`: its studies, or its scenes.
pub fn documented(studies: bool) -> impl Iterator<Item = &'static str> {
    let page = include_str!("../../../docs/input.md");
    let blocks = page.split("```toml\n").skip(1).filter_map(|block| block.split("```").next());
    blocks.filter(move |block| block.contains("[[arm]]") == studies)
}

/// The most that a reader may hold of a text [bytes] (chosen: a value of a byte or two is held in a hundred, several times where a mistake
/// is looked for).
pub fn most_for(text: &str) -> usize {
    100_000 + 1000 * text.len()
}
