//! Runs as moving pictures: what is seen of each frame.

use snowlab_solver::Vector;

use crate::export::Snapshot;
use crate::figure::moving::{Moment, Track, ink};
use crate::figure::style::Ink;
use crate::film::{Source, SourceError};
use crate::metrics::{MetricError, friends_of_friends};
use crate::present::outline;
use crate::render::View;
use crate::spec::SceneSpec;
use crate::spec::scene::SolidSpec;

/// Obstacles in the plane.
const SOLID: Ink = Ink::hex(0xd3d8dd);
/// Floors and walls in space.
const PLANE: Ink = Ink::hex(0xe4e8ec);
const OTHER_PLANE: Ink = Ink::hex(0xeef1f4);
/// Half the side of a floor or wall over the radius of what is looked at.
const REACH: f64 = 1.4;

/// What counts as a fragment.
#[derive(Clone, Copy, Debug)]
pub struct Pieces {
    /// Linking length [m].
    pub link: f64,
    /// Share of the mass below which a piece is dust.
    pub least_share: f64,
}

/// A run that cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum AnimateError {
    /// Its frames.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// Its fragments.
    #[error(transparent)]
    Metric(#[from] MetricError),
}

/// The frames of the given numbers as they are drawn, in space as seen from before the walls.
///
/// # Errors
/// [`AnimateError`].
pub fn track(
    name: &str,
    source: &mut Source,
    numbers: &[usize],
    pieces: &Pieces,
) -> Result<Track, AnimateError> {
    let scene = source.scene();
    let ends = [numbers.first(), numbers.last()].into_iter().flatten();
    let ends = ends.map(|&number| source.snapshot(number)).collect::<Result<Vec<_>, _>>()?;
    let view = View::of(scene.as_ref(), &ends);
    let first = ends.first().cloned().unwrap_or_default();
    let mut moments = Vec::new();
    for &number in numbers {
        moments.push(moment(&source.snapshot(number)?, scene.as_ref(), &view, pieces)?);
    }
    Ok(Track { name: name.into(), spacing: first.spacing_of_particles(), moments })
}

fn moment(
    snapshot: &Snapshot,
    scene: Option<&SceneSpec>,
    view: &View,
    pieces: &Pieces,
) -> Result<Moment, AnimateError> {
    let count = snapshot.positions.len();
    let masses = snapshot.masses.clone().unwrap_or_else(|| vec![1.0; count]);
    let points: Vec<_> = snapshot.positions.iter().map(|x| Vector::<f64, 3>::from(*x)).collect();
    let analysis = friends_of_friends(&points, &masses, pieces.link)?;
    let least = pieces.least_share * analysis.total_mass();
    let heavy = analysis.count(least) as u32;
    let rank = |p: usize| Some(analysis.labels()[p]).filter(|rank| *rank < heavy);
    let share = 100.0 * analysis.largest_share();
    let caption = format!("{heavy} fragment{}, largest {share:.0} %", if heavy == 1 { "" } else { "s" });
    let flat = snapshot.dimension == 2;
    let mut particles: Vec<(f64, [f64; 2], Ink)> = (0..count)
        .map(|p| {
            if flat {
                // Dust first, then from the heaviest fragment to the lightest, so that small pieces are seen.
                let [x, y, _] = snapshot.positions[p];
                let order = rank(p).map_or(0.0, |rank| f64::from(rank) + 1.0);
                return (order, [x, y], ink(rank(p), 0.0));
            }
            let nearness = (points[p] - view.centre).dot(&view.towards) / view.radius;
            (nearness, project(view, &points[p]), ink(rank(p), 0.5 - 0.5 * nearness))
        })
        .collect();
    particles.sort_by(|a, b| a.0.total_cmp(&b.0));
    let colliders = || scene.iter().flat_map(|scene| &scene.collider);
    let obstacles = if flat {
        colliders().map(|collider| (outline(collider, snapshot.time), SOLID)).collect()
    } else {
        colliders().filter_map(|collider| plane(&collider.shape, view)).collect()
    };
    let particles = particles.into_iter().map(|(_, x, ink)| (x, ink)).collect();
    Ok(Moment { particles, obstacles, caption })
}

/// Where a point is seen in a picture without perspective [m].
fn project(view: &View, point: &Vector<f64, 3>) -> [f64; 2] {
    let right = view.right();
    let upright = view.towards.cross(&right);
    let offset = point - view.centre;
    [offset.dot(&right), offset.dot(&upright)]
}

/// A square of a floor or wall near to what is looked at; of other obstacles nothing is drawn in space.
fn plane(shape: &SolidSpec, view: &View) -> Option<(Vec<[f64; 2]>, Ink)> {
    let SolidSpec::HalfSpace { point, normal } = shape else { return None };
    let normal = Vector::<f64, 3>::from_column_slice(normal).normalize();
    let point = Vector::<f64, 3>::from_column_slice(point);
    let near = view.centre - (view.centre - point).dot(&normal) * normal;
    let is_floor = normal.dot(&view.up) > 0.9;
    let along = if is_floor { view.right() } else { view.up };
    let along = (along - along.dot(&normal) * normal).normalize();
    let across = normal.cross(&along);
    let reach = REACH * view.radius;
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let corners = corners.map(|[a, b]| project(view, &(near + reach * (a * along + b * across))));
    Some((corners.to_vec(), if is_floor { PLANE } else { OTHER_PLANE }))
}
