//! Where the camera stands.

use serde::Serialize;
use snowlab_solver::Vector;

use crate::view::Viewpoint;

/// Angle of view across the picture's width [degrees] (chosen: that of a 50 mm lens on 36 mm film is 40).
const FIELD_OF_VIEW: f64 = 38.0;
/// Room round what is looked at (chosen: pieces at the edge stay whole).
const ROOM: f64 = 1.04;

/// A camera.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Camera {
    /// Where it stands [m].
    pub origin: [f64; 3],
    /// What it looks at [m].
    pub target: [f64; 3],
    /// What is up.
    pub up: [f64; 3],
    /// Angle across the picture's width [degrees].
    pub field_of_view: f64,
}

impl Camera {
    /// The one that has all of a view in a picture so many times as wide as high.
    pub fn of(view: &Viewpoint, aspect: f64) -> Self {
        let half_width = libm::tan(0.5 * FIELD_OF_VIEW.to_radians());
        let reach = |corner: &Vector<f64, 3>| {
            let [right, upright, near] = view.seen(corner).into();
            near + right.abs().max(aspect * upright.abs()) / half_width
        };
        let corners = view.corners();
        let distance = ROOM * corners.iter().map(reach).fold(0.0, f64::max).max(view.radius());
        Camera {
            origin: (view.centre + distance * view.towards).into(),
            target: view.centre.into(),
            up: view.up.into(),
            field_of_view: FIELD_OF_VIEW,
        }
    }
}
