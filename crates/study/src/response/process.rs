//! A Gaussian process of constant mean and squared-exponential covariance with a length for each factor, on the means of the points (Rasmussen &
//! Williams 2006, Gaussian Processes for Machine Learning, ch. 2 and 5).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::data::Data;
use super::search::minimum;
use super::surface::Prediction;

/// Lengths, in ranges of the factor: a factor with the longest does nothing (chosen: beyond, the likelihood is flat).
const LENGTHS: [f64; 2] = [0.1, 10.0];
/// Standard deviations of the process and of what no smooth surface explains, over that of the points' means.
const SPREADS: [f64; 2] = [1e-3, 10.0];

/// The process.
pub struct Process {
    points: Vec<Vec<f64>>,
    lengths: Vec<f64>,
    /// Variance of the process.
    signal: f64,
    /// Variance of a single ball about it.
    single: f64,
    mean: f64,
    /// K^-1 (y - mean).
    weights: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

/// Lengths, variance of the process, variance of what it leaves of points.
struct Shape {
    lengths: Vec<f64>,
    signal: f64,
    rough: f64,
}

impl Process {
    /// Fits the lengths and variances by their likelihood.
    ///
    /// # Errors
    /// A covariance that cannot be factored.
    pub fn fit(data: &Data) -> Result<Self, String> {
        let means: Vec<f64> = data.points.iter().map(|point| point.mean()).collect();
        let centre = means.iter().sum::<f64>() / means.len() as f64;
        let spread = (means.iter().map(|m| (m - centre).powi(2)).sum::<f64>() / means.len() as f64).sqrt();
        if spread == 0.0 {
            return Err("all points have the same response".into());
        }
        let d = data.factors.len();
        let shape = |x: &[f64]| Shape {
            lengths: x[..d].iter().map(|ln| libm::exp(*ln)).collect(),
            signal: libm::exp(2.0 * x[d]) * spread * spread,
            rough: libm::exp(2.0 * x[d + 1]) * spread * spread,
        };
        let ends = |[low, high]: [f64; 2]| [libm::log(low), libm::log(high)];
        let limits: Vec<[f64; 2]> = vec![ends(LENGTHS); d].into_iter().chain([ends(SPREADS); 2]).collect();
        let cost =
            |x: &[f64]| Self::with(data, &shape(x)).map_or(f64::INFINITY, |(_, likelihood)| -likelihood);
        // Smooth and rough beginnings: the likelihood has more than one top.
        let starts = [(1.0, 1.0, 0.1), (0.4, 1.0, 0.1), (2.0, 0.7, 0.7)];
        let found = starts.map(|(length, signal, rough)| {
            let mut start = vec![libm::log(length); d];
            start.extend([libm::log(signal), libm::log(rough)]);
            minimum(cost, start, &limits)
        });
        let best = found.iter().min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are starts");
        let fitted = Self::with(data, &shape(&best.0));
        fitted.map(|(process, _)| process).ok_or_else(|| "the covariance of the points is singular".into())
    }

    /// The process of a shape, with its log likelihood, up to a constant.
    fn with(data: &Data, shape: &Shape) -> Option<(Self, f64)> {
        let n = data.points.len();
        let points: Vec<Vec<f64>> = data.points.iter().map(|point| point.at.clone()).collect();
        let noise = data.noise();
        let y = DVector::from_iterator(n, data.points.iter().map(|point| point.mean()));
        let covariance = DMatrix::from_fn(n, n, |i, j| {
            let own = if i == j { shape.rough + noise / data.points[i].values.len() as f64 } else { 0.0 };
            covariance(&shape.lengths, shape.signal, &points[i], &points[j]) + own
        });
        let factor = covariance.cholesky()?;
        let ones = DVector::from_element(n, 1.0);
        let mean = ones.dot(&factor.solve(&y)) / ones.dot(&factor.solve(&ones));
        let centred = y.add_scalar(-mean);
        let weights = factor.solve(&centred);
        let log_determinant: f64 = factor.l_dirty().diagonal().iter().map(|l| libm::log(*l)).sum();
        let likelihood = -0.5 * centred.dot(&weights) - log_determinant;
        let process = Process {
            points,
            lengths: shape.lengths.clone(),
            signal: shape.signal,
            single: shape.rough + noise,
            mean,
            weights,
            factor,
        };
        Some((process, likelihood))
    }

    /// What it says of one ball.
    pub fn predict(&self, at: &[f64]) -> Prediction {
        let near = DVector::from_iterator(
            self.points.len(),
            self.points.iter().map(|point| covariance(&self.lengths, self.signal, point, at)),
        );
        let known = near.dot(&self.factor.solve(&near));
        Prediction {
            mean: self.mean + near.dot(&self.weights),
            deviation: ((self.signal - known).max(0.0) + self.single).sqrt(),
            freedom: f64::INFINITY,
        }
    }

    /// For each point what the process of all others says of it, lengths and variances kept (Dubrule 1983, Math. Geol. 15, 687).
    pub fn left_out(&self, data: &Data) -> Vec<Prediction> {
        let inverse = self.factor.inverse();
        let noise = data.noise();
        let left = |(k, point): (usize, &super::Point)| Prediction {
            mean: point.mean() - self.weights[k] / inverse[(k, k)],
            // The variance is that of the point's mean, which has a share of the noise.
            deviation: (1.0 / inverse[(k, k)] + noise * (1.0 - 1.0 / point.values.len() as f64)).sqrt(),
            freedom: f64::INFINITY,
        };
        data.points.iter().enumerate().map(left).collect()
    }
}

fn covariance(lengths: &[f64], signal: f64, a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = lengths.iter().zip(a.iter().zip(b)).map(|(l, (a, b))| ((a - b) / l).powi(2)).sum();
    signal * libm::exp(-0.5 * squares)
}
