//! One case at the count N* of its block: the endpoint, and the checks that stored frames allow.

use snowlab_solver::Vector;

use super::thinning_of;
use crate::claims::{Check, Primary};
use crate::frames::{Frame, Frames};
use crate::measure::{Ruler, earlier_frame};
use crate::metrics::{
    FloodRaster, FragmentAnalysis, Gate, MetricError, flood_fill, friends_of_friends, mean_over_subsets,
    thinning,
};
use crate::results::{Archive, CaseResult};
use crate::store::StoreError;

/// What a case says at N*.
pub struct Remeasured {
    /// A = ln N_eff by the primary metric.
    pub primary: f64,
    /// Whether that metric sees, in the thinned particles, the intended bodies at t = 0.
    pub whole: bool,
    /// The same endpoint measured otherwise. Where the flood fill is the primary, `no thinning` and `flood fill` are one
    /// number.
    pub checks: [(Check, f64); 5],
}

/// Measures a case anew; `None` where it cannot be.
pub fn remeasure(
    archive: &Archive,
    result: &CaseResult,
    count: usize,
    primary: Primary,
) -> Result<Option<Remeasured>, StoreError> {
    match result.case.scene.dimension {
        3 => remeasure_in::<3>(archive, result, count, primary),
        _ => remeasure_in::<2>(archive, result, count, primary),
    }
}

fn remeasure_in<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
    count: usize,
    primary: Primary,
) -> Result<Option<Remeasured>, StoreError> {
    let Some(metrics) = &result.metrics else { return Ok(None) };
    let frames: Frames<D> = archive.store.case(&result.key).read_frames()?;
    let spec = &archive.study.measure;
    let ruler = Ruler::new(spec, &result.case.scene, &result.record);
    let thinning = thinning_of(result);
    let by_link =
        |link: f64| move |points: &[Vector<f64, D>], masses: &[f64]| friends_of_friends(points, masses, link);
    let by_primary = |points: &[Vector<f64, D>], masses: &[f64]| match primary {
        Primary::FriendsOfFriends => ruler.fragments(points, masses),
        Primary::FloodFill => flood_fill(points, masses, raster(&ruler)),
    };
    let at = |frame: Option<&Frame<D>>, measure: &dyn Measure<D>| -> Result<f64, MetricError> {
        let points = frame.map_or(Vec::new(), Frame::points);
        let ids: Vec<usize> = (0..points.len()).collect();
        mean_over_subsets(thinning, count, &ids, &points, &frames.masses, |points, masses| {
            Ok(measure(points, masses)?.log_effective_number())
        })
    };
    let whole = |frame: Option<&Frame<D>>| -> Result<bool, MetricError> {
        let points = frame.map_or(Vec::new(), Frame::points);
        let ids: Vec<usize> = (0..points.len()).collect();
        for subset in thinning.subsets(&ids, count)? {
            let (points, masses) = thinning::thinned(&points, &frames.masses, &subset)?;
            if !Gate::judge(&by_primary(&points, &masses)?, ruler.least_mass, spec.bodies).is_valid() {
                return Ok(false);
            }
        }
        Ok(true)
    };
    let (first, last) = (frames.frames.first(), frames.frames.last());
    let earlier = earlier_frame(&frames, spec, &result.record);
    let unthinned = match primary {
        Primary::FriendsOfFriends => metrics.end.ln_neff,
        Primary::FloodFill => metrics.ln_neff_flood,
    };
    let measured = (|| -> Result<Remeasured, MetricError> {
        Ok(Remeasured {
            primary: at(last, &by_primary)?,
            whole: whole(first)?,
            checks: [
                (Check::NoThinning, unthinned),
                (Check::LongLink, at(last, &by_link(3.0 * ruler.spacing))?),
                (Check::FloodFill, metrics.ln_neff_flood),
                (Check::BondGraph, metrics.ln_neff_bonds),
                (Check::EarlierTime, at(earlier, &by_primary)?),
            ],
        })
    })();
    Ok(measured.ok())
}

/// Fragments of positions [m] with masses [kg].
trait Measure<const D: usize>: Fn(&[Vector<f64, D>], &[f64]) -> Result<FragmentAnalysis, MetricError> {}
impl<const D: usize, F> Measure<D> for F where
    F: Fn(&[Vector<f64, D>], &[f64]) -> Result<FragmentAnalysis, MetricError>
{
}

/// The raster of the stored metric: cells of h_max from the frames' origin.
fn raster<const D: usize>(ruler: &Ruler) -> FloodRaster<D> {
    FloodRaster { side: ruler.spacing, origin: Vector::zeros(), rest_density: ruler.density }
}
