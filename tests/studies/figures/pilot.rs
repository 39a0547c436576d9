//! The pilot's damage at each speed.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use snowlab_study::figure::pilot::{Pilot, PilotArm, pilot};

use super::{ARMS, keep, normal};

#[test]
fn pilot_shows_every_seed_at_every_speed() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let speeds = [2.0, 3.0, 5.0, 8.0, 12.0];
    let mut seeds = |speed: f64, arm: usize| -> Vec<f64> {
        (0..6).map(|_| (0.05 * speed + 0.08 * arm as f64 + 0.05 * normal(&mut rng)).clamp(0.0, 1.0)).collect()
    };
    let made: Vec<Vec<Vec<f64>>> =
        (0..2).map(|arm| speeds.iter().map(|s| seeds(*s, arm)).collect()).collect();
    let slices: Vec<Vec<&[f64]>> = made.iter().map(|arm| arm.iter().map(Vec::as_slice).collect()).collect();
    let arms: Vec<_> = slices.iter().zip(ARMS).map(|(damage, arm)| PilotArm { arm, damage }).collect();
    let figure = Pilot {
        title: "Pilot: which speed breaks a quarter off",
        speeds: &speeds,
        arms: &arms,
        target: 0.25,
        accepted: [0.05, 0.6],
        chosen: Some(2),
        note: "Points: six seeds per arm and speed. Short lines: medians.",
    };
    keep("pilot", &pilot(&figure).expect("the data is sound"));
}
