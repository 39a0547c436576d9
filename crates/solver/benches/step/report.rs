//! The table on the terminal, and the one that is kept.

use std::fmt::Write;

use crate::contest::{Contestant, Outcome, Time};
use crate::machine::Machine;
use crate::rows::{Row, Variant};

const COLUMNS: &str = "case,particles,contestant,threads,instructions,ns_median,ns_least,mps_median,goal_mps,\
    stretch_mps,ratio_to_naive,ratio_to_naive_own_svd,bytes_per_particle,yielding_share,cpu,cores,load,commit,rustc\n";

/// What stands above [`line`]'s columns.
pub fn heading() -> String {
    format!(
        "median ns per particle-step; Mp/s: million particle-steps per second on two threads; ratios: of one thread\n\
         {:<43}{:>7}{:>7}{:>6}{:>7}{:>7}{:>7}{:>7}{:>7}{:>6}{:>9}{:>7}{:>8}{:>6}{:>6}{:>7}",
        "case",
        "naive",
        "own",
        "ref.",
        "fast",
        "least",
        "fast",
        "least",
        "Mp/s",
        "goal",
        "stretch",
        "naive/",
        "own svd/",
        "two/",
        "B per",
        "yield"
    ) + &format!(
        "\n{:<43}{:>7}{:>7}{:>6}{:>7}{:>7}{:>7}{:>7}{:>7}{:>6}{:>9}{:>7}{:>8}{:>6}{:>6}{:>7}",
        "", "", "svd", "", "1 thr.", "", "2 thr.", "", "", "", "", "fast", "fast", "one", "part.", "%"
    )
}

/// A row of the table on the terminal.
pub fn line(row: &Row, outcome: &Outcome) -> String {
    let median = |contestant| outcome.find(contestant).map(|time| time.median);
    let least = |contestant| outcome.find(contestant).map(|time| time.least);
    let (one, two) = (Contestant::Fast(1), Contestant::Fast(2));
    let ratio = |a: Option<f64>, b: Option<f64>| Some(a? / b?);
    let mut line = format!("{:<43}", row.label());
    for (value, width, digits) in [
        (median(Contestant::Naive), 7, 0),
        (median(Contestant::NaiveOwnSvd), 7, 0),
        (median(Contestant::Reference), 6, 0),
        (median(one), 7, 1),
        (least(one), 7, 1),
        (median(two), 7, 1),
        (least(two), 7, 1),
        (median(two).map(million_a_second), 7, 1),
        (row.goal.map(|goal| goal.goal), 6, 0),
        (row.goal.map(|goal| goal.stretch), 9, 0),
        (ratio(median(Contestant::Naive), median(one)), 7, 1),
        (ratio(median(Contestant::NaiveOwnSvd), median(one)), 8, 1),
        (ratio(median(one), median(two)), 6, 2),
        (Some(outcome.bytes_per_particle), 6, 0),
        (Some(outcome.yielding * 100.0), 7, 0),
    ] {
        match value {
            Some(value) => write!(line, "{value:>width$.digits$}"),
            None => write!(line, "{:>width$}", "-"),
        }
        .expect("a String takes all");
    }
    line
}

/// All rows as CSV, a line a contestant; ratios are of medians, above 1 where this contestant is the faster.
pub fn csv(machine: &Machine, results: &[(Row, Outcome)]) -> String {
    let mut csv = COLUMNS.to_owned();
    for (row, outcome) in results {
        for time in &outcome.times {
            csv_line(&mut csv, machine, row, outcome, time).expect("a String takes all");
        }
    }
    csv
}

fn csv_line(
    csv: &mut String,
    machine: &Machine,
    row: &Row,
    outcome: &Outcome,
    time: &Time,
) -> std::fmt::Result {
    let Machine { cpu, cores, load, commit, rustc, .. } = machine;
    let or_empty =
        |value: Option<f64>, digits: usize| value.map_or(String::new(), |value| format!("{value:.digits$}"));
    let ratio = |to| or_empty(outcome.find(to).map(|to| to.median / time.median), 2);
    let instructions = if row.variant == Variant::Avx2 { "avx2" } else { machine.instructions };
    let (name, threads, fast) = match time.contestant {
        Contestant::Naive => ("naive", 1, false),
        Contestant::NaiveOwnSvd => ("naive_own_svd", 1, false),
        Contestant::Reference => ("reference", 1, false),
        Contestant::Fast(threads) => ("fast", threads, true),
    };
    writeln!(
        csv,
        "{},{},{name},{threads},{},{:.2},{:.2},{:.2},{},{},{},{},{},{:.3},{cpu},{cores},{load},{commit},{rustc}",
        row.name(),
        row.particles,
        if fast { instructions } else { "baseline" },
        time.median,
        time.least,
        million_a_second(time.median),
        or_empty(row.goal.map(|goal| goal.goal), 0),
        or_empty(row.goal.map(|goal| goal.stretch), 0),
        ratio(Contestant::Naive),
        ratio(Contestant::NaiveOwnSvd),
        or_empty(fast.then_some(outcome.bytes_per_particle), 0),
        outcome.yielding,
    )
}

fn million_a_second(nanoseconds: f64) -> f64 {
    1e3 / nanoseconds
}

impl Outcome {
    fn find(&self, contestant: Contestant) -> Option<&Time> {
        self.times.iter().find(|time| time.contestant == contestant)
    }

    /// The numbers as text, for another process.
    pub fn to_text(&self) -> String {
        let times = self.times.iter().map(|time| format!("{} {}", time.median, time.least));
        let times: Vec<_> = times.collect();
        format!("{} {} {}", self.bytes_per_particle, self.yielding, times.join(" "))
    }

    /// What [`Outcome::to_text`] wrote of these contestants.
    pub fn from_text(text: &str, contestants: &[Contestant]) -> Option<Self> {
        let numbers: Vec<f64> = text.split_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
        let (head, times) = numbers.split_at_checked(2)?;
        if times.len() != 2 * contestants.len() {
            return None;
        }
        let times = contestants.iter().zip(times.chunks(2));
        let times = times.map(|(&contestant, t)| Time { contestant, median: t[0], least: t[1] });
        Some(Outcome { times: times.collect(), bytes_per_particle: head[0], yielding: head[1] })
    }
}
