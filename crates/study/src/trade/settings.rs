//! What a setting costs and how far it is off, over many scenes: what [`super::recommend`] chooses from.
//!
//! A setting is an arm of a study with `[tradeoff]`, along whose axis the scene changes. Its error E in a scene is the largest of e_u, e_I and e_K,
//! the mean over blocks.
//!
//! Errors are told for the impact of the study's first scene ([`super::impacts`]). What is left over scenes is taken to be log-normal: the limits of
//! a setting are those between which the error in one more scene lies, and scenes that are held out show whether it does.

use std::collections::BTreeMap;
use std::path::Path;

use toml::{Table as Toml, Value};

use super::Truths;
use super::impacts::{Impacts, cells_across};
use crate::memory;
use crate::results::{Archive, CaseResult};
use crate::spec::SceneSpec;
use crate::spec::study::TradeoffSpec;
use crate::statistics::{self, student_t_quantile};
use crate::store::StoreError;
use crate::table::{Cell, Row, Table};
use crate::tables::{groups, usable};
use crate::template::Record;

/// Of either limit (study plan: the upper 95 % limit is what a user's bound is held against).
const CONFIDENCE: f64 = 0.95;
/// Orders of convergence that Richardson's rule is trusted with (chosen: friction and yield leave 1/2, the scheme has no more than 2).
const ORDERS: [f64; 2] = [0.5, 2.0];
/// Errors below so many times that of the reference are not told from it (study plan).
const AT_REFERENCE: f64 = 2.0;
/// Keys of `numerics` that make a setting, beside the spacing.
pub(super) const KEYS: [&str; 7] = [
    "kernel",
    "transfer",
    "flip_reference_step",
    "precision",
    "wave_courant",
    "advective_courant",
    "integrator",
];

/// E of an arm, scene by scene.
struct Known<'a> {
    first: &'a CaseResult,
    coarser: Option<f64>,
    /// Number of the scene and E in it, carried to the impact of the first scene.
    errors: Vec<(f64, f64)>,
    steps: f64,
    iterations: f64,
    stopped: usize,
}

impl Known<'_> {
    fn learnt<'k>(&'k self, tradeoff: &'k TradeoffSpec) -> impl Iterator<Item = f64> + 'k {
        let is_held_out = |scene: f64| tradeoff.held_out.contains(&scene);
        self.errors.iter().filter(move |(scene, _)| !is_held_out(*scene)).map(|(_, error)| *error)
    }

    fn in_scene(&self, scene: f64) -> Option<f64> {
        self.errors.iter().find(|(number, _)| *number == scene).map(|(_, error)| *error)
    }
}

/// Between what E lies in a scene to come.
#[derive(Clone, Copy, Debug)]
struct Limits {
    mean: f64,
    lower: f64,
    upper: f64,
}

impl Limits {
    fn of(errors: impl Iterator<Item = f64>) -> Option<Self> {
        let logs: Vec<f64> = errors.map(libm::log).collect();
        let (mean, spread) = (statistics::mean(&logs)?, statistics::standard_deviation(&logs)?);
        let count = logs.len() as f64;
        let half = student_t_quantile(CONFIDENCE, count - 1.0) * spread * (1.0 + 1.0 / count).sqrt();
        let [mean, lower, upper] = [mean, mean - half, mean + half].map(libm::exp);
        Some(Limits { mean, lower, upper })
    }
}

/// `settings`, one row a setting, and `reference`, one row a scene. `seconds` are wall times of arms, timed alone; `fragments` the rows of the table
/// `equivalence` of the study that tells of them.
///
/// # Errors
/// Frames that cannot be read.
pub fn settings(
    archive: &Archive,
    results: &[CaseResult],
    tradeoff: &TradeoffSpec,
    seconds: &BTreeMap<String, f64>,
    fragments: &[Record],
) -> Result<[Table; 2], StoreError> {
    let impacts = Impacts::of(archive, results, tradeoff);
    let all = known(archive, results, tradeoff, &impacts)?;
    let (coarser, own): (Vec<&Known>, Vec<&Known>) = all.iter().partition(|known| known.coarser.is_some());
    let reference = reference(&coarser, &impacts);
    let its_errors: Vec<f64> = reference.rows.iter().filter_map(|row| row.value("error")).collect();
    let its_error = statistics::median(&its_errors);
    let limits: Vec<Option<Limits>> = own.iter().map(|known| Limits::of(known.learnt(tradeoff))).collect();
    let all_seconds: Vec<Option<f64>> =
        own.iter().map(|known| seconds.get(&known.first.case.arm).copied()).collect();
    let rows = own.iter().zip(&limits).zip(&all_seconds).map(|((known, own_limits), own_seconds)| {
        let beats = |(theirs, seconds): (&Option<Limits>, &Option<f64>)| -> Option<bool> {
            Some((*seconds)? < (*own_seconds)? && theirs.as_ref()?.mean < own_limits.as_ref()?.mean)
        };
        let is_beaten = limits.iter().zip(&all_seconds).any(|pair| beats(pair) == Some(true));
        let of_fragments = fragments.iter().filter(|row| row.get("arm") == Some(&known.first.case.arm));
        let spread = of_fragments.filter_map(|row| row.get("d_bound")?.parse::<f64>().ok());
        let mut row = Row::default();
        the_setting(&mut row, known, archive.folder);
        its_cost(&mut row, known, *own_seconds, archive.folder);
        its_error_columns(&mut row, known, *own_limits, its_error, tradeoff);
        impacts.columns(&mut row);
        row.put(
            "on_front",
            "-",
            "no setting is both faster and closer",
            Cell::Flag(own_limits.is_some() && !is_beaten),
        )
        .put(
            "spread",
            "SD",
            "greatest 90 % limit of |d| of fragments beside the reference",
            spread.reduce(f64::max),
        );
        row
    });
    Ok([Table { name: "settings", rows: rows.collect() }, reference])
}

