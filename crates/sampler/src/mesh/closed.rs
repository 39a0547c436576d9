//! Whether triangles close: every edge is passed as often in one direction as in the other.

use crate::error::SamplerError;

use super::Point;

/// # Errors
/// [`SamplerError::OpenMesh`], with the edges that do not, and where the first of them is.
pub fn check(vertices: &[Point], triangles: &[[u32; 3]]) -> Result<(), SamplerError> {
    let mut passes: Vec<(u32, u32, bool)> = triangles.iter().flat_map(|corners| edges(*corners)).collect();
    passes.sort_unstable();
    let (mut open, mut crowded, mut turned, mut first) = (0, 0, 0, None);
    for edge in passes.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let forwards = edge.iter().filter(|pass| pass.2).count();
        match (forwards, edge.len() - forwards) {
            (forwards, backwards) if forwards == backwards => continue,
            (1, 0) | (0, 1) => open += 1,
            (2, 0) | (0, 2) => turned += 1,
            _ => crowded += 1,
        }
        first = first.or(Some(edge[0]));
    }
    match first {
        None => Ok(()),
        Some((from, to, _)) => {
            let at = (vertices[from as usize] + vertices[to as usize]) * 0.5;
            Err(SamplerError::OpenMesh { open, crowded, turned, at: at.into() })
        }
    }
}

/// The edges of a triangle from the lower number to the higher, and whether it passes them so.
fn edges([a, b, c]: [u32; 3]) -> [(u32, u32, bool); 3] {
    [(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from < to))
}
