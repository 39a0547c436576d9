//! Where the camera and the light stand.

use serde::Serialize;

use snowlab_solver::Vector;

use crate::export::Snapshot;
use crate::spec::SceneSpec;
use crate::spec::scene::SolidSpec;

type Point = Vector<f64, 3>;

/// Angle of view across the picture's width [degrees] (chosen: that of a 50 mm lens on 36 mm film is 40).
const FIELD_OF_VIEW: f64 = 38.0;
/// Share of the particles that may lie outside of the picture on each side along each axis: a few grains that fly far must not make the rest small.
const OUTSIDE: f64 = 0.02;
/// Room round what is looked at.
const ROOM: f64 = 1.15;

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

/// What is looked at, and from where: the same for all pictures of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The middle [m].
    pub centre: Point,
    /// Radius of the ball about it that holds most particles [m].
    pub radius: f64,
    /// What is up.
    pub up: Point,
    /// Direction from the middle to the camera.
    pub towards: Point,
}

impl View {
    /// Of snapshots of a run of `scene`, as many as are to be seen together.
    pub fn of(scene: Option<&SceneSpec>, snapshots: &[Snapshot]) -> Self {
        // A plane is looked at as it is.
        let scene = scene.filter(|scene| scene.dimension == 3);
        let mut low = Point::repeat(f64::INFINITY);
        let mut high = Point::repeat(f64::NEG_INFINITY);
        for axis in 0..3 {
            for snapshot in snapshots.iter().filter(|snapshot| !snapshot.positions.is_empty()) {
                let mut values: Vec<f64> = snapshot.positions.iter().map(|x| x[axis]).collect();
                values.sort_by(f64::total_cmp);
                let cut = (OUTSIDE * values.len() as f64) as usize;
                low[axis] = low[axis].min(values[cut]);
                high[axis] = high[axis].max(values[values.len() - 1 - cut]);
            }
        }
        if low.x > high.x {
            (low, high) = (Point::zeros(), Point::zeros());
        }
        let up = up(scene);
        View {
            centre: 0.5 * (low + high),
            radius: (0.5 * (high - low).norm()).max(1e-6),
            up,
            towards: towards(scene, &up),
        }
    }

    /// The camera that has it all in a picture so many times as wide as high.
    pub fn camera(&self, aspect: f64) -> Camera {
        let half_width = libm::tan(0.5 * FIELD_OF_VIEW.to_radians());
        let narrow = half_width * (1.0 / aspect).min(1.0);
        let distance = ROOM * self.radius / libm::sin(libm::atan(narrow));
        Camera {
            origin: (self.centre + distance * self.towards).into(),
            target: self.centre.into(),
            up: self.up.into(),
            field_of_view: FIELD_OF_VIEW,
        }
    }

    /// To the right of who looks.
    pub fn right(&self) -> Point {
        self.up.cross(&self.towards).normalize()
    }
}

/// Against gravity, else along y.
fn up(scene: Option<&SceneSpec>) -> Point {
    let gravity = scene.map(|scene| scene.gravity.as_slice()).filter(|gravity| !gravity.is_empty());
    let gravity = gravity.map_or(Point::zeros(), |g| Point::new(g[0], g[1], g[2]));
    if gravity.norm() > 0.0 { -gravity.normalize() } else { Point::y() }
}

/// From before the walls, a little from the side and from above; without walls from the front.
fn towards(scene: Option<&SceneSpec>, up: &Point) -> Point {
    let mut before = Point::zeros();
    for collider in scene.iter().flat_map(|scene| &scene.collider) {
        if let SolidSpec::HalfSpace { normal, .. } = &collider.shape {
            let normal = Point::new(normal[0], normal[1], normal[2]).normalize();
            before += normal - normal.dot(up) * up;
        }
    }
    if before.norm() < 1e-6 {
        before = if up.z.abs() < 0.9 { Point::z() } else { -Point::y() };
        before -= before.dot(up) * up;
    }
    let before = before.normalize();
    // chosen: a third view of the wall, as photographs of impacts are taken.
    (0.55 * before + 0.8 * before.cross(up) + 0.32 * up).normalize()
}
