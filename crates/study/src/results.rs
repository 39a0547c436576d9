//! The results of a study: every case with what it left on disk.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::assemble::engine;
use crate::measure::{Metrics, measure};
use crate::metrics::MetricError;
use crate::record::{Outcome, RunRecord};
use crate::run::{Observer, run_scene};
use crate::spec::scene::{EngineName, PlacementSpec};
use crate::spec::study::MeasureSpec;
use crate::spec::{SceneSpec, SpecError};
use crate::store::{CaseFolder, PANIC, Store, StoreError, case_key, metric_key};
use crate::sweep::{Case, Study};

/// A case with its results.
#[derive(Clone, Debug)]
pub struct CaseResult {
    /// What was asked.
    pub case: Case,
    /// Its key.
    pub key: String,
    /// How it went.
    pub record: RunRecord,
    /// Its fragments; `None` where the run stopped or could not be measured.
    pub metrics: Option<Metrics>,
    /// Why it could not be measured.
    pub unmeasured: Option<MetricError>,
}

impl CaseResult {
    /// Why the case cannot be used: the run stopped, could not be measured, or failed the gate.
    pub fn failure(&self) -> Option<String> {
        match (&self.record.outcome, &self.unmeasured, &self.metrics) {
            (Outcome::Stopped { message, .. }, _, _) => Some(message.clone()),
            (_, Some(error), _) => Some(error.to_string()),
            (_, _, Some(metrics)) if !metrics.gate_valid => Some(metrics.gate.clone()),
            _ => None,
        }
    }
}

/// A result that cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// A file of particles that a scene names cannot be read.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// Results cannot be written or read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The case has not been run.
    #[error("case {key} ({arm}, block {block}) has not been run; run the study first")]
    Missing {
        /// Its key.
        key: String,
        /// Its arm.
        arm: String,
        /// Its block.
        block: u64,
    },
}

/// A study and what it has on disk: the keys and folders of its cases.
#[derive(Clone, Debug)]
pub struct Archive<'a> {
    /// The study.
    pub study: &'a Study,
    /// Where its results are.
    pub store: Store,
    /// The folder that paths in scenes are relative to.
    pub folder: &'a Path,
    keys: Vec<String>,
}

impl<'a> Archive<'a> {
    /// Looks up the keys of all cases.
    ///
    /// # Errors
    /// A particle file that cannot be read.
    pub fn open(study: &'a Study, out: &Path, folder: &'a Path) -> Result<Self, CaseError> {
        let store = Store::new(out, &study.spec.name, &study.profile);
        let keys = study
            .cases
            .iter()
            .map(|case| key_of(&case.scene, folder))
            .collect::<Result<Vec<_>, SpecError>>()?;
        Ok(Archive { study, store, folder, keys })
    }

    /// The key of case number `index`.
    pub fn key(&self, index: usize) -> &str {
        &self.keys[index]
    }

    /// The folder of case number `index`.
    pub fn case_folder(&self, index: usize) -> CaseFolder {
        self.store.case(&self.keys[index])
    }

    /// Numbers of the cases that have not been run.
    pub fn missing(&self) -> Vec<usize> {
        (0..self.keys.len()).filter(|&index| !self.case_folder(index).is_finished()).collect()
    }

