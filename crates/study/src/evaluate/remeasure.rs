//! One case at the count N* of its block: the endpoint, and the checks that stored frames allow.

use snowlab_solver::Vector;

use super::thinning_of;
use crate::claims::{Check, Primary};
use crate::frames::{Frame, Frames};
use crate::measure::{Ruler, earlier_frame};
use crate::metrics::{
    BondGraph, FloodRaster, FragmentAnalysis, Gate, MetricError, flood_fill, friends_of_friends,
    mean_over_subsets, thinning,
};
use crate::results::{Archive, CaseResult};
use crate::spec::study::MeasureSpec;
use crate::store::StoreError;

/// What a case says at N*.
pub struct Remeasured {
    /// A = ln N_eff by the primary metric.
    pub primary: f64,
    /// Whether the claim's link sees the intended bodies at t = 0.
    pub seen: bool,
    /// Whether the primary metric, too, sees them, in the thinned particles.
    pub whole: bool,
    /// The same endpoint measured otherwise.
    pub checks: [(Check, f64); 5],
    /// The same by rulers that the rule does not ask for.
    pub others: Vec<(&'static str, f64)>,
}

/// By what a claim is measured.
#[derive(Clone, Debug)]
pub struct Yardstick {
    /// The study's, with h_max of the claim's arms.
    pub measure: MeasureSpec,
    /// The metric of the endpoint.
    pub primary: Primary,
    /// Cells of the flood fill [m]: the same for all arms of the claim.
    pub flood_side: f64,
    /// Whether the claim's arms have different grids.
    pub grids_differ: bool,
}

/// Measures a case anew; `None` where it cannot be.
pub fn remeasure(
    archive: &Archive,
    result: &CaseResult,
    count: usize,
    yardstick: &Yardstick,
) -> Result<Option<Remeasured>, StoreError> {
    match result.case.scene.dimension {
        3 => remeasure_in::<3>(archive, result, count, yardstick),
        _ => remeasure_in::<2>(archive, result, count, yardstick),
    }
}

fn remeasure_in<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
    count: usize,
    Yardstick { measure: spec, primary, flood_side, grids_differ }: &Yardstick,
) -> Result<Option<Remeasured>, StoreError> {
    let Some(metrics) = &result.metrics else { return Ok(None) };
    let frames: Frames<D> = archive.store.case(&result.key).read_frames()?;
    let ruler = Ruler::new(spec, &result.case.scene, &result.record);
    let thinning = thinning_of(result);
    let by_link =
        |link: f64| move |points: &[Vector<f64, D>], masses: &[f64]| friends_of_friends(points, masses, link);
    let raster = FloodRaster { side: *flood_side, origin: Vector::zeros(), rest_density: ruler.density };
    let by_flood = |points: &[Vector<f64, D>], masses: &[f64]| flood_fill(points, masses, raster);
    let by_primary = |points: &[Vector<f64, D>], masses: &[f64]| match primary {
        Primary::FriendsOfFriends => ruler.fragments(points, masses),
        Primary::FloodFill => by_flood(points, masses),
    };
    let number = |frame: Option<&Frame<D>>, count: usize, value: &NumberOf<D>| {
        let points = frame.map_or(Vec::new(), Frame::points);
        let ids: Vec<usize> = (0..points.len()).collect();
        mean_over_subsets(thinning, count, &ids, &points, &frames.masses, value)
    };
    let at = |frame, measure: &dyn Measure<D>| {
        number(frame, count, &|points, masses| Ok(measure(points, masses)?.log_effective_number()))
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
    let without_dust = |points: &[Vector<f64, D>], masses: &[f64]| {
        Ok(by_primary(points, masses)?.log_effective_number_above(ruler.least_mass))
    };
    let all = frames.masses.len();
    let unthinned =
        || number(last, all, &|points, masses| Ok(by_primary(points, masses)?.log_effective_number()));
    // What is on record is by the study's own h_max.
    let is_on_record = spec.largest_spacing == archive.study.measure.largest_spacing;
    let points = |frame: Option<&Frame<D>>| frame.map_or(Vec::new(), Frame::points);
    let seen = || -> Result<bool, MetricError> {
        if is_on_record {
            return Ok(metrics.gate_valid);
        }
        let found = ruler.fragments(&points(first), &frames.masses)?;
        Ok(Gate::judge(&found, ruler.least_mass, spec.bodies).is_valid())
    };
    let bonds = || {
        if is_on_record {
            return Ok(metrics.ln_neff_bonds);
        }
        let bonds = BondGraph::new(&points(first), ruler.spacing)?;
        Ok(bonds.analyse(&points(last), &frames.masses)?.fragments.log_effective_number())
    };
    // What someone sees who has this case alone.
    let own_link = spec.link_ratio * result.case.scene.numerics.spacing;
    let by_own_grid =
        || number(last, all, &|points, masses| Ok(by_link(own_link)(points, masses)?.log_effective_number()));
    let measured = (|| -> Result<Remeasured, MetricError> {
        let mut others = vec![
            ("link 4h", at(last, &by_link(4.0 * ruler.spacing))?),
            ("without dust", number(last, count, &without_dust)?),
        ];
        if *grids_differ {
            others.push(("each by its own grid, all particles", by_own_grid()?));
        }
        let seen = seen()?;
        Ok(Remeasured {
            primary: at(last, &by_primary)?,
            seen,
            whole: seen && whole(first)?,
            checks: [
                (Check::NoThinning, unthinned()?),
                (Check::LongLink, at(last, &by_link(3.0 * ruler.spacing))?),
                (Check::FloodFill, at(last, &by_flood)?),
                (Check::BondGraph, bonds()?),
                (Check::EarlierTime, at(earlier, &by_primary)?),
            ],
            others,
        })
    })();
    Ok(measured.ok())
}

/// A number of positions [m] with masses [kg].
type NumberOf<'a, const D: usize> = dyn Fn(&[Vector<f64, D>], &[f64]) -> Result<f64, MetricError> + 'a;

/// Fragments of positions [m] with masses [kg].
trait Measure<const D: usize>: Fn(&[Vector<f64, D>], &[f64]) -> Result<FragmentAnalysis, MetricError> {}
impl<const D: usize, F> Measure<D> for F where
    F: Fn(&[Vector<f64, D>], &[f64]) -> Result<FragmentAnalysis, MetricError>
{
}
