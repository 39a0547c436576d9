//! A study as a Slurm job array: chunks of cases that are missing, the script that runs one of them, and the script that collects.
//!
//! Nothing is asked of the scheduler but to start commands: what has been run is told by the files of the cases. An element that is started twice,
//! or dies and is started again, gives the same results.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::results::Archive;
use crate::store::{StoreError, read_whole, write_whole};

/// Name of the folder beside a study's tables.
const FOLDER: &str = "slurm";

/// What the scripts need to know.
#[derive(Clone, Debug)]
pub struct ArrayJob<'a> {
    /// Name of the job.
    pub name: &'a str,
    /// Folder that commands are run in.
    pub directory: &'a Path,
    /// Folder of scripts and logs.
    pub folder: &'a Path,
    /// The program.
    pub program: &'a str,
    /// The arguments that name the study.
    pub study: &'a [String],
    /// Keys of the cases of each element.
    pub elements: &'a [Vec<String>],
    /// Threads of a case.
    pub threads: usize,
    /// Time that the longest element is allowed [s].
    pub seconds: f64,
    /// Memory that an element is allowed [bytes].
    pub memory: f64,
    /// Memory that the job which collects is allowed [bytes].
    pub collect_memory: f64,
}

/// Where a submission's files are.
#[derive(Clone, Debug)]
pub struct Submission {
    folder: PathBuf,
}

/// The jobs of a submission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Submitted {
    /// The array's.
    pub array: String,
    /// That of the job that collects.
    pub collect: String,
    /// When, UTC.
    pub when: String,
    /// Name of the list of its elements.
    #[serde(default)]
    pub list: String,
}

/// A job of a submission that has not ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Queued {
    /// Number, with that of the element.
    pub job: String,
    /// State in Slurm's words.
    pub state: String,
    /// Why it waits.
    pub reason: String,
}

/// Time before the limit at which an element is asked to stop [s] (chosen: a checkpoint takes seconds; Slurm looks every 30 s or so).
const WARNING: u32 = 120;

/// Groups the cases of the given numbers, in their order, into at most `most` elements of about `target` seconds each.
pub fn chunks(
    numbers: &[usize],
    seconds: impl Fn(usize) -> f64,
    target: f64,
    most: usize,
) -> Vec<Vec<usize>> {
    let total: f64 = numbers.iter().map(|&index| seconds(index)).sum();
    // Where even shares would be too many, an element takes as much more: nearly all end beyond their share by less than a case.
    let mut target = target.max(total / most.max(1) as f64);
    loop {
        let chunks = fill(numbers, &seconds, target);
        if chunks.len() <= most.max(1) {
            return chunks;
        }
        target *= 1.1;
    }
}

fn fill(numbers: &[usize], seconds: &impl Fn(usize) -> f64, target: f64) -> Vec<Vec<usize>> {
    let mut chunks: Vec<Vec<usize>> = Vec::new();
    let mut sum = f64::INFINITY;
    for &index in numbers {
        let own = seconds(index);
        match chunks.last_mut() {
            Some(chunk) if sum + own <= target => chunk.push(index),
            _ => {
                chunks.push(vec![index]);
                sum = 0.0;
            }
        }
        sum += own;
    }
    chunks
}

