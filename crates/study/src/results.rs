//! The results of a study: every case with what it left on disk.

use std::path::Path;

use rayon::prelude::*;

use crate::assemble::engine;
use crate::manifest::{CaseManifest, MANIFEST};
use crate::measure::{Metrics, measure};
use crate::metrics::MetricError;
use crate::record::{Outcome, RunRecord, in_full};
use crate::spec::scene::{EngineName, PlacementSpec, RegionSpec};
use crate::spec::study::MeasureSpec;
use crate::spec::{SceneSpec, SpecError};
use crate::store::{
    Asked, CASE, CaseFolder, SOLVER_VERSION, Store, StoreError, case_key, metric_key, scene_key,
};
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
    /// Who ran it and for how long; `None` where that is not there or cannot be read.
    pub manifest: Option<CaseManifest>,
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
    /// A file that a scene names and that cannot be read.
    pub fn open(study: &'a Study, out: &Path, folder: &'a Path) -> Result<Self, CaseError> {
        let store = Store::new(out, &study.spec.name, &study.profile);
        let mut inputs = Inputs::default();
        let keys = study
            .cases
            .iter()
            .map(|case| Ok(key_of(&case.scene, inputs.of(&case.scene, folder)?)))
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

    /// Numbers of the cases without a sound record of a finished run.
    pub fn missing(&self) -> Vec<usize> {
        (0..self.keys.len()).filter(|&index| !self.is_done(index)).collect()
    }

    /// Whether case number `index` has a sound record of a finished run.
    pub fn is_done(&self, index: usize) -> bool {
        let folder = self.case_folder(index);
        folder.is_finished() && matches!(folder.read_run(), Ok(Some(_)))
    }

    /// Whether the record of case number `index` says that it stopped.
    pub fn stopped(&self, index: usize) -> bool {
        let record = self.case_folder(index).read_record();
        matches!(record, Ok(Some(RunRecord { outcome: Outcome::Stopped { .. }, .. })))
    }

    /// What the scene of case number `index` is called whatever the solver's version.
    ///
    /// # Errors
    /// A file that a scene names and that cannot be read.
    pub fn scene_key(&self, index: usize) -> Result<String, SpecError> {
        let scene = &self.study.cases[index].scene;
        Ok(scene_key(scene, Inputs::default().of(scene, self.folder)?))
    }

    /// Why case number `index` is not now what its key names: a file that its scene names has changed since the keys were looked up, or cannot be
    /// read.
    pub(crate) fn changed_input(&self, index: usize) -> Option<String> {
        let scene = &self.study.cases[index].scene;
        input_files(scene).next()?;
        match Inputs::default().of(scene, self.folder) {
            Ok(inputs) if key_of(scene, inputs) == self.keys[index] => None,
            Ok(_) => Some(
                "a file that its scene names was changed after the study was opened; run it again".into(),
            ),
            Err(error) => Some(in_full(&error)),
        }
    }

    /// Arm, point of the sweep and block of case number `index`.
    pub fn describe(&self, index: usize) -> String {
        let case = &self.study.cases[index];
        let point: Vec<String> = case.point().map(|(name, value)| format!(" {name} = {value}")).collect();
        format!("{}{} block {}", case.arm, point.concat(), case.block)
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
        let manifest = folder.read_json(MANIFEST).ok().flatten();
        Ok(CaseResult { case, key, record, metrics, unmeasured, manifest })
    }

    /// The results of all cases that have left a record, that of a failure among them.
    ///
    /// # Errors
    /// [`CaseError`].
    pub fn results(&self) -> Result<Vec<CaseResult>, CaseError> {
        let one = |index| match self.result(index) {
            Err(CaseError::Missing { .. }) => None,
            result => Some(result),
        };
        (0..self.keys.len()).into_par_iter().filter_map(one).collect()
    }

    /// Whether the metrics of case number `index` are what was written, or not there.
    ///
    /// # Errors
    /// [`StoreError`], in which way they are not.
    pub fn check_metrics(&self, index: usize) -> Result<(), StoreError> {
        self.case_folder(index).read_json::<Metrics>(&metrics_file(&self.study.measure)).map(|_| ())
    }

    /// What was asked of case number `index`, as it stands in its folder.
    pub(crate) fn asked(&self, index: usize) -> Asked {
        let scene = self.study.cases[index].scene.clone();
        let scene_key = self.scene_key(index).unwrap_or_default();
        Asked { solver_version: SOLVER_VERSION, scene_key, scene }
    }

    /// Makes anew what follows from the scene of finished case number `index`, where it is damaged; a damaged manifest goes, for nothing else knows who
    /// ran the case. False where frames or metrics are: they take another run. (Metrics of frames and record as they are read would do for tables, but
    /// JSON is read to an ulp, and files are made anew to the byte.)
    ///
    /// # Errors
    /// [`StoreError::Io`].
    pub(crate) fn mend(&self, index: usize, record: &RunRecord) -> Result<bool, StoreError> {
        let folder = self.case_folder(index);
        if record.was_built()
            && (is_damaged(folder.check_frames())? || is_damaged(self.check_metrics(index))?)
        {
            return Ok(false);
        }
        if is_damaged(folder.read_json::<Asked>(CASE))? {
            folder.write_json(CASE, &self.asked(index))?;
        }
        if is_damaged(folder.read_json::<CaseManifest>(MANIFEST))? {
            folder.remove(MANIFEST)?;
        }
        Ok(true)
    }

    fn metrics(
        &self,
        folder: &CaseFolder,
        scene: &SceneSpec,
        record: &RunRecord,
    ) -> Result<Result<Metrics, MetricError>, StoreError> {
        let name = metrics_file(&self.study.measure);
        // Metrics follow from frames: damaged ones are measured again.
        if let Ok(Some(metrics)) = folder.read_json(&name) {
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

fn is_damaged<V>(read: Result<V, StoreError>) -> Result<bool, StoreError> {
    match read {
        Ok(_) => Ok(false),
        Err(StoreError::Damaged { .. }) => Ok(true),
        Err(error) => Err(error),
    }
}

/// Name of the file of metrics by `measure`.
pub(crate) fn metrics_file(measure: &MeasureSpec) -> String {
    format!("metrics-{}.json", metric_key(measure))
}

/// The contents of the files of the scene that was asked for last: most cases of a study have those of the one before.
#[derive(Default)]
struct Inputs {
    paths: Vec<String>,
    contents: Vec<Vec<u8>>,
}

impl Inputs {
    fn of(&mut self, scene: &SceneSpec, folder: &Path) -> Result<&[Vec<u8>], SpecError> {
        if !input_files(scene).eq(&self.paths) {
            let read = |path: &str| {
                let path = folder.join(path);
                std::fs::read(&path).map_err(|source| SpecError::Read { path, source })
            };
            self.contents = input_files(scene).map(read).collect::<Result<_, _>>()?;
            self.paths = input_files(scene).map(String::from).collect();
        }
        Ok(&self.contents)
    }
}

/// The files of particles and the meshes that a scene names, in its order.
fn input_files(scene: &SceneSpec) -> impl Iterator<Item = &str> {
    scene.body.iter().flat_map(|body| {
        let particles = match &body.placement {
            PlacementSpec::File { path, .. } => Some(path.as_str()),
            _ => None,
        };
        let meshes = body.region.iter().flat_map(RegionSpec::meshes).map(|mesh| mesh.path.as_str());
        particles.into_iter().chain(meshes)
    })
}

/// The key of a scene, with the contents of the files that it names.
fn key_of(scene: &SceneSpec, inputs: &[Vec<u8>]) -> String {
    // The engine that will run is the one that counts: a CPU may not have what the fast one takes.
    let mut scene = scene.clone();
    if !engine(scene.numerics.engine).is_available() {
        scene.numerics.engine = EngineName::Reference;
    }
    case_key(&scene, inputs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec;

    #[test]
    fn a_file_of_many_cases_is_read_once() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        let scene = |file: &str| -> SceneSpec {
            let body = format!("placement = {{ kind = \"file\", path = \"{file}\", filled_volume = 1.0 }}");
            let rest = "[output]\nframe_interval = 0.1\nend = 0.2\n";
            spec::parse(&format!("[numerics]\nspacing = 0.1\n[[body]]\n{body}\n{rest}")).expect("a scene")
        };
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a file");
        let mut inputs = Inputs::default();
        write("one.csv", "1");
        write("two.csv", "2");
        assert_eq!(inputs.of(&scene("one.csv"), folder.path()).expect("readable"), [b"1"]);
        write("one.csv", "changed");
        assert_eq!(inputs.of(&scene("one.csv"), folder.path()).expect("read before"), [b"1"]);
        assert_eq!(inputs.of(&scene("two.csv"), folder.path()).expect("readable"), [b"2"]);
        assert!(inputs.of(&scene("none.csv"), folder.path()).is_err());
    }
}