    /// Runs case number `index` on so many threads and stores what it gives: frames first, the record last. A case that cannot be built, or
    /// in which the program panics, leaves a record that says so; after a panic the case still counts as missing.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn run(&self, index: usize, threads: usize, observer: &mut impl Observer) -> Result<(), StoreError> {
        let scene = &self.study.cases[index].scene;
        let folder = self.case_folder(index);
        // What a panic leaves half done is the observer's count of steps and files that no record vouches for.
        let ended = catch_unwind(AssertUnwindSafe(|| match scene.dimension {
            3 => self.run_in::<3>(scene, &folder, threads, observer),
            _ => self.run_in::<2>(scene, &folder, threads, observer),
        }));
        match ended {
            Ok(ended) => ended.and_then(|()| folder.forget_panic()),
            Err(panic) => {
                let record = RunRecord::without_particles(Outcome::panicked(words_of(panic.as_ref())));
                folder.write_json("case.json", scene)?;
                folder.write_json(PANIC, &record)
            }
        }
    }

    fn run_in<const D: usize>(
        &self,
        scene: &SceneSpec,
        folder: &CaseFolder,
        threads: usize,
        observer: &mut impl Observer,
    ) -> Result<(), StoreError> {
        folder.write_json("case.json", scene)?;
        let run = match run_scene::<D>(scene, self.folder, threads, observer) {
            Ok(run) => run,
            Err(error) => {
                let record = RunRecord::without_particles(Outcome::not_built(error.to_string()));
                return folder.write_json("run.json", &record);
            }
        };
        folder.write_frames(&run.frames)?;
        if let Ok(metrics) = measure(&self.study.measure, scene, &run.frames, &run.record) {
            folder.write_json(&metrics_file(&self.study.measure), &metrics)?;
        }
        folder.write_json("run.json", &run.record)
    }

    /// The results of case number `index`; frames are measured anew where the measurement has changed.
    ///
    /// # Errors
    /// [`CaseError`].
    pub fn result(&self, index: usize) -> Result<CaseResult, CaseError> {
        let case = self.study.cases[index].clone();
        let key = self.keys[index].clone();
        let folder = self.case_folder(index);
        let Some(record) = folder.read_record()? else {
            return Err(CaseError::Missing { key, arm: case.arm, block: case.block });
        };
        let (metrics, unmeasured) = match record.outcome {
            Outcome::Stopped { .. } => (None, None),
            _ => match self.metrics(&folder, &case.scene, &record)? {
                Ok(metrics) => (Some(metrics), None),
                Err(error) => (None, Some(error)),
            },
        };
        Ok(CaseResult { case, key, record, metrics, unmeasured })
    }

    /// The results of all cases that have left a record, a panic's among them.
    ///
    /// # Errors
    /// [`CaseError`].
    pub fn results(&self) -> Result<Vec<CaseResult>, CaseError> {
        let recorded = (0..self.keys.len()).filter(|&index| self.case_folder(index).has_record());
        recorded.map(|index| self.result(index)).collect()
    }

    fn metrics(
        &self,
        folder: &CaseFolder,
        scene: &SceneSpec,
        record: &RunRecord,
    ) -> Result<Result<Metrics, MetricError>, StoreError> {
        let name = metrics_file(&self.study.measure);
        if let Some(metrics) = folder.read_json(&name)? {
            return Ok(Ok(metrics));
        }
        let spec = &self.study.measure;
        let metrics = match scene.dimension {
            3 => measure(spec, scene, &folder.read_frames::<3>()?, record),
            _ => measure(spec, scene, &folder.read_frames::<2>()?, record),
        };
        if let Ok(metrics) = &metrics {
            folder.write_json(&name, metrics)?;
        }
        Ok(metrics)
    }
}

fn metrics_file(measure: &MeasureSpec) -> String {
    format!("metrics-{}.json", metric_key(measure))
}

/// What a panic said.
fn words_of(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
    format!("the program failed: {}; please report it", text.unwrap_or("without a word"))
}

/// The key of a scene, with the contents of its particle files.
fn key_of(scene: &SceneSpec, folder: &Path) -> Result<String, SpecError> {
    let mut inputs = Vec::new();
    for body in &scene.body {
        if let PlacementSpec::File { path, .. } = &body.placement {
            let path = folder.join(path);
            inputs.push(std::fs::read(&path).map_err(|source| SpecError::Read { path, source })?);
        }
    }
    // The engine that will run is the one that counts: a CPU may not have what the fast one takes.
    let mut scene = scene.clone();
    if !engine(scene.numerics.engine).is_available() {
        scene.numerics.engine = EngineName::Reference;
    }
    Ok(case_key(&scene, &inputs))
}
