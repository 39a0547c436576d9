//! A mistake of the program in one case: the study goes on, and the case is run again the next time.

use std::path::Path;

use snowlab_solver::{Real, Simulation};
use snowlab_study::case_run::{CaseEnd, Job};
use snowlab_study::keeper::Limits;
use snowlab_study::manifest::Program;
use snowlab_study::record::Outcome;
use snowlab_study::results::Archive;
use snowlab_study::run::{Observer, Unobserved};
use snowlab_study::spec;
use snowlab_study::sweep::Study;

const STUDY: &str = r#"
name = "tiny"
question = "Does it go on?"
blocks = { first = 1, count = 2 }
measure = { largest_spacing = 0.1 }
[scene.numerics]
spacing = 0.1
[[scene.body]]
region = { kind = "ball", centre = [0.0, 0.3], radius = 0.25 }
placement = { kind = "random", count = 40 }
[scene.output]
frame_interval = 0.001
end = 0.002
[[arm]]
id = "one"
"#;

/// Panics at the first step.
struct Clumsy;

impl Observer for Clumsy {
    fn progress(&mut self, _share: f64, _steps: u64) {
        panic!("dropped the snowball");
    }
    fn frame<T: Real, const D: usize>(&mut self, _simulation: &Simulation<T, D>) {}
}

#[test]
fn a_case_that_panics_is_a_record_and_is_run_again() {
    let study = Study::expand(spec::parse(STUDY).unwrap(), None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let archive = Archive::open(&study, folder.path(), Path::new(".")).unwrap();
    let (limits, program) = (Limits::default(), Program::this(Path::new(".")));
    let job = Job::alone(&limits, &program);
    assert!(matches!(archive.run(0, &job, &mut Clumsy).unwrap(), CaseEnd::Failed(_)));
    assert_eq!(archive.run(1, &job, &mut Unobserved).unwrap(), CaseEnd::Finished);

    let results = archive.results().unwrap();
    let outcomes: Vec<String> = results.iter().map(|result| result.record.outcome.in_words()).collect();
    assert_eq!(outcomes, ["stopped(panic)", "ok"]);
    assert!(results[0].failure().unwrap().contains("dropped the snowball"));
    assert_eq!(archive.missing(), [0], "it still counts as not run");

    archive.run(0, &job, &mut Unobserved).unwrap();
    assert!(archive.missing().is_empty());
    assert_eq!(archive.result(0).unwrap().record.outcome, Outcome::Ok);
    let left = archive.case_folder(0).path().join("failure.json");
    assert!(!left.exists(), "of the panic nothing is left");
}
