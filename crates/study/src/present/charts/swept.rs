//! Endpoints along the axis of a sweep.

use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};
use crate::tables::{case_row, usable};

use super::{Findings, Titled, drawn, summary};

/// An axis that reaches over more than this ratio is drawn logarithmically (chosen: a decade).
const DECADE: f64 = 10.0;

/// Mean and 95 % interval of an endpoint at every number of the axis.
struct Line {
    label: String,
    numbers: Vec<f64>,
    /// Mean, lower and upper end.
    columns: [Vec<f64>; 3],
}

/// A panel for each endpoint, a curve for each arm, where the study has one axis of numbers.
pub(super) fn chart(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let [axis] = findings.archive.study.spec.sweep.as_slice() else { return Ok(None) };
    let mut numbers = axis.all_numbers();
    if numbers.len() < 2 || numbers.iter().any(|number| !number.is_finite()) {
        return Ok(None);
    }
    numbers.sort_by(f64::total_cmp);
    let (least, greatest) = (numbers[0], numbers[numbers.len() - 1]);
    let endpoints = [("fragments", "fragments N_{f}"), ("ln_neff", "A = ln N_{eff}"), ("damage", "damage D")];
    let lines: Vec<Vec<Line>> =
        endpoints.iter().map(|(endpoint, _)| lines(findings, &axis.name, endpoint, &numbers)).collect();
    let shown: Vec<Vec<Curve>> =
        lines.iter().map(|lines| lines.iter().filter_map(Line::curve).collect()).collect();
    let quantities: Vec<Quantity> = endpoints
        .iter()
        .zip(&shown)
        .map(|((_, label), curves)| Quantity {
            label,
            scale: Scale::Linear,
            hold: &[0.0],
            level: None,
            guides: &[],
            curves,
        })
        .collect();
    let logarithmic = least > 0.0 && greatest > DECADE * least;
    let figure = Curves {
        title: "",
        x_label: axis.axis_label(),
        x_scale: if logarithmic { Scale::Logarithmic } else { Scale::Linear },
        mark: None,
        spread: Spread::Bars,
        note: "mean with its 95 % t interval",
        quantities: &quantities,
    };
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: axis.name.replace('_', "-"),
        title: format!("Fragments along {}", axis.axis_label()),
        caption: "Number of fragments, A and damage of each arm: means over the cases with their 95 % t intervals.".into(),
        alternative: format!(
            "Number of fragments, ln N_eff and damage of each arm against {}; the numbers are in the summary table.",
            axis.axis_label()
        ),
        drawing,
    }))
}

/// A line for each arm that is run along the axis.
fn lines(findings: Findings, axis: &str, endpoint: &str, numbers: &[f64]) -> Vec<Line> {
    let study = findings.archive.study;
    let line = |arm: &str| {
        let own = || findings.results.iter().filter(|result| result.case.arm == arm && usable(result));
        let mut line =
            Line { label: study.label(arm), numbers: Vec::new(), columns: [vec![], vec![], vec![]] };
        for &number in numbers {
            let here = own().filter(|result| result.case.number(axis) == Some(number));
            let values: Vec<f64> = here.filter_map(|result| case_row(result).value(endpoint)).collect();
            if let Some(found) = summary(&values) {
                line.numbers.push(number);
                for (column, value) in line.columns.iter_mut().zip([found.mean, found.low, found.high]) {
                    column.push(value);
                }
            }
        }
        line
    };
    study.arms().into_iter().map(line).collect()
}

impl Line {
    /// `None` without a number.
    fn curve(&self) -> Option<Curve<'_>> {
        let [middle, low, high] = &self.columns;
        (!self.numbers.is_empty()).then_some(Curve { arm: &self.label, x: &self.numbers, middle, low, high })
    }
}
