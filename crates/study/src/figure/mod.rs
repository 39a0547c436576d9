//! Figures, from plain numbers to PNG.
//!
//! A function per kind of figure takes slices and names and returns a [`Drawing`]: a value which [`Drawing::png`]
//! paints. The charts are plotters' own: [`Drawing`] is a plotters backend that keeps marks instead of pixels, axes
//! and meshes come from its chart builder, and curves, bands, bars and points are its elements. Nothing here reads a file, knows a study or runs a case. Data that is missing or not finite leaves a note
//! in the panel; data that contradicts itself is a [`FigureError`].

pub mod axis;
mod backend;
pub mod curves;
pub mod drawing;
mod encode;
pub mod energy;
mod error;
pub mod forest;
pub mod gif;
pub mod moment;
pub mod moving;
pub mod outcomes;
mod panel;
pub mod pilot;
mod raster;
mod sheet;
pub mod sizes;
pub mod snowballs;
mod solids;
mod splats;
pub mod strips;
pub mod style;
pub mod text;
mod window;

pub use drawing::Drawing;
pub use error::FigureError;
pub use raster::Image;
