//! Files of points.

use std::path::Path;

use snowlab_study::metrics::{MetricError, friends_of_friends};
use snowlab_study::points::{AnyPointCloud, PointCloud, read_any_from};

use super::memory::most_held;
use super::{hand_over, hold_words, point_files};

/// What a reader may hold of a file (chosen: its buffers, and 24 bytes a coordinate twice for files of 2 bytes a point).
const MOST_HELD: usize = 200_000;
const MOST_HELD_BYTE: usize = 100;

#[test]
fn every_csv_is_points_or_refused_in_words_that_help() {
    hand_over("CSV", 17, |random| hold("hostile.csv", &point_files::csv(random)));
}

#[test]
fn every_ply_is_points_or_refused_in_words_that_help() {
    hand_over("PLY", 17, |random| hold("hostile.ply", &point_files::ply(random)));
}

fn hold(name: &str, file: &[u8]) -> bool {
    let (read, held) = most_held(|| read_any_from(Path::new(name), file));
    let input = || file.escape_ascii().to_string();
    assert!(
        held < MOST_HELD + MOST_HELD_BYTE * file.len(),
        "{held} bytes are held for {}: {}",
        file.len(),
        input()
    );
    match read {
        Ok(AnyPointCloud::Two(cloud)) => hold_cloud(&cloud, file),
        Ok(AnyPointCloud::Three(cloud)) => hold_cloud(&cloud, file),
        Err(error) => {
            let message = error.to_string();
            let rest = message.strip_prefix(name).unwrap_or_else(|| panic!("{message:?} names no file"));
            hold_words(rest, &input());
            return false;
        }
    }
    true
}

/// All quantities are there for every point, finite and of their sign, and the points have taken bytes of the file.
fn hold_cloud<const D: usize>(cloud: &PointCloud<D>, file: &[u8]) {
    let points = cloud.positions.len();
    let input = || file.escape_ascii().to_string();
    // Two numbers of a byte each are the shortest point.
    assert!(2 * points <= file.len(), "{points} points: {}", input());
    let vectors = [Some(&cloud.positions), cloud.velocities.as_ref()];
    for rows in vectors.into_iter().flatten() {
        assert!(rows.len() == points && rows.iter().flatten().all(|x| x.is_finite()), "{}", input());
    }
    for values in [&cloud.masses, &cloud.volumes, &cloud.plastic_ratios].into_iter().flatten() {
        let taken = |value: &f64| *value > 0.0 && value.is_finite();
        assert!(values.len() == points && values.iter().all(taken), "{}", input());
    }
    for matrices in cloud.deformations.iter() {
        assert!(matrices.len() == points && matrices.iter().flatten().all(|x| x.is_finite()), "{}", input());
    }
    hold_fragments(cloud, &input());
}

/// Whatever points there are, they have fragments, or the metric says why not.
fn hold_fragments<const D: usize>(cloud: &PointCloud<D>, input: &str) {
    let masses = cloud.masses.clone().unwrap_or_else(|| vec![1.0; cloud.positions.len()]);
    let found: Result<_, MetricError> = friends_of_friends(&cloud.positions, &masses, 0.1);
    match found {
        Ok(analysis) => assert!(analysis.components() <= cloud.positions.len(), "{input}"),
        Err(error) => {
            let message = error.to_string();
            assert!(message.len() < 600 && !message.contains(char::is_control), "{message:?}: {input}");
        }
    }
}
