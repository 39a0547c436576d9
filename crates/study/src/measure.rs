//! From frames to metrics. Measuring never simulates.

use serde::{Deserialize, Serialize};
use snowlab_solver::Vector;

use crate::assemble::kernel;
use crate::frames::{Frame, Frames};
use crate::metrics::{
    BondGraph, FloodRaster, FragmentAnalysis, Gate, LinkCurve, MetricError, Spread, flood_fill,
    friends_of_friends, kernel_graph, mass_shares_above, spread::LOOSENED,
};
use crate::record::RunRecord;
use crate::spec::SceneSpec;
use crate::spec::study::MeasureSpec;

/// Links at which the curve N(link) is kept (chosen: 8 % apart from 0.5 to 4 h).
const CURVE_POINTS: usize = 28;
/// `settled`: M1/M varies by at most this over the window (study definition).
const SETTLED_CHANGE: f64 = 0.01;

/// The metrics of one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Whether friends-of-friends sees at t = 0 the bodies that were built, and what it sees.
    pub gate: String,
    /// Whether the gate holds.
    pub gate_valid: bool,
    /// Whether M1/M has come to rest.
    pub settled: bool,
    /// At the end, by friends-of-friends.
    pub end: FragmentMetrics,
    /// ln N_eff at the end by friends-of-friends at 3 h_max.
    pub ln_neff_long_link: f64,
    /// ln N_eff at the end, mean over nine links in [2, 4] h_max.
    pub ln_neff_mean_link: f64,
    /// ln N_eff at the end by flood fill.
    pub ln_neff_flood: f64,
    /// ln N_eff at the end by the bond graph.
    pub ln_neff_bonds: f64,
    /// ln N_eff at the end by the kernel graph.
    pub ln_neff_kernel: f64,
    /// ln N_eff by friends-of-friends, one settle window before the end.
    pub ln_neff_earlier: f64,
    /// Crack length [m], area [m^2] in 3D, at the end.
    pub crack: Option<f64>,
    /// ln of the horizontal extent of the bulk [m]; `None` where it has none.
    pub ln_extent: Option<f64>,
    /// Horizontal distance from the centre of mass of the first frame that 95 % of the mass stay within [m].
    pub run_out: f64,
    /// Shares of the mass with J_P above 1.05, 1.3 and 2.
    pub loosened: [f64; 3],
    /// Masses of the fragments of at least the cut, over the mass of all, descending.
    pub sizes: Vec<f64>,
    /// (link over h_max, components, M1/M, ln N_eff) at the end.
    pub link_curve: Vec<(f64, usize, f64, f64)>,
    /// One row for each frame.
    pub series: Vec<SeriesRow>,
}

/// Fragments at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FragmentMetrics {
    /// Components of at least the cut.
    pub fragments: usize,
    /// All components.
    pub components: usize,
    /// A = ln N_eff.
    pub ln_neff: f64,
    /// D = 1 - M1/M.
    pub damage: f64,
    /// Share of the mass in components below the cut.
    pub dust: f64,
    /// Equivalent diameter of the mass-weighted median fragment [m].
    pub d50: f64,
}

/// Fragments over time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeriesRow {
    /// Time [s].
    pub time: f64,
    /// Time since contact over the output's time unit; negative before.
    pub since_contact: f64,
    /// Fragments.
    pub fragments: FragmentMetrics,
}

/// What lengths and masses a measurement uses.
#[derive(Clone, Copy, Debug)]
pub struct Ruler {
    /// h_max [m].
    pub spacing: f64,
    /// Link [m].
    pub link: f64,
    /// m_cut [kg].
    pub least_mass: f64,
    /// Density at rest of the first body [kg/m^D].
    pub density: f64,
}

impl Ruler {
    /// The ruler of a case.
    pub fn new(measure: &MeasureSpec, scene: &SceneSpec, record: &RunRecord) -> Self {
        Ruler {
            spacing: measure.largest_spacing,
            link: measure.link_ratio * measure.largest_spacing,
            least_mass: measure.min_mass_share * record.made.solid_mass,
            density: scene.body[0].material.density(),
        }
    }

    /// Friends-of-friends of some points.
    ///
    /// # Errors
    /// [`MetricError`].
    pub fn fragments<const D: usize>(
        &self,
        points: &[Vector<f64, D>],
        masses: &[f64],
    ) -> Result<FragmentAnalysis, MetricError> {
        friends_of_friends(points, masses, self.link)
    }

    fn metrics<const D: usize>(&self, analysis: &FragmentAnalysis) -> FragmentMetrics {
        FragmentMetrics {
            fragments: analysis.count(self.least_mass),
            components: analysis.components(),
            ln_neff: analysis.log_effective_number(),
            damage: 1.0 - analysis.largest_share(),
            dust: analysis.dust_share(self.least_mass),
            d50: analysis.median_diameter::<D>(self.density).unwrap_or(0.0),
        }
    }
}

/// The frame one settle window before the end.
pub fn earlier_frame<'a, const D: usize>(
    frames: &'a Frames<D>,
    measure: &MeasureSpec,
    record: &RunRecord,
) -> Option<&'a Frame<D>> {
    let end = frames.frames.last()?.time;
    let earlier = end - measure.settle_window * record.time_unit;
    frames.frames.iter().min_by(|a, b| (a.time - earlier).abs().total_cmp(&(b.time - earlier).abs()))
}

