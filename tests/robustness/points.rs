//! Files of points: what is written comes back bit by bit, what others write is understood, and whatever else stands
//! in a file is refused with its place and a remedy, without a panic and without memory for points that are not there.

mod malformed;
mod mutations;

use std::path::PathBuf;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use snowlab_solver::{Matrix, Vector};
use snowlab_study::points::{AnyPointCloud, PointCloud, dimension, read, read_any, write, write_cloud};
use tempfile::TempDir;

/// A file of this name and content in a directory of its own.
fn file(name: &str, content: impl AsRef<[u8]>) -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    std::fs::write(&path, content).unwrap();
    (directory, path)
}

/// Any finite number, all exponents alike, so also denormal ones.
fn any_finite(random: &mut ChaCha8Rng) -> f64 {
    loop {
        let number = f64::from_bits(random.next_u64());
        if number.is_finite() {
            return number;
        }
    }
}

/// Points whose numbers are hard to write: random bits, and the edges of f64.
fn hard_cloud<const D: usize>(velocities: bool, masses: bool) -> PointCloud<D> {
    let mut random = ChaCha8Rng::seed_from_u64(D as u64);
    let edges = [0.0, -0.0, 5e-324, f64::MIN_POSITIVE, f64::MAX, f64::MIN, 0.1, 1.0 / 3.0, 1e15, 1e16, 1e22];
    let mut vectors = || -> Vec<Vector<f64, D>> {
        let edge = edges.iter().map(|&value| Vector::from_element(value));
        let rest: Vec<_> = (0..500).map(|_| Vector::from_fn(|_, _| any_finite(&mut random))).collect();
        edge.chain(rest).collect()
    };
    let positions = vectors();
    let weights = |power: f64| {
        let weigh = |_: &Vec<_>| (0..positions.len()).map(|i| 10f64.powf(i as f64 / 3.0 - power)).collect();
        masses.then_some(&positions).map(weigh)
    };
    let (masses, volumes, plastic_ratios) = (weights(80.0), weights(81.1), weights(82.3));
    let velocities = velocities.then(&mut vectors);
    let rows = |vectors: &Vec<Vector<f64, D>>| {
        (0..vectors.len()).map(|i| Matrix::from_fn(|j, k| vectors[(i + 3 * j) % vectors.len()][k])).collect()
    };
    PointCloud {
        deformations: velocities.as_ref().map(rows),
        velocities,
        masses,
        volumes,
        plastic_ratios,
        positions,
    }
}

fn bits<const D: usize>(vectors: &[Vector<f64, D>]) -> Vec<Vec<u64>> {
    vectors.iter().map(|vector| vector.iter().map(|value| value.to_bits()).collect()).collect()
}

fn round_trip<const D: usize>(name: &str) {
    for (velocities, masses) in [(false, false), (true, false), (false, true), (true, true)] {
        let cloud = hard_cloud::<D>(velocities, masses);
        let (_directory, path) = file(name, "");
        write_cloud(&path, &cloud).unwrap();
        let back = read::<D>(&path).unwrap();
        assert_eq!(bits(&back.positions), bits(&cloud.positions), "{name} {D}D");
        assert_eq!(
            (&back.volumes, &back.plastic_ratios),
            (&cloud.volumes, &cloud.plastic_ratios),
            "{name} {D}D"
        );
        assert_eq!(back.deformations, cloud.deformations, "{name} {D}D");
        assert_eq!(
            back.velocities.as_deref().map(bits),
            cloud.velocities.as_deref().map(bits),
            "{name} {D}D"
        );
        assert_eq!(back.masses, cloud.masses, "{name} {D}D");
        assert_eq!(dimension(&path).unwrap(), D, "{name}");
    }
}

#[test]
fn what_is_written_comes_back_with_the_same_bits() {
    for name in ["points.csv", "points.ply", "POINTS.CSV", "points.Ply"] {
        round_trip::<2>(name);
        round_trip::<3>(name);
    }
}

#[test]
fn positions_alone_are_written_as_the_cloud_that_has_nothing_else() {
    let positions = [Vector::<f64, 3>::new(1.0, 2.0, 3.0), Vector::<f64, 3>::new(0.1, -0.2, 1e-9)];
    for name in ["a.csv", "a.ply"] {
        let (_directory, path) = file(name, "");
        write(&path, &positions).unwrap();
        let expected = PointCloud { positions: positions.to_vec(), ..PointCloud::default() };
        assert_eq!(read::<3>(&path).unwrap(), expected);
        assert_eq!(read_any(&path).unwrap(), AnyPointCloud::Three(expected));
    }
    let (_directory, path) = file("a.csv", "");
    write(&path, &positions).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "x,y,z\n1.0,2.0,3.0\n0.1,-0.2,1e-9\n");
}