fn the_setting(row: &mut Row, known: &Known, folder: &Path) {
    let case = &known.first.case;
    row.put("arm", "-", "the setting", case.arm.as_str())
        .number(
            "cells_across",
            "-",
            "cells across the body, where it is narrowest",
            cells_across(&case.scene, folder),
        )
        .number("particles_per_cell", "-", "particles to a cell", known.first.record.made.particles_per_cell)
        .put("numerics", "-", "its other keys of `numerics`, as TOML", numerics(&case.scene).as_str());
}

fn its_cost(row: &mut Row, known: &Known, seconds: Option<f64>, folder: &Path) {
    row.put("seconds", "s", "median wall time of the first scene on one thread, timed alone", seconds)
        .number("steps", "-", "mean steps", known.steps)
        .number("iterations", "-", "mean applications of implicit operators", known.iterations)
        .put(
            "memory",
            "B",
            "what the first scene is said to take",
            memory::of_case(&known.first.case.scene, folder, None),
        )
        .count("stopped", "cases that stopped", known.stopped as u64);
}

/// E as it was learnt, with its limits in another scene, and beside the scenes that were held out.
fn its_error_columns(
    row: &mut Row,
    known: &Known,
    limits: Option<Limits>,
    of_reference: Option<f64>,
    tradeoff: &TradeoffSpec,
) {
    let held_out: Vec<f64> = tradeoff.held_out.iter().filter_map(|&n| known.in_scene(n)).collect();
    let below = |limits: Limits| held_out.iter().filter(|error| **error <= limits.upper).count();
    row.count("scenes", "scenes that E is learnt from", known.learnt(tradeoff).count() as u64)
        .put(
            "error",
            "-",
            "E, geometric mean over scenes, at the impact of the first one",
            limits.map(|limits| limits.mean),
        )
        .put("error_lower", "-", "lower 95 % limit in another scene", limits.map(|limits| limits.lower))
        .put("error_upper", "-", "upper 95 % limit in another scene", limits.map(|limits| limits.upper))
        .put(
            "error_bound",
            "-",
            "that and the error of the reference itself, median over scenes",
            limits.zip(of_reference).map(|(limits, its)| limits.upper + its),
        )
        .put(
            "at_reference",
            "-",
            "whether E is within twice the error of the reference itself",
            Cell::Flag(limits.zip(of_reference).is_some_and(|(own, its)| own.mean < AT_REFERENCE * its)),
        )
        .count("held_out", "scenes held out", held_out.len() as u64)
        .count("held_out_below", "of them with E below the upper limit", limits.map_or(0, below) as u64)
        .put("held_out_error", "-", "E in them, geometric mean, at that impact", geometric_mean(&held_out));
}

fn known<'a>(
    archive: &Archive,
    results: &'a [CaseResult],
    tradeoff: &TradeoffSpec,
    impacts: &Impacts,
) -> Result<Vec<Known<'a>>, StoreError> {
    let mut truths = Truths::new(archive, results);
    let mut all: Vec<Known> = Vec::new();
    for group in groups(results) {
        let first = group[0];
        let arm = archive.study.spec.arm.iter().find(|arm| arm.id == first.case.arm);
        let Some(trade) = arm.and_then(|arm| arm.trade.as_ref()) else { continue };
        let (mut errors, mut steps, mut iterations) = (Vec::new(), Vec::new(), Vec::new());
        for result in &group {
            let Some((_, found)) = truths.errors(result, &trade.reference)? else { continue };
            // Where particles are too few to tell the deformation, E is not known.
            let Some(deformation) = found.deformation else { continue };
            errors.push([found.impulse, found.kinetic].into_iter().flatten().fold(deformation, f64::max));
            steps.push(result.record.steps as f64);
            iterations.push(result.record.iterations as f64);
        }
        if all.last().is_none_or(|last| last.first.case.arm != first.case.arm) {
            let (coarser, errors) = (trade.coarser, Vec::new());
            all.push(Known { first, coarser, errors, steps: 0.0, iterations: 0.0, stopped: 0 });
        }
        let known = all.last_mut().expect("one has been put there");
        known.stopped += group.iter().filter(|result| !usable(result)).count();
        if let (Some(scene), Some(error)) = (first.case.number(&tradeoff.axis), statistics::mean(&errors)) {
            known.errors.push((scene, error * impacts.carried(scene)));
            let scenes = known.errors.len() as f64;
            let add = |mean: &mut f64, values: &[f64]| {
                *mean += (statistics::mean(values).unwrap_or(0.0) - *mean) / scenes;
            };
            add(&mut known.steps, &steps);
            add(&mut known.iterations, &iterations);
        }
    }
    Ok(all)
}

