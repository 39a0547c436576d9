//! The fragments of files of points: discs of known number and size, and the JSON that scripts read.

use std::path::PathBuf;

use snowlab_solver::Vector;
use snowlab_study::fragments_command::{DEFAULT_MIN_MASS_SHARE, FragmentReport, fragments_of_file};
use snowlab_study::points::{PointCloud, write, write_cloud};
use tempfile::TempDir;

/// Spacing of the points within a piece [m].
const SPACING: f64 = 0.01;

/// Balls (discs in 2D) of these radii [spacings] in a row, `gap` [m] between the nearest points of neighbours, and the
/// points of each.
fn balls<const D: usize>(radii: &[i32], gap: f64) -> (Vec<Vector<f64, D>>, Vec<usize>) {
    let (mut positions, mut sizes, mut left) = (Vec::new(), Vec::new(), 0.0);
    for &radius in radii {
        let before = positions.len();
        let side = 2 * radius + 1;
        for site in 0..side.pow(D as u32) {
            let offset: [i32; D] = std::array::from_fn(|axis| site / side.pow(axis as u32) % side - radius);
            if offset.iter().map(|o| o * o).sum::<i32>() <= radius * radius {
                let along = left + SPACING * f64::from(radius);
                let origin = |axis| if axis == 0 { along } else { 1.0 };
                positions.push(Vector::from_fn(|axis, _| origin(axis) + SPACING * f64::from(offset[axis])));
            }
        }
        sizes.push(positions.len() - before);
        left += SPACING * f64::from(2 * radius) + gap;
    }
    (positions, sizes)
}

fn place(name: &str) -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    (directory, path)
}

fn fragments<const D: usize>(name: &str, positions: &[Vector<f64, D>], link: f64) -> FragmentReport {
    let (_directory, path) = place(name);
    write(&path, positions).unwrap();
    fragments_of_file(&path, link, DEFAULT_MIN_MASS_SHARE).unwrap()
}

fn balls_are_counted<const D: usize>(name: &str) {
    let gap = 0.03;
    let (positions, mut sizes) = balls::<D>(&[3, 5, 1, 4], gap);
    let apart = fragments(name, &positions, 0.99 * gap);
    sizes.sort_by(|a, b| b.cmp(a));
    assert_eq!(apart.sizes, sizes);
    assert_eq!((apart.fragments, apart.largest, apart.dimension), (4, sizes[0], D), "{name}");
    assert_eq!(apart.points, positions.len());
    let shares: Vec<f64> = sizes.iter().map(|&size| size as f64 / positions.len() as f64).collect();
    assert!((apart.largest_share - shares[0]).abs() < 1e-15);
    let effective = 1.0 / shares.iter().map(|share| share * share).sum::<f64>();
    assert!((apart.effective_number - effective).abs() < 1e-12);
    // The gap flips at the link: just above it all is one.
    let joined = fragments(name, &positions, 1.01 * gap);
    assert_eq!((joined.fragments, joined.sizes), (1, vec![positions.len()]), "{name}");
    // Below the spacing every point is alone.
    assert_eq!(fragments(name, &positions, 0.99 * SPACING).fragments, positions.len(), "{name}");
}

#[test]
fn balls_apart_are_counted_in_2d_and_3d_from_csv_and_ply() {
    for name in ["balls.csv", "balls.ply"] {
        balls_are_counted::<2>(name);
        balls_are_counted::<3>(name);
    }
}

#[test]
fn the_cut_is_a_share_of_the_mass_met_exactly() {
    // Ten pieces of three points: each is 3/30 of the mass, and 0.1 * 30 would be rounded above 3.
    let positions: Vec<_> =
        (0..30).map(|i| Vector::<f64, 2>::new(f64::from(i / 3), 0.1 * f64::from(i % 3))).collect();
    let (_directory, path) = place("pieces.csv");
    write(&path, &positions).unwrap();
    let at = |share| fragments_of_file(&path, 0.2, share).unwrap();
    assert_eq!((at(0.1).fragments_above_cut, at(0.1).dust_share), (10, 0.0));
    let above = 0.1f64.next_up();
    assert_eq!((at(above).fragments_above_cut, at(above).dust_share), (0, 1.0));
    assert_eq!(at(above).fragments, 10, "dust still counts as fragments");
}

