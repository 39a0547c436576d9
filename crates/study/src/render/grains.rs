//! Particles as one mesh of icosahedra: Mitsuba's plugin for many ellipsoids is wrong for small radii, and one mesh of two million triangles is loaded in seconds.

use std::io::{self, Write};

use crate::export::Snapshot;

/// The golden ratio: an icosahedron has its corners at the cyclic permutations of (0, +-1, +-phi).
const PHI: f64 = 1.618_033_988_749_895;
const CORNERS: [[f64; 3]; 12] = [
    [-1.0, PHI, 0.0],
    [1.0, PHI, 0.0],
    [-1.0, -PHI, 0.0],
    [1.0, -PHI, 0.0],
    [0.0, -1.0, PHI],
    [0.0, 1.0, PHI],
    [0.0, -1.0, -PHI],
    [0.0, 1.0, -PHI],
    [PHI, 0.0, -1.0],
    [PHI, 0.0, 1.0],
    [-PHI, 0.0, -1.0],
    [-PHI, 0.0, 1.0],
];
/// Corners of the faces, against the clock seen from outside.
const FACES: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// Writes grains of this radius [m] as binary PLY with faces.
pub fn write(file: &mut dyn Write, snapshot: &Snapshot, radius: f64) -> io::Result<()> {
    let count = snapshot.positions.len();
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        count * CORNERS.len(),
        count * FACES.len()
    )?;
    let size = radius / (1.0 + PHI * PHI).sqrt();
    for position in &snapshot.positions {
        for corner in &CORNERS {
            for k in 0..3 {
                file.write_all(&((position[k] + size * corner[k]) as f32).to_le_bytes())?;
            }
        }
    }
    for grain in 0..count {
        for face in &FACES {
            file.write_all(&[3])?;
            for corner in face {
                file.write_all(&((grain * CORNERS.len()) as u32 + corner).to_le_bytes())?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The faces close a body: every edge is there once in each direction, and all turn outward.
    #[test]
    fn an_icosahedron_is_closed_and_turned_outward() {
        let mut edges: Vec<(u32, u32)> =
            FACES.iter().flat_map(|f| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])]).collect();
        edges.sort_unstable();
        edges.dedup();
        assert_eq!(edges.len(), 60);
        assert!(edges.iter().all(|(a, b)| edges.contains(&(*b, *a))));
        for face in FACES {
            let [a, b, c] = face.map(|n| nalgebra::Vector3::from(CORNERS[n as usize]));
            assert!((b - a).cross(&(c - a)).dot(&a) > 0.0);
            assert!(((b - a).norm() - 2.0).abs() < 1e-12, "edges of length 2");
        }
    }
}
