//! Charts of the experiments: series of points, one above the other a quantity.

use crate::figure::Drawing;
use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Guide, Quantity, Spread, curves};

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
    /// Dashed lines of theory, each beside the line of its name.
    pub theory: Vec<Line>,
    /// Dashed lines beside all, name and both ends.
    pub slopes: Vec<(&'static str, [f64; 2], [f64; 2])>,
}

impl<'a> Panel<'a> {
    /// A panel of lines alone.
    pub fn new(label: &'a str, scale: Scale, lines: Vec<Line>) -> Self {
        Panel { label, scale, level: None, lines, theory: Vec::new(), slopes: Vec::new() }
    }

    /// With the slopes of orders 1 and 2, from the greatest value at the least abscissa. `towards` is -1 where the abscissa counts
    /// cells, 1 where it is a step.
    pub fn with_orders(mut self, towards: f64) -> Self {
        let all = || self.lines.iter().flat_map(|line| line.x.iter().copied().zip(line.y.iter().copied()));
        let xs = || all().map(|(x, _)| x);
        let (first, last) = (xs().fold(f64::INFINITY, f64::min), xs().fold(0.0, f64::max));
        // The error is largest at the coarse end.
        let coarse = if towards < 0.0 { first } else { last };
        let top = all().filter(|(x, _)| *x == coarse).map(|(_, y)| y).fold(0.0, f64::max);
        let floor = all().map(|(_, y)| y).filter(|y| *y > 0.0).fold(f64::INFINITY, f64::min);
        let fine = if towards < 0.0 { last } else { first };
        for (order, name) in [(1.0, "order 1"), (2.0, "order 2")] {
            let error = |x: f64| top * (x / coarse).powf(towards * order);
            // As far as the errors reach.
            let end = if error(fine) < floor { coarse * (floor / top).powf(towards / order) } else { fine };
            self.slopes.push((name, [coarse, end], [top, error(end)]));
        }
        self
    }

    fn guides(&self) -> Vec<Guide<'_>> {
        let theory = self.theory.iter().map(|line| Guide {
            arm: Some(&line.name),
            name: "theory",
            x: &line.x,
            y: &line.y,
        });
        let slopes = self.slopes.iter().map(|(name, x, y)| Guide { arm: None, name, x, y });
        theory.chain(slopes).collect()
    }
}

/// Draws panels above a common abscissa: settings, with bars where there are any, on a logarithmic one; what goes on, such as time, on
/// a linear one.
pub fn chart(x_label: &str, x_scale: Scale, note: &str, panels: &[Panel]) -> anyhow::Result<Drawing> {
    let lines: Vec<Vec<Curve>> =
        panels.iter().map(|panel| panel.lines.iter().map(Line::curve).collect()).collect();
    let guides: Vec<Vec<Guide>> = panels.iter().map(Panel::guides).collect();
    let quantities: Vec<Quantity> = panels
        .iter()
        .zip(lines.iter().zip(&guides))
        .map(|(panel, (curves, guides))| Quantity {
            label: panel.label,
            scale: panel.scale,
            hold: &[],
            level: panel.level,
            guides,
            curves,
        })
        .collect();
    let with_bars = lines.iter().flatten().any(|curve| curve.low != curve.middle);
    let spread = match (x_scale, with_bars) {
        (Scale::Linear, _) => Spread::Band,
        (Scale::Logarithmic, true) => Spread::Bars,
        (Scale::Logarithmic, false) => Spread::Points,
    };
    Ok(curves(&Curves { title: "", x_label, x_scale, mark: None, spread, note, quantities: &quantities })?)
}
