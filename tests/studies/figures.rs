//! Every kind of figure, drawn from made-up data: sizes, aspect, repeatability, and data that is missing.

mod curves;
mod drawing;
mod energy;
mod forest;
mod missing;
mod moment;
mod outcomes;
mod pilot;
mod sizes;
mod snowballs;
mod strips;

use std::path::PathBuf;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use snowlab_study::figure::Drawing;

/// Keeps a figure under the target directory to be looked at.
fn keep(name: &str, drawing: &Drawing) -> Vec<u8> {
    let bytes = drawing.png();
    assert_eq!(&bytes[1..4], b"PNG");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("figures");
    std::fs::create_dir_all(&folder).expect("the target directory can be written");
    std::fs::write(folder.join(format!("{name}.png")), &bytes).expect("the target directory can be written");
    bytes
}

const ARMS: [&str; 12] = [
    "random-5k",
    "random-30k",
    "circles-30k",
    "ellipses-30k-equal-density",
    "jittered-5k",
    "jittered-30k",
    "lattice-5k",
    "lattice-30k",
    "poisson-disk-30k",
    "weight-noise-lattice",
    "stiffness-only",
    "gaussian-field-30k",
];

/// A standard normal number, by the sum of twelve uniform ones.
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0
}
