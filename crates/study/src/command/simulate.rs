//! One scene: its frames as a film and in the formats of other programs.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

use clap::Args;
use snowlab_solver::{Real, Simulation};
use snowlab_study::export::{Exporter, SERIES, Snapshot, is_frame_name};
use snowlab_study::film::{FILM, FilmWriter};
use snowlab_study::memory;
use snowlab_study::record::{HistoryRow, Outcome, RunRecord};
use snowlab_study::run::{Observer, run_scene};
use snowlab_study::spec::{self, SceneSpec};
use snowlab_study::store::StoreError;
use snowlab_study::table::{Row, Table};
use snowlab_study::tables::energies;

use super::Exit;
use super::export::ExportArguments;
use super::preflight::warn;

/// What to run, and what to write of it.
#[derive(Debug, Args)]
pub struct SimulateArguments {
    /// Scene file
    scene: PathBuf,
    /// Folder for the frames
    #[arg(long)]
    out: PathBuf,
    /// Threads; all cores if not told. Their number shows in no result
    #[arg(long)]
    threads: Option<usize>,
    #[command(flatten)]
    export: ExportArguments,
}

/// Runs the scene; frames, energies and collider forces go to the folder.
pub fn simulate(arguments: &SimulateArguments) -> anyhow::Result<Exit> {
    let SimulateArguments { scene: path, out, threads, export } = arguments;
    let (scene, text) = spec::read::<SceneSpec>(path)?;
    export.check(scene.dimension)?;
    let threads = threads.unwrap_or_else(super::cores);
    let folder = path.parent().unwrap_or(Path::new("."));
    memory::side_by_side(memory::of_simulation(&scene, folder), 1, 1)
        .map_err(|message| anyhow::anyhow!("{}: {message}", path.display()))?;
    warn(&scene, folder).map_err(|error| error.in_text(&text).within(path.display()))?;
    let writer = FrameWriter::new(out, export.exporter(out), export.link, &text);
    let mut observer = Frames { count: 0, background: Background::new(writer) };
    let record = match scene.dimension {
        3 => run_scene::<3>(&scene, folder, threads, &mut observer).map(|run| run.record),
        _ => run_scene::<2>(&scene, folder, threads, &mut observer).map(|run| run.record),
    };
    let record = record.map_err(|error| error.in_text(&text).within(path.display()))?;
    let frames = observer.count;
    observer.background.end()?.exporter.end()?;
    history(&record).write(out)?;
    println!("{}: {} frames, {} steps, {}", out.display(), frames, record.steps, record.outcome.in_words());
    if let Outcome::Stopped { message, .. } = &record.outcome {
        eprintln!("snowlab: the run stopped: {message}");
        return Ok(Exit::CasesFailed);
    }
    Ok(Exit::Done)
}

/// Has each frame written as it comes, while the run goes on.
struct Frames {
    count: usize,
    background: Background<FrameWriter>,
}

impl Observer for Frames {
    fn progress(&mut self, _share: f64, _steps: u64) {}

    fn frame<T: Real, const D: usize>(&mut self, simulation: &Simulation<T, D>) {
        let (state, scene) = (simulation.state().clone(), simulation.scene());
        let (materials, spacing) = (scene.materials.clone(), scene.spacing.as_f64());
        let number = self.count;
        self.count += 1;
        self.background.add(move |writer| {
            let snapshot = Snapshot::of_state(&state, &materials, spacing);
            drop(state);
            writer.write(number, snapshot)
        });
    }
}

/// Writes frames: the film, and what is exported.
struct FrameWriter {
    folder: PathBuf,
    scene: String,
    link: Option<f64>,
    film: Option<FilmWriter>,
    exporter: Exporter,
}

impl FrameWriter {
    fn new(folder: &Path, exporter: Exporter, link: Option<f64>, scene: &str) -> Self {
        FrameWriter { folder: folder.into(), scene: scene.into(), link, film: None, exporter }
    }

    fn write(&mut self, number: usize, mut snapshot: Snapshot) -> anyhow::Result<()> {
        let film = match &mut self.film {
            Some(film) => film,
            None => {
                clear(&self.folder)?;
                self.film.insert(FilmWriter::begin(&self.folder.join(FILM), &snapshot, &self.scene)?)
            }
        };
        film.add(&snapshot)?;
        if self.exporter.tells_fragments() {
            super::export::find_fragments(&mut snapshot, self.link)?;
        }
        Ok(self.exporter.add(number, &snapshot)?)
    }
}

type Job<W> = Box<dyn FnOnce(&mut W) -> anyhow::Result<()> + Send>;

/// A thread with something to write with, which does jobs in the order in which they come.
struct Background<W> {
    jobs: SyncSender<Job<W>>,
    thread: JoinHandle<anyhow::Result<W>>,
}

impl<W: Send + 'static> Background<W> {
    fn new(mut writer: W) -> Self {
        // A job holds a copy of all particles: whoever brings another one waits.
        let (jobs, waiting) = sync_channel::<Job<W>>(0);
        // After an error jobs are taken and left, so that nobody waits.
        let thread = std::thread::spawn(move || {
            let mut result = Ok(());
            for job in waiting {
                if result.is_ok() {
                    result = job(&mut writer);
                }
            }
            result.map(|()| writer)
        });
        Background { jobs, thread }
    }

    fn add(&self, job: impl FnOnce(&mut W) -> anyhow::Result<()> + Send + 'static) {
        self.jobs.send(Box::new(job)).expect("the thread takes jobs until the end");
    }

    /// Waits for all jobs; the first error of any.
    fn end(self) -> anyhow::Result<W> {
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

/// Whether a file's name is one that is written here.
fn is_own(name: &str) -> bool {
    ["history.csv", FILM, SERIES].contains(&name) || is_frame_name(name)
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
