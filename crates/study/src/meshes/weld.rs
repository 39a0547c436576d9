//! Vertices at the same place become one.

use std::collections::HashMap;

use snowlab_solver::geometry::Vector;

use super::Soup;

/// Vertices are one where they are nearer than this share of the mesh's longest side. Chosen: above the rounding of
/// single precision and of six digits, far below any feature.
pub const WELD: f64 = 1e-6;
/// No vertex.
const NONE: u32 = u32::MAX;

/// Vertices that were met, each with the one before it in the same cell.
struct Cells {
    last: HashMap<[u32; 3], u32>,
    before: Vec<u32>,
}

/// The same triangles between fewer vertices: each vertex is the first that was near it. Triangles with two corners alike
/// are left out.
pub fn weld(soup: Soup) -> Soup {
    let nothing = (Vector::<f64, 3>::repeat(f64::INFINITY), Vector::<f64, 3>::repeat(f64::NEG_INFINITY));
    let (min, max) = soup.vertices.iter().fold(nothing, |(min, max), v| (min.inf(v), max.sup(v)));
    let near = (WELD * (max - min).max()).max(f64::MIN_POSITIVE);
    let mut cells = Cells { last: HashMap::new(), before: Vec::new() };
    let mut vertices: Vec<Vector<f64, 3>> = Vec::new();
    let numbers: Vec<u32> = soup
        .vertices
        .iter()
        .map(|vertex| {
            let cell = |shift: f64| (vertex - min).map(|c| ((c + shift) / (2.0 * near)).max(0.0) as u32);
            let is_near = |&other: &u32| (vertices[other as usize] - vertex).norm() <= near;
            let found = cells.around(cell(-near), cell(near)).filter(is_near).min();
            found.unwrap_or_else(|| {
                vertices.push(*vertex);
                cells.add(cell(0.0))
            })
        })
        .collect();
    let corners = soup.triangles.iter().map(|corners| corners.map(|corner| numbers[corner as usize]));
    let triangles = corners.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    Soup { vertices, triangles }
}

impl Cells {
    /// The next vertex, in a cell.
    fn add(&mut self, cell: Vector<u32, 3>) -> u32 {
        let number = self.before.len() as u32;
        self.before.push(self.last.insert(cell.into(), number).unwrap_or(NONE));
        number
    }

    /// Vertices in the cells from one to another.
    fn around(&self, from: Vector<u32, 3>, to: Vector<u32, 3>) -> impl Iterator<Item = u32> {
        let cells = (from.x..=to.x)
            .flat_map(move |x| (from.y..=to.y).flat_map(move |y| (from.z..=to.z).map(move |z| [x, y, z])));
        let last = cells.filter_map(|cell| self.last.get(&cell).copied());
        last.flat_map(|last| {
            let before = |&number: &u32| Some(self.before[number as usize]).filter(|before| *before != NONE);
            std::iter::successors(Some(last), before)
        })
    }
}