/// Measures a run.
///
/// # Errors
/// [`MetricError`], where a run left something that cannot be measured.
pub fn measure<const D: usize>(
    spec: &MeasureSpec,
    scene: &SceneSpec,
    frames: &Frames<D>,
    record: &RunRecord,
) -> Result<Metrics, MetricError> {
    let ruler = Ruler::new(spec, scene, record);
    let series = series(&ruler, frames, record)?;
    let masses = &frames.masses;
    let (start, end) = match (frames.frames.first(), frames.frames.last()) {
        (Some(start), Some(end)) => (start.points(), end),
        _ => (Vec::new(), &Frame { time: 0.0, positions: Vec::new(), plastic_ratios: Vec::new() }),
    };
    let points = end.points();
    let gate = Gate::judge(&ruler.fragments(&start, masses)?, ruler.least_mass, spec.bodies);
    let analysis = ruler.fragments(&points, masses)?;
    let (h, grid) = (ruler.spacing, &scene.numerics);
    let curve = LinkCurve::new(&points, masses, [0.5 * h, 4.0 * h])?;
    let bonds = BondGraph::new(&start, h)?.analyse(&points, masses)?;
    let raster = FloodRaster { side: h, origin: Vector::zeros(), rest_density: ruler.density };
    let ratios: Vec<f64> = end.plastic_ratios.iter().map(|&j| f64::from(j)).collect();
    let earlier = earlier_frame(frames, spec, record).map_or(Vec::new(), Frame::points);
    let spread = match centre_of_mass(&start, masses) {
        None => None,
        Some(centre) => Some(Spread::new(&points, masses, D - 1, centre)?),
    };
    Ok(Metrics {
        gate: gate.to_string(),
        gate_valid: gate.is_valid(),
        settled: settled(&series, spec.settle_window),
        end: ruler.metrics::<D>(&analysis),
        ln_neff_long_link: curve.at(3.0 * h)?.log_effective_number,
        ln_neff_mean_link: curve.mean_log_effective_number([2.0 * h, 4.0 * h], 9)?,
        ln_neff_flood: flood_fill(&points, masses, raster)?.log_effective_number(),
        ln_neff_bonds: bonds.fragments.log_effective_number(),
        ln_neff_kernel: kernel_graph(&points, masses, grid.spacing, Vector::zeros(), kernel(grid.kernel))?
            .log_effective_number(),
        ln_neff_earlier: ruler.fragments(&earlier, masses)?.log_effective_number(),
        crack: bonds.crack_measure,
        ln_extent: spread.map(|s| s.log_extent()).filter(|ln| ln.is_finite()),
        run_out: spread.map_or(0.0, |s| s.run_out[0]),
        loosened: mass_shares_above(&ratios, masses, LOOSENED)?,
        sizes: sizes(&analysis, ruler.least_mass),
        link_curve: curve_points(&curve, h)?,
        series,
    })
}

/// The mean of `points` weighted by mass [m]; `None` without points.
fn centre_of_mass<const D: usize>(points: &[Vector<f64, D>], masses: &[f64]) -> Option<Vector<f64, D>> {
    let weighted = points.iter().zip(masses).map(|(&x, &mass)| x * mass);
    (!points.is_empty()).then(|| weighted.sum::<Vector<f64, D>>() / masses.iter().sum::<f64>())
}

fn series<const D: usize>(
    ruler: &Ruler,
    frames: &Frames<D>,
    record: &RunRecord,
) -> Result<Vec<SeriesRow>, MetricError> {
    let contact = record.contact_time.unwrap_or(f64::INFINITY);
    let row = |frame: &Frame<D>| {
        let analysis = ruler.fragments(&frame.points(), &frames.masses)?;
        let since_contact =
            if contact.is_finite() { (frame.time - contact) / record.time_unit } else { -1.0 };
        Ok(SeriesRow { time: frame.time, since_contact, fragments: ruler.metrics::<D>(&analysis) })
    };
    frames.frames.iter().map(row).collect()
}

fn settled(series: &[SeriesRow], window: f64) -> bool {
    let Some(last) = series.last() else { return false };
    // Frames at exactly the window's begin count, whatever the rounding.
    let from = last.since_contact - window - 1e-6;
    let damages = series.iter().filter(|row| row.since_contact >= from).map(|row| row.fragments.damage);
    let (least, greatest) = damages.fold((f64::INFINITY, 0.0_f64), |(a, b), d| (a.min(d), b.max(d)));
    greatest - least <= SETTLED_CHANGE
}

fn sizes(analysis: &FragmentAnalysis, least_mass: f64) -> Vec<f64> {
    let total = analysis.total_mass();
    analysis.masses().iter().take_while(|&&mass| mass >= least_mass).map(|mass| mass / total).collect()
}

fn curve_points(curve: &LinkCurve, h: f64) -> Result<Vec<(f64, usize, f64, f64)>, MetricError> {
    let [least, greatest] = curve.range();
    (0..CURVE_POINTS)
        .map(|k| {
            let share = k as f64 / (CURVE_POINTS - 1) as f64;
            let link = (least * libm::pow(greatest / least, share)).clamp(least, greatest);
            let state = curve.at(link)?;
            Ok((link / h, state.components, state.largest_share, state.log_effective_number))
        })
        .collect()
}
