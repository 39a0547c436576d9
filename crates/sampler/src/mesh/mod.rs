//! Solids bounded by triangles.
//!
//! A point is inside where the surface winds round it at least once: overlapping parts are one solid, and a part that
//! faces inwards within another is a cavity. The winding number is counted along a vertical ray by the exact signs of
//! Shewchuk (1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates"), and ties are
//! broken as if the point were shifted by (e_x, e_y, e_z) with e_z >> e_x >> e_y > 0 (Edelsbrunner and Mücke 1990,
//! "Simulation of Simplicity"): a ray through an edge or a vertex passes exactly one of the triangles that meet there,
//! so that nothing leaks. Points exactly on the surface are inside or outside as their shifted images are.

mod closed;
mod columns;
mod placed;
mod tree;
mod triangle;

use snowlab_solver::geometry::{Aabb, Vector};

use crate::error::{SamplerError, require};

pub use placed::PlacedMesh;
use tree::Tree;
use triangle::Triangle;

/// Most triangles of a mesh. Chosen: some 200 MB, up to five times as much while it is read, and far more than sampling
/// resolves.
pub const MOST_TRIANGLES: usize = 2_000_000;
/// Largest coordinate in the mesh's own units. Chosen: a kilometre in micrometres.
const LARGEST: f64 = 1e9;
/// Smallest of its longest sides. Chosen: far below any unit in use, and products of three do not underflow.
const SMALLEST: f64 = 1e-9;
/// Share of the volume that may be enclosed the wrong way round. Chosen: folds where polygons that are not flat were cut
/// into triangles are thinner, parts that face inwards are not.
const MOST_INSIDE_OUT: f64 = 1e-3;

type Point = Vector<f64, 3>;

/// A closed surface of triangles, in units of its own, with a tree to find them by.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    tree: Tree,
    volume: f64,
}

impl Mesh {
    /// The solid within `triangles`, each of three numbers of `vertices` (shape `[n]`, coordinates in any one unit),
    /// anticlockwise as seen from outside. A surface that faces inwards as a whole is turned round.
    ///
    /// # Errors
    /// [`SamplerError::CountOutOfRange`] without triangles or with more than [`MOST_TRIANGLES`],
    /// [`SamplerError::OutOfRange`] for a coordinate or extent, [`SamplerError::NoSuchVertex`],
    /// [`SamplerError::OpenMesh`], [`SamplerError::FlatMesh`], [`SamplerError::MeshInsideOut`].
    pub fn new(vertices: &[Point], triangles: &[[u32; 3]]) -> Result<Self, SamplerError> {
        if !(1..=MOST_TRIANGLES).contains(&triangles.len()) {
            let name = "number of triangles of the mesh";
            let value = triangles.len();
            return Err(SamplerError::CountOutOfRange { name, value, least: 1, most: MOST_TRIANGLES });
        }
        for &coordinate in vertices.iter().flatten() {
            require(coordinate.abs() <= LARGEST, "a coordinate of the mesh", coordinate, "-1e9 to 1e9")?;
        }
        let corners = triangles.iter().enumerate().map(|(number, corners)| at(vertices, number, corners));
        let mut corners = corners.collect::<Result<Vec<_>, _>>()?;
        closed::check(vertices, triangles)?;
        let volume = enclosed(&corners);
        if volume < 0.0 {
            corners.iter_mut().for_each(Triangle::turn);
        }
        let mut mesh = Self { tree: Tree::new(corners), volume: volume.abs() };
        let sides = mesh.bounds().max - mesh.bounds().min;
        require(sides.max() >= SMALLEST, "longest side of the mesh", sides.max(), "1e-9 or more")?;
        mesh.settle_overlaps()?;
        // Rounding of the sum leaves this much of a flat sheet (chosen: far below any solid).
        if !(mesh.volume > 1e-12 * sides.max().powi(3)) {
            return Err(SamplerError::FlatMesh);
        }
        Ok(mesh)
    }

    /// Takes what the surface encloses more than once, or the wrong way round, out of the volume.
    fn settle_overlaps(&mut self) -> Result<(), SamplerError> {
        let found = columns::measure(&self.tree);
        if found.inside_out > MOST_INSIDE_OUT * self.volume {
            let share = found.inside_out / self.volume;
            return Err(SamplerError::MeshInsideOut { share, at: found.at.into() });
        }
        self.volume -= found.excess;
        Ok(())
    }

    /// Whether the solid holds `point`.
    pub fn contains(&self, point: &Point) -> bool {
        self.tree.winding(point) >= 1
    }

    /// Distance from `point` to the nearest triangle.
    pub fn distance(&self, point: &Point) -> f64 {
        self.tree.squared_distance(point).sqrt()
    }

    /// Volume: by the divergence theorem, sum of a . (b x c) / 6 over the triangles abc (Gauss); what parts have in
    /// common counts once, measured along 256 x 256 vertical lines.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The smallest box about it along the axes.
    pub fn bounds(&self) -> Aabb<3> {
        self.tree.bounds()
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.tree.triangles().len()
    }
}

fn at(vertices: &[Point], triangle: usize, corners: &[u32; 3]) -> Result<Triangle, SamplerError> {
    let [a, b, c] = corners.map(|corner| {
        let missing = SamplerError::NoSuchVertex { triangle, vertex: corner, vertices: vertices.len() };
        vertices.get(corner as usize).copied().ok_or(missing)
    });
    Ok(Triangle([a?, b?, c?]))
}

/// Signed volume within closed triangles, from one of their corners for the sake of rounding.
fn enclosed(triangles: &[Triangle]) -> f64 {
    let origin = triangles[0].0[0];
    triangles.iter().map(|triangle| triangle.cone(&origin)).sum()
}
