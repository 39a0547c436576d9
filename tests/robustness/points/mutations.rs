//! Valid files, changed at random.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use snowlab_study::points::{dimension, read};

use super::{varied_ascii, varied_binary};
use crate::hostile::bytes::mutated;

#[test]
fn no_mutation_of_a_valid_file_panics_or_lets_a_bad_point_through() {
    let csv = b"id,y,x,z,vx,vy,vz,mass\n0,1.5,2,0,1,2,3,1\n1,-1e-3,2.25,3,1,2,3,0.5\n".to_vec();
    let quoted = b"\"name\";\"x\";\"y\"\r\n\"a;b\";1;2\r\n# no\r\nc;3;-4.5\r\n".to_vec();
    let valid = [
        ("a.csv", csv),
        ("a.csv", quoted),
        ("a.csv", b"0.5 0.25\n-1 2e3\n".to_vec()),
        ("a.ply", varied_ascii()),
        ("a.ply", varied_binary(false)),
        ("a.ply", varied_binary(true)),
    ];
    let directory = tempfile::tempdir().unwrap();
    for (kind, (name, valid)) in valid.iter().enumerate() {
        let path = directory.path().join(name);
        let mut random = ChaCha8Rng::seed_from_u64(kind as u64);
        let mut taken = 0;
        const MUTATIONS: usize = 1000;
        for _ in 0..MUTATIONS {
            let bytes = mutated(valid, &[], &mut random);
            // A new file each time: some file systems wait for the disk where an old one is written over.
            let _ = std::fs::remove_file(&path);
            std::fs::write(&path, &bytes).unwrap();
            let in_plane = read::<2>(&path);
            if let Ok(cloud) = &in_plane {
                assert_eq!(dimension(&path).unwrap(), 2);
                assert!(cloud.positions.iter().all(|position| position.iter().all(|x| x.is_finite())));
            }
            match read::<3>(&path) {
                Ok(cloud) => {
                    let points = cloud.positions.len();
                    // The shortest point, "1 2\n", takes 4 bytes of text, and no type is shorter than one byte.
                    assert!(3 * points <= bytes.len(), "{points} points of {} bytes", bytes.len());
                    assert!(cloud.positions.iter().all(|position| position.iter().all(|x| x.is_finite())));
                    assert!(cloud.velocities.is_none_or(|rows| {
                        rows.len() == points && rows.iter().all(|row| row.iter().all(|x| x.is_finite()))
                    }));
                    assert!(
                        cloud.masses.is_none_or(|rows| rows.len() == points && rows.iter().all(|&m| m > 0.0))
                    );
                    taken += 1;
                }
                Err(error) => {
                    let message = error.to_string();
                    assert!(message.starts_with(path.to_str().unwrap()), "{message}");
                    assert!(message.len() < 600 && !message.contains('\n'), "{message}");
                    taken += usize::from(in_plane.is_ok());
                }
            }
        }
        assert!(
            (MUTATIONS / 50..MUTATIONS * 49 / 50).contains(&taken),
            "file {kind}: {taken} taken: no test"
        );
    }
}