#[test]
fn no_points_are_a_file_like_any_other() {
    for name in ["none.csv", "none.ply"] {
        let (_directory, path) = file(name, "");
        write::<2>(&path, &[]).unwrap();
        assert_eq!(read::<2>(&path).unwrap(), PointCloud::default());
        assert_eq!(dimension(&path).unwrap(), 2);
        write::<3>(&path, &[]).unwrap();
        assert_eq!(read::<3>(&path).unwrap(), PointCloud::default());
    }
}

#[test]
fn csv_columns_go_by_name_in_any_order_and_layout() {
    let positions = vec![Vector::<f64, 2>::new(1.0, 2.5), Vector::<f64, 2>::new(-3.0, 4e-3)];
    let plain = PointCloud { positions, ..PointCloud::default() };
    let velocities = Some(vec![Vector::<f64, 2>::new(7.0, 8.0), Vector::<f64, 2>::new(9.0, -1.0)]);
    let moving = PointCloud { velocities, ..plain.clone() };
    let heavy = PointCloud { masses: Some(vec![0.5, 2.0]), ..plain.clone() };
    let table = [
        ("x,y\n1,2.5\n-3,4e-3\n", &plain),
        ("Y,X\n2.5,1\n4e-3,-3\n", &plain),
        ("id,y,wetness,x,fragment\n0,2.5,1.1,1,zero\n1,.004,,-3.,\n", &plain),
        ("1,2.5\n-3,0.004\n", &plain),
        ("x,y\r\n1,2.5\r\n-3,4E-3", &plain),
        ("\u{feff}x,y\n1,2.5\n-3,4e-3\n", &plain),
        ("# by hand\n\nx,y\n\n1,2.5\n# more\n-3,4e-3\n\n", &plain),
        ("x;y\n1;2.5\n-3;+4e-3\n", &plain),
        ("x\ty\n1\t2.5\n-3\t4e-3\n", &plain),
        ("  1   2.5 \n-3 \t 4e-3\n", &plain),
        ("\"x\",\"y\"\n\"1\", 2.5\n -3 ,\"4e-3\"\n", &plain),
        ("name,x,y\n\"a, b\",1,2.5\n\"two\nlines\",-3,4e-3\n", &plain),
        ("x,y,vx\n1,2.5,7\n-3,4e-3,9\n", &plain),
        ("x,y,z\n1,2.5,0\n-3,4e-3,-0.0\n", &plain),
        ("vy,y,x,VX\n8,2.5,1,7\n-1,4e-3,-3,9\n", &moving),
        ("x,y,z,vx,vy,vz\n1,2.5,0,7,8,0\n-3,4e-3,0,9,-1,0\n", &moving),
        ("mass,x,y\n0.5,1,2.5\n2,-3,4e-3\n", &heavy),
    ];
    for (text, expected) in table {
        let (_directory, path) = file("points.csv", text);
        assert_eq!(
            &read::<2>(&path).unwrap_or_else(|error| panic!("{text:?}: {error}")),
            expected,
            "{text:?}"
        );
        assert_eq!(dimension(&path).unwrap(), 2, "{text:?}");
    }
    let (_directory, path) = file("points.csv", "1 2 3\n4 5 6\n");
    assert_eq!(
        read::<3>(&path).unwrap().positions,
        [Vector::<f64, 3>::new(1.0, 2.0, 3.0), Vector::<f64, 3>::new(4.0, 5.0, 6.0)]
    );
}

/// A header with every type, lists before and after the points, and the coordinates out of order.
const VARIED: &str = "obj_info by hand\ncomment three elements\nelement face 2\nproperty list uchar int vertex_indices\n\
    property uchar red\nelement material 0\nelement vertex 2\nproperty short y\nproperty list ushort double weights\n\
    property double X\nproperty uint id\nproperty float z\nproperty char vx\nproperty uchar vy\nproperty int8 vz\n\
    element edge 1\nproperty int vertex1\nend_header\n";

pub fn varied_binary(big: bool) -> Vec<u8> {
    let name = if big { "big" } else { "little" };
    let mut bytes = format!("ply\r\nformat binary_{name}_endian 1.0\r\n{VARIED}").into_bytes();
    let mut put = |little: &[u8]| match big {
        true => bytes.extend(little.iter().rev()),
        false => bytes.extend(little),
    };
    for face in [&[0i32, 1, 1][..], &[]] {
        put(&[face.len() as u8]);
        face.iter().for_each(|index| put(&index.to_le_bytes()));
        put(&[255]);
    }
    for (y, weights, x, id, z, v) in
        [(-300i16, &[0.5f64, 0.25][..], 0.1f64, u32::MAX, 0.75f32, -7i8), (2, &[], -1e-3, 1, -2.5, 7)]
    {
        put(&y.to_le_bytes());
        put(&(weights.len() as u16).to_le_bytes());
        weights.iter().for_each(|weight| put(&weight.to_le_bytes()));
        put(&x.to_le_bytes());
        put(&id.to_le_bytes());
        put(&z.to_le_bytes());
        put(&v.to_le_bytes());
        put(&[200]);
        put(&v.to_le_bytes());
    }
    put(&9i32.to_le_bytes());
    bytes
}

