//! Particle files that change, or cannot be read, while a study is run: nothing is stored under the key of other particles.

use std::path::{Path, PathBuf};

use snowlab_solver::{Real, Simulation};
use snowlab_study::assemble::assemble;
use snowlab_study::case_run::{CaseEnd, Job};
use snowlab_study::keeper::Limits;
use snowlab_study::manifest::Program;
use snowlab_study::record::Outcome;
use snowlab_study::results::Archive;
use snowlab_study::run::{Observer, Unobserved};
use snowlab_study::spec::{self, SpecError};
use snowlab_study::sweep::Study;

const STUDY: &str = r#"
name = "tiny"
question = "Of which particles?"
blocks = { first = 1, count = 1 }
measure = { largest_spacing = 0.1 }
[scene.numerics]
spacing = 0.1
[[scene.body]]
placement = { kind = "file", path = "points.csv", filled_volume = 0.02 }
[scene.output]
frame_interval = 0.001
end = 0.002
[[arm]]
id = "one"
"#;
const POINTS: &str = "x,y\n0.0,0.2\n0.1,0.2\n";
const OTHERS: &str = "x,y\n0.0,0.2\n0.1,0.3\n";

/// Another program writes the file while the case runs.
struct Writer(PathBuf);

impl Observer for Writer {
    fn progress(&mut self, _share: f64, _steps: u64) {
        std::fs::write(&self.0, OTHERS).unwrap();
    }
    fn frame<T: Real, const D: usize>(&mut self, _simulation: &Simulation<T, D>) {}
}

#[test]
fn a_particle_file_that_changes_meanwhile_is_no_result() {
    let study = Study::expand(spec::parse(STUDY).unwrap(), None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("points.csv");
    std::fs::write(&file, POINTS).unwrap();
    let archive = Archive::open(&study, &folder.path().join("results"), folder.path()).unwrap();
    let (limits, program) = (Limits::default(), Program::this(Path::new(".")));
    let job = Job::alone(&limits, &program);
    let has_failed = |end: CaseEnd, says: &str| {
        let CaseEnd::Failed(Outcome::Stopped { reason, message }) = end else { panic!("{end:?}") };
        assert!(reason == "input" && message.contains(says), "{reason}: {message}");
        assert_eq!(archive.missing(), [0], "it is tried again");
    };
    std::fs::write(&file, OTHERS).unwrap();
    has_failed(archive.run(0, &job, &mut Unobserved).unwrap(), "was changed after the study was opened");
    std::fs::remove_file(&file).unwrap();
    has_failed(archive.run(0, &job, &mut Unobserved).unwrap(), "points.csv: cannot be read");
    std::fs::write(&file, POINTS).unwrap();
    has_failed(archive.run(0, &job, &mut Writer(file.clone())).unwrap(), "was changed after the study");
    std::fs::write(&file, POINTS).unwrap();
    assert_eq!(archive.run(0, &job, &mut Unobserved).unwrap(), CaseEnd::Finished);
}

#[test]
fn a_particle_file_that_cannot_be_read_is_told_from_one_that_is_wrong() {
    let study = Study::expand(spec::parse(STUDY).unwrap(), None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let refusal = || assemble::<f64, 2>(&study.cases[0].scene, folder.path()).map(|_| ()).unwrap_err();
    assert!(matches!(refusal(), SpecError::Particles { .. }), "{}", refusal());
    std::fs::write(folder.path().join("points.csv"), "x,y\n0,up\n").unwrap();
    assert!(matches!(refusal(), SpecError::Value { .. }), "{}", refusal());
}
