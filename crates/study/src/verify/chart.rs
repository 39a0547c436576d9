//! Line charts of the experiments: series of points, one above the other a quantity.

use crate::figure::Drawing;
use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};

/// A named series of points, in the order of x.
pub struct Line {
    name: String,
    x: Vec<f64>,
    y: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Line {
    /// From its points (x, y), in any order.
    pub fn new(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Line::with_spread(name, points.into_iter().map(|(x, y)| (x, y, 0.0)))
    }

    /// From its points (x, y, half the length of the bar), in any order.
    pub fn with_spread(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64, f64)>) -> Self {
        let mut points: Vec<(f64, f64, f64)> = points.into_iter().collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Line {
            name: name.into(),
            x: points.iter().map(|point| point.0).collect(),
            y: points.iter().map(|point| point.1).collect(),
            low: points.iter().map(|point| point.1 - point.2).collect(),
            high: points.iter().map(|point| point.1 + point.2).collect(),
        }
    }

    fn curve(&self) -> Curve<'_> {
        Curve { arm: &self.name, x: &self.x, middle: &self.y, low: &self.low, high: &self.high }
    }
}

/// A panel of lines.
pub struct Panel<'a> {
    /// Label of the vertical axis, with unit.
    pub label: &'a str,
    /// Its scale.
    pub scale: Scale,
    /// A level marked by a dashed line, with its name.
    pub level: Option<(f64, &'a str)>,
    /// The lines, the same names in every panel.
    pub lines: Vec<Line>,
}

impl<'a> Panel<'a> {
    /// A panel without a marked level.
    pub fn new(label: &'a str, scale: Scale, lines: Vec<Line>) -> Self {
        Panel { label, scale, level: None, lines }
    }
}

/// Draws panels above a common abscissa: settings, with bars, on a logarithmic one; what goes on, such as time, on a linear one.
pub fn chart(x_label: &str, x_scale: Scale, note: &str, panels: &[Panel]) -> anyhow::Result<Drawing> {
    let lines: Vec<Vec<Curve>> =
        panels.iter().map(|panel| panel.lines.iter().map(Line::curve).collect()).collect();
    let quantities: Vec<Quantity> = panels
        .iter()
        .zip(&lines)
        .map(|(panel, curves)| Quantity {
            label: panel.label,
            scale: panel.scale,
            hold: &[],
            level: panel.level,
            curves,
        })
        .collect();
    Ok(curves(&Curves {
        title: "",
        x_label,
        x_scale,
        mark: None,
        spread: if x_scale == Scale::Linear { Spread::Band } else { Spread::Bars },
        note,
        quantities: &quantities,
    })?)
}
