//! Closed surfaces of triangles whose solids are known.

use std::collections::BTreeMap;

use snowlab_solver::geometry::Vector;

pub type Point = Vector<f64, 3>;

/// Vertices, and triangles of their numbers, anticlockwise from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    pub vertices: Vec<Point>,
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// Each vertex where `map` takes it.
    pub fn mapped(&self, map: impl Fn(&Point) -> Point) -> Self {
        Shape { vertices: self.vertices.iter().map(map).collect(), triangles: self.triangles.clone() }
    }

    /// Facing the other way.
    pub fn turned(&self) -> Self {
        let triangles = self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        Shape { vertices: self.vertices.clone(), triangles }
    }

    /// Both surfaces, each with its own vertices.
    pub fn and(&self, other: &Self) -> Self {
        let before = self.vertices.len() as u32;
        let others = other.triangles.iter().map(|corners| corners.map(|corner| corner + before));
        Shape {
            vertices: [&self.vertices[..], &other.vertices[..]].concat(),
            triangles: self.triangles.iter().copied().chain(others).collect(),
        }
    }

    /// Distance of the nearest plane of a triangle from the origin.
    pub fn inner_radius(&self) -> f64 {
        let of = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| self.vertices[corner as usize]);
            let normal = (b - a).cross(&(c - a));
            normal.dot(&a) / normal.norm()
        };
        self.triangles.iter().map(of).fold(f64::INFINITY, f64::min)
    }
}

/// The cube from -1 to 1.
pub fn cube() -> Shape {
    let corner = |k: u32, bit: u32| if k & bit == 0 { -1.0 } else { 1.0 };
    let vertices = (0..8).map(|k| Point::new(corner(k, 1), corner(k, 2), corner(k, 4))).collect();
    let faces: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Shape { vertices, triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect() }
}

/// The unit ball, inscribed: an icosahedron whose triangles are cut in four `cuts` times, 20 x 4^cuts of them.
pub fn icosphere(cuts: u32) -> Shape {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let signs = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
    let mut vertices: Vec<Point> = signs
        .iter()
        .flat_map(|&(s, t)| {
            let (one, other) = (s, t * golden);
            [Point::new(0.0, one, other), Point::new(one, other, 0.0), Point::new(other, 0.0, one)]
        })
        .collect();
    vertices.iter_mut().for_each(|vertex| *vertex /= vertex.norm());
    let mut triangles = hull_of_icosahedron(&vertices);
    for _ in 0..cuts {
        let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let sum = vertices[a as usize] + vertices[b as usize];
                vertices.push(sum / sum.norm());
                vertices.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    Shape { vertices, triangles }
}

/// Each three vertices as near to each other as any are a face.
fn hull_of_icosahedron(vertices: &[Point]) -> Vec<[u32; 3]> {
    let edge = (vertices[0] - vertices[1]).norm().min((vertices[0] - vertices[3]).norm());
    let near = |a: usize, b: usize| (vertices[a] - vertices[b]).norm() < 1.1 * edge;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in (a + 1..12).filter(|&b| near(a, b)) {
            for c in (b + 1..12).filter(|&c| near(a, c) && near(b, c)) {
                let outwards = vertices[a].dot(&vertices[b].cross(&vertices[c])) > 0.0;
                faces.push(if outwards { [a, b, c] } else { [a, c, b] }.map(|corner| corner as u32));
            }
        }
    }
    assert_eq!(faces.len(), 20);
    faces
}
