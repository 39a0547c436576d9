//! Lists of numbers as vectors.

use snowlab_solver::Vector;

use crate::spec::SpecError;

pub(super) fn vector_or_zero<const D: usize>(values: &[f64], key: &str) -> Result<Vector<f64, D>, SpecError> {
    if values.is_empty() { Ok(Vector::zeros()) } else { vector(values, key) }
}

pub(super) fn vector<const D: usize>(values: &[f64], key: &str) -> Result<Vector<f64, D>, SpecError> {
    if values.len() == D && values.iter().all(|v| v.is_finite()) {
        return Ok(Vector::from_fn(|k, _| values[k]));
    }
    Err(SpecError::value(key, format!("is {values:?}; a scene in {D}D takes {D} finite numbers")))
}
