use serde::{Deserialize, Serialize};

/// A closed interval of the estimated quantity, in that quantity's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

impl Interval {
    /// Whether the whole interval lies above `value`.
    pub fn lies_above(&self, value: f64) -> bool {
        self.lower > value
    }

    /// Whether the whole interval lies below `value`.
    pub fn lies_below(&self, value: f64) -> bool {
        self.upper < value
    }

    /// Whether `value` lies in the interval, ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }
}
