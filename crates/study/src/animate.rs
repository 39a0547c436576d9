//! Runs as moving pictures.

use crate::figure::moment::View;
use crate::figure::moving::Track;
use crate::film::{Source, SourceError};
use crate::metrics::{MetricError, friends_of_friends};
use crate::view::{Instant, Seen, Viewpoint};
use snowlab_solver::Vector;

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

/// What is seen of a run.
#[derive(Clone, Debug)]
pub struct Run {
    name: String,
    seen: Vec<Seen>,
}

impl Run {
    /// The frames of the given numbers, those in space as seen from before the walls.
    ///
    /// # Errors
    /// [`AnimateError`].
    pub fn of(
        name: &str,
        source: &mut Source,
        numbers: &[usize],
        pieces: &Pieces,
    ) -> Result<Self, AnimateError> {
        let scene = source.scene();
        let colliders = scene.as_ref().map_or(&[][..], |scene| &scene.collider);
        let ends = [numbers.first(), numbers.last()].into_iter().flatten();
        let ends = ends.map(|&number| source.snapshot(number)).collect::<Result<Vec<_>, _>>()?;
        let first = ends.first().cloned().unwrap_or_default();
        let viewpoint = (first.dimension == 3).then(|| {
            let ends: Vec<_> = ends.iter().map(|end| end.positions.as_slice()).collect();
            Viewpoint::of(scene.as_ref(), &ends)
        });
        let mut seen = Vec::new();
        for &number in numbers {
            let snapshot = source.snapshot(number)?;
            let masses = snapshot.masses.clone().unwrap_or_else(|| vec![1.0; snapshot.positions.len()]);
            let points: Vec<_> = snapshot.positions.iter().map(|x| Vector::<f64, 3>::from(*x)).collect();
            let fragments = friends_of_friends(&points, &masses, pieces.link)?;
            let instant = Instant {
                time: snapshot.time,
                positions: &snapshot.positions,
                spacing: first.spacing_of_particles(),
                fragments: &fragments,
                least_mass: pieces.least_share * fragments.total_mass(),
                colliders,
            };
            seen.push(Seen::of(&instant, viewpoint.as_ref()));
        }
        Ok(Run { name: name.into(), seen })
    }

    /// To be drawn.
    pub fn track(&self) -> Track<'_> {
        let moments = self.seen.iter().map(|seen| (seen.moment(), seen.words()));
        Track { name: &self.name, moments: moments.collect() }
    }
}

/// What shows all of several runs; none without particles.
pub fn view_of(runs: &[Run]) -> Option<View> {
    let seen = || runs.iter().flat_map(|run| &run.seen);
    let boxes: Vec<_> = seen().filter_map(|seen| seen.bounds).collect();
    let obstacles: Vec<_> = seen().flat_map(|seen| seen.obstacles.iter().cloned()).collect();
    View::of(&boxes, &obstacles, 0.0)
}
