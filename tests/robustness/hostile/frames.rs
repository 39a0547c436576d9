//! Frames: files of our own, changed and given the checksum that belongs to the change.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use snowlab_solver::Vector;
use snowlab_study::frames::{Frame, Frames};
use snowlab_study::store::{sign, verify};

use super::memory::most_held;
use super::{bytes, hand_over};

/// Whose they are.
const CASE: &str = "0123456789abcdef0123";
/// Where the header has D, the number of frames and that of particles.
const COUNTS: [std::ops::Range<usize>; 3] = [16..20, 20..24, 24..32];

fn valid<const D: usize>(frames: usize, particles: usize) -> Vec<u8> {
    let frame = |k: usize| Frame {
        time: 0.1 * k as f64,
        positions: vec![[0.5; D]; particles],
        plastic_ratios: vec![1.0; particles],
    };
    let origin = Vector::<f64, D>::from_element(1.0);
    Frames { origin, masses: vec![0.25; particles], frames: (0..frames).map(frame).collect() }.to_bytes()
}

/// A valid file, its counts or any bytes changed; most get the checksum that belongs to what they hold.
fn mutated(random: &mut ChaCha8Rng) -> Vec<u8> {
    let (frames, particles) = (random.random_range(0..4), random.random_range(0..5));
    let mut file =
        if random.random() { valid::<2>(frames, particles) } else { valid::<3>(frames, particles) };
    match random.random_range(0..4) {
        0 => file = bytes::mutated(&file, &[], random),
        1 => {
            let place = COUNTS[random.random_range(0..COUNTS.len())].clone();
            let count = [0, 1, 2, 3, 4, 5, u64::MAX, u64::MAX / 4, 1 << 62, 1 << 32, 1 << 31];
            let count = count[random.random_range(0..count.len())].to_le_bytes();
            file[place.clone()].copy_from_slice(&count[..place.len()]);
        }
        2 => {
            // The numbers themselves may be any.
            let place = random.random_range(32..file.len());
            file[place] = random.random();
        }
        _ => {}
    }
    match random.random_range(0..8) {
        0 => bytes::mutated(&sign(CASE, file), &[], random),
        _ => sign(CASE, file),
    }
}

#[test]
fn frames_are_those_of_their_bytes_or_refused() {
    hand_over("frames", 3, |random| {
        let file = mutated(random);
        hold::<2>(&file) | hold::<3>(&file)
    });
}

fn hold<const D: usize>(file: &[u8]) -> bool {
    let (read, held) = most_held(|| verify(CASE, file).and_then(Frames::<D>::from_bytes));
    assert!(held < 4096 + 16 * file.len(), "{held} bytes are held for {}", file.len());
    match read {
        Ok(frames) => {
            assert_eq!(sign(CASE, frames.to_bytes()), file, "the same frames have the same bytes");
            true
        }
        Err(message) => {
            assert!(message.starts_with("it") && message.len() < 200, "{message}");
            false
        }
    }
}
