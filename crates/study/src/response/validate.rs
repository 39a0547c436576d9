//! Whether predictions hold: targets that were not learnt from, frozen before they are run, and what came out of them.

use std::collections::BTreeMap;

use super::propose::{Proposal, Refusal, Wanted, band, propose};
use super::score::interval_score;
use super::surface::{LEVEL, Prediction, Surface, of_all};
use crate::spec::study::SweepSpec;
use crate::statistics::{Interval, clopper_pearson, least_squares_slope, mean};
use crate::table::{Row, Table};
use crate::template::Record;
use toml::Value;

/// The factor that a user gives beside the wanted response, where there is one.
const GIVEN: &str = "speed";
/// Seed of the targets (chosen: the year after PS17's).
const SEED: u32 = 2018;
/// Share of the reachable band that targets are drawn from, on either side of its middle (chosen: all but its outermost tenths).
const INSIDE: [f64; 2] = [0.1, 0.9];

/// A target with the placement proposed for it.
#[derive(Clone, Debug)]
pub struct Target {
    /// Index of its surface.
    pub surface: usize,
    /// The response wanted.
    pub wanted: f64,
    /// The placement.
    pub proposal: Proposal,
}

/// Targets spread evenly over what can be reached and over the speed; each is given to the surface that predicts it best.
///
/// # Errors
/// [`Refusal`], where a band cannot be told.
pub fn targets(surfaces: &[Surface], count: usize) -> Result<Vec<Target>, Refusal> {
    let drawn = |point: usize, dimension: u32| f64::from(sobol_burley::sample(point as u32, dimension, SEED));
    let mut targets = Vec::new();
    for point in 0..count {
        let speed = surfaces[0].data.factors.iter().find(|factor| factor.name == GIVEN);
        let given: BTreeMap<String, f64> =
            speed.map(|factor| (GIVEN.to_string(), factor.at(drawn(point, 0)))).into_iter().collect();
        let bands = surfaces.iter().map(|surface| band(surface, &given)).collect::<Result<Vec<_>, _>>()?;
        let lower = bands.iter().map(|band| band.lower).fold(f64::INFINITY, f64::min);
        let upper = bands.iter().map(|band| band.upper).fold(f64::NEG_INFINITY, f64::max);
        let share = INSIDE[0] + drawn(point, 1) * (INSIDE[1] - INSIDE[0]);
        let wanted = Wanted { response: lower + share * (upper - lower), given };
        let proposals = surfaces.iter().enumerate().filter_map(|(k, s)| Some((k, propose(s, &wanted).ok()?)));
        let best = proposals.min_by(|a, b| a.1.prediction.deviation.total_cmp(&b.1.prediction.deviation));
        // Between two bands there may be a gap that no surface reaches.
        targets.extend(best.map(|(surface, proposal)| Target { surface, wanted: wanted.response, proposal }));
    }
    Ok(targets)
}

/// The axis that runs a surface's targets: numbers are those of the targets, labels the responses wanted.
pub fn axis(surface: &Surface, number: usize, targets: &[Target]) -> Option<SweepSpec> {
    let own: Vec<(usize, &Target)> =
        targets.iter().enumerate().filter(|(_, t)| t.surface == number).collect();
    let factors = &surface.data.factors;
    let settings = |target: &Target| {
        let set = factors.iter().zip(&target.proposal.numbers);
        Value::Table(set.map(|(factor, number)| (factor.path.clone(), factor.value(*number))).collect())
    };
    (!own.is_empty()).then(|| SweepSpec {
        name: format!("target-{}", surface.data.arm),
        path: None,
        values: own.iter().map(|(_, target)| settings(target)).collect(),
        sample: None,
        labels: Some(own.iter().map(|(_, target)| format!("{:.4}", target.wanted)).collect()),
        numbers: Some(own.iter().map(|(index, _)| (index + 1) as f64).collect()),
        axis_label: None,
        arms: vec![surface.data.arm.clone()],
    })
}

/// A target that has been run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its number.
    pub target: f64,
    /// Its arm.
    pub arm: String,
    /// What is predicted.
    pub prediction: Prediction,
    /// What came out, ball by ball.
    pub values: Vec<f64>,
}

/// The targets of a surface that have been run.
pub fn outcomes(surface: &Surface, axis: &SweepSpec, rows: &[Record]) -> Vec<Outcome> {
    let metric = surface.data.metric;
    let outcome = |index: usize| {
        let settings = axis.values[index].as_table()?;
        let at: Option<Vec<f64>> = surface
            .data
            .factors
            .iter()
            .map(|factor| Some(factor.share(factor.number(settings.get(&factor.path)?)?)))
            .collect();
        let target = axis.number(index);
        let of_target = |row: &&Record| row.get(&axis.name).and_then(|n| n.parse().ok()) == Some(target);
        let values = rows
            .iter()
            .filter(of_target)
            .filter(|row| row.get("outcome").is_some_and(|outcome| outcome.starts_with("ok")))
            .filter_map(|row| Some(metric.fitted(row.get(metric.column())?.parse().ok()?)))
            .collect();
        let arm = surface.data.arm.clone();
        Some(Outcome { target, arm, prediction: surface.predict(&at?), values })
    };
    (0..axis.values.len()).filter_map(outcome).filter(|outcome| !outcome.values.is_empty()).collect()
}