impl ArrayJob<'_> {
    /// Name of the list of elements, by its content: Slurm copies scripts when they are handed in, but elements read the list when they start, and
    /// whatever is submitted meanwhile has another one.
    pub fn list(&self) -> String {
        format!("elements-{}.txt", &blake3::hash(self.element_list().as_bytes()).to_hex()[..12])
    }

    /// The keys, one element a line.
    pub fn element_list(&self) -> String {
        self.elements.iter().map(|keys| keys.join(" ") + "\n").collect()
    }

    /// The script of an element.
    pub fn array_script(&self) -> String {
        let last = self.elements.len().saturating_sub(1);
        let minutes = (self.seconds / 60.0).ceil().max(1.0) as u64;
        let megabytes = megabytes(self.memory);
        format!(
            "#!/bin/bash\n\
             #SBATCH --job-name={name}\n\
             #SBATCH --array=0-{last}\n\
             #SBATCH --cpus-per-task={threads}\n\
             #SBATCH --mem={megabytes}M\n\
             #SBATCH --time={minutes}\n\
             #SBATCH --signal=B:TERM@{WARNING}\n\
             #SBATCH --requeue\n\
             #SBATCH --open-mode=append\n\
             #SBATCH {log}\n\
             #SBATCH {directory}\n\
             # One element: the cases of its line of the list, those that are missing.\n\
             # The program stands in for the shell, so that the signal before the limit reaches it: it puts its case away.\n\
             cases=()\n\
             for key in $(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" {list}); do cases+=(--case \"$key\"); done\n\
             if ((${{#cases[@]}} == 0)); then echo \"element $SLURM_ARRAY_TASK_ID has no cases in\" {list} >&2; exit 2; fi\n\
             exec {program} run {study} --jobs 1 --threads-per-case {threads} \"${{cases[@]}}\"\n",
            name = self.name,
            threads = self.threads,
            log = self.option("--output", &self.folder.join("element-%A-%a.log")),
            directory = self.option("--chdir", self.directory),
            list = quoted(&self.folder.join(self.list()).display().to_string()),
            program = quoted(self.program),
            study = self.study_words(),
        )
    }

    /// The script that writes the tables when all elements have ended, whatever became of them.
    pub fn collect_script(&self) -> String {
        format!(
            "#!/bin/bash\n\
             #SBATCH --job-name={name}-collect\n\
             #SBATCH --cpus-per-task=1\n\
             #SBATCH --mem={megabytes}M\n\
             #SBATCH --time=60\n\
             #SBATCH --open-mode=append\n\
             #SBATCH {log}\n\
             #SBATCH {directory}\n\
             exec {program} collect {study}\n",
            name = self.name,
            megabytes = megabytes(self.collect_memory),
            log = self.option("--output", &self.folder.join("collect.log")),
            directory = self.option("--chdir", self.directory),
            program = quoted(self.program),
            study = self.study_words(),
        )
    }

    fn option(&self, name: &str, path: &Path) -> String {
        quoted(&format!("{name}={}", path.display()))
    }

    fn study_words(&self) -> String {
        self.study.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
    }
}

const ARRAY: &str = "array.sh";
const COLLECT: &str = "collect.sh";
const SUBMITTED: &str = "submitted.json";

