//! A study that a command works on.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use snowlab_study::memory;
use snowlab_study::results::{Archive, CaseResult};
use snowlab_study::store::{Hold, Lock};
use snowlab_study::sweep::Study;

/// Which study, and where its results are.
#[derive(Clone, Debug, Args)]
pub struct StudyArguments {
    /// Study file
    pub file: PathBuf,
    /// A named variation of the study
    #[arg(long)]
    pub profile: Option<String>,
    /// Folder of results
    #[arg(long, default_value = "results")]
    pub out: PathBuf,
}

/// The study and its text.
pub struct Opened {
    /// Under the profile that was asked for.
    pub study: Study,
    /// The file's.
    pub text: String,
}

impl StudyArguments {
    /// Reads the study.
    pub fn open(&self) -> anyhow::Result<Opened> {
        let (study, text) = Study::read(&self.file, self.profile.as_deref())?;
        Ok(Opened { study, text })
    }

    /// The folder that paths in scenes are relative to.
    pub fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new("."))
    }

    /// The study's results.
    pub fn archive<'a>(&'a self, study: &'a Study) -> anyhow::Result<Archive<'a>> {
        Ok(Archive::open(study, &self.out, self.folder())?)
    }

    /// The arguments that name the same study, for a command that is shown or written to a script.
    pub fn words(&self) -> Vec<String> {
        let mut words = vec![self.file.display().to_string()];
        if let Some(profile) = &self.profile {
            words.extend(["--profile".into(), profile.clone()]);
        }
        if self.out != Path::new("results") {
            words.extend(["--out".into(), self.out.display().to_string()]);
        }
        words
    }
}

/// Time that a command waits for `gc` to end, and between two looks (chosen: a minute deletes the files of ten thousand cases from a disk).
const LONGEST_WAIT: Duration = Duration::from_secs(60);
const WAIT: Duration = Duration::from_millis(100);

/// Keeps others from clearing away what is in use; waits for one who is at it.
pub fn use_study(archive: &Archive) -> anyhow::Result<Lock> {
    let (path, began) = (archive.store.lock(), Instant::now());
    loop {
        if let Some(lock) = Lock::take(&path, Hold::Shared)? {
            return Ok(lock);
        }
        anyhow::ensure!(
            began.elapsed() < LONGEST_WAIT,
            "{}: `snowlab gc` is clearing the study; try again when it is done",
            path.display()
        );
        std::thread::sleep(WAIT);
    }
}

/// Bytes of the largest of the cases of the given numbers.
pub fn largest(archive: &Archive, numbers: &[usize]) -> Option<f64> {
    let Archive { study, folder, .. } = archive;
    let h_max = Some(study.measure.largest_spacing);
    let of_case = |&index: &usize| memory::of_case(&study.cases[index].scene, folder, h_max);
    numbers.iter().filter_map(of_case).reduce(f64::max)
}

/// Cases of the given numbers at a time, and threads of each, where `jobs` and `threads` are asked for: no more than there is memory for.
///
/// # Errors
/// Where not even one case fits.
pub fn shares(
    archive: &Archive,
    numbers: &[usize],
    jobs: Option<usize>,
    threads: Option<usize>,
) -> Result<(usize, usize), String> {
    let cores = jobs.unwrap_or_else(super::cores).max(1);
    let side_by_side = memory::side_by_side(largest(archive, numbers), numbers.len(), cores)?;
    // A thread for each of many cases keeps all cores busy; few cases share the cores.
    Ok((side_by_side, threads.unwrap_or(cores / side_by_side).max(1)))
}

/// Why a case stopped, where it has.
pub fn stopped(result: &CaseResult) -> Option<String> {
    match &result.record.outcome {
        snowlab_study::record::Outcome::Stopped { message, .. } => {
            Some(format!("{} block {} stopped: {message}", result.case.arm, result.case.block))
        }
        _ => None,
    }
}

/// `12 s`, `3 min 20 s`, `2 h 5 min`, `3 days 4 h`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    let (minutes, hours, days) = (whole / 60, whole / 3600, whole / 86400);
    match whole {
        0..60 if seconds < 9.95 => format!("{seconds:.1} s"),
        0..60 => format!("{whole} s"),
        60..3600 => format!("{minutes} min {} s", whole % 60),
        3600..86400 => format!("{hours} h {} min", minutes % 60),
        _ => format!("{days} days {} h", hours % 24),
    }
}
