//! Who ran what, where and for how long: kept apart from results, which know no clock.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::attempt::host;
use crate::results::{Archive, CaseResult};
use crate::store::{METRIC_VERSION, SOLVER_VERSION, StoreError, write_whole};

/// Name of the file, in a case's folder and in that of a study's tables.
pub const MANIFEST: &str = "manifest.json";

/// The program and the machine it runs on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// Version of snowlab.
    pub version: String,
    /// BLAKE3 of the program's file, 16 letters: two runs with the same one had the same program.
    pub digest: String,
    /// Git revision of the folder that the study lies in, where there is one. That of the program's sources is not known: its hash tells programs apart.
    #[serde(alias = "revision")]
    pub study_revision: Option<String>,
    /// Compiler.
    pub rustc: String,
    /// What it was compiled for.
    pub target: String,
    /// The vectors that the fast engine takes here: `avx512`, `avx2`, or `none`.
    pub vectors: String,
    /// Version of the solver.
    pub solver_version: u32,
    /// Version of the measurement.
    pub metric_version: u32,
    /// Host.
    pub host: String,
}

/// How a case was run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseManifest {
    /// The program and the machine that ended it.
    pub program: Program,
    /// Seed.
    pub seed: u64,
    /// When the last attempt began, UTC.
    pub began: String,
    /// When it ended, UTC.
    pub ended: String,
    /// Wall time [s] of all attempts, as far as their work was kept.
    pub wall_seconds: f64,
    /// Attempts.
    pub attempts: u32,
    /// Peak memory of the process so far [bytes].
    pub peak_memory: u64,
    /// Cases run side by side.
    pub jobs: usize,
    /// Threads of the case.
    pub threads: usize,
}

/// How a study's tables came to be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyManifest {
    /// Name of the study.
    pub study: String,
    /// Its profile.
    pub profile: String,
    /// BLAKE3 of the study file.
    pub study_digest: String,
    /// The program that wrote the tables.
    pub program: Program,
    /// Cases of the study.
    pub cases: usize,
    /// Cases with a row in the tables.
    pub rows: usize,
    /// When the first of their attempts began and the last ended, UTC.
    pub began: Option<String>,
    /// See `began`.
    pub ended: Option<String>,
    /// Wall time of all cases together [s].
    pub case_seconds: f64,
    /// Digests of the programs that ran them.
    pub programs: BTreeSet<String>,
    /// Git revisions of the study's folder when they ran them.
    #[serde(alias = "revisions")]
    pub study_revisions: BTreeSet<String>,
    /// Hosts that they ran on.
    pub hosts: BTreeSet<String>,
}

impl Program {
    /// This program; `folder` is where the study lies.
    pub fn this(folder: &Path) -> Self {
        static DIGEST: OnceLock<String> = OnceLock::new();
        let digest = || {
            let mut hasher = blake3::Hasher::new();
            let file = std::env::current_exe().and_then(std::fs::File::open);
            let hashed = file.and_then(|file| hasher.update_reader(file).map(|hasher| hasher.finalize()));
            hashed.map_or("unknown".into(), |hash| hash.to_hex()[..16].to_string())
        };
        Program {
            version: env!("CARGO_PKG_VERSION").into(),
            digest: DIGEST.get_or_init(digest).clone(),
            study_revision: revision(folder),
            rustc: env!("SNOWLAB_RUSTC").into(),
            target: env!("SNOWLAB_TARGET").into(),
            vectors: snowlab_solver::Engine::vectors().into(),
            solver_version: SOLVER_VERSION,
            metric_version: METRIC_VERSION,
            host: host(),
        }
    }
}

impl StudyManifest {
    /// Of the tables of `results` that are written now.
    pub fn of(archive: &Archive, study_text: &str, program: Program, results: &[CaseResult]) -> Self {
        let mut manifest = StudyManifest {
            study: archive.study.spec.name.clone(),
            profile: archive.study.profile.clone(),
            study_digest: blake3::hash(study_text.as_bytes()).to_hex()[..32].to_string(),
            program,
            cases: archive.study.cases.len(),
            rows: results.len(),
            began: None,
            ended: None,
            case_seconds: 0.0,
            programs: BTreeSet::new(),
            study_revisions: BTreeSet::new(),
            hosts: BTreeSet::new(),
        };
        for case in results.iter().filter_map(|result| result.manifest.clone()) {
            manifest.case_seconds += case.wall_seconds;
            // Times are written so that those of letters and of time are one order.
            let earlier = manifest.began.take().map_or(case.began.clone(), |began| began.min(case.began));
            let later = manifest.ended.take().map_or(case.ended.clone(), |ended| ended.max(case.ended));
            (manifest.began, manifest.ended) = (Some(earlier), Some(later));
            manifest.hosts.insert(case.program.host);
            manifest.programs.insert(case.program.digest);
            manifest.study_revisions.extend(case.program.study_revision);
        }
        manifest
    }

    /// What a reader of the tables should know: results of several programs.
    pub fn warning(&self) -> Option<String> {
        if self.programs.len() < 2 {
            return None;
        }
        let programs: Vec<&str> = self.programs.iter().map(String::as_str).collect();
        Some(format!(
            "the cases were run by {} programs (BLAKE3 {}); the solver's version is the same, so their numbers should be; \
             `snowlab gc FILE --all --delete` and another run make them of one",
            programs.len(),
            programs.join(", "),
        ))
    }

    /// Writes it beside the tables.
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub fn write(&self, folder: &Path) -> Result<(), StoreError> {
        let mut text = serde_json::to_vec_pretty(self).expect("plain data");
        text.push(b'\n');
        write_whole(&folder.join(MANIFEST), &text)
    }
}

/// Peak memory of this process so far [bytes]; 0 where the system does not tell.
pub fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = kilobytes.and_then(|rest| rest.trim().trim_end_matches(" kB").parse::<u64>().ok());
    kilobytes.unwrap_or(0) * 1024
}

/// Git's revision of `folder`, and whether files differ from it; none outside a checkout.
pub fn revision(folder: &Path) -> Option<String> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(folder).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
    };
    let revision = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changed =
        git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|status| !status.is_empty());
    Some(if changed { format!("{revision}, with uncommitted changes") } else { revision })
}
