//! Records under seal, changed and sealed again.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use snowlab_study::record::{Outcome, RunRecord};
use snowlab_study::store::{seal, unseal};

use super::memory::most_held;
use super::{bytes, hand_over};

/// Whose they are.
const CASE: &str = "0123456789abcdef0123";

#[test]
fn records_are_read_or_refused() {
    let valid = seal(CASE, &RunRecord::without_particles(Outcome::failed("panic", "so it is".into())));
    let text = String::from_utf8(valid.clone()).expect("JSON");
    let content =
        text.split_once("\"content\": ").expect("a seal").1.trim_end().trim_end_matches('}').trim_end();
    hand_over("records", 2, |random: &mut ChaCha8Rng| {
        let file = match random.random_range(0..5) {
            0 => valid.clone(),
            1 => bytes::mutated(&valid, &[], random),
            _ => {
                let changed = bytes::mutated(content.as_bytes(), &[], random);
                let hashed = [CASE.as_bytes(), b"\n", &changed].concat();
                let hash = blake3::hash(&hashed).to_hex();
                [format!("{{\"blake3\": \"{hash}\", \"content\": ").as_bytes(), &changed, b"}"].concat()
            }
        };
        let (read, held) = most_held(|| unseal::<RunRecord>(CASE, &file));
        assert!(held < 16384 + 64 * file.len(), "{held} bytes are held for {}", file.len());
        read.map_err(|message| assert!(message.len() < 300, "{message}")).is_ok()
    });
}
