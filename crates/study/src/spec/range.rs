//! Ranges of numbers, in words that a message and `docs/input.md` share.

use std::fmt;

/// Numbers from `least` to `greatest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least number, negative infinity without one.
    pub least: f64,
    /// Whether `least` itself is allowed.
    pub from_least: bool,
    /// Greatest number, infinity without one.
    pub greatest: f64,
    /// Whether `greatest` itself is allowed.
    pub to_greatest: bool,
}

/// Every finite number.
pub const FINITE: Range =
    Range { least: f64::NEG_INFINITY, from_least: false, greatest: f64::INFINITY, to_greatest: false };
/// Finite and above 0.
pub const POSITIVE: Range = Range { least: 0.0, ..FINITE };
/// Finite and not below 0.
pub const NOT_NEGATIVE: Range = at_least(0.0);

/// From `least`, which is allowed, on.
pub const fn at_least(least: f64) -> Range {
    Range { least, from_least: true, ..FINITE }
}

/// From `least` to `greatest`, both allowed.
pub const fn within(least: f64, greatest: f64) -> Range {
    Range { least, from_least: true, greatest, to_greatest: true }
}

impl Range {
    /// The same without its least number.
    pub const fn open_below(self) -> Self {
        Range { from_least: false, ..self }
    }

    /// The same without its greatest number.
    pub const fn open_above(self) -> Self {
        Range { to_greatest: false, ..self }
    }

    /// Whether `value` lies in it; NaN and infinities never do.
    pub fn contains(&self, value: f64) -> bool {
        value.is_finite()
            && (value > self.least || self.from_least && value == self.least)
            && (value < self.greatest || self.to_greatest && value == self.greatest)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = (Number(self.least), Number(self.greatest));
        match (self.least.is_finite(), self.from_least, self.greatest.is_finite(), self.to_greatest) {
            (false, _, false, _) => write!(f, "finite"),
            (true, true, false, _) => write!(f, "{low} or more"),
            (true, false, false, _) => write!(f, "above {low}"),
            (true, true, true, true) => write!(f, "{low} to {high}"),
            (true, true, true, false) => write!(f, "{low} or more, below {high}"),
            (true, false, true, true) => write!(f, "above {low}, at most {high}"),
            (true, false, true, false) => write!(f, "above {low}, below {high}"),
            (false, _, true, true) => write!(f, "at most {high}"),
            (false, _, true, false) => write!(f, "below {high}"),
        }
    }
}

/// A number with few digits: large ones as powers of ten.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.abs() >= 1e5 { write!(f, "{:e}", self.0) } else { write!(f, "{}", self.0) }
    }
}

/// A value with few digits: very large and very small ones by powers of ten.
pub struct Shown(pub f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        let usual = size == 0.0 || (1e-9..1e16).contains(&size) || !size.is_finite();
        if usual { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}
