//! A case as it stood at t = 0, thinned.

use snowlab_solver::Vector;

use super::thinning_of;
use crate::frames::{Frame, Frames};
use crate::measure::Ruler;
use crate::metrics::{MetricError, thinning};
use crate::results::{Archive, CaseResult};
use crate::spec::study::MeasureSpec;
use crate::store::StoreError;

/// A case at t = 0.
pub struct Start<const D: usize> {
    /// Positions [m].
    pub points: Vec<Vector<f64, D>>,
    /// Masses [kg].
    pub masses: Vec<f64>,
    /// Link of the primary metric [m].
    pub link: f64,
}

/// Positions [m] and masses [kg].
pub type Points<const D: usize> = (Vec<Vector<f64, D>>, Vec<f64>);

impl<const D: usize> Start<D> {
    /// Reads the first frame; `measure` is what its link is of.
    pub fn read(archive: &Archive, result: &CaseResult, measure: &MeasureSpec) -> Result<Self, StoreError> {
        let frames: Frames<D> = archive.store.case(&result.key).read_frames()?;
        let ruler = Ruler::new(measure, &result.case.scene, &result.record);
        let points = frames.frames.first().map_or(Vec::new(), Frame::points);
        Ok(Start { points, masses: frames.masses, link: ruler.link })
    }

    /// The first subset of `count` particles.
    pub fn thinned(&self, result: &CaseResult, count: usize) -> Result<Points<D>, MetricError> {
        let ids: Vec<usize> = (0..self.points.len()).collect();
        let subsets = thinning_of(result).subsets(&ids, count)?;
        thinning::thinned(&self.points, &self.masses, &subsets[0])
    }
}
