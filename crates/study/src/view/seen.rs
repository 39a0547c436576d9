//! A frame as it is seen: particles in the colours of their fragments, and the obstacles.

use snowlab_solver::Vector;

use crate::figure::moment::{Moment, bounds};
use crate::figure::style::{self, DUST, Ink};
use crate::metrics::FragmentAnalysis;
use crate::spec::scene::{BallSpec, BoxSpec, ColliderSpec, SolidSpec};

use super::Viewpoint;
use super::light::{lights, lit};
use super::outline::{circle, outline};

/// Half the side of a floor or wall in space over the radius of what is looked at (chosen: it is seen to end, and its end is not in the way).
const REACH: f64 = 1.4;

/// A frame with its fragments.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a> {
    /// Time [s].
    pub time: f64,
    /// Positions [m]; the last of a plane is 0.
    pub positions: &'a [[f64; 3]],
    /// Between them at rest [m].
    pub spacing: f64,
    /// Their fragments.
    pub fragments: &'a FragmentAnalysis,
    /// Below it a piece is dust [kg].
    pub least_mass: f64,
    /// Obstacles.
    pub colliders: &'a [ColliderSpec],
}

/// What is seen of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Whether it is seen in space.
    in_space: bool,
    /// Between particles at rest [m].
    spacing: f64,
    /// Positions in the picture [m], in the order in which they are painted.
    pub positions: Vec<[f64; 2]>,
    /// Colour of each.
    pub inks: Vec<Ink>,
    /// Outlines of the obstacles [m].
    pub obstacles: Vec<Vec<[f64; 2]>>,
    /// Corners of the box round its fragments, or round its dust where there is nothing else [m]; none without particles.
    pub bounds: Option<[[f64; 2]; 2]>,
    /// Number of fragments.
    pub count: usize,
    /// Share of the largest in the mass.
    pub largest_share: f64,
}

impl Seen {
    /// A plane as it is, or space from a viewpoint.
    pub fn of(instant: &Instant<'_>, viewpoint: Option<&Viewpoint>) -> Self {
        let Instant { time, positions, spacing, fragments, least_mass, colliders } = *instant;
        let count = fragments.count(least_mass);
        let rank = |p: usize| Some(fragments.labels()[p] as usize).filter(|rank| *rank < count);
        let colour = |p: usize| rank(p).map_or(DUST, style::category);
        let lights = viewpoint.map(|view| lights(positions, spacing, view));
        let mut painted: Vec<(f64, [f64; 2], Ink)> = Vec::with_capacity(positions.len());
        for (p, position) in positions.iter().enumerate() {
            painted.push(match (viewpoint, &lights) {
                (Some(view), Some(lights)) => {
                    let [right, upright, near] =
                        view.seen(&(Vector::<f64, 3>::from(*position) - view.centre)).into();
                    (near, [right, upright], lit(colour(p), lights[p]))
                }
                // Dust first, then from the heaviest fragment to the lightest, so that small pieces are seen.
                _ => (rank(p).map_or(0.0, |rank| rank as f64 + 1.0), [position[0], position[1]], colour(p)),
            });
        }
        let heavy: Vec<[f64; 2]> =
            (0..painted.len()).filter(|p| rank(*p).is_some()).map(|p| painted[p].1).collect();
        painted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (positions, inks): (Vec<_>, Vec<_>) = painted.into_iter().map(|(_, x, ink)| (x, ink)).unzip();
        let obstacles = match viewpoint {
            None => colliders.iter().map(|collider| outline(collider, time)).collect(),
            Some(view) => colliders.iter().flat_map(|collider| in_space(collider, time, view)).collect(),
        };
        let bounds = bounds(if heavy.is_empty() { &positions } else { &heavy });
        Seen {
            in_space: viewpoint.is_some(),
            spacing,
            positions,
            inks,
            obstacles,
            bounds,
            count,
            largest_share: fragments.largest_share(),
        }
    }

    /// Its particles and obstacles, to be drawn.
    pub fn moment(&self) -> Moment<'_> {
        Moment {
            positions: &self.positions,
            inks: &self.inks,
            spacing: self.spacing,
            obstacles: &self.obstacles,
            obstacles_behind: self.in_space,
        }
    }

    /// Such as `12 fragments, largest 30 %`.
    pub fn words(&self) -> String {
        let noun = if self.count == 1 { "fragment" } else { "fragments" };
        format!("{} {noun}, largest {:.0}\u{a0}%", self.count, 100.0 * self.largest_share)
    }
}

