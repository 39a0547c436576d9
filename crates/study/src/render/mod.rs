//! Pictures of snow in space by Mitsuba 3 (Jakob et al. 2022), as in PS17's section 3: the density on a grid as a volume, and on top of it the individual particles.
//!
//! Mitsuba is not part of the program. It is driven through Python: a scene file, a mesh of grains and a grid volume a picture.

mod camera;
mod grains;
mod mitsuba;
mod picture;

pub use camera::Camera;
pub use mitsuba::{Mitsuba, MitsubaError};
pub use picture::{Picture, Preset, RenderError};
