//! Whether arms break like another that is taken for the truth: settings after fracture, when no path can be followed any more.
//!
//! Arms are held against the reference ball for ball, not block for block: by the mean and by the whole distribution of A, D, the logarithm of the
//! extent, and of how far a ball's coarse map of density lies from the reference's mean map.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::results::{Archive, CaseResult};
use crate::statistics::{mean, quantile, standard_deviation, student_t_quantile};
use crate::store::StoreError;
use crate::table::{Row, Table};
use crate::tables::{case_row, usable};

/// Differences this many standard deviations of the reference large are of interest (study plan).
const MARGIN: f64 = 0.3;
/// Of the intervals of d, so that both one-sided tests are at 95 % (study plan).
const CONFIDENCE: f64 = 0.9;
/// Pairs of samples that the distance of two samples of one distribution is known from (chosen: the quantile is then within 2 %).
const RESAMPLES: usize = 2000;
/// Seed of resampling (chosen: PS17's year).
const SEED: u64 = 2017;
/// Cells of the coarse map over R (chosen: the smallest that a ball 25 cells across fills with several).
const MAP_CELLS: f64 = 4.0;
/// Metrics of `cases.csv`.
const METRICS: [&str; 3] = ["ln_neff", "damage", "ln_extent"];

/// What is said of a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Likeness {
    /// Within the margin, by mean and by distribution.
    Equivalent,
    /// Beyond it.
    Different,
    /// Neither has been shown.
    Unresolved,
}

impl Likeness {
    /// The word in tables.
    pub fn word(self) -> &'static str {
        match self {
            Likeness::Equivalent => "equivalent",
            Likeness::Different => "different",
            Likeness::Unresolved => "unresolved",
        }
    }
}

/// An arm beside the reference, in standard deviations of the latter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Difference of the means.
    pub d: f64,
    /// Its 90 % limits.
    pub limits: [f64; 2],
    /// Wasserstein-1 distance of the samples.
    pub distance: f64,
    /// 95 % quantile of that of two samples of the reference, as large as these.
    pub null: f64,
    /// What follows.
    pub likeness: Likeness,
}

/// Compares two samples; `None` where one has under two values, or the reference no spread.
pub fn compare(values: &[f64], reference: &[f64]) -> Option<Comparison> {
    let spread = standard_deviation(reference).filter(|s| *s > 0.0)?;
    let own = standard_deviation(values)?;
    let (n, m) = (values.len() as f64, reference.len() as f64);
    let d = (mean(values)? - mean(reference)?) / spread;
    let error = (own * own / n + spread * spread / m).sqrt() / spread;
    let half = student_t_quantile(0.5 + 0.5 * CONFIDENCE, n + m - 2.0) * error;
    let limits = [d - half, d + half];
    let distance = wasserstein(values, reference) / spread;
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut draw = |count: usize| -> Vec<f64> {
        (0..count).map(|_| reference[random.random_range(0..reference.len())]).collect()
    };
    let apart: Vec<f64> =
        (0..RESAMPLES).map(|_| wasserstein(&draw(values.len()), &draw(reference.len())) / spread).collect();
    let null = quantile(&apart, 0.95)?;
    let likeness = if -MARGIN <= limits[0] && limits[1] <= MARGIN && distance < null + MARGIN {
        Likeness::Equivalent
    } else if (limits[0] > 0.0 || limits[1] < 0.0) && d.abs() >= MARGIN {
        Likeness::Different
    } else {
        Likeness::Unresolved
    };
    Some(Comparison { d, limits, distance, null, likeness })
}

/// Area between the distribution functions of two samples (Vallender 1973).
fn wasserstein(a: &[f64], b: &[f64]) -> f64 {
    let mut steps: Vec<(f64, f64)> = a.iter().map(|x| (*x, 1.0 / a.len() as f64)).collect();
    steps.extend(b.iter().map(|x| (*x, -1.0 / b.len() as f64)));
    steps.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut height = 0.0;
    let areas = steps.windows(2).map(|pair| {
        height += pair[0].1;
        f64::abs(height) * (pair[1].0 - pair[0].0)
    });
    areas.sum()
}

/// `equivalence`: one row for each arm beside `reference` and metric.
///
/// # Errors
/// Frames that cannot be read.
pub fn equivalence(archive: &Archive, results: &[CaseResult], reference: &str) -> Result<Table, StoreError> {
    let arms = archive.study.arms();
    let of = |arm: &str| -> Vec<&CaseResult> {
        results.iter().filter(|r| r.case.arm == arm && usable(r)).collect()
    };
    let truth = of(reference);
    let maps = maps_of(archive, &truth)?;
    let all = sum(maps.iter());
    // Each ball of the reference beside the others.
    let own_distances: Vec<f64> =
        maps.iter().map(|map| apart(map, &sum([&all, &scaled(map, -1.0)]))).collect();
    let mut rows = Vec::new();
    for arm in arms.into_iter().filter(|arm| *arm != reference) {
        let balls = of(arm);
        let distances: Vec<f64> = maps_of(archive, &balls)?.iter().map(|map| apart(map, &all)).collect();
        let values = |of: &[&CaseResult], metric: &str| -> Vec<f64> {
            of.iter().filter_map(|result| case_row(result).value(metric)).collect()
        };
        let mut samples: Vec<(&str, Vec<f64>, Vec<f64>)> =
            METRICS.iter().map(|metric| (*metric, values(&balls, metric), values(&truth, metric))).collect();
        samples.push(("density_map", distances, own_distances.clone()));
        for (metric, own, theirs) in samples {
            let Some(c) = compare(&own, &theirs) else { continue };
            let mut row = Row::default();
            row.put("arm", "-", "arm", arm)
                .put("metric", "-", "what is compared", metric)
                .count("balls", "balls of the arm", own.len() as u64)
                .count("reference_balls", "balls of the reference", theirs.len() as u64)
                .put("mean", "of the metric", "mean of the arm", mean(&own))
                .put("reference_mean", "of the metric", "mean of the reference", mean(&theirs))
                .put(
                    "reference_sd",
                    "of the metric",
                    "standard deviation of the reference",
                    standard_deviation(&theirs),
                )
                .number("d", "SD", "difference of the means over that", c.d)
                .number("d_lower", "SD", "90 % limit", c.limits[0])
                .number("d_upper", "SD", "90 % limit", c.limits[1])
                .number(
                    "d_bound",
                    "SD",
                    "the greater of the limits' sizes",
                    c.limits[0].abs().max(c.limits[1].abs()),
                )
                .number("distance", "SD", "Wasserstein-1 distance of the distributions", c.distance)
                .number(
                    "distance_null",
                    "SD",
                    "95 % quantile of that of two samples of the reference",
                    c.null,
                )
                .put("likeness", "-", "equivalent, different or unresolved, at 0.3 SD", c.likeness.word());
            rows.push(row);
        }
    }
    Ok(Table { name: "equivalence", rows })
}

