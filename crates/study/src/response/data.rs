//! What is known of a response: the values of each point's balls, at the point's place in the unit box of the factors.

use std::collections::BTreeMap;
use std::path::Path;

use crate::spec::StudySpec;
use crate::spec::sample::{FactorSpec, SampleSpec};
use crate::statistics::mean;
use crate::template::{Record, records};

/// What responds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// A = ln N_eff.
    EffectiveNumber,
    /// ln of the number of fragments.
    Fragments,
    /// D = 1 - M1/M.
    Damage,
    /// Length of cracks [m].
    Crack,
}

impl Metric {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::EffectiveNumber, Self::Fragments, Self::Damage, Self::Crack];

    /// The column of `cases.csv`.
    pub fn column(self) -> &'static str {
        match self {
            Self::EffectiveNumber => "ln_neff",
            Self::Fragments => "fragments",
            Self::Damage => "damage",
            Self::Crack => "crack",
        }
    }

    /// What is fitted of a number of that column.
    pub fn fitted(self, number: f64) -> f64 {
        match self {
            Self::Fragments => libm::log(number.max(1.0)),
            Self::EffectiveNumber | Self::Damage | Self::Crack => number,
        }
    }

    /// The words for what is fitted.
    pub fn words(self) -> &'static str {
        match self {
            Self::EffectiveNumber => "ln N_eff",
            Self::Fragments => "ln N_f",
            Self::Damage => "D",
            Self::Crack => "crack length [m]",
        }
    }
}

/// A point of the box and what came out there.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Share of each factor's range, in [0, 1].
    pub at: Vec<f64>,
    /// The response of each ball.
    pub values: Vec<f64>,
}

impl Point {
    /// Mean over the balls.
    pub fn mean(&self) -> f64 {
        mean(&self.values).unwrap_or(f64::NAN)
    }
}

/// The response of one arm.
#[derive(Clone, Debug)]
pub struct Data {
    /// The arm.
    pub arm: String,
    /// What responds.
    pub metric: Metric,
    /// Dimensions of the box.
    pub factors: Vec<FactorSpec>,
    /// The points that have a value.
    pub points: Vec<Point>,
}

/// Why there is no response to learn from.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// No sampled axis.
    #[error(
        "the study `{0}` has no [sweep.sample] that its arm `{1}` is run along; a response is learnt from points of such an axis"
    )]
    NotSampled(String, String),
    /// The table cannot be read.
    #[error("{0}; run the study and `snowlab report` it")]
    Table(String),
    /// Fewer points than a surface takes.
    #[error("arm `{arm}`: {found} points have a value of `{column}`; {needed} or more are needed")]
    TooFew {
        /// The arm.
        arm: String,
        /// The column.
        column: &'static str,
        /// Points.
        found: usize,
        /// Points that are needed.
        needed: usize,
    },
}

impl Data {
    /// Reads the response of an arm from `cases.csv` in `results`, over the cases that ended well.
    ///
    /// # Errors
    /// [`DataError`].
    pub fn read(study: &StudySpec, arm: &str, metric: Metric, results: &Path) -> Result<Self, DataError> {
        let path = results.join("cases.csv");
        let rows = records(&path).map_err(|error| DataError::Table(format!("{error:#}")))?;
        Self::of(study, arm, metric, &rows)
    }

    /// The response of an arm from rows of `cases.csv`.
    ///
    /// # Errors
    /// [`DataError`].
    pub fn of(study: &StudySpec, arm: &str, metric: Metric, rows: &[Record]) -> Result<Self, DataError> {
        let sample = sample_of(study, arm)
            .ok_or_else(|| DataError::NotSampled(study.name.clone(), arm.to_string()))?;
        let factors: Vec<FactorSpec> = sample.factors_of(arm).map(|(_, factor)| factor.clone()).collect();
        // Points by their numbers as they are written.
        let mut points: BTreeMap<Vec<String>, Point> = BTreeMap::new();
        for row in rows.iter().filter(|row| row.get("arm").is_some_and(|name| name == arm)) {
            let well = row.get("outcome").is_some_and(|outcome| outcome.starts_with("ok"));
            let number = |column: &str| row.get(column).and_then(|text| text.parse::<f64>().ok());
            let at: Option<Vec<f64>> =
                factors.iter().map(|factor| Some(factor.share(number(&factor.name)?))).collect();
            if let (true, Some(at), Some(value)) = (well, at, number(metric.column())) {
                let key = factors.iter().map(|factor| row[&factor.name].clone()).collect();
                let point = points.entry(key).or_insert(Point { at, values: Vec::new() });
                point.values.push(metric.fitted(value));
            }
        }
        let points: Vec<Point> = points.into_values().collect();
        // Chosen: half as many again as a quadratic surface has coefficients.
        let needed = 3 * coefficients(factors.len()) / 2;
        if points.len() < needed {
            return Err(DataError::TooFew {
                arm: arm.into(),
                column: metric.column(),
                found: points.len(),
                needed,
            });
        }
        Ok(Data { arm: arm.into(), metric, factors, points })
    }

    /// Variance of balls about the mean of their point, pooled.
    pub fn noise(&self) -> f64 {
        let squares = |point: &Point| point.values.iter().map(|v| (v - point.mean()).powi(2)).sum::<f64>();
        let freedom: usize = self.points.iter().map(|point| point.values.len() - 1).sum();
        self.points.iter().map(squares).sum::<f64>() / freedom.max(1) as f64
    }
}

/// The sampled axis that an arm is run along.
pub fn sample_of<'a>(study: &'a StudySpec, arm: &str) -> Option<&'a SampleSpec> {
    study.sweep.iter().filter(|axis| axis.takes(arm)).find_map(|axis| axis.sample.as_ref())
}

/// The arms that are run along a sampled axis.
pub fn sampled_arms(study: &StudySpec) -> Vec<&str> {
    study.arm.iter().map(|arm| arm.id.as_str()).filter(|arm| sample_of(study, arm).is_some()).collect()
}

/// Coefficients of a quadratic in so many factors.
pub(super) fn coefficients(factors: usize) -> usize {
    (factors + 1) * (factors + 2) / 2
}