/// How far the reference is from the truth, by Richardson's rule from the same on two coarser grids: where e_r is the error of one r times as coarse
/// beside the reference, e_r = C (r^p - 1), and C is the reference's own.
fn reference(coarser: &[&Known], impacts: &Impacts) -> Table {
    let mut by_ratio = coarser.to_vec();
    by_ratio.sort_by(|a, b| a.coarser.partial_cmp(&b.coarser).expect("ratios are numbers"));
    let [near, far] = by_ratio[..] else { return Table { name: "reference", rows: Vec::new() } };
    let (r, s) = (near.coarser.expect("it is coarser"), far.coarser.expect("it is coarser"));
    let rows = near.errors.iter().filter_map(|&(scene, near_error)| {
        let far_error = far.in_scene(scene)?;
        let order = order(far_error / near_error, r, s);
        let mut row = Row::default();
        row.number("scene", "-", "number of the scene", scene)
            .number(
                "carried",
                "-",
                "cells that the impact presses in while a wave crosses the body, over those of the first scene; errors are carried by it",
                impacts.carried(scene),
            )
            .number("error_near", "-", "E of the reference on the next coarser grid", near_error)
            .number("error_far", "-", "E of the reference on the grid after that", far_error)
            .number("order", "-", "of convergence, held within 1/2 and 2", order)
            .number(
                "error",
                "-",
                "of the reference, by Richardson's rule",
                near_error / (libm::pow(r, order) - 1.0),
            );
        Some(row)
    });
    Table { name: "reference", rows: rows.collect() }
}

/// p of (s^p - 1) / (r^p - 1) = `ratio`, which grows with p, by bisection.
fn order(ratio: f64, r: f64, s: f64) -> f64 {
    let [mut low, mut high] = ORDERS;
    for _ in 0..50 {
        let p = 0.5 * (low + high);
        if (libm::pow(s, p) - 1.0) / (libm::pow(r, p) - 1.0) < ratio { low = p } else { high = p }
    }
    0.5 * (low + high)
}

fn geometric_mean(values: &[f64]) -> Option<f64> {
    let logs: Vec<f64> = values.iter().copied().map(libm::log).collect();
    statistics::mean(&logs).map(libm::exp)
}

/// What of `numerics` makes a setting, as an inline table.
fn numerics(scene: &SceneSpec) -> String {
    let all = Toml::try_from(&scene.numerics).unwrap_or_default();
    let own = KEYS.iter().filter_map(|key| Some((key.to_string(), all.get(*key)?.clone())));
    Value::Table(own.collect()).to_string()
}

#[cfg(test)]
mod tests {
    use super::{Limits, order};

    #[test]
    fn the_order_is_that_of_a_power_law() {
        let ratio = |p: f64| (2.0_f64.powf(p) - 1.0) / (2.0_f64.powf(0.5 * p) - 1.0);
        assert!((order(ratio(1.3), 2.0_f64.sqrt(), 2.0) - 1.3).abs() < 1e-9);
        assert_eq!((order(1.0, 2.0_f64.sqrt(), 2.0) * 1e6).round(), 5e5, "held at 1/2");
    }

    #[test]
    fn limits_of_four_scenes_by_hand() {
        // ln E = -3, -2, -2, -1: mean -2, standard deviation sqrt(2/3), t of 3 degrees at 95 % 2.353363.
        let limits = Limits::of([-3.0, -2.0, -2.0, -1.0_f64].map(f64::exp).into_iter()).unwrap();
        let half = 2.353_363 * (2.0 / 3.0 * 1.25_f64).sqrt();
        assert!((limits.mean.ln() + 2.0).abs() < 1e-12);
        assert!((limits.upper.ln() - (half - 2.0)).abs() < 1e-5, "{limits:?}");
        assert!((limits.lower.ln() + 2.0 + half).abs() < 1e-5, "{limits:?}");
        assert!(Limits::of([0.1].into_iter()).is_none());
    }
}
