//! One scene, its frames as CSV in full precision.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

use snowlab_solver::{Real, Simulation};
use snowlab_study::frame_csv::frame_csv;
use snowlab_study::memory;
use snowlab_study::record::{HistoryRow, Outcome, RunRecord};
use snowlab_study::run::{Observer, run_scene};
use snowlab_study::spec::{self, SceneSpec};
use snowlab_study::store::{StoreError, write_whole};
use snowlab_study::table::{Row, Table};
use snowlab_study::tables::energies;

use super::Exit;
use super::preflight::warn;

/// Runs the scene on so many threads, all cores if not told; frames, energies and collider forces go to `out`.
pub fn simulate(path: &Path, out: &Path, threads: Option<usize>) -> anyhow::Result<Exit> {
    let (scene, text) = spec::read::<SceneSpec>(path)?;
    let threads = threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let folder = path.parent().unwrap_or(Path::new("."));
    memory::side_by_side(memory::of_simulation(&scene, folder), 1, 1)
        .map_err(|message| anyhow::anyhow!("{}: {message}", path.display()))?;
    warn(&scene, folder).map_err(|error| error.in_text(&text).within(path.display()))?;
    let mut writer = FrameWriter { out: out.into(), frames: 0, background: Background::new() };
    let record = match scene.dimension {
        3 => run_scene::<3>(&scene, folder, threads, &mut writer).map(|run| run.record),
        _ => run_scene::<2>(&scene, folder, threads, &mut writer).map(|run| run.record),
    };
    let record = record.map_err(|error| error.in_text(&text).within(path.display()))?;
    let frames = writer.frames;
    writer.background.end()?;
    history(&record).write(out)?;
    println!("{}: {} frames, {} steps, {}", out.display(), frames, record.steps, record.outcome.in_words());
    if let Outcome::Stopped { message, .. } = &record.outcome {
        eprintln!("snowlab: the run stopped: {message}");
        return Ok(Exit::CasesFailed);
    }
    Ok(Exit::Done)
}

/// Has each frame written as it comes, while the run goes on.
struct FrameWriter {
    out: PathBuf,
    frames: usize,
    background: Background,
}

impl Observer for FrameWriter {
    fn progress(&mut self, _share: f64, _steps: u64) {}

    fn frame<T: Real, const D: usize>(&mut self, simulation: &Simulation<T, D>) {
        let (out, number, state) = (self.out.clone(), self.frames, simulation.state().clone());
        self.frames += 1;
        self.background.add(move || {
            if number == 0 {
                clear(&out)?;
            }
            write_whole(&out.join(format!("frame-{number:05}.csv")), frame_csv(&state).as_bytes())
        });
    }
}

type Job = Box<dyn FnOnce() -> Result<(), StoreError> + Send>;

/// A thread that does jobs in the order in which they come.
struct Background {
    jobs: SyncSender<Job>,
    thread: JoinHandle<Result<(), StoreError>>,
}

impl Background {
    fn new() -> Self {
        // A job holds a copy of all particles: whoever brings another one waits.
        let (jobs, waiting) = sync_channel::<Job>(0);
        // After an error jobs are taken and left, so that nobody waits.
        let thread = std::thread::spawn(move || {
            let mut result = Ok(());
            for job in waiting {
                if result.is_ok() {
                    result = job();
                }
            }
            result
        });
        Background { jobs, thread }
    }

    fn add(&self, job: impl FnOnce() -> Result<(), StoreError> + Send + 'static) {
        self.jobs.send(Box::new(job)).expect("the thread takes jobs until the end");
    }

    /// Waits for all jobs; the first error of any.
    fn end(self) -> Result<(), StoreError> {
        drop(self.jobs);
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// Deletes what an earlier run left in the folder, and nothing else: a shorter run must not end in its frames.
fn clear(out: &Path) -> Result<(), StoreError> {
    let delete = || -> std::io::Result<()> {
        if !out.is_dir() {
            return Ok(());
        }
        for entry in std::fs::read_dir(out)? {
            let entry = entry?;
            if entry.file_name().to_str().is_some_and(is_own) {
                std::fs::remove_file(entry.path())?;
            }
        }
        Ok(())
    };
    delete().map_err(|source| StoreError::Io { path: out.into(), source })
}

/// Whether a file's name is one that is written here: `history.csv`, or `frame-`, five digits or more, `.csv`.
fn is_own(name: &str) -> bool {
    let number = name.strip_prefix("frame-").and_then(|rest| rest.strip_suffix(".csv"));
    name == "history.csv" || number.is_some_and(|n| n.len() >= 5 && n.bytes().all(|b| b.is_ascii_digit()))
}

/// `history`: energies, losses, and impulse and mean force on each obstacle, one row a frame.
fn history(record: &RunRecord) -> Table {
    let rows =
        record.history.iter().enumerate().map(|(index, now)| {
            let before = index.checked_sub(1).map(|i| &record.history[i]);
            let mut row = Row::default();
            row.count("frame", "number of the frame", index as u64)
                .number("time", "s", "time", now.time)
                .count("steps", "steps taken", now.steps);
            energies(&mut row, now);
            row.number("collider_work", "J/m or J", "work of obstacles so far", now.collider_work);
            for collider in 0..now.impulses.len() {
                forces(&mut row, collider, now, before);
            }
            row
        });
    Table { name: "history", rows: rows.collect() }
}

fn forces(row: &mut Row, collider: usize, now: &HistoryRow, before: Option<&HistoryRow>) {
    for (axis, impulse) in ["x", "y", "z"].iter().zip(&now.impulses[collider]) {
        let k = ["x", "y", "z"].iter().position(|a| a == axis).unwrap_or(0);
        let force = before.map_or(0.0, |b| (impulse - b.impulses[collider][k]) / (now.time - b.time));
        row.number(&format!("impulse_{collider}_{axis}"), "N s", "impulse on the obstacle so far", *impulse)
            .number(
                &format!("force_{collider}_{axis}"),
                "N",
                "mean force on it since the frame before",
                force,
            );
    }
}
