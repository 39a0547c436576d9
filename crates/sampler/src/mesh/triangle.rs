//! One triangle: what a vertical ray and a nearby point see of it.

use robust::{Coord, Coord3D, orient2d, orient3d};

use super::Point;

/// Corners, anticlockwise as seen from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle(pub [Point; 3]);

impl Triangle {
    /// Makes it face the other way.
    pub fn turn(&mut self) {
        self.0.swap(1, 2);
    }

    /// Signed volume of the tetrahedron over it with its tip at `origin`.
    pub fn cone(&self, origin: &Point) -> f64 {
        let [a, b, c] = self.0.map(|corner| corner - origin);
        a.dot(&b.cross(&c)) / 6.0
    }

    /// How its image in the plane of x and y winds round that of the shifted `point`: 1 facing up, -1 facing down, 0
    /// beside it or upright. By the crossings of a ray along x, as in a polygon (Sunday 2001); see [`super`] for ties.
    pub fn winding(&self, point: &Point) -> i32 {
        let [a, b, c] = &self.0;
        crossing(a, b, point) + crossing(b, c, point) + crossing(c, a, point)
    }

    /// Whether it lies above the shifted `point`, round which it winds `winding` times.
    pub fn is_above(&self, point: &Point, winding: i32) -> bool {
        let [a, b, c, p] =
            [self.0[0], self.0[1], self.0[2], *point].map(|q| Coord3D { x: q.x, y: q.y, z: q.z });
        f64::from(winding) * orient3d(a, b, c, p) > 0.0
    }

    /// Height at which the vertical line through (x, y) of `point` meets it.
    pub fn height(&self, point: &Point) -> f64 {
        let [a, b, c] = self.0.map(|corner| corner - point);
        let normal = (b - a).cross(&(c - a));
        let [least, greatest] = [a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z)];
        // The plane of one that is nearly upright is lost to rounding.
        point.z + (normal.dot(&a) / normal.z).max(least).min(greatest)
    }

    /// Squared distance to its nearest point: over its inside where the foot of the perpendicular lies in it, else to an
    /// edge.
    pub fn squared_distance(&self, point: &Point) -> f64 {
        let [a, b, c] = self.0.map(|corner| corner - point);
        let normal = (b - a).cross(&(c - a));
        let inside = |from: &Point, to: &Point| from.cross(to).dot(&normal) >= 0.0;
        if normal.norm_squared() > 0.0 && inside(&a, &b) && inside(&b, &c) && inside(&c, &a) {
            let height = normal.dot(&a);
            return height * height / normal.norm_squared();
        }
        from_edge(&a, &b).min(from_edge(&b, &c)).min(from_edge(&c, &a))
    }
}

/// 1 where the edge from `u` to `v` passes the ray along x from the shifted point upwards in y, -1 downwards.
fn crossing(u: &Point, v: &Point, point: &Point) -> i32 {
    let (low, high, direction) = if u.y <= v.y { (u, v, 1) } else { (v, u, -1) };
    if low.y > point.y || high.y <= point.y {
        return 0;
    }
    let [low, high, point] = [low, high, point].map(|q| Coord { x: q.x, y: q.y });
    if orient2d(low, high, point) > 0.0 { direction } else { 0 }
}

/// Squared distance of the origin from the edge between two points.
fn from_edge(from: &Point, to: &Point) -> f64 {
    let along = to - from;
    let length = along.norm_squared();
    let share = if length > 0.0 { (-from.dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (from + along * share).norm_squared()
}
