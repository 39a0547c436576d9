//! Progress on the terminal: a bar, or a line now and then where there is no terminal. Standard output stays clean.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use snowlab_study::case_run::CaseEnd;
use snowlab_study::record::in_full;
use snowlab_study::results::Archive;
use snowlab_study::schedule::Progress;
use snowlab_study::store::StoreError;

/// Time between plain lines.
const LINE_INTERVAL: Duration = Duration::from_secs(10);
/// Resolution of the bar.
const TICKS: u64 = 10_000;

/// A bar on a terminal, plain lines elsewhere. The time left is weighted by particle-steps.
pub struct Bar<'a> {
    archive: &'a Archive<'a>,
    bar: Option<ProgressBar>,
    total: usize,
    plain: Mutex<Plain>,
    /// Whether it was told that a case could not be put away.
    warned: AtomicBool,
}

struct Plain {
    started: Instant,
    latest: Instant,
    share: f64,
}

impl<'a> Bar<'a> {
    /// For so many cases of a study.
    pub fn new(archive: &'a Archive<'a>, total: usize) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style =
                ProgressStyle::with_template("{wide_bar} {percent} % {msg}, {elapsed} gone, {eta} to go");
            ProgressBar::new(TICKS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        let now = Instant::now();
        let plain = Mutex::new(Plain { started: now, latest: now, share: 0.0 });
        Bar { archive, bar, total, plain, warned: AtomicBool::new(false) }
    }

    fn tell(&self, index: usize, what: &str) {
        let line = format!("{}: {what}", self.archive.describe(index));
        match &self.bar {
            Some(bar) => bar.suspend(|| eprintln!("{line}")),
            None => eprintln!("{line}"),
        }
    }

    fn line(&self, share: f64, cases: usize) {
        let Ok(mut plain) = self.plain.lock() else { return };
        plain.share = plain.share.max(share);
        if plain.latest.elapsed() < LINE_INTERVAL && cases < self.total {
            return;
        }
        plain.latest = Instant::now();
        let gone = plain.started.elapsed().as_secs_f64();
        let left = gone * (1.0 - plain.share).max(0.0) / plain.share.max(1e-9);
        eprintln!(
            "{:5.1} %, {cases} of {} cases, {gone:.0} s gone, about {left:.0} s to go",
            100.0 * plain.share,
            self.total
        );
    }
}

impl Progress for Bar<'_> {
    fn advanced(&self, share: f64, cases: usize) {
        match &self.bar {
            Some(bar) => {
                bar.set_position(bar.position().max((share * TICKS as f64) as u64));
                bar.set_message(format!("{cases} of {} cases", self.total));
            }
            None => self.line(share, cases),
        }
    }

    fn not_put_away(&self, index: usize, error: &StoreError) {
        // Once: it may be so at every checkpoint of every case.
        if !self.warned.swap(true, Ordering::Relaxed) {
            self.tell(index, &format!("cannot be put away, goes on: {}", in_full(error)));
        }
    }

    fn ended(&self, index: usize, result: Result<&CaseEnd, &StoreError>) {
        let what = match result {
            Ok(CaseEnd::Finished) => return,
            Ok(end) => end.in_words(),
            Err(error) => format!("failed: {}", in_full(error)),
        };
        self.tell(index, &what);
    }
}
