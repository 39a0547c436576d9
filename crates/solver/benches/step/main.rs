//! Time of a step, in nanoseconds per particle, beside the goals: the fast engine on one and two threads, the reference engine, and a step as
//! people write it first (`naive.rs`), with nalgebra's singular value decomposition and with the solver's own. All take their bursts in turn, in one
//! process, so that a shared machine's drift meets all alike; compare ratios rather than times.
//!
//! ```text
//! cargo bench -p snowlab-solver --bench step                    all cases, 100 thousand particles in 3D; kept in results/bench/steps.csv
//! cargo bench -p snowlab-solver --bench step -- --full          a million in 3D; steps_full.csv
//! cargo bench -p snowlab-solver --bench step -- sweep           the first case, from 10 thousand to 4 million; steps_sweep.csv
//! cargo bench -p snowlab-solver --bench step -- scaling         4 to 64 threads, by a model of blocks of measured cost; printed
//! cargo bench -p snowlab-solver --bench step -- operator        an application of the implicit operator beside an explicit step; printed
//! cargo bench -p snowlab-solver --bench step -- 2D FLIP         the cases with all these words, nothing kept
//! cargo test --release -p snowlab-solver --bench step           no times: the naive step against the reference engine
//! ```

mod agreement;
mod ball;
mod contest;
mod decomposition;
mod machine;
mod naive;
mod operator;
mod report;
mod rows;
mod scaling;

use std::path::Path;
use std::process::{Command, Stdio};

use contest::Outcome;
use machine::Machine;
use rows::{Precision, Row, Size, Variant};
use snowlab_solver::KernelKind;

/// What `cargo bench` says to a benchmark; `cargo test --benches` does not.
const TIMED: &str = "--bench";
const FULL: &str = "--full";
const SWEEP: &str = "sweep";
const SCALING: &str = "scaling";
const OPERATOR: &str = "operator";
/// Said to the process that measures a row with other instructions: print the outcome alone.
const ALONE: &str = "--alone";

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    let words: Vec<String> =
        arguments.iter().filter(|word| !word.starts_with("--") && *word != SWEEP).cloned().collect();
    let size = match (has(TIMED), has(FULL), has(SWEEP)) {
        (false, _, _) => Size::Tried,
        (true, true, false) => Size::Full,
        (true, _, true) => Size::Sweep,
        (true, false, false) => Size::Quick,
    };
    if size != Size::Tried && has(SCALING) {
        scaling::run();
        return;
    }
    if size != Size::Tried && has(OPERATOR) {
        operator::run();
        return;
    }
    if size == Size::Tried && !has(ALONE) {
        agreement::check();
    }
    let rows: Vec<Row> = size.rows().into_iter().filter(|row| row.has(&words)).collect();
    if has(ALONE) {
        rows.iter().for_each(|row| println!("{}", measure(row, size).to_text()));
        return;
    }
    let machine = Machine::here();
    println!("{machine:?}\n{}", report::heading());
    let mut results = Vec::new();
    for row in rows {
        let outcome =
            if row.variant == Variant::Avx2 { measure_narrowed(&row, size) } else { measure(&row, size) };
        println!("{}", report::line(&row, &outcome));
        results.push((row, outcome));
    }
    // A selection is looked at, not kept.
    if words.is_empty() && size != Size::Tried {
        keep(size, &report::csv(&machine, &results));
    }
}

fn measure(row: &Row, size: Size) -> Outcome {
    match (row.dimension, row.precision, row.kernel) {
        (2, Precision::F32, KernelKind::Cubic) => contest::run::<f32, 2, 4>(row, size),
        (2, Precision::F64, KernelKind::Cubic) => contest::run::<f64, 2, 4>(row, size),
        (3, Precision::F32, KernelKind::Cubic) => contest::run::<f32, 3, 4>(row, size),
        (3, Precision::F64, KernelKind::Cubic) => contest::run::<f64, 3, 4>(row, size),
        (3, Precision::F32, KernelKind::Quadratic) => contest::run::<f32, 3, 3>(row, size),
        _ => unreachable!("no such row"),
    }
}

/// In a process of its own, for the instructions are chosen once in a process.
fn measure_narrowed(row: &Row, size: Size) -> Outcome {
    let this = std::env::current_exe().expect("a running program");
    let mut arguments: Vec<String> = std::env::args().skip(1).filter(|word| word.starts_with("--")).collect();
    arguments.push(ALONE.into());
    arguments.extend(row.label().split(' ').map(String::from));
    let output = Command::new(this)
        .args(arguments)
        .env("SNOWLAB_INSTRUCTIONS", "avx2")
        .stderr(Stdio::inherit())
        .output()
        .expect("this program can be started");
    assert!(output.status.success(), "{}: {}", row.label(), output.status);
    let text = String::from_utf8(output.stdout).expect("numbers");
    Outcome::from_text(text.lines().last().unwrap_or_default(), size.contestants()).expect("an outcome")
}

fn keep(size: Size, csv: &str) {
    let name = match size {
        Size::Full => "steps_full.csv",
        Size::Sweep => "steps_sweep.csv",
        Size::Quick | Size::Tried => "steps.csv",
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/bench");
    std::fs::create_dir_all(&folder).expect("a folder for the results");
    std::fs::write(folder.join(name), csv).expect("room for the results");
    println!("kept in results/bench/{name}");
}