/// How the predictions did.
#[derive(Clone, Debug)]
pub struct Validation {
    /// Balls.
    pub balls: usize,
    /// Balls in their 80 % interval.
    pub inside: usize,
    /// 95 % limits of that share (Clopper & Pearson 1934). Balls of one target share its error: the limits are those of independent balls.
    pub coverage: Interval,
    /// Mean interval score.
    pub score: f64,
    /// That of the mean and spread of all balls learnt from, whatever their factors.
    pub score_no_factor: f64,
    /// Slope of the targets' means on the predicted ones: 1 where a wanted change comes out in full.
    pub slope: Option<f64>,
}

impl Validation {
    /// Of all targets that have been run; `None` without one.
    pub fn of(surfaces: &[Surface], outcomes: &[Outcome]) -> Option<Self> {
        let balls = || outcomes.iter().flat_map(|o| o.values.iter().map(move |value| (o, *value)));
        let count = balls().count();
        let inside = balls().filter(|(o, value)| o.prediction.interval(LEVEL).contains(*value)).count();
        let learnt: Vec<f64> =
            surfaces.iter().flat_map(|s| &s.data.points).flat_map(|p| p.values.iter().copied()).collect();
        let flat = of_all(&learnt).interval(LEVEL);
        let score = balls().map(|(o, value)| interval_score(o.prediction.interval(LEVEL), value, LEVEL));
        let flat_score = balls().map(|(_, value)| interval_score(flat, value, LEVEL));
        let predicted: Vec<f64> = outcomes.iter().map(|o| o.prediction.mean).collect();
        let found: Vec<f64> = outcomes.iter().filter_map(|o| mean(&o.values)).collect();
        Some(Validation {
            balls: count,
            inside,
            coverage: clopper_pearson(inside, count, 0.95)?,
            score: score.sum::<f64>() / count as f64,
            score_no_factor: flat_score.sum::<f64>() / count as f64,
            slope: least_squares_slope(&predicted, &found),
        })
    }
}

impl Validation {
    /// `validation_summary`: one row.
    pub fn table(&self) -> Table {
        let mut row = Row::default();
        row.count("balls", "balls thrown", self.balls as u64)
            .count("inside", "balls in their 80 % interval", self.inside as u64)
            .number(
                "coverage",
                "-",
                "share of the balls in their 80 % interval",
                self.inside as f64 / self.balls as f64,
            )
            .number("coverage_lower", "-", "95 % limit by Clopper and Pearson", self.coverage.lower)
            .number("coverage_upper", "-", "95 % limit by Clopper and Pearson", self.coverage.upper)
            .number("score", "ln N_eff", "interval score, mean over balls", self.score)
            .number(
                "score_no_factor",
                "ln N_eff",
                "that of the mean and spread of all balls learnt from",
                self.score_no_factor,
            )
            .put("slope", "-", "of the targets' means on the predicted ones", self.slope);
        Table { name: "validation_summary", rows: vec![row] }
    }

    /// The same in a line.
    pub fn in_words(&self) -> String {
        format!(
            "{} of {} balls in the 80 % interval ({:.3}, 95 % limits {:.3} to {:.3}); interval score {:.3}, {:.2} of that without factors; slope {:.2}",
            self.inside,
            self.balls,
            self.inside as f64 / self.balls as f64,
            self.coverage.lower,
            self.coverage.upper,
            self.score,
            self.score / self.score_no_factor,
            self.slope.unwrap_or(f64::NAN)
        )
    }
}

/// `validation`: one row a target.
pub fn table(outcomes: &[Outcome]) -> Table {
    let rows = outcomes.iter().map(|outcome| {
        let interval = outcome.prediction.interval(LEVEL);
        let inside = outcome.values.iter().filter(|value| interval.contains(**value)).count();
        let mut row = Row::default();
        row.number("target", "-", "its number", outcome.target)
            .put("arm", "-", "arm", outcome.arm.as_str())
            .number("predicted", "ln N_eff", "predicted mean", outcome.prediction.mean)
            .number("lower", "ln N_eff", "lower end of the 80 % interval for one ball", interval.lower)
            .number("upper", "ln N_eff", "upper end of the 80 % interval for one ball", interval.upper)
            .count("balls", "balls thrown", outcome.values.len() as u64)
            .count("inside", "balls in the interval", inside as u64)
            .put("mean", "ln N_eff", "mean over the balls", mean(&outcome.values));
        row
    });
    Table { name: "validation", rows: rows.collect() }
}
