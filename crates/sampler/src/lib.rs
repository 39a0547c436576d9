//! Placements of material points and void fields for the snowlab.
//!
//! A [`Region`] says where the material is, a [`VoidField`] what is missing from it, a [`Sampler`] how the
//! points are laid; [`place`] returns exactly the number asked for. All coordinates are in metres, all numbers
//! `f64`, `D` is 2 or 3, and the same seed gives the same bits on every machine: transcendental functions come
//! from `libm`, random numbers from named ChaCha8 [`Streams`].
//!
//! ```
//! use snowlab_sampler::{InclusionField, Region, Sampler, Streams, VoidField, draw_voids, place};
//! use snowlab_solver::geometry::Vector;
//!
//! # fn main() -> Result<(), snowlab_sampler::SamplerError> {
//! let (spacing, streams) = (0.0072, Streams::new(1));
//! let ball: Region<2> = Region::Ball { centre: Vector::<f64, 2>::zeros(), radius: 0.25 };
//! let voids = draw_voids(&ball, &VoidField::Inclusions(InclusionField::circles(spacing)), spacing, &streams)?;
//! let placement = place(&ball, &Sampler::Random, Some(&voids), 5_000, &streams)?;
//! assert_eq!(placement.positions.len(), 5_000);
//! assert!((voids.porosity - 0.15).abs() < 0.01 * 0.15);
//! # Ok(())
//! # }
//! ```

mod directions;
mod domain;
mod draw;
mod drawn_voids;
mod error;
mod gaussian_field;
mod heterogeneity;
mod inclusion;
mod inclusion_layout;
mod jittered;
mod lattice;
mod level_cut;
mod mesh;
mod neighbours;
mod place;
mod poisson_disk;
pub mod quality;
mod random;
mod raster;
mod region;
pub mod rng;
mod void_acceptance;
mod void_field;

pub use directions::{lattice_rotation, rotation};
pub use draw::draw_voids;
pub use drawn_voids::{DrawnVoids, Rejections};
pub use error::SamplerError;
pub use gaussian_field::PlaneWaves;
pub use heterogeneity::Heterogeneity;
pub use mesh::{MOST_TRIANGLES, Mesh, PlacedMesh};
pub use place::{LATTICE_ANGLE, MOST_PARTICLES, Placement, Sampler, place};
pub use region::Region;
pub use rng::{Purpose, Streams};
pub use void_field::{GaussianField, InclusionField, InclusionShape, Orientation, VoidField};