pub fn varied_ascii() -> Vec<u8> {
    let data =
        "3 0 1 1 255\n0 255\n-300 2 0.5 0.25 0.1 4294967295 0.75 -7 200 -7\n2 0 -1e-3 1 -2.5 7 200 7\n9\n";
    format!("ply\nformat ascii 1.0\n{VARIED}{data}").into_bytes()
}

#[test]
fn ply_is_read_in_each_encoding_with_every_type_and_whatever_else_it_holds() {
    let expected = PointCloud {
        positions: vec![Vector::<f64, 3>::new(0.1, -300.0, 0.75), Vector::<f64, 3>::new(-1e-3, 2.0, -2.5)],
        velocities: Some(vec![
            Vector::<f64, 3>::new(-7.0, 200.0, -7.0),
            Vector::<f64, 3>::new(7.0, 200.0, 7.0),
        ]),
        ..PointCloud::default()
    };
    for bytes in [varied_ascii(), varied_binary(false), varied_binary(true)] {
        let (_directory, path) = file("points.ply", bytes);
        assert_eq!(read::<3>(&path).unwrap(), expected);
        assert_eq!(dimension(&path).unwrap(), 3);
    }
}

#[test]
fn points_are_3d_where_some_z_is_not_0() {
    let ply = |z: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
             end_header\n1 2 {z}\n3 4 {z}\n"
        )
    };
    let csv = |z: &str| format!("x,y,z\n1,2,{z}\n3,4,{z}\n");
    for (z, expected) in [("0", 2), ("-0.0", 2), ("0.5", 3), ("1e-300", 3)] {
        for (name, text) in [("points.ply", ply(z)), ("points.csv", csv(z))] {
            let (_directory, path) = file(name, text);
            assert_eq!(dimension(&path).unwrap(), expected, "{name} {z}");
            assert_eq!(read::<2>(&path).is_ok(), expected == 2, "{name} {z}");
            let any = read_any(&path).unwrap();
            assert_eq!(matches!(any, AnyPointCloud::Two(_)), expected == 2, "{name} {z}");
            assert_eq!(read::<3>(&path).unwrap().positions.len(), 2, "{name} {z}");
        }
    }
    let (_directory, path) = file("points.csv", "x,y,z,vx,vy,vz\n1,2,0,0,0,0\n3,4,0,0,0,1\n");
    assert_eq!(dimension(&path).unwrap(), 3, "what leaves the plane is not 2D");
}

#[test]
fn what_could_not_be_read_back_is_not_written() {
    let good = Vector::<f64, 2>::new(1.0, 2.0);
    let cloud = |positions: &[_]| PointCloud { positions: positions.to_vec(), ..PointCloud::default() };
    let table = [
        (cloud(&[good, Vector::<f64, 2>::new(0.0, f64::NAN)]), "point 1 (from 0): `y` is NaN"),
        (
            PointCloud {
                velocities: Some(vec![Vector::<f64, 2>::new(f64::INFINITY, 0.0)]),
                ..cloud(&[good])
            },
            "point 0 (from 0): `vx` is inf",
        ),
        (PointCloud { masses: Some(vec![0.0]), ..cloud(&[good]) }, "point 0 (from 0): `mass` is 0.0"),
        (PointCloud { masses: Some(vec![]), ..cloud(&[good]) }, "1 points but 0 masses; give one per point"),
        (PointCloud { velocities: Some(vec![good; 2]), ..cloud(&[good]) }, "1 points but 2 velocities"),
        (PointCloud { plastic_ratios: Some(vec![-1.0]), ..cloud(&[good]) }, "point 0 (from 0): `jp` is -1.0"),
        (PointCloud { deformations: Some(vec![]), ..cloud(&[good]) }, "1 points but 0 deformations"),
        (
            PointCloud { deformations: Some(vec![Matrix::repeat(f64::NAN)]), ..cloud(&[good]) },
            "point 0 (from 0): `fxx` is NaN",
        ),
    ];
    let directory = tempfile::tempdir().unwrap();
    for name in ["a.csv", "a.ply"] {
        for (cloud, part) in &table {
            let path = directory.path().join(name);
            let message = write_cloud(&path, cloud).unwrap_err().to_string();
            assert!(message.contains(part), "{message:?} lacks {part:?}");
            assert!(!path.exists(), "a refused cloud leaves no file");
        }
    }
}
