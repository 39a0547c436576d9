//! Who is at work on which input, so that a fault can be repeated and a hang is one.

use std::collections::HashMap;
use std::sync::{LazyLock, Mutex};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

/// An input that takes longer is a hang (chosen: a thousand times what the slowest takes on a busy machine).
const LONGEST: Duration = Duration::from_secs(20);

type AtWork = HashMap<ThreadId, (String, Instant)>;

/// Every input at work; with it begins the thread that looks after them.
static AT_WORK: LazyLock<Mutex<AtWork>> = LazyLock::new(|| {
    thread::spawn(look_after);
    Mutex::default()
});

/// An input at work on this thread, until it is dropped.
pub struct Watch;

impl Watch {
    /// `input` tells which one, and how it is repeated.
    pub fn over(input: String) -> Self {
        with_all(|all| all.insert(thread::current().id(), (input, Instant::now())));
        Watch
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        with_all(|all| all.remove(&thread::current().id()));
    }
}

fn with_all<T>(change: impl FnOnce(&mut AtWork) -> T) -> T {
    change(&mut AT_WORK.lock().expect("nothing panics under the lock"))
}

fn look_after() {
    loop {
        thread::sleep(Duration::from_secs(1));
        let late = |all: &mut AtWork| all.values().find(|(_, begin)| begin.elapsed() > LONGEST).cloned();
        if let Some((input, begin)) = with_all(late) {
            eprintln!("at work for {} s: {input}", begin.elapsed().as_secs());
            std::process::abort();
        }
    }
}
