//! What a body's heterogeneity does to its particles, and to a run.

use std::path::Path;

use snowlab_solver::timestep::fastest_wave_squared;
use snowlab_study::assemble::{Assembly, assemble};
use snowlab_study::run::{Unobserved, run_scene};
use snowlab_study::spec::{self, SceneSpec};

use super::runner::desk::SCENE;

fn scene(heterogeneity: &str) -> SceneSpec {
    spec::parse(&SCENE.replace("velocity = ", &format!("{heterogeneity}\nvelocity = "))).unwrap()
}

fn built(heterogeneity: &str) -> Assembly<f64, 2> {
    assemble::<f64, 2>(&scene(heterogeneity), Path::new(".")).unwrap()
}

fn spread(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt() / mean
}

/// Of mass, volume and stiffness those differ that were asked for; the body's mass and the places of its particles stay.
#[test]
fn what_was_asked_for_differs_and_nothing_else() {
    let alike = built("");
    for (of, differs) in
        [("weight", [true, true, false]), ("mass", [true, false, false]), ("stiffness", [false, false, true])]
    {
        let noisy =
            built(&format!("heterogeneity = {{ kind = \"independent\", of = \"{of}\", spread = 0.5 }}"));
        let [own, same] = [&noisy, &alike].map(|assembly| &assembly.state);
        assert_eq!(own.motion.position, same.motion.position, "{of}");
        let masses = |state: &snowlab_solver::State<f64, 2>| state.constants.mass.iter().sum::<f64>();
        assert!((masses(own) / masses(same) - 1.0).abs() < 1e-12, "{of}");
        let columns = [&own.constants.mass, &own.constants.volume, &own.constants.stiffness_scale];
        for (column, differs) in columns.into_iter().zip(differs) {
            let found = spread(column);
            assert!(if differs { (0.4..0.6).contains(&found) } else { found < 1e-12 }, "{of}: {found}");
        }
    }
}

/// The step follows the particle that is stiffest for its mass.
#[test]
fn waves_are_as_fast_as_the_stiffest_particle_for_its_mass() {
    let hard =
        built("heterogeneity = { kind = \"shell\", of = \"stiffness\", factor = 4.0, thickness = 0.1 }");
    let alike = built("");
    let speed = |a: &Assembly<f64, 2>| fastest_wave_squared(&a.scene, &a.state);
    assert!((speed(&hard) / speed(&alike) - 4.0).abs() < 1e-9);
    let light = built("heterogeneity = { kind = \"independent\", of = \"mass\", spread = 0.5 }");
    let least = light.state.constants.mass.iter().copied().fold(f64::INFINITY, f64::min);
    let mean = light.state.constants.mass.iter().sum::<f64>() / 300.0;
    assert!((speed(&light) / speed(&alike) - mean / least).abs() < 1e-9 * mean / least);
}

#[test]
fn heterogeneous_bodies_run() {
    for of in ["weight", "mass", "stiffness"] {
        let text = format!(
            "heterogeneity = {{ kind = \"correlated\", of = \"{of}\", spread = 0.5, correlation_length = 0.1 }}"
        );
        let run = run_scene::<2>(&scene(&text), Path::new("."), 1, &mut Unobserved).unwrap();
        assert_eq!(run.record.outcome.in_words(), "ok", "{of}");
    }
}
