//! Faults of machine and disk, injected into runs of a small study at random: nothing is lost but the work since the last checkpoint, no wrong file
//! is taken for right, and the final files are those of an undisturbed run, byte for byte.
//!
//! A short campaign is part of the tests. The long one, whose figures stand in docs/reliability.md, writes them to results/reliability:
//!
//! ```text
//! SNOWLAB_FAULTS=1200 cargo test --locked --release -p snowlab-study --test faults -- --nocapture
//! ```

#[path = "../desk/mod.rs"]
mod desk;
mod files;
mod lab;
mod limits;
mod page;
mod runners;

use std::collections::BTreeMap;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use lab::Lab;

/// What goes wrong; `Err` says what was done about it that should not have been.
type Fault = fn(&mut Lab, &mut ChaCha8Rng) -> Result<(), String>;

/// Every kind of fault, its name on the page, and its share of the campaign.
const KINDS: &[(&str, u32, Fault)] = &[
    ("runner killed with SIGKILL", 12, runners::killed),
    ("runner told to stop with SIGTERM", 3, runners::terminated),
    ("runner told to stop with SIGINT", 2, runners::interrupted),
    ("one of two runners on one study killed", 3, runners::one_of_two_killed),
    ("the clock of the day set back or forth by years", 2, runners::with_another_clock),
    ("bit of a result file flipped", 6, files::bit_flipped),
    ("result file cut short", 4, files::cut_short),
    ("checkpoint's bit flipped", 3, files::checkpoint_bit_flipped),
    ("checkpoint cut short", 2, files::checkpoint_cut_short),
    ("file exchanged for that of another case", 2, files::exchanged),
    ("disk full", 4, limits::disk_full),
    ("folder of results read-only", 2, limits::read_only),
    ("address space limited", 3, limits::memory_short),
];

/// Faults of the short campaign (chosen: one of each kind at least, in half a minute).
const SHORT: usize = 48;

#[test]
fn a_study_survives_what_happens_to_machines() {
    let told = std::env::var("SNOWLAB_FAULTS").ok();
    let faults = told.as_deref().map_or(SHORT, |text| text.parse().expect("SNOWLAB_FAULTS is a number"));
    let mut random = ChaCha8Rng::seed_from_u64(faults as u64);
    let mut lab = Lab::open();
    let mut tally: BTreeMap<&str, usize> = BTreeMap::new();
    let mut skipped: BTreeMap<&str, String> = BTreeMap::new();
    for number in 0..faults {
        let (name, _, fault) = if number < KINDS.len() { KINDS[number] } else { drawn(&mut random) };
        match fault(&mut lab, &mut random) {
            Ok(()) => *tally.entry(name).or_default() += 1,
            Err(reason) => match reason.strip_prefix(lab::SKIPPED) {
                Some(reason) => drop(skipped.insert(name, reason.trim().to_string())),
                None => panic!("fault {number} of {faults}, {name}: {reason}"),
            },
        }
    }
    lab.finish().unwrap_or_else(|reason| panic!("after {faults} faults: {reason}"));
    for (name, reason) in &skipped {
        println!("NOT INJECTED: {name}: {reason}");
        assert!(std::env::var_os("SNOWLAB_ALL_FAULTS").is_none(), "{name}: {reason}");
    }
    if told.is_some() {
        page::write(KINDS.iter().map(|(name, ..)| (*name, tally.get(name).copied().unwrap_or(0))));
    }
    println!(
        "{} faults, all survived; the study was run to its end {} times",
        tally.values().sum::<usize>(),
        lab.ends()
    );
}

fn drawn(random: &mut ChaCha8Rng) -> (&'static str, u32, Fault) {
    let total: u32 = KINDS.iter().map(|(_, share, _)| share).sum();
    let mut ticket = random.random_range(0..total);
    for kind in KINDS {
        if ticket < kind.1 {
            return *kind;
        }
        ticket -= kind.1;
    }
    unreachable!("the shares add up")
}