/// An obstacle in space: of a floor or wall a square near to what is looked at, of a ball its disc, of a box the faces that are turned to who looks.
fn in_space(collider: &ColliderSpec, time: f64, view: &Viewpoint) -> Vec<Vec<[f64; 2]>> {
    let moved = |point: &[f64]| {
        Vector::<f64, 3>::from_fn(|k, _| point[k] + time * collider.velocity.get(k).copied().unwrap_or(0.0))
    };
    let project = |point: Vector<f64, 3>| -> [f64; 2] {
        let seen = view.seen(&(point - view.centre));
        [seen.x, seen.y]
    };
    match &collider.shape {
        SolidSpec::HalfSpace { point, normal } => {
            let normal = Vector::<f64, 3>::from_column_slice(normal);
            let [middle, along, across] = view.square_on(&moved(point), &normal);
            let reach = REACH * view.radius();
            let corner = |[a, b]: [f64; 2]| project(middle + reach * (a * along + b * across));
            vec![SQUARE.map(corner).to_vec()]
        }
        SolidSpec::Ball(BallSpec { centre, radius }) => vec![circle(project(moved(centre)), *radius)],
        SolidSpec::Box(BoxSpec { centre, half_extent, angle }) => {
            let (sin, cos) = libm::sincos(angle.to_radians());
            let turn =
                |x: Vector<f64, 3>| Vector::<f64, 3>::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z);
            let face = |axis: usize, side: f64| {
                let mut normal = Vector::<f64, 3>::zeros();
                normal[axis] = side;
                let corner = |[a, b]: [f64; 2]| {
                    let mut at = half_extent[axis] * normal;
                    at[(axis + 1) % 3] = a * half_extent[(axis + 1) % 3];
                    at[(axis + 2) % 3] = b * half_extent[(axis + 2) % 3];
                    project(moved(centre) + turn(at))
                };
                (turn(normal).dot(&view.towards) > 0.0).then(|| SQUARE.map(corner).to_vec())
            };
            (0..3).flat_map(|axis| [face(axis, -1.0), face(axis, 1.0)]).flatten().collect()
        }
    }
}

/// Corners of a square.
const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks along -z, with y upright.
    fn front() -> Viewpoint {
        Viewpoint::of(None, &[&[[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]])
    }

    fn collider(shape: &str) -> ColliderSpec {
        toml::from_str(&format!("shape = {shape}")).expect("a collider")
    }

    fn corners(outline: &[[f64; 2]]) -> Vec<[i64; 2]> {
        let mut corners: Vec<_> =
            outline.iter().map(|x| x.map(|value| (1e6 * value).round() as i64)).collect();
        corners.sort_unstable();
        corners
    }

    #[test]
    fn what_is_near_is_painted_last() {
        let fragments = FragmentAnalysis::of_partition(&[0, 0, 0], &[1.0; 3]).expect("sound");
        let positions = [[0.1, 0.0, 1.0], [0.2, 0.0, -1.0], [0.3, 0.0, 0.0]];
        let instant = Instant {
            time: 0.0,
            positions: &positions,
            spacing: 1.0,
            fragments: &fragments,
            least_mass: 0.5,
            colliders: &[],
        };
        let mut view = front();
        (view.towards, view.up) = (Vector::<f64, 3>::z(), Vector::<f64, 3>::y());
        let seen = Seen::of(&instant, Some(&view));
        assert_eq!(seen.positions, [[0.2, 0.0], [0.3, 0.0], [0.1, 0.0]]);
        assert_eq!(seen.words(), "1 fragment, largest 100\u{a0}%");
        let flat = Seen::of(&instant, None);
        assert_eq!(flat.positions, [[0.1, 0.0], [0.2, 0.0], [0.3, 0.0]], "a plane has no depth");
        assert!(flat.inks.iter().all(|ink| *ink == style::category(0)));
    }

    /// Of a box only faces that are turned to who looks are drawn, where they stand at that time.
    #[test]
    fn obstacles_in_space_are_drawn_as_they_stand() {
        let mut view = front();
        (view.towards, view.up) = (Vector::<f64, 3>::z(), Vector::<f64, 3>::y());
        let mut cuboid = collider(
            "{ kind = \"box\", centre = [1.0, 0.0, 0.0], half_extent = [0.5, 0.25, 2.0], angle = 90.0 }",
        );
        cuboid.velocity = vec![0.0, 2.0, 0.0];
        let faces = in_space(&cuboid, 1.0, &view);
        assert_eq!(faces.len(), 1, "the others are seen from their sides");
        let expected =
            [[750_000, 1_500_000], [750_000, 2_500_000], [1_250_000, 1_500_000], [1_250_000, 2_500_000]];
        assert_eq!(corners(&faces[0]), expected);
        let ball =
            in_space(&collider("{ kind = \"ball\", centre = [0.0, 1.0, 5.0], radius = 2.0 }"), 0.0, &view);
        assert!(ball[0].iter().all(|x| (libm::hypot(x[0], x[1] - 1.0) - 2.0).abs() < 1e-12));
        let floor = collider("{ kind = \"half-space\", point = [9.0, -1.0, 9.0], normal = [0.0, 2.0, 0.0] }");
        let outline = &in_space(&floor, 0.0, &view)[0];
        assert!(outline.iter().all(|x| (x[1] + 1.0).abs() < 1e-12), "seen from its side: {outline:?}");
        let (low, high) = outline.iter().fold((0.0_f64, 0.0_f64), |(a, b), x| (a.min(x[0]), b.max(x[0])));
        let reach = REACH * 3.0_f64.sqrt();
        assert!((low + reach).abs() < 1e-12 && (high - reach).abs() < 1e-12, "{low} {high}");
    }
}