#[test]
fn masses_of_the_file_decide_the_shares_and_points_the_sizes() {
    let (_directory, path) = place("heavy.ply");
    let positions = vec![
        Vector::<f64, 2>::new(0.0, 0.0),
        Vector::<f64, 2>::new(0.1, 0.0),
        Vector::<f64, 2>::new(5.0, 0.0),
    ];
    write_cloud(&path, &PointCloud { positions, masses: Some(vec![1.0, 1.0, 6.0]), ..PointCloud::default() })
        .unwrap();
    let report = fragments_of_file(&path, 0.2, 0.5).unwrap();
    assert!(report.masses_from_file);
    assert_eq!((report.sizes, report.largest, report.largest_share), (vec![2, 1], 2, 0.75));
    assert_eq!((report.fragments_above_cut, report.dust_share), (1, 0.25));
    assert_eq!(report.effective_number, 1.6); // 1 / (0.75^2 + 0.25^2)
}

#[test]
fn no_points_are_no_fragments() {
    let (_directory, path) = place("none.csv");
    std::fs::write(&path, "x,y\n").unwrap();
    let report = fragments_of_file(&path, 0.2, DEFAULT_MIN_MASS_SHARE).unwrap();
    assert_eq!((report.points, report.fragments, report.largest, report.fragments_above_cut), (0, 0, 0, 0));
    assert_eq!((report.largest_share, report.effective_number, report.dust_share), (0.0, 0.0, 0.0));
    assert!(report.sizes.is_empty());
    std::fs::write(&path, "").unwrap();
    let message = fragments_of_file(&path, 0.2, DEFAULT_MIN_MASS_SHARE).unwrap_err().to_string();
    assert!(message.contains("the file is empty; give it a header"), "{message}");
}

#[test]
fn the_json_has_the_keys_that_scripts_read() {
    let (positions, _) = balls::<2>(&[1, 2], 0.05);
    let report = fragments("two.csv", &positions, 0.02);
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["fragments"], 2);
    assert_eq!(json["largest"], 13);
    assert_eq!(json["sizes"], serde_json::json!([13, 5]));
    assert_eq!(json["points"], 18);
    assert_eq!(json["dimension"], 2);
    assert_eq!(json["link"], 0.02);
    assert_eq!(json["fragments_above_cut"], 2);
    assert_eq!(json["min_mass_share"], 0.002);
    assert_eq!(json["dust_share"], 0.0);
    assert_eq!(json["largest_share"], 13.0 / 18.0);
    let effective = json["effective_number"].as_f64().unwrap();
    assert!((effective - 324.0 / 194.0).abs() < 1e-12); // 18^2 / (13^2 + 5^2)
    assert_eq!(json["masses_from_file"], false);
    assert!(json["file"].as_str().unwrap().ends_with("two.csv"));
}

#[test]
fn the_plain_text_says_the_same() {
    let scattered: Vec<_> = (0..20).map(|i| Vector::<f64, 3>::new(f64::from(i), 1.0, 1.0)).collect();
    let text = fragments("scattered.ply", &scattered, 0.5).to_string();
    let expected = "scattered.ply: 20 points in 3D, equal masses, link 0.5\n\
        \x20 fragments         20\n\
        \x20 above the cut     20, with 0.2000 % of the mass or more\n\
        \x20 dust              0.0000 % of the mass\n\
        \x20 effective number  20.0000\n\
        \x20 largest           1 points\n\
        \x20 heaviest          5.0000 % of the mass\n\
        \x20 points in each    1 1 1 1 1 1 1 1 1 1 1 1 and 8 more";
    assert!(text.ends_with(expected), "{text}");
}

#[test]
fn what_cannot_be_measured_is_refused_with_what_is_allowed() {
    let (_directory, path) = place("points.csv");
    std::fs::write(&path, "x,y\n1,2\n3e150,4\n").unwrap();
    let refusal = |link, share| fragments_of_file(&path, link, share).unwrap_err().to_string();
    for share in [-0.1, 1.1, f64::NAN] {
        assert!(refusal(0.1, share).contains("`--min-mass-share` is"), "{share}");
    }
    let message = refusal(0.1, 0.1);
    assert!(message.contains("points.csv: metrics: position of particle 1 on axis 0 is 3e150;"), "{message}");
    std::fs::write(&path, "x,y\n1,2\n").unwrap();
    let refusal = |link| fragments_of_file(&path, link, 0.1).unwrap_err().to_string();
    for link in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let message = refusal(link);
        assert!(message.contains("`--link` is") && message.contains("allowed: above 0"), "{message}");
        assert!(message.len() < 200, "{message}");
    }
    let absent = fragments_of_file(&path.with_extension("vtp"), 0.1, 0.1).unwrap_err().to_string();
    assert!(absent.contains("use .csv or .ply"), "{absent}");
}
