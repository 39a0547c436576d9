//! Checkpoints: changed and given the signature that belongs to the change, then gone on with.

use std::path::Path;
use std::sync::OnceLock;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use snowlab_solver::Real;
use snowlab_study::checkpoint::{CheckpointFile, Put, Taken};
use snowlab_study::keeper::{Keeper, Pause, Wish};
use snowlab_study::record::HistoryRow;
use snowlab_study::run::{Ended, Unobserved, run_kept};
use snowlab_study::spec::{self, SceneSpec};
use snowlab_study::store::{StoreError, sign};

use super::{bytes, hand_over};

/// Whose they are.
const CASE: &str = "0123456789abcdef0123";
/// Steps after which a run is put away, and those that a hostile one may take.
const STEPS: u64 = 40;

const SCENE: &str = r#"
[numerics]
spacing = 0.05
[[body]]
region = { kind = "ball", centre = [0.0, 0.3], radius = 0.25 }
placement = { kind = "random", count = 40 }
velocity = [0.0, -8.0]
[[collider]]
shape = { kind = "half-space", point = [0.0, 0.0], normal = [0.0, 1.0] }
[output]
frame_interval = 0.002
end = 0.05
"#;

/// The engines' checkpoints differ.
fn scene(engine: &str) -> SceneSpec {
    spec::parse(&SCENE.replace("spacing", &format!("engine = \"{engine}\"\nspacing"))).expect("a scene")
}

/// Puts a run away once.
#[derive(Default)]
struct Away {
    content: Option<Vec<u8>>,
}

impl Keeper for Away {
    fn take<T: Real, const D: usize>(&mut self) -> Option<Taken<T, D>> {
        None
    }
    fn refuse(&mut self, reason: &str) {
        panic!("{reason}");
    }
    fn wish(&mut self, steps: u64) -> Wish {
        if steps < STEPS { Wish::GoOn } else { Wish::Stop(Pause::Interrupted) }
    }
    fn put(
        &mut self,
        _share: f64,
        frames: Vec<u8>,
        history: &[HistoryRow],
        simulation: impl Serialize,
    ) -> Result<(), StoreError> {
        let put = Put { frames, history, seconds: 1.0, simulation };
        self.content = Some(postcard::to_stdvec(&put).expect("plain data"));
        Ok(())
    }
}

/// Goes on with a file's bytes, for some steps.
struct Hostile<'a> {
    bytes: &'a [u8],
    asked: u64,
    taken: bool,
}

impl Keeper for Hostile<'_> {
    fn take<T: Real, const D: usize>(&mut self) -> Option<Taken<T, D>> {
        let parsed = CheckpointFile::new(Path::new("."), CASE).parse::<Taken<T, D>>(self.bytes);
        let taken = parsed.map_err(|message| assert!(message.len() < 200, "{message}")).ok();
        self.taken = taken.is_some();
        taken
    }
    fn refuse(&mut self, reason: &str) {
        assert!(reason.len() < 200, "{reason}");
        self.taken = false;
    }
    fn wish(&mut self, _steps: u64) -> Wish {
        self.asked += 1;
        if self.asked < STEPS { Wish::GoOn } else { Wish::Stop(Pause::StepLimit) }
    }
    fn put(
        &mut self,
        _share: f64,
        _frames: Vec<u8>,
        _history: &[HistoryRow],
        _simulation: impl Serialize,
    ) -> Result<(), StoreError> {
        Ok(())
    }
}

/// A scene and the content of its checkpoint, for both engines.
fn valid() -> &'static [(SceneSpec, Vec<u8>); 2] {
    static VALID: OnceLock<[(SceneSpec, Vec<u8>); 2]> = OnceLock::new();
    VALID.get_or_init(|| {
        ["fast", "reference"].map(|engine| {
            let (scene, mut away) = (scene(engine), Away::default());
            let ended =
                run_kept::<2>(&scene, Path::new("."), 1, &mut Unobserved, &mut away).expect("it runs");
            assert!(matches!(ended, Ended::Paused(Pause::Interrupted)));
            (scene, away.content.expect("it was put away"))
        })
    })
}

/// The file of a content.
fn file(content: &[u8]) -> Vec<u8> {
    let head = [&b"snowlab-check-1\n"[..], CASE.as_bytes(), &0.5_f64.to_le_bytes()].concat();
    sign(CASE, [&head, content].concat())
}

#[test]
fn checkpoints_are_gone_on_with_or_refused() {
    hand_over("checkpoints", 1, |random: &mut ChaCha8Rng| {
        let (scene, content) = &valid()[usize::from(random.random::<bool>())];
        let changed = match random.random_range(0..4) {
            0 => content.clone(),
            1 => {
                // Numbers of the run itself: any eight bytes.
                let mut changed = content.clone();
                let place = random.random_range(0..changed.len() - 8);
                let numbers = [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e300, 5e-324, 1e9];
                let number = numbers[random.random_range(0..numbers.len())];
                changed[place..place + 8].copy_from_slice(&number.to_le_bytes());
                changed
            }
            _ => bytes::mutated(content, &[], random),
        };
        let file = file(&changed);
        let mut hostile = Hostile { bytes: &file, asked: 0, taken: false };
        run_kept::<2>(scene, Path::new("."), 1, &mut Unobserved, &mut hostile)
            .expect("the scene can be built");
        hostile.taken
    });
}