/// Share of the mass by cell, about the middle of where the body was.
type Map = std::collections::BTreeMap<Vec<i64>, f64>;

fn maps_of(archive: &Archive, results: &[&CaseResult]) -> Result<Vec<Map>, StoreError> {
    let of = |result: &&CaseResult| match result.case.scene.dimension {
        3 => map::<3>(archive, result),
        _ => map::<2>(archive, result),
    };
    results.iter().map(of).collect()
}

fn map<const D: usize>(archive: &Archive, result: &CaseResult) -> Result<Map, StoreError> {
    let frames = archive.store.case(&result.key).read_frames::<D>()?;
    let (Some(first), Some(last)) = (frames.frames.first(), frames.frames.last()) else {
        return Ok(Map::new());
    };
    let total: f64 = frames.masses.iter().sum();
    let weighed = |positions: &[[f32; D]], k: usize| -> f64 {
        positions.iter().zip(&frames.masses).map(|(p, mass)| mass * f64::from(p[k])).sum()
    };
    let middle: [f64; D] = std::array::from_fn(|k| weighed(&first.positions, k) / total);
    let square = |p: &[f32; D]| (0..D).map(|k| (f64::from(p[k]) - middle[k]).powi(2)).sum::<f64>();
    let side = first.positions.iter().map(square).fold(0.0, f64::max).sqrt() / MAP_CELLS;
    let mut map = Map::new();
    for (position, mass) in last.positions.iter().zip(&frames.masses) {
        let cell = (0..D).map(|k| ((f64::from(position[k]) - middle[k]) / side).floor() as i64).collect();
        *map.entry(cell).or_default() += mass / total;
    }
    Ok(map)
}

fn sum<'a>(maps: impl IntoIterator<Item = &'a Map>) -> Map {
    let mut all = Map::new();
    maps.into_iter().flatten().for_each(|(cell, share)| *all.entry(cell.clone()).or_default() += share);
    all
}

fn scaled(map: &Map, factor: f64) -> Map {
    map.iter().map(|(cell, share)| (cell.clone(), factor * share)).collect()
}

/// Share of the mass that lies elsewhere in `map` than in the mean of those that `all` is the sum of.
fn apart(map: &Map, all: &Map) -> f64 {
    let total: f64 = all.values().sum();
    if total <= 0.0 {
        return f64::NAN;
    }
    let difference = sum([map, &scaled(all, -1.0 / total)]);
    0.5 * difference.values().map(|share| share.abs()).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::{Likeness, apart, compare, sum, wasserstein};

    #[test]
    fn distances_by_hand() {
        assert_eq!(wasserstein(&[0.0, 1.0], &[0.0, 1.0]), 0.0);
        assert!((wasserstein(&[0.0, 1.0, 3.0], &[5.0, 6.0, 8.0]) - 5.0).abs() < 1e-12);
        // A quarter of the mass of the first goes 1, a quarter 3.
        assert!((wasserstein(&[0.0, 2.0], &[0.0, 1.0, 2.0, 5.0]) - 1.0).abs() < 1e-12);
        let [one, other] = [0, 1].map(|cell| [(vec![cell], 0.5), (vec![2], 0.5)].into());
        assert!((apart(&one, &other) - 0.5).abs() < 1e-12);
        assert!((apart(&one, &sum([&one, &other])) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn samples_are_alike_differ_or_leave_it_open() {
        let sample = |count: usize, shift: f64| -> Vec<f64> {
            (0..count).map(|k| ((k as f64 + 0.5) * 0.618_033_988_749_895).fract() + shift).collect()
        };
        let reference = sample(200, 0.0);
        let likeness = |values: &[f64]| compare(values, &reference).unwrap().likeness;
        assert_eq!(likeness(&sample(190, 0.01)), Likeness::Equivalent);
        assert_eq!(likeness(&sample(190, 0.15)), Likeness::Different);
        assert_eq!(likeness(&sample(6, 0.05)), Likeness::Unresolved);
        // As wide again: the means agree, the distributions do not.
        let wide: Vec<f64> = sample(190, 0.0).iter().map(|x| 3.0 * (x - 0.5) + 0.5).collect();
        assert_eq!(likeness(&wide), Likeness::Unresolved);
        assert!(compare(&[0.1], &reference).is_none());
    }
}
