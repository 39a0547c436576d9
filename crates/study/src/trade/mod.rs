//! What arms trade: their error beside a reference, for the time they take.
//!
//! The response to a placement is smooth enough that settings which keep it are compared path by path. The error is the largest of that of the
//! deformation, of the impulse on obstacles and of the energy lost to plastic flow ([`Errors`]), each at the end of the run.

mod equivalence;
mod errors;
mod impacts;
mod nearest;
mod recommend;
mod settings;

pub use equivalence::{Comparison, Likeness, compare, equivalence};
pub use errors::{Errors, Truth};
pub use recommend::{Binding, Preset, Refusal, Setting, Wanted, recommend};
pub use settings::settings;

use std::collections::BTreeMap;

use crate::results::{Archive, CaseResult};
use crate::spec::study::TradeSpec;
use crate::statistics;
use crate::store::StoreError;
use crate::table::{Row, Table};
use crate::tables::usable;

/// An arm at a point of the sweep: means over blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Trade {
    /// Arm.
    pub arm: String,
    /// Line of the figure.
    pub family: String,
    /// Point of the sweep.
    pub axes: Vec<(String, Option<f64>)>,
    /// Blocks that both arms have.
    pub blocks: usize,
    /// Blocks of the arm that stopped.
    pub stopped: usize,
    /// Median wall time of a case, measuring included [s].
    pub seconds: f64,
    /// That of the reference [s].
    pub reference_seconds: f64,
    /// Mean number of steps.
    pub steps: f64,
    /// Mean number of applications of implicit operators.
    pub iterations: f64,
    /// Mean errors.
    pub errors: Errors,
    /// Whether no arm of this point is both faster and closer.
    pub on_front: bool,
}

impl Trade {
    /// The largest of its errors.
    pub fn error(&self) -> f64 {
        let Errors { deformation, impulse, plastic, .. } = self.errors;
        [deformation, impulse, plastic].into_iter().flatten().fold(0.0, f64::max)
    }
}

/// All trades of a study, in the order of its cases.
///
/// # Errors
/// Frames or clocks that cannot be read.
pub fn trades(archive: &Archive, results: &[CaseResult]) -> Result<Vec<Trade>, StoreError> {
    let spec = &archive.study.spec;
    let trade_of = |arm: &str| spec.arm.iter().find(|a| a.id == arm).and_then(|a| a.trade.as_ref());
    let mut trades = Vec::new();
    let mut truths = Truths::new(archive, results);
    for group in crate::tables::groups(results) {
        let first = &group[0].case;
        if let Some(trade) = trade_of(&first.arm) {
            trades.extend(compared(&mut truths, &group, trade)?);
        }
    }
    let all = trades.clone();
    for trade in &mut trades {
        let beats = |other: &Trade| {
            other.axes == trade.axes && other.seconds < trade.seconds && other.error() < trade.error()
        };
        trade.on_front = trade.blocks > 0 && !all.iter().any(beats);
    }
    Ok(trades)
}

/// The truths of a study's arms, each read once.
pub struct Truths<'a> {
    archive: &'a Archive<'a>,
    results: &'a [CaseResult],
    plane: BTreeMap<String, Truth<2>>,
    space: BTreeMap<String, Truth<3>>,
}

impl<'a> Truths<'a> {
    /// None has been read.
    pub fn new(archive: &'a Archive<'a>, results: &'a [CaseResult]) -> Self {
        Truths { archive, results, plane: BTreeMap::new(), space: BTreeMap::new() }
    }

    /// Errors of a case beside that of the arm `reference` at the same point and block, which comes with them; `None` where there is none to be
    /// used.
    ///
    /// # Errors
    /// Frames that cannot be read.
    pub fn errors(
        &mut self,
        result: &CaseResult,
        reference: &str,
    ) -> Result<Option<(&'a CaseResult, Errors)>, StoreError> {
        let is_truth = |other: &&CaseResult| {
            other.case.arm == reference
                && other.case.axes == result.case.axes
                && other.case.block == result.case.block
                && usable(other)
        };
        let Some(truth) = self.results.iter().find(is_truth).filter(|_| usable(result)) else {
            return Ok(None);
        };
        let errors = match result.case.scene.dimension {
            3 => of_map(&mut self.space, self.archive, truth)?.errors(self.archive, result)?,
            _ => of_map(&mut self.plane, self.archive, truth)?.errors(self.archive, result)?,
        };
        Ok(Some((truth, errors)))
    }
}

