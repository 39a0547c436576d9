//! What is seen of a run: from where, and of each frame the particles and obstacles in the plane of the picture.

mod light;
mod outline;
mod seen;
mod viewpoint;

pub use outline::outline;
pub use seen::{Instant, Seen};
pub use viewpoint::Viewpoint;
