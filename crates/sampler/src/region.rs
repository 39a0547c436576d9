//! Where material is: balls, boxes, ellipsoids, meshes, unions and differences.

use std::f64::consts::PI;

use snowlab_solver::geometry::{Aabb, Matrix, Vector};

use crate::error::{SamplerError, require};
use crate::mesh::PlacedMesh;

/// Largest number of cells a volume is counted on. Chosen: a few seconds at most.
const MOST_CELLS: f64 = 2e8;
/// Deepest nesting of unions and differences. Chosen: far beyond any scene, far below the stack.
const MOST_LEVELS: usize = 32;

/// A set of points, in 2D or 3D; lengths in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Region<const D: usize> {
    /// A disc or ball.
    Ball {
        /// Centre [m].
        centre: Vector<f64, D>,
        /// Radius [m].
        radius: f64,
    },
    /// A rectangle or cuboid.
    Box {
        /// Centre [m].
        centre: Vector<f64, D>,
        /// Half the side along each of its own axes [m].
        half_extent: Vector<f64, D>,
        /// Its own axes, as orthonormal columns.
        orientation: Matrix<f64, D>,
    },
    /// An ellipse or ellipsoid.
    Ellipsoid {
        /// Centre [m].
        centre: Vector<f64, D>,
        /// Half the width along each of its own axes [m].
        semi_axes: Vector<f64, D>,
        /// Its own axes, as orthonormal columns.
        orientation: Matrix<f64, D>,
    },
    /// What a closed surface of triangles encloses, in 3D only.
    Mesh(PlacedMesh),
    /// Points in any of the parts.
    Union(Vec<Region<D>>),
    /// Points in `solid` but not in `removed`.
    Difference {
        /// What there is at first.
        solid: Box<Region<D>>,
        /// What is taken away.
        removed: Box<Region<D>>,
    },
}

impl<const D: usize> Region<D> {
    /// Whether `point` [m] belongs to the region, its surface included; of the surface of a mesh one side of each pair
    /// of faces is ([`Mesh`](crate::Mesh)).
    pub fn contains(&self, point: &Vector<f64, D>) -> bool {
        self.covers(point, true)
    }

