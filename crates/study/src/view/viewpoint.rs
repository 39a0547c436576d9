//! From where a run in space is looked at.

use snowlab_solver::Vector;

use crate::spec::SceneSpec;
use crate::spec::scene::SolidSpec;

type Point = Vector<f64, 3>;

/// Share of the particles that may lie outside of the picture on each side along each axis (chosen: a few grains that fly far must not make the rest small).
const OUTSIDE: f64 = 0.02;

/// Least radius of what is looked at [m] (chosen: a lone particle has a place in a picture).
const LEAST: f64 = 1e-6;
/// A floor is what has its normal this near to up, as a cosine (chosen: a slope of 25 degrees still is one).
const UPRIGHT: f64 = 0.9;

/// What is looked at, and from where: the same for all pictures of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewpoint {
    /// The middle [m].
    pub centre: Point,
    /// Half the sides of the box about it, along x, y and z, that holds most particles [m].
    pub half_extent: Point,
    /// What is up.
    pub up: Point,
    /// Direction from the middle to the camera.
    pub towards: Point,
}

impl Viewpoint {
    /// For particles of a run of `scene`, a list [m] for each moment that is to be seen.
    pub fn of(scene: Option<&SceneSpec>, moments: &[&[[f64; 3]]]) -> Self {
        // A plane is looked at as it is.
        let scene = scene.filter(|scene| scene.dimension == 3);
        let mut low = Point::repeat(f64::INFINITY);
        let mut high = Point::repeat(f64::NEG_INFINITY);
        for axis in 0..3 {
            for positions in moments.iter().filter(|positions| !positions.is_empty()) {
                let mut values: Vec<f64> = positions.iter().map(|x| x[axis]).collect();
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
        Viewpoint {
            centre: 0.5 * (low + high),
            half_extent: 0.5 * (high - low),
            up,
            towards: towards(scene, &up),
        }
    }

    /// Radius of the ball about the middle that holds the box [m].
    pub fn radius(&self) -> f64 {
        self.half_extent.norm().max(LEAST)
    }

    /// The corners of the box, from the middle [m].
    pub fn corners(&self) -> [Point; 8] {
        let side = |corner: usize, axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
        std::array::from_fn(|corner| Point::from_fn(|axis, _| side(corner, axis) * self.half_extent[axis]))
    }

    /// An offset from the middle as it is seen: to the right, upright, and towards who looks [m].
    pub fn seen(&self, offset: &Point) -> Point {
        let right = self.right();
        Point::new(offset.dot(&right), offset.dot(&self.towards.cross(&right)), offset.dot(&self.towards))
    }

    /// The plane through `point` [m] with this normal, near to what is looked at: its point nearest to the middle, and the directions along and across it,
    /// along being up where that is not its normal.
    pub fn square_on(&self, point: &Point, normal: &Point) -> [Point; 3] {
        let normal = normal.normalize();
        let middle = self.centre - (self.centre - point).dot(&normal) * normal;
        let along = if normal.dot(&self.up).abs() < UPRIGHT { self.up } else { self.right() };
        let along = (along - along.dot(&normal) * normal).normalize();
        [middle, along, normal.cross(&along)]
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
