//! Files of meshes.

use std::path::Path;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use snowlab_solver::Vector;
use snowlab_study::meshes::read_from;

use super::memory::most_held;
use super::{bytes, hand_over, hold_words};
use crate::made::shapes::{Shape, cube, icosphere};
use crate::made::written;

/// What a reader may hold of a file (chosen: buffers, and some 500 bytes a triangle of 10 bytes).
const MOST_HELD: usize = 400_000;
const MOST_HELD_BYTE: usize = 100;

#[test]
fn every_obj_is_a_solid_or_refused_in_words_that_help() {
    hand_over("OBJ", 2, |random| hold("hostile.obj", random, &[written::obj]));
}

#[test]
fn every_stl_is_a_solid_or_refused_in_words_that_help() {
    hand_over("STL", 2, |random| hold("hostile.stl", random, &[written::stl_text, written::stl_binary]));
}

#[test]
fn every_ply_is_a_solid_or_refused_in_words_that_help() {
    let binary = |shape: &Shape| written::ply_binary(shape, false);
    hand_over("PLY of faces", 2, |random| hold("hostile.ply", random, &[written::ply_text, binary]));
}

/// One of the ways to write a shape, changed, and where it is taken, what it encloses.
fn hold(name: &str, random: &mut ChaCha8Rng, ways: &[fn(&Shape) -> Vec<u8>]) -> bool {
    let shape = if random.random() { cube() } else { icosphere(0) };
    let files: Vec<Vec<u8>> = ways.iter().map(|write| write(&shape)).collect();
    let others: Vec<&[u8]> = files.iter().map(Vec::as_slice).collect();
    let mut file = bytes::mutated(others[random.random_range(0..others.len())], &others, random);
    if random.random_range(0..8) == 0 {
        // Numbers of the header and of corners: any four bytes.
        let place = random.random_range(0..=file.len().saturating_sub(4));
        let end = (place + 4).min(file.len());
        file[place..end].fill(if random.random() { 0xff } else { 0 });
    }
    let (read, held) = most_held(|| read_from(Path::new(name), file.clone()));
    let input = || file.escape_ascii().to_string();
    assert!(held < MOST_HELD + MOST_HELD_BYTE * file.len(), "{held} bytes for {}: {}", file.len(), input());
    match read {
        Ok(mesh) => {
            let sides = mesh.bounds().max - mesh.bounds().min;
            // What faces outwards is no more than the box about it, but for what lines see of overlaps.
            assert!(
                mesh.volume() > 0.0 && mesh.volume() < 1.1 * sides.product(),
                "{}: {}",
                mesh.volume(),
                input()
            );
            let outside = mesh.bounds().max + Vector::<f64, 3>::repeat(1.0);
            assert!(!mesh.contains(&outside) && mesh.distance(&outside) > 0.0, "{}", input());
            true
        }
        Err(error) => {
            let message = error.to_string();
            let rest = message.strip_prefix(name).unwrap_or_else(|| panic!("{message:?} names no file"));
            hold_words(rest, &input());
            false
        }
    }
}