    /// Whether `point` belongs to the region, with or without its `surface`.
    fn covers(&self, point: &Vector<f64, D>, surface: bool) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.contains(point),
            Self::Union(parts) => parts.iter().any(|part| part.covers(point, surface)),
            Self::Difference { solid, removed } => {
                solid.covers(point, surface) && !removed.covers(point, !surface)
            }
            Self::Ball { .. } | Self::Box { .. } | Self::Ellipsoid { .. } => {
                let depth = self.depth(point);
                depth > 0.0 || surface && depth == 0.0
            }
        }
    }

    /// How far `point` lies below the surface [m], negative outside: the distance to the surface for the inside of
    /// balls, boxes and meshes of one part, a lower bound of it for the inside of everything else. Zero exactly on the
    /// surface.
    pub fn depth(&self, point: &Vector<f64, D>) -> f64 {
        match self {
            Self::Ball { centre, radius } => radius - (point - centre).norm(),
            Self::Box { centre, half_extent, orientation } => {
                let local = orientation.tr_mul(&(point - centre));
                (half_extent - local.abs()).min()
            }
            Self::Ellipsoid { centre, semi_axes, orientation } => {
                let local = orientation.tr_mul(&(point - centre));
                semi_axes.min() * (1.0 - local.component_div(semi_axes).norm())
            }
            Self::Mesh(mesh) => mesh.depth(point),
            Self::Union(parts) => {
                parts.iter().map(|part| part.depth(point)).fold(f64::NEG_INFINITY, f64::max)
            }
            Self::Difference { solid, removed } => solid.depth(point).min(-removed.depth(point)),
        }
    }

    /// The smallest axis-aligned box about the region [m]; of a difference, the box of its `solid`.
    pub fn bounding_box(&self) -> Aabb<D> {
        let around = |centre: &Vector<f64, D>, reach: Vector<f64, D>| Aabb {
            min: centre - reach,
            max: centre + reach,
        };
        match self {
            Self::Ball { centre, radius } => around(centre, Vector::<f64, D>::repeat(*radius)),
            Self::Box { centre, half_extent, orientation } => around(centre, orientation.abs() * half_extent),
            Self::Ellipsoid { centre, semi_axes, orientation } => {
                let scaled =
                    Matrix::<f64, D>::from_fn(|row, column| orientation[(row, column)] * semi_axes[column]);
                around(centre, Vector::<f64, D>::from_fn(|row, _| scaled.row(row).norm()))
            }
            Self::Mesh(mesh) => {
                let Aabb { min, max } = mesh.bounds();
                let own = |corner: Vector<f64, 3>| Vector::<f64, D>::from_fn(|axis, _| corner[axis]);
                Aabb { min: own(min), max: own(max) }
            }
            Self::Union(parts) => {
                let nothing = Aabb {
                    min: Vector::<f64, D>::repeat(f64::INFINITY),
                    max: Vector::<f64, D>::repeat(f64::NEG_INFINITY),
                };
                parts.iter().map(Self::bounding_box).fold(nothing, |all, part| Aabb {
                    min: all.min.inf(&part.min),
                    max: all.max.sup(&part.max),
                })
            }
            Self::Difference { solid, .. } => solid.bounding_box(),
        }
    }

    /// Area or volume [m^D]: in closed form for the primitives, else counted at the centres of cells of side
    /// `raster` [m].
    ///
    /// # Errors
    /// [`SamplerError::OutOfRange`] for a raster that is not positive, [`SamplerError::RasterTooFine`], and
    /// whatever [`Region::validate`] finds.
    pub fn volume(&self, raster: f64) -> Result<f64, SamplerError> {
        self.validate()?;
        require(raster > 0.0, "raster [m]", raster, "above 0")?;
        let unit_ball = if D == 2 { PI } else { 4.0 / 3.0 * PI };
        match self {
            Self::Ball { radius, .. } => Ok(unit_ball * (0..D).map(|_| radius).product::<f64>()),
            Self::Box { half_extent, .. } => Ok(half_extent.map(|half| 2.0 * half).product()),
            Self::Ellipsoid { semi_axes, .. } => Ok(unit_ball * semi_axes.product()),
            Self::Mesh(mesh) => Ok(mesh.volume()),
            Self::Union(_) | Self::Difference { .. } => self.counted_volume(raster),
        }
    }

    /// A raster fine enough for [`Region::volume`] of a composite region [m]: the longest side of the bounding box
    /// over 1024 in 2D and over 128 in 3D (chosen: one to two million cells, errors near 1e-4).
    pub fn volume_raster(&self) -> f64 {
        let bounds = self.bounding_box();
        (bounds.max - bounds.min).max() / if D == 2 { 1024.0 } else { 128.0 }
    }

    fn counted_volume(&self, raster: f64) -> Result<f64, SamplerError> {
        let bounds = self.bounding_box();
        let shape = (bounds.max - bounds.min).map(|side| (side / raster).ceil().max(1.0));
        let cells = shape.product();
        if cells > MOST_CELLS {
            return Err(SamplerError::RasterTooFine { cell: raster, cells, most: MOST_CELLS });
        }
        let mut inside = 0_u64;
        let mut index = Vector::<f64, D>::zeros();
        for _ in 0..cells as u64 {
            let centre = bounds.min + index.map(|step| (step + 0.5) * raster);
            inside += u64::from(self.contains(&centre));
            for axis in 0..D {
                index[axis] += 1.0;
                if index[axis] < shape[axis] {
                    break;
                }
                index[axis] = 0.0;
            }
        }
        Ok(inside as f64 * (0..D).map(|_| raster).product::<f64>())
    }

    /// Checks every number of the region.
    ///
    /// # Errors
    /// [`SamplerError::OutOfRange`] for a length that is not positive or a coordinate that is not finite,
    /// [`SamplerError::Orientation`], [`SamplerError::MeshInPlane`], [`SamplerError::EmptyUnion`],
    /// [`SamplerError::NestedTooDeep`].
    pub fn validate(&self) -> Result<(), SamplerError> {
        self.validate_level(1)
    }

    fn validate_level(&self, level: usize) -> Result<(), SamplerError> {
        const { assert!(D == 2 || D == 3, "regions have two or three dimensions") };
        if level > MOST_LEVELS {
            return Err(SamplerError::NestedTooDeep { depth: level, most: MOST_LEVELS });
        }
        match self {
            Self::Ball { centre, radius } => {
                finite("centre of a ball [m]", centre)?;
                positive("radius of a ball [m]", *radius)
            }
            Self::Box { centre, half_extent, orientation } => {
                finite("centre of a box [m]", centre)?;
                half_extent.iter().try_for_each(|&half| positive("half extent of a box [m]", half))?;
                orthonormal("box", orientation)
            }
            Self::Ellipsoid { centre, semi_axes, orientation } => {
                finite("centre of an ellipsoid [m]", centre)?;
                semi_axes.iter().try_for_each(|&axis| positive("semi-axis of an ellipsoid [m]", axis))?;
                orthonormal("ellipsoid", orientation)
            }
            // It was checked when it was made.
            Self::Mesh(_) if D == 3 => Ok(()),
            Self::Mesh(_) => Err(SamplerError::MeshInPlane),
            Self::Union(parts) if parts.is_empty() => Err(SamplerError::EmptyUnion),
            Self::Union(parts) => parts.iter().try_for_each(|part| part.validate_level(level + 1)),
            Self::Difference { solid, removed } => {
                solid.validate_level(level + 1)?;
                removed.validate_level(level + 1)
            }
        }
    }
}

/// Chosen: a kilometre-sized scene is far beyond snow in a laboratory, and squares stay far from overflow.
fn positive(name: &'static str, value: f64) -> Result<(), SamplerError> {
    require(value > 0.0 && value <= 1e6, name, value, "above 0, at most 1e6")
}

fn finite<const D: usize>(name: &'static str, centre: &Vector<f64, D>) -> Result<(), SamplerError> {
    centre.iter().try_for_each(|&value| require(value.abs() <= 1e6, name, value, "-1e6 to 1e6"))
}

pub(crate) fn orthonormal<const D: usize>(
    shape: &'static str,
    axes: &Matrix<f64, D>,
) -> Result<(), SamplerError> {
    let defect = (axes.tr_mul(axes) - Matrix::<f64, D>::identity()).abs().max();
    if axes.iter().all(|entry| entry.is_finite()) && defect <= 1e-9 {
        Ok(())
    } else {
        Err(SamplerError::Orientation { shape, defect })
    }
}
