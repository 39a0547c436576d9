//! Figures, from plain numbers to PNG.
//!
//! A function per kind of figure takes slices and names and returns a [`Drawing`]: a value which [`Drawing::png`]
//! paints. Nothing here reads a file, knows a study or runs a case. Data that is missing or not finite leaves a note
//! in the panel; data that contradicts itself is a [`FigureError`].

pub mod axis;
pub mod curves;
pub mod drawing;
pub mod energy;
mod error;
pub mod forest;
pub mod panel;
pub mod pilot;
mod raster;
pub mod sizes;
pub mod snowballs;
pub mod strips;
pub mod style;
pub mod text;

pub use drawing::Drawing;
pub use error::FigureError;
pub use raster::Image;