fn of_map<'m, const D: usize>(
    known: &'m mut BTreeMap<String, Truth<D>>,
    archive: &Archive,
    truth: &CaseResult,
) -> Result<&'m Truth<D>, StoreError> {
    if !known.contains_key(&truth.key) {
        known.insert(truth.key.clone(), Truth::read(archive, truth)?);
    }
    Ok(&known[&truth.key])
}

fn compared(
    truths: &mut Truths,
    group: &[&CaseResult],
    trade: &TradeSpec,
) -> Result<Option<Trade>, StoreError> {
    let first = &group[0].case;
    let mut all = Vec::new();
    let (mut seconds, mut reference_seconds) = (Vec::new(), Vec::new());
    let (mut steps, mut iterations) = (0.0, 0.0);
    for result in group {
        let Some((truth, errors)) = truths.errors(result, &trade.reference)? else { continue };
        all.push(errors);
        steps += result.record.steps as f64;
        iterations += result.record.iterations as f64;
        let time = |result: &CaseResult| result.manifest.as_ref().map(|manifest| manifest.wall_seconds);
        seconds.extend(time(result));
        reference_seconds.extend(time(truth));
    }
    let blocks = all.len();
    let mean = |sum: f64| sum / blocks.max(1) as f64;
    let mean_of = |error: fn(&Errors) -> Option<f64>| {
        let values: Vec<f64> = all.iter().filter_map(error).collect();
        statistics::mean(&values)
    };
    Ok((blocks > 0 || group.iter().any(|result| !usable(result))).then(|| Trade {
        arm: first.arm.clone(),
        family: trade.family.clone(),
        axes: first.axes.clone(),
        blocks,
        stopped: group.iter().filter(|result| !usable(result)).count(),
        seconds: median(&seconds),
        reference_seconds: median(&reference_seconds),
        steps: mean(steps),
        iterations: mean(iterations),
        errors: Errors {
            deformation: mean_of(|errors| errors.deformation),
            impulse: mean_of(|errors| errors.impulse),
            plastic: mean_of(|errors| errors.plastic),
            kinetic: mean_of(|errors| errors.kinetic),
        },
        on_front: false,
    }))
}

fn median(values: &[f64]) -> f64 {
    statistics::median(values).unwrap_or(f64::NAN)
}

/// `trade`: one row an arm that is compared and point of the sweep.
pub fn table(trades: &[Trade]) -> Table {
    let row = |trade: &Trade| {
        let mut row = Row::default();
        row.put("arm", "-", "arm", trade.arm.as_str());
        for (name, number) in &trade.axes {
            row.put(name, "-", "axis of the sweep", *number);
        }
        row.count("blocks", "blocks compared with the reference", trade.blocks as u64)
            .count("stopped", "blocks that stopped", trade.stopped as u64)
            .number("seconds", "s", "median wall time of a case, measuring included", trade.seconds)
            .number("reference_seconds", "s", "that of the reference", trade.reference_seconds)
            .number("mean_steps", "-", "mean number of steps", trade.steps)
            .number("mean_iterations", "-", "mean applications of implicit operators", trade.iterations)
            .put(
                "error_u",
                "-",
                "relative error of the deformation, by material cells",
                trade.errors.deformation,
            )
            .put("error_impulse", "-", "relative error of the impulse on obstacles", trade.errors.impulse)
            .put(
                "error_plastic",
                "-",
                "relative error of the energy lost to plastic flow",
                trade.errors.plastic,
            )
            .number(
                "error",
                "-",
                "the largest of these three",
                if trade.blocks > 0 { trade.error() } else { f64::NAN },
            )
            .put("error_kinetic", "-", "relative error of the kinetic energy", trade.errors.kinetic)
            .put(
                "on_front",
                "-",
                "no arm of this point is both faster and closer",
                crate::table::Cell::Flag(trade.on_front),
            );
        row
    };
    Table { name: "trade", rows: trades.iter().map(row).collect() }
}