impl Submission {
    /// Of a study.
    pub fn of(archive: &Archive) -> Self {
        Submission { folder: archive.store.root().join(FOLDER) }
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes list and scripts.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write(&self, job: &ArrayJob) -> Result<[PathBuf; 3], StoreError> {
        let (list, array, collect) = (job.list(), ARRAY.to_string(), COLLECT.to_string());
        let files =
            [(list, job.element_list()), (array, job.array_script()), (collect, job.collect_script())];
        let paths = files.map(|(name, text)| (self.folder.join(name), text));
        paths.iter().try_for_each(|(path, text)| write_whole(path, text.as_bytes()))?;
        Ok(paths.map(|(path, _)| path))
    }

    /// Hands the scripts to `sbatch`, with `extra` flags, and remembers the jobs beside those that have not ended.
    ///
    /// # Errors
    /// What `sbatch` says.
    pub fn submit(&self, job: &ArrayJob, extra: &[String], when: String) -> Result<Submitted, String> {
        let mut all = self.not_ended();
        let array = sbatch(&[], extra, &self.folder.join(ARRAY))?;
        let after = format!("--dependency=afterany:{array}");
        let collect = sbatch(&[after], extra, &self.folder.join(COLLECT))
            .map_err(|error| format!("the array runs as job {array}, but nothing will collect: {error}"))?;
        let submitted = Submitted { array, collect, when, list: job.list() };
        all.push(submitted.clone());
        let mut text = serde_json::to_vec_pretty(&all).expect("plain data");
        text.push(b'\n');
        write_whole(&self.folder.join(SUBMITTED), &text).map_err(|error| error.to_string())?;
        Ok(submitted)
    }

    /// The jobs of its submissions that have not ended; `None` where there were none or `squeue` is not there.
    pub fn queued(&self) -> Option<Vec<Queued>> {
        let jobs: Vec<String> = self
            .submitted()
            .into_iter()
            .flat_map(|Submitted { array, collect, .. }| [array, collect])
            .collect();
        if jobs.is_empty() {
            return None;
        }
        let output = Command::new("squeue")
            .args(["-h", "-r", "-o", "%i %T %r", "-j", &jobs.join(",")])
            .output()
            .ok()?;
        let line = |line: &str| {
            let mut words = line.splitn(3, ' ').map(str::to_string);
            Some(Queued {
                job: words.next()?,
                state: words.next()?,
                reason: words.next().unwrap_or_default(),
            })
        };
        // Of jobs that it no longer knows it prints an error and nothing else.
        Some(String::from_utf8_lossy(&output.stdout).lines().filter_map(line).collect())
    }

    /// Keys of the cases of elements that wait or run.
    pub fn keys_queued(&self) -> BTreeSet<String> {
        let queued = self.queued().unwrap_or_default();
        let mut keys = BTreeSet::new();
        for Submitted { array, list, .. } in self.submitted() {
            let list = std::fs::read_to_string(self.folder.join(list)).unwrap_or_default();
            let elements: Vec<&str> = list.lines().collect();
            for job in queued.iter().filter(|job| job.state != "COMPLETING") {
                let element =
                    job.job.strip_prefix(&array).and_then(|rest| rest.strip_prefix('_')?.parse().ok());
                let own = element.and_then(|element: usize| elements.get(element));
                keys.extend(own.into_iter().flat_map(|line| line.split_whitespace()).map(String::from));
            }
        }
        keys
    }

    fn not_ended(&self) -> Vec<Submitted> {
        let queued = self.queued().unwrap_or_default();
        let is_of = |job: &Queued, number: &str| job.job.split('_').next() == Some(number);
        let mut all = self.submitted();
        all.retain(|s| queued.iter().any(|job| is_of(job, &s.array) || is_of(job, &s.collect)));
        all
    }

    fn submitted(&self) -> Vec<Submitted> {
        let read = || serde_json::from_slice(&read_whole(&self.folder.join(SUBMITTED)).ok()??).ok();
        read().unwrap_or_default()
    }
}

/// Runs `sbatch`; the job's number.
fn sbatch(own: &[String], extra: &[String], script: &Path) -> Result<String, String> {
    let output = Command::new("sbatch").arg("--parsable").args(own).args(extra).arg(script).output();
    let output = output.map_err(|error| {
        format!("`sbatch` cannot be started ({error}); submit on a machine of the cluster, or use `--dry-run` and take the scripts there")
    })?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_string();
    if !output.status.success() {
        return Err(format!("`sbatch {}` failed: {}", script.display(), text(&output.stderr)));
    }
    // `--parsable` prints the number, and the cluster's name after a semicolon where there are several.
    let id = text(&output.stdout).split(';').next().unwrap_or_default().to_string();
    if id.is_empty() { Err("`sbatch` printed no job number".into()) } else { Ok(id) }
}

/// The most elements of an array that the cluster takes, where it tells.
pub fn most_elements() -> Option<usize> {
    let output = Command::new("scontrol").args(["show", "config"]).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let line = text.lines().find(|line| line.starts_with("MaxArraySize"))?;
    line.split('=').nth(1)?.trim().parse().ok()
}

fn megabytes(bytes: f64) -> u64 {
    (bytes / 1e6).ceil() as u64
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_string();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_the_shell() {
        for word in ["plain/path.toml", "with space", "it's", "$(rm x)", "", "a\"b\\c", "new\nline"] {
            let output = Command::new("sh").args(["-c", &format!("printf %s {}", quoted(word))]).output();
            assert_eq!(String::from_utf8_lossy(&output.expect("a shell").stdout), word);
        }
    }

    #[test]
    fn elements_are_filled_and_never_too_many() {
        let numbers: Vec<usize> = (0..1000).collect();
        let each = |index: usize| 1.0 + (index % 7) as f64;
        for (target, most) in [(60.0, 1000), (1.0, 1000), (1.0, 10), (1e9, 5), (0.0, 1)] {
            let chunks = chunks(&numbers, each, target, most);
            assert!(chunks.len() <= most, "{} elements", chunks.len());
            assert_eq!(chunks.concat(), numbers);
            let longest = chunks.iter().map(|c| c.iter().map(|&i| each(i)).sum::<f64>()).fold(0.0, f64::max);
            assert!(longest <= target.max(1.25 * 4000.0 / most as f64 + 7.0), "{longest} s of {target} s");
        }
        assert!(super::chunks(&[], each, 60.0, 10).is_empty());
    }
}
