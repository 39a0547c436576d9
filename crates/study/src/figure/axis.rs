//! Axes: a coordinate of plotters that is linear or logarithmic by value, not by type, and where its ticks stand.

use super::style;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// How values are laid along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm; only positive values have a place.
    Logarithmic,
}

/// An axis from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Even or logarithmic.
    pub scale: Scale,
    /// Value at the start.
    pub low: f64,
    /// Value at the end.
    pub high: f64,
}

/// A tick: a value and what is written there (nothing at minor ticks).
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where.
    pub value: f64,
    /// The number, empty at a minor tick.
    pub label: String,
}

/// Share of the axis at either side of a value that has no other beside it (chosen: enough for a tick or two).
const ALONE: f64 = 0.05;

impl Axis {
    /// The smallest axis that holds all values with `pad` of its length free at both ends; round values that are all
    /// the same there is room even where `pad` is 0. Values that are not finite (or not positive on a logarithmic axis)
    /// are passed over; without any the axis runs from 0 to 1 (from 0.1 to 1).
    pub fn around(scale: Scale, values: impl IntoIterator<Item = f64>, pad: f64) -> Self {
        let mut range: Option<[f64; 2]> = None;
        for value in values {
            if value.is_finite() && (scale == Scale::Linear || value > 0.0) {
                let [low, high] = range.unwrap_or([value, value]);
                range = Some([low.min(value), high.max(value)]);
            }
        }
        match (scale, range) {
            (Scale::Linear, None) => Self { scale, low: 0.0, high: 1.0 },
            (Scale::Logarithmic, None) => Self { scale, low: 0.1, high: 1.0 },
            (Scale::Linear, Some([low, high])) => {
                let least = 1e-9 * low.abs().max(high.abs());
                let alone = high - low <= least;
                let width = if alone { low.abs().max(1.0) } else { high - low };
                let pad = if alone { pad.max(ALONE) } else { pad };
                Self { scale, low: low - pad * width, high: high + pad * width }
            }
            (Scale::Logarithmic, Some([low, high])) => {
                let alone = high / low <= 1.0 + 1e-9;
                let width = if alone { 2.0 } else { libm::log(high / low) };
                let pad = if alone { pad.max(ALONE) } else { pad };
                Self { scale, low: low * libm::exp(-pad * width), high: high * libm::exp(pad * width) }
            }
        }
    }

    /// Place of a value, 0 at the start and 1 at the end; `None` for a value without a place.
    pub fn share(&self, value: f64) -> Option<f64> {
        let share = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Logarithmic => libm::log(value / self.low) / libm::log(self.high / self.low),
        };
        share.is_finite().then_some(share)
    }

    /// Ticks inside the axis, at most about `most` with labels.
    pub fn ticks(&self, most: usize) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => linear_ticks(self.low, self.high, most),
            Scale::Logarithmic => logarithmic_ticks(self.low, self.high, most),
        }
    }
}

/// A value without a place is mapped to the start; callers ask [`Axis::share`] first. The logarithm is libm's, as that
/// of plotters' own logarithmic coordinate may differ in the last bit from machine to machine.
impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        RangedCoordf64::from(0.0..1.0).map(&self.share(*value).unwrap_or(0.0), limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        self.ticks(hint.max_num_points()).into_iter().map(|tick| tick.value).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

/// Multiples of 1, 2 or 5 times a power of ten; none on an axis that has no length.
fn linear_ticks(low: f64, high: f64, most: usize) -> Vec<Tick> {
    if !(high > low && (high - low).is_finite()) {
        return Vec::new();
    }
    let raw = (high - low) / most.max(2) as f64;
    let exponent = libm::floor(libm::log10(raw));
    let power = libm::pow(10.0, exponent);
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * power >= raw * (1.0 - 1e-9)).unwrap_or(10.0);
    let step = factor * power;
    let digits = (-libm::floor(libm::log10(step) + 1e-9)).max(0.0) as usize;
    let first = libm::ceil(low / step - 1e-9) as i64;
    let last = libm::floor(high / step + 1e-9) as i64;
    (first..=last).map(|k| k as f64 * step).map(|value| Tick { value, label: fixed(value, digits) }).collect()
}

/// Decades, with labels at 1, 2 and 5 where the axis is short, and minor ticks between; none on an axis that has no
/// length.
fn logarithmic_ticks(low: f64, high: f64, most: usize) -> Vec<Tick> {
    if !(low > 0.0 && high > low && high.is_finite()) {
        return Vec::new();
    }
    let decades = libm::log10(high / low);
    let [first, last] = [low, high].map(|v| libm::floor(libm::log10(v)) as i32);
    let every = libm::ceil(decades / most.max(2) as f64).max(1.0) as i32;
    let labelled: &[u32] = match decades {
        d if d < 0.7 => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
        d if d < 2.2 => &[1, 2, 5],
        _ => &[1],
    };
    let mut ticks = Vec::new();
    for decade in first..=last {
        for digit in 1..10_u32 {
            let value = f64::from(digit) * libm::pow(10.0, f64::from(decade));
            if value < low * (1.0 - 1e-9) || value > high * (1.0 + 1e-9) {
                continue;
            }
            let named = labelled.contains(&digit) && decade.rem_euclid(every) == 0;
            let label = if named { decimal(digit, decade) } else { String::new() };
            ticks.push(Tick { value, label });
        }
    }
    ticks
}

/// `digit * 10^decade` written out within 0.001 to 10,000, as a power of ten outside.
fn decimal(digit: u32, decade: i32) -> String {
    match decade {
        -3..=-1 => format!(
            "{:.*}",
            decade.unsigned_abs() as usize,
            f64::from(digit) * libm::pow(10.0, decade.into())
        ),
        0..=4 => format!("{}", u64::from(digit) * 10_u64.pow(decade.unsigned_abs())),
        _ => {
            let power = format!("10^{{{}}}", style::number(f64::from(decade), 0));
            if digit == 1 { power } else { format!("{digit}\u{b7}{power}") }
        }
    }
}

/// A fixed number of digits, a true minus sign, no minus zero.
fn fixed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.replace('-', "") } else { text.replace('-', "\u{2212}") }
}
