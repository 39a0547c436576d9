//! Scenes.

use std::path::Path;
use std::sync::LazyLock;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use snowlab_study::assemble::assemble;
use snowlab_study::memory::of_case;
use snowlab_study::spec::scene::{PrecisionName, RegionSpec};
use snowlab_study::spec::{self, SceneSpec, SpecError};

use super::corpus::{Corpus, documented, most_for};
use super::memory::most_held;
use super::{hand_over, hold_refusal};
use crate::messages::{SCENE, SCENES};

/// Bodies of more particles are not placed here (chosen: placing takes as long as reading).
const MOST_PLACED: usize = 500;

static CORPUS: LazyLock<Corpus> =
    LazyLock::new(|| Corpus::new(SCENES.into_iter().chain([SCENE]).chain(documented(false))));

#[test]
fn every_scene_is_built_or_refused_in_words_that_help() {
    hand_over("scenes", 30, |random| {
        let text = CORPUS.mutated(random, |_, _| {});
        let (parsed, held) = most_held(|| spec::parse::<SceneSpec>(&text));
        assert!(held < most_for(&text), "{held} bytes are held for {}: {text}", text.len());
        match &parsed {
            Ok(scene) => hold_accepted(scene, random),
            Err(error) => hold_refusal(&error.to_string(), &text),
        }
        parsed.is_ok()
    });
}

/// What is accepted can be written and read again, and built or refused.
fn hold_accepted(scene: &SceneSpec, random: &mut ChaCha8Rng) {
    let text = toml::to_string(scene).expect("a scene is plain data");
    assert_eq!(&spec::parse::<SceneSpec>(&text).expect(&text), scene);
    let count = scene.body.iter().filter_map(|body| body.placement.count()).sum::<usize>();
    // Counting cells of composed regions and voids takes ten thousand times as long as reading.
    let slow =
        scene.body.iter().any(|body| body.voids.is_some() || body.region.as_ref().is_some_and(is_composed));
    if count <= MOST_PLACED && (!slow || random.random_range(0..5000) == 0) {
        of_case(scene, Path::new("/nowhere"), None);
        match build(scene) {
            Ok(particles) => assert!(particles >= count / 3, "{particles} of {count} particles: {text}"),
            Err(error) => hold_refusal(&error.to_string(), &text),
        }
    }
}

fn is_composed(region: &RegionSpec) -> bool {
    matches!(region, RegionSpec::Union { .. } | RegionSpec::Difference { .. })
}

/// The number of particles of the scene in its own precision and dimension.
fn build(scene: &SceneSpec) -> Result<usize, SpecError> {
    let folder = Path::new("/nowhere");
    match (scene.dimension, scene.numerics.precision) {
        (3, PrecisionName::F64) => assemble::<f64, 3>(scene, folder).map(|built| built.state.len()),
        (3, PrecisionName::F32) => assemble::<f32, 3>(scene, folder).map(|built| built.state.len()),
        (_, PrecisionName::F64) => assemble::<f64, 2>(scene, folder).map(|built| built.state.len()),
        (_, PrecisionName::F32) => assemble::<f32, 2>(scene, folder).map(|built| built.state.len()),
    }
}
