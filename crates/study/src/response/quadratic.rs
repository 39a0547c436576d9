//! A full quadratic in the factors, by least squares on the means of the points.

use nalgebra::{DMatrix, DVector};

use super::data::{Data, coefficients};
use super::surface::Prediction;

/// The surface.
pub struct Quadratic {
    coefficients: DVector<f64>,
    /// (X^T X)^-1.
    inverse: DMatrix<f64>,
    /// Variance of the points' means about the surface.
    residual: f64,
    /// What a single ball's variance has beyond that of a point's mean.
    single: f64,
    freedom: f64,
}

impl Quadratic {
    /// Fits the surface.
    ///
    /// # Errors
    /// Points that lie so that no surface is determined.
    pub fn fit(data: &Data) -> Result<Self, String> {
        let (n, k) = (data.points.len(), coefficients(data.factors.len()));
        let rows: Vec<Vec<f64>> = data.points.iter().map(|point| terms(&point.at)).collect();
        let x = DMatrix::from_fn(n, k, |i, j| rows[i][j]);
        let y = DVector::from_iterator(n, data.points.iter().map(|point| point.mean()));
        let inverse = (x.transpose() * &x)
            .cholesky()
            .ok_or_else(|| format!("the {n} points determine no quadratic of {k} coefficients"))?
            .inverse();
        let solved = &inverse * (x.transpose() * &y);
        let freedom = (n - k) as f64;
        let residual = (&y - &x * &solved).norm_squared() / freedom;
        Ok(Quadratic { coefficients: solved, inverse, residual, single: single(data), freedom })
    }

    /// What it says of one ball.
    pub fn predict(&self, at: &[f64]) -> Prediction {
        let x = DVector::from_vec(terms(at));
        let leverage = (x.transpose() * &self.inverse * &x)[0];
        self.prediction(x.dot(&self.coefficients), self.residual, leverage, self.freedom)
    }

    fn prediction(&self, mean: f64, residual: f64, leverage: f64, freedom: f64) -> Prediction {
        Prediction { mean, deviation: (residual * (1.0 + leverage) + self.single).sqrt(), freedom }
    }

    /// For each point what the surface through all others says of it (Allen 1974: the error left out is the error over 1 - leverage).
    pub fn left_out(&self, data: &Data) -> Vec<Prediction> {
        let left = |point: &super::Point| {
            let x = DVector::from_vec(terms(&point.at));
            let leverage = (x.transpose() * &self.inverse * &x)[0];
            let error = (point.mean() - x.dot(&self.coefficients)) / (1.0 - leverage);
            let freedom = self.freedom - 1.0;
            let squares = self.residual * self.freedom - error * error * (1.0 - leverage);
            // Of the others, about which the point lies further out.
            self.prediction(point.mean() - error, squares / freedom, leverage / (1.0 - leverage), freedom)
        };
        data.points.iter().map(left).collect()
    }
}

/// A ball's variance about its point's mean is the noise; that mean of n balls has 1/n of it already.
fn single(data: &Data) -> f64 {
    let balls =
        data.points.iter().map(|point| point.values.len()).sum::<usize>() as f64 / data.points.len() as f64;
    data.noise() * (1.0 - 1.0 / balls)
}

/// 1, u_i, and u_i u_j, of u = 2 at - 1.
fn terms(at: &[f64]) -> Vec<f64> {
    let u: Vec<f64> = at.iter().map(|share| 2.0 * share - 1.0).collect();
    let squares = (0..u.len()).flat_map(|i| (i..u.len()).map(move |j| (i, j))).map(|(i, j)| u[i] * u[j]);
    [1.0].into_iter().chain(u.iter().copied()).chain(squares).collect()
}
