//! An axis of a sweep whose points are spread over a box of factors.

use serde::{Deserialize, Serialize};
use toml::Value;

/// Digits of a factor's numbers (chosen: they stay legible, and no response is known to as many).
const DIGITS: i32 = 4;

/// Points spread evenly over a box: an Owen-scrambled Sobol sequence (Burley 2020, J. Comput. Graph. Tech. 9(4)), whose first points are the
/// same for every number of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampleSpec {
    /// Number of points.
    pub points: u32,
    /// Seed of the scrambling.
    #[serde(default)]
    pub seed: u32,
    /// The box: a dimension each.
    pub factor: Vec<FactorSpec>,
}

/// One dimension of the box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FactorSpec {
    /// Name: a column of the tables.
    pub name: String,
    /// Dotted path into the scene.
    pub path: String,
    /// Least and greatest value.
    pub range: [f64; 2],
    /// How points are spread between them.
    #[serde(default)]
    pub scale: Scale,
    /// Direction: the path is set to the value times this; to the value itself when left out.
    #[serde(default)]
    pub along: Option<Vec<f64>>,
    /// Arms that it is set in; all that are run along the axis when left out.
    #[serde(default)]
    pub arms: Vec<String>,
}

/// How points are spread over a range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// Evenly in the logarithm.
    Logarithmic,
}

impl SampleSpec {
    /// The number of the factor `factor`, by its index, at a point.
    pub fn number(&self, point: u32, factor: usize) -> f64 {
        let share = f64::from(sobol_burley::sample(point, factor as u32, self.seed));
        self.factor[factor].at(share)
    }

    /// The factors that an arm takes, by index.
    pub fn factors_of<'a>(&'a self, arm: &'a str) -> impl Iterator<Item = (usize, &'a FactorSpec)> {
        self.factor.iter().enumerate().filter(move |(_, factor)| factor.takes(arm))
    }
}

impl FactorSpec {
    /// Whether it is set in the arm `id`.
    pub fn takes(&self, id: &str) -> bool {
        self.arms.is_empty() || self.arms.iter().any(|arm| arm == id)
    }

    /// The number at a share of the range in [0, 1].
    pub fn at(&self, share: f64) -> f64 {
        let [least, greatest] = self.range;
        let number = match self.scale {
            Scale::Linear => least + share * (greatest - least),
            Scale::Logarithmic => least * libm::pow(greatest / least, share),
        };
        rounded(number).clamp(least, greatest)
    }

    /// The share of the range in [0, 1] at which a number lies; the inverse of [`FactorSpec::at`] but for its rounding.
    pub fn share(&self, number: f64) -> f64 {
        let [least, greatest] = self.range;
        match self.scale {
            Scale::Linear => (number - least) / (greatest - least),
            Scale::Logarithmic => libm::log(number / least) / libm::log(greatest / least),
        }
    }

    /// What the path is set to.
    pub fn value(&self, number: f64) -> Value {
        match &self.along {
            None => Value::Float(number),
            Some(along) => Value::Array(along.iter().map(|part| Value::Float(part * number)).collect()),
        }
    }
}

impl FactorSpec {
    /// The number that a value of the path stands for; the inverse of [`FactorSpec::value`].
    pub fn number(&self, value: &Value) -> Option<f64> {
        let Some(along) = &self.along else { return value.as_float() };
        let axis = along.iter().position(|part| *part != 0.0)?;
        Some(value.as_array()?.get(axis)?.as_float()? / along[axis])
    }
}

fn rounded(number: f64) -> f64 {
    if number == 0.0 || !number.is_finite() {
        return number;
    }
    let scale = libm::pow(10.0, f64::from(DIGITS - 1) - libm::floor(libm::log10(number.abs())));
    libm::round(number * scale) / scale
}
