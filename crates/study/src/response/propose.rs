//! A placement for a wanted fragmentation.

use std::collections::BTreeMap;

use super::surface::{LEVEL, Prediction, Surface};
use crate::statistics::{Interval, quantile};

/// Places of the box that are looked at (chosen: of six factors each then has a hundred values or so to itself).
const CANDIDATES: u32 = 4096;
/// A place counts as one where the wanted response is predicted within this share of a ball's own spread (chosen: far below what anyone could tell).
const CLOSE: f64 = 0.05;
/// The band of reachable responses: these quantiles of what is predicted over the box (the study's plan).
const BAND: [f64; 2] = [0.05, 0.95];
/// Seed of the places looked at (chosen: PS17's year).
const SEED: u32 = 2017;

/// What is asked for.
#[derive(Clone, Debug, Default)]
pub struct Wanted {
    /// The response.
    pub response: f64,
    /// Factors whose numbers are given, by name.
    pub given: BTreeMap<String, f64>,
}

/// A placement.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The number of each factor, in the order of the surface.
    pub numbers: Vec<f64>,
    /// What is predicted of one ball.
    pub prediction: Prediction,
    /// In which it lies with 80 % probability.
    pub interval: Interval,
}

/// Why there is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The target lies where the surface cannot be trusted to lead.
    #[error("the response {wanted:.3} is out of reach: with what is given it lies between {:.3} and {:.3} (5 to 95 % of what is predicted over the factors' ranges)", .band.lower, .band.upper)]
    OutOfReach {
        /// The target.
        wanted: f64,
        /// What can be reached.
        band: Interval,
    },
    /// A factor that the surface does not have.
    #[error("`{name}` is no factor of the arm; it has: {known}")]
    Unknown {
        /// Its name.
        name: String,
        /// Those there are.
        known: String,
    },
    /// A number outside the factor's range.
    #[error("`{name}` is {number}; allowed: {least} to {greatest}, the range that the study has sampled")]
    OutOfRange {
        /// The factor.
        name: String,
        /// The number.
        number: f64,
        /// Least.
        least: f64,
        /// Greatest.
        greatest: f64,
    },
}

/// The place at which the wanted response is predicted, and predicted best: of all that are close enough the one whose balls spread least.
///
/// # Errors
/// [`Refusal`].
pub fn propose(surface: &Surface, wanted: &Wanted) -> Result<Proposal, Refusal> {
    let places = places(surface, &wanted.given)?;
    let predicted: Vec<Prediction> = places.iter().map(|at| surface.predict(at)).collect();
    let band = quantiles(&predicted);
    if !band.contains(wanted.response) {
        return Err(Refusal::OutOfReach { wanted: wanted.response, band });
    }
    let error = |k: usize| (predicted[k].mean - wanted.response).abs() / predicted[k].deviation;
    let close: Vec<usize> = (0..places.len()).filter(|&k| error(k) < CLOSE).collect();
    let best = close
        .into_iter()
        .min_by(|&a, &b| predicted[a].deviation.total_cmp(&predicted[b].deviation))
        .or_else(|| (0..places.len()).min_by(|&a, &b| error(a).total_cmp(&error(b))))
        .expect("there are places");
    let factors = &surface.data.factors;
    let numbers: Vec<f64> = factors
        .iter()
        .zip(&places[best])
        .map(|(factor, share)| wanted.given.get(&factor.name).copied().unwrap_or_else(|| factor.at(*share)))
        .collect();
    let at: Vec<f64> = factors.iter().zip(&numbers).map(|(factor, number)| factor.share(*number)).collect();
    let prediction = surface.predict(&at);
    Ok(Proposal { numbers, prediction, interval: prediction.interval(LEVEL) })
}

/// The reachable responses with these factors given.
///
/// # Errors
/// [`Refusal`] of a factor.
pub fn band(surface: &Surface, given: &BTreeMap<String, f64>) -> Result<Interval, Refusal> {
    let places = places(surface, given)?;
    Ok(quantiles(&places.iter().map(|at| surface.predict(at)).collect::<Vec<_>>()))
}

fn quantiles(predicted: &[Prediction]) -> Interval {
    let means: Vec<f64> = predicted.iter().map(|p| p.mean).collect();
    let at = |share| quantile(&means, share).unwrap_or(f64::NAN);
    Interval { lower: at(BAND[0]), upper: at(BAND[1]) }
}

/// Places over the box, those factors held that are given.
fn places(surface: &Surface, given: &BTreeMap<String, f64>) -> Result<Vec<Vec<f64>>, Refusal> {
    let factors = &surface.data.factors;
    for (name, number) in given {
        let Some(factor) = factors.iter().find(|factor| factor.name == *name) else {
            let known: Vec<&str> = factors.iter().map(|factor| factor.name.as_str()).collect();
            return Err(Refusal::Unknown { name: name.clone(), known: known.join(", ") });
        };
        let [least, greatest] = factor.range;
        if !(least..=greatest).contains(number) {
            return Err(Refusal::OutOfRange { name: name.clone(), number: *number, least, greatest });
        }
    }
    let share = |point: u32, k: usize| match given.get(&factors[k].name) {
        Some(number) => factors[k].share(*number),
        None => f64::from(sobol_burley::sample(point, k as u32, SEED)),
    };
    Ok((0..CANDIDATES).map(|point| (0..factors.len()).map(|k| share(point, k)).collect()).collect())
}
