//! The results of a study: every case with what it left on disk.

use std::path::Path;

use crate::measure::{Metrics, measure};
use crate::record::RunRecord;
use crate::run::{Observer, run_scene};
use crate::spec::scene::PlacementSpec;
use crate::spec::study::MeasureSpec;
use crate::spec::{SceneSpec, SpecError};
use crate::store::{CaseFolder, Store, StoreError, case_key, metric_key};
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
}

/// A case that could not be run or stored.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The scene cannot be built.
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
        let store = Store::new(out, &study.spec.name);
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

    /// Runs case number `index` and stores what it gives: frames first, the record last.
    ///
    /// # Errors
    /// [`CaseError`].
    pub fn run(&self, index: usize, observer: &mut impl Observer) -> Result<(), CaseError> {
        let scene = &self.study.cases[index].scene;
        match scene.dimension {
            3 => self.run_in::<3>(index, observer),
            _ => self.run_in::<2>(index, observer),
        }
    }

    fn run_in<const D: usize>(&self, index: usize, observer: &mut impl Observer) -> Result<(), CaseError> {
        let scene = &self.study.cases[index].scene;
        let folder = self.case_folder(index);
        let run = run_scene::<D>(scene, self.folder, observer)?;
        folder.write_json("case.json", scene)?;
        folder.write_frames(&run.frames)?;
        let metrics = measure(&self.study.measure, scene, &run.frames, &run.record).ok();
        if let Some(metrics) = metrics {
            folder.write_json(&metrics_file(&self.study.measure), &metrics)?;
        }
        folder.write_json("run.json", &run.record)?;
        Ok(())
    }

    /// The results of case number `index`; frames are measured anew where the measurement has changed.
    ///
    /// # Errors
    /// [`CaseError`].
    pub fn result(&self, index: usize) -> Result<CaseResult, CaseError> {
        let case = self.study.cases[index].clone();
        let key = self.keys[index].clone();
        let folder = self.case_folder(index);
        let Some(record) = folder.read_json::<RunRecord>("run.json")? else {
            return Err(CaseError::Missing { key, arm: case.arm, block: case.block });
        };
        let stopped = matches!(record.outcome, crate::record::Outcome::Stopped { .. });
        let metrics = if stopped { None } else { self.metrics(&folder, &case.scene, &record)? };
        Ok(CaseResult { case, key, record, metrics })
    }

    fn metrics(
        &self,
        folder: &CaseFolder,
        scene: &SceneSpec,
        record: &RunRecord,
    ) -> Result<Option<Metrics>, StoreError> {
        let name = metrics_file(&self.study.measure);
        if let Some(metrics) = folder.read_json(&name)? {
            return Ok(Some(metrics));
        }
        let spec = &self.study.measure;
        let metrics = match scene.dimension {
            3 => measure(spec, scene, &folder.read_frames::<3>()?, record).ok(),
            _ => measure(spec, scene, &folder.read_frames::<2>()?, record).ok(),
        };
        if let Some(metrics) = &metrics {
            folder.write_json(&name, metrics)?;
        }
        Ok(metrics)
    }
}

fn metrics_file(measure: &MeasureSpec) -> String {
    format!("metrics-{}.json", metric_key(measure))
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
    Ok(case_key(scene, &inputs))
}
