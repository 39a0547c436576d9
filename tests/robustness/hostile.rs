//! Hostile input: valid scenes, studies, points, meshes, frames, records and checkpoints, changed at random and on purpose. Every reader takes whatever comes:
//! it accepts it and keeps its promises, or refuses it in words that help; no panic, no hang, no memory for what is not there.
//!
//! Input `k` of a reader is made from the number `k` alone. A fault names reader and number; a watchdog ends the program where
//! one input takes too long. The environment variable `SNOWLAB_HOSTILE_INPUTS` says how many inputs all readers together take
//! (by default a few seconds' worth), or, as `k..m`, which numbers each reader takes:
//!
//! ```text
//! SNOWLAB_HOSTILE_INPUTS=10000000 cargo test --release --locked -p snowlab-study --test robustness hostile -- --nocapture
//! SNOWLAB_HOSTILE_INPUTS=12345..12346 cargo test --release --locked -p snowlab-study --test robustness hostile::studies
//! ```

pub mod bytes;
mod checkpoints;
mod corpus;
mod document;
mod frames;
mod memory;
mod meshes;
mod point_files;
mod points;
mod records;
mod scenes;
mod studies;
mod telling;
pub mod watch;

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::messages::{MOST_SAID, hold_message};
use watch::Watch;

/// Inputs of all readers where the environment does not say (chosen: eight seconds on one core).
const USUAL_INPUTS: u64 = 40_000;
/// A reader with so many faults is tried no more.
const MOST_FAULTS: usize = 10;
/// What says how many.
const VARIABLE: &str = "SNOWLAB_HOSTILE_INPUTS";

/// Hands a reader `percent` of all inputs; `read` makes one, tries it and returns whether it was accepted. Both must happen, or nothing
/// is tested.
fn hand_over(reader: &'static str, percent: u64, read: impl Fn(&mut ChaCha8Rng) -> bool + Sync) {
    let (numbers, whole) = numbers(percent);
    let (inputs, accepted, start) = (numbers.end - numbers.start, AtomicU64::new(0), Instant::now());
    let faults = Mutex::new(Vec::new());
    let done = numbers.into_par_iter().try_for_each(|number| {
        let _watch = Watch::over(format!(
            "input {number} of {reader} ({VARIABLE}={number}..{} repeats it)",
            number + 1
        ));
        let tried = catch_unwind(AssertUnwindSafe(|| read(&mut ChaCha8Rng::seed_from_u64(number))));
        let mut faults = faults.lock().expect("nothing panics under the lock");
        match tried {
            Ok(taken) => drop(accepted.fetch_add(u64::from(taken), Ordering::Relaxed)),
            Err(_) => faults.push(number),
        }
        (faults.len() < MOST_FAULTS).then_some(())
    });
    let (faults, accepted) = (faults.into_inner().expect("no thread is left"), accepted.into_inner());
    assert!(
        faults.is_empty() && done.is_some(),
        "{reader}: faults of inputs {faults:?}; {VARIABLE}=k..m repeats them"
    );
    let refused = inputs - accepted;
    println!("{reader}: {inputs} inputs in {:.1?}, {accepted} accepted, {refused} refused", start.elapsed());
    let both = inputs / 100..=inputs - inputs / 100;
    assert!(!whole || both.contains(&accepted), "{reader}: {accepted} of {inputs} accepted: no test");
}

/// The numbers of a reader's inputs, and whether they are all of a run and not some that were picked.
fn numbers(percent: u64) -> (Range<u64>, bool) {
    let count = |text: &str| text.parse().unwrap_or_else(|_| panic!("{VARIABLE} is {text:?}: no number"));
    match std::env::var(VARIABLE) {
        Err(_) => (0..USUAL_INPUTS * percent / 100, true),
        Ok(text) => match text.split_once("..") {
            Some((first, end)) => (count(first)..count(end), false),
            None => (0..count(&text) * percent / 100, true),
        },
    }
}

/// A refusal is a line of plain words, with nothing that a terminal would obey; what it quotes may be any words.
fn hold_words(message: &str, input: &str) {
    let own: Vec<&str> = message.split(['`', '"']).step_by(2).collect();
    hold_message(&own.join("`"), input, &[]);
    assert!(message.len() <= MOST_SAID, "{message:?} is long");
    assert!(!message.contains(char::is_control), "{message:?} has control characters");
}

/// A refusal of a document names a place in it, too.
pub fn hold_refusal(message: &str, input: &str) {
    hold_words(message, input);
    assert!(message.contains("line ") || message.contains('`'), "{message:?} names no place");
}
