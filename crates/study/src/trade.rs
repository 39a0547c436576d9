//! What arms trade: their error beside a reference with the same particles, for the time they take.
//!
//! The response to a placement is smooth enough that settings which keep it are compared path by path. The error is the largest of three, each of
//! the end of the run:
//!
//! - e_u: relative L2 of the mean displacement over material cells, beside the deformation there is (the displacement less its mean);
//! - e_I: of the impulse on all obstacles;
//! - e_W: of the energy lost to plastic flow, where there is any.

use std::collections::BTreeMap;

use crate::results::{Archive, CaseResult};
use crate::spec::study::TradeSpec;
use crate::store::StoreError;
use crate::table::{Row, Table};
use crate::tables::usable;

/// Cells along the longest edge of the box round the particles at rest (chosen: R/8 for a ball; single particles are too coarse a sample).
const CELLS: f64 = 16.0;

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
    /// e_u, e_I and e_W.
    pub errors: [Option<f64>; 3],
    /// Whether no arm of this point is both faster and closer.
    pub on_front: bool,
}

impl Trade {
    /// The largest of its errors.
    pub fn error(&self) -> f64 {
        self.errors.iter().flatten().copied().fold(0.0, f64::max)
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
    for group in crate::tables::groups(results) {
        let first = &group[0].case;
        if let Some(trade) = trade_of(&first.arm) {
            trades.extend(compare(archive, results, &group, trade)?);
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

fn compare(
    archive: &Archive,
    results: &[CaseResult],
    group: &[&CaseResult],
    trade: &TradeSpec,
) -> Result<Option<Trade>, StoreError> {
    let first = &group[0].case;
    let mut sums = [(0.0, 0); 3];
    let (mut seconds, mut reference_seconds) = (Vec::new(), Vec::new());
    let (mut blocks, mut steps, mut iterations) = (0, 0.0, 0.0);
    for result in group.iter().filter(|result| usable(result)) {
        let is_truth = |other: &&CaseResult| {
            other.case.arm == trade.reference
                && other.case.axes == result.case.axes
                && other.case.block == result.case.block
                && usable(other)
        };
        let Some(truth) = results.iter().find(is_truth) else { continue };
        let errors = match result.case.scene.dimension {
            3 => errors::<3>(archive, result, truth)?,
            _ => errors::<2>(archive, result, truth)?,
        };
        for (sum, error) in sums.iter_mut().zip(errors) {
            if let Some(error) = error {
                *sum = (sum.0 + error, sum.1 + 1);
            }
        }
        blocks += 1;
        steps += result.record.steps as f64;
        iterations += result.record.iterations as f64;
        let time = |result: &CaseResult| result.manifest.as_ref().map(|manifest| manifest.wall_seconds);
        seconds.extend(time(result));
        reference_seconds.extend(time(truth));
    }
    let mean = |sum: f64| sum / blocks.max(1) as f64;
    Ok((blocks > 0 || group.iter().any(|result| !usable(result))).then(|| Trade {
        arm: first.arm.clone(),
        family: trade.family.clone(),
        axes: first.axes.clone(),
        blocks,
        stopped: group.iter().filter(|result| !usable(result)).count(),
        seconds: median(&mut seconds),
        reference_seconds: median(&mut reference_seconds),
        steps: mean(steps),
        iterations: mean(iterations),
        errors: sums.map(|(sum, count)| (count > 0).then(|| sum / f64::from(count))),
        on_front: false,
    }))
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 { f64::NAN } else { 0.5 * (values[(n - 1) / 2] + values[n / 2]) }
}

/// e_u, e_I and e_W of `result` beside `truth`.
fn errors<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
    truth: &CaseResult,
) -> Result<[Option<f64>; 3], StoreError> {
    let displacement = displacement_error::<D>(archive, result, truth)?;
    let (Some(own), Some(theirs)) = (result.record.history.last(), truth.record.history.last()) else {
        return Ok([displacement, None, None]);
    };
    let impulse = |row: &crate::record::HistoryRow| -> Vec<f64> {
        (0..D).map(|k| row.impulses.iter().map(|impulse| impulse[k]).sum()).collect()
    };
    let (own_impulse, their_impulse) = (impulse(own), impulse(theirs));
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let difference: Vec<f64> = own_impulse.iter().zip(&their_impulse).map(|(a, b)| a - b).collect();
    let of_impulse = (norm(&their_impulse) > 0.0).then(|| norm(&difference) / norm(&their_impulse));
    let of_plastic = (theirs.plastic_loss > 0.0)
        .then(|| (own.plastic_loss - theirs.plastic_loss).abs() / theirs.plastic_loss);
    Ok([displacement, of_impulse, of_plastic])
}

/// Mean displacements by material cell: particles, and the sum of what they moved [m].
type Cells<const D: usize> = BTreeMap<[i64; D], (f64, [f64; D])>;

fn displacement_error<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
    truth: &CaseResult,
) -> Result<Option<f64>, StoreError> {
    let (own, theirs) = (cells::<D>(archive, result)?, cells::<D>(archive, truth)?);
    let particles: f64 = theirs.values().map(|(count, _)| count).sum();
    let mean: [f64; D] =
        std::array::from_fn(|k| theirs.values().map(|(_, moved)| moved[k]).sum::<f64>() / particles);
    let (mut error, mut size) = (0.0, 0.0);
    for (cell, (count, moved)) in &theirs {
        let Some((own_count, own_moved)) = own.get(cell) else { return Ok(None) };
        for k in 0..D {
            let truth = moved[k] / count;
            error += count * (own_moved[k] / own_count - truth).powi(2);
            size += count * (truth - mean[k]).powi(2);
        }
    }
    Ok((size > 0.0).then(|| (error / size).sqrt()))
}

fn cells<const D: usize>(archive: &Archive, result: &CaseResult) -> Result<Cells<D>, StoreError> {
    let frames = archive.store.case(&result.key).read_frames::<D>()?;
    let (Some(first), Some(last)) = (frames.frames.first(), frames.frames.last()) else {
        return Ok(Cells::new());
    };
    let extent = |k: usize| {
        let of = |p: &[f32; D]| f64::from(p[k]);
        let least = first.positions.iter().map(of).fold(f64::INFINITY, f64::min);
        first.positions.iter().map(of).fold(f64::NEG_INFINITY, f64::max) - least
    };
    let side = (0..D).map(extent).fold(0.0, f64::max) / CELLS;
    let mut cells = Cells::new();
    for (start, end) in first.positions.iter().zip(&last.positions) {
        let cell = start.map(|x| (f64::from(x) / side).floor() as i64);
        let (count, moved) = cells.entry(cell).or_insert((0.0, [0.0; D]));
        *count += 1.0;
        for k in 0..D {
            moved[k] += f64::from(end[k]) - f64::from(start[k]);
        }
    }
    Ok(cells)
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
            .put("error_u", "-", "relative error of the deformation, by material cells", trade.errors[0])
            .put("error_impulse", "-", "relative error of the impulse on obstacles", trade.errors[1])
            .put("error_plastic", "-", "relative error of the energy lost to plastic flow", trade.errors[2])
            .number(
                "error",
                "-",
                "the largest of these",
                if trade.blocks > 0 { trade.error() } else { f64::NAN },
            )
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
