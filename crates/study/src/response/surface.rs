//! A response surface: the model that predicts points it has not seen better.

use super::data::Data;
use super::process::Process;
use super::quadratic::Quadratic;
use super::score::{Skill, interval_score};
use crate::statistics::{Interval, mean, standard_deviation, student_t_quantile};

/// Level of the prediction intervals (the study's plan).
pub const LEVEL: f64 = 0.8;

/// What a model says of one ball at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Mean.
    pub mean: f64,
    /// Standard deviation of a ball about it: what is not known of the mean, and what differs from ball to ball.
    pub deviation: f64,
    /// Degrees of freedom; infinite for a normal law.
    pub freedom: f64,
}

impl Prediction {
    /// The interval that one ball lies in with the probability `level`.
    pub fn interval(&self, level: f64) -> Interval {
        // Beyond a million degrees of freedom Student's law is the normal one.
        let t = student_t_quantile(0.5 + 0.5 * level, self.freedom.min(1e6));
        Interval { lower: self.mean - t * self.deviation, upper: self.mean + t * self.deviation }
    }
}

/// A model of the response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A full quadratic by least squares.
    Quadratic,
    /// A Gaussian process.
    Process,
}

impl Kind {
    /// The words for it.
    pub fn words(self) -> &'static str {
        match self {
            Kind::Quadratic => "quadratic",
            Kind::Process => "Gaussian process",
        }
    }
}

enum Model {
    Quadratic(Quadratic),
    Process(Box<Process>),
}

/// The better model of the two, and how well each predicts.
pub struct Surface {
    /// What it was learnt from.
    pub data: Data,
    /// Which model it is.
    pub kind: Kind,
    /// Leave-point-out skill of the quadratic, the Gaussian process, and of no factor at all.
    pub skills: [Skill; 3],
    model: Model,
}

impl Surface {
    /// Fits both models and keeps the one with the lower leave-point-out interval score.
    ///
    /// # Errors
    /// In words, where a model cannot be fitted.
    pub fn fit(data: Data) -> Result<Self, String> {
        let quadratic = Quadratic::fit(&data)?;
        let process = Process::fit(&data)?;
        let skills = [
            Skill::of(&data, &quadratic.left_out(&data)),
            Skill::of(&data, &process.left_out(&data)),
            Skill::of(&data, &no_factor(&data)),
        ];
        let better = skills[0].score <= skills[1].score;
        let (kind, model) = if better {
            (Kind::Quadratic, Model::Quadratic(quadratic))
        } else {
            (Kind::Process, Model::Process(Box::new(process)))
        };
        Ok(Surface { data, kind, skills, model })
    }

    /// What it says of one ball at a point of the unit box.
    pub fn predict(&self, at: &[f64]) -> Prediction {
        match &self.model {
            Model::Quadratic(model) => model.predict(at),
            Model::Process(model) => model.predict(at),
        }
    }

    /// Interval score of its predictions for values seen at points, at [`LEVEL`].
    pub fn score(&self, at: &[f64], value: f64) -> f64 {
        interval_score(self.predict(at).interval(LEVEL), value, LEVEL)
    }
}

/// For each point the mean and spread of all balls of the others.
pub(super) fn no_factor(data: &Data) -> Vec<Prediction> {
    let others = |left: usize| -> Vec<f64> {
        let points = data.points.iter().enumerate().filter(|(k, _)| *k != left);
        points.flat_map(|(_, point)| point.values.iter().copied()).collect()
    };
    (0..data.points.len()).map(|left| of_all(&others(left))).collect()
}

/// Mean and spread of balls, whatever their factors.
pub(super) fn of_all(values: &[f64]) -> Prediction {
    let n = values.len() as f64;
    Prediction {
        mean: mean(values).unwrap_or(f64::NAN),
        deviation: standard_deviation(values).unwrap_or(f64::NAN) * (1.0 + 1.0 / n).sqrt(),
        freedom: n - 1.0,
    }
}
