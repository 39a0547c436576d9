//! What responds to the factors of a sampled axis.

use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};
use crate::response::sampled_arms;
use crate::template::{Record, records};

use super::{Findings, Titled, drawn};

/// A column of numbers.
type Column = Vec<f64>;

/// A chart for every arm and response of the table `response`, a panel for each factor.
pub(super) fn charts(findings: Findings) -> anyhow::Result<Vec<Titled>> {
    let table = findings.archive.store.root().join("response.csv");
    if !table.exists() {
        return Ok(Vec::new());
    }
    let rows = records(&table)?;
    let mut charts = Vec::new();
    for arm in sampled_arms(&findings.archive.study.spec) {
        for (number, response) in values(&rows, "response").into_iter().enumerate() {
            let own: Vec<&Record> =
                rows.iter().filter(|row| row["arm"] == arm && row["response"] == response).collect();
            if own.is_empty() {
                continue;
            }
            let factors = factors(&own);
            let label = findings.archive.study.label(arm);
            let drawing = drawn(chart(&label, &response, &factors))?;
            charts.extend(drawing.map(|drawing| Titled {
                name: format!("response-{arm}-{}", number + 1),
                title: format!("What {response} responds to: {label}"),
                caption: format!(
                    "Predicted {response} of one ball along each factor, the others in the middle of their ranges, with the 80 % interval for one ball."
                ),
                alternative: format!(
                    "Curves of {response} against each of {} factors, {label}; the numbers are in response.csv.",
                    factors.len()
                ),
                drawing,
            }));
        }
    }
    Ok(charts)
}

fn values(rows: &[Record], column: &str) -> Vec<String> {
    let mut values: Vec<String> = Vec::new();
    for row in rows {
        if !values.contains(&row[column]) {
            values.push(row[column].clone());
        }
    }
    values
}

/// Name of the factor with its range, and mean, lower and upper end over it.
fn factors(rows: &[&Record]) -> Vec<(String, [Column; 3])> {
    let mut factors: Vec<(String, Vec<String>, [Column; 3])> = Vec::new();
    for row in rows {
        if factors.last().is_none_or(|(name, ..)| *name != row["factor"]) {
            factors.push((row["factor"].clone(), Vec::new(), [vec![], vec![], vec![]]));
        }
        let (_, numbers, columns) = factors.last_mut().expect("one has been put there");
        numbers.push(row["number"].clone());
        for (column, name) in columns.iter_mut().zip(["mean", "lower", "upper"]) {
            column.push(row[name].parse().unwrap_or(f64::NAN));
        }
    }
    let named = |(name, numbers, columns): (String, Vec<String>, [Column; 3])| {
        let end = |number: Option<&String>| {
            number.and_then(|text| text.parse::<f64>().ok()).map_or(String::new(), |x| format!("{x:.4}"))
        };
        let trimmed = |text: String| text.trim_end_matches('0').trim_end_matches('.').to_string();
        let [least, greatest] = [numbers.first(), numbers.last()].map(|number| trimmed(end(number)));
        (format!("{name}: {least} to {greatest}"), columns)
    };
    factors.into_iter().map(named).collect()
}

fn chart(
    arm: &str,
    response: &str,
    factors: &[(String, [Column; 3])],
) -> Result<crate::figure::drawing::Drawing, crate::figure::FigureError> {
    let shares: Column = factors.first().map_or(Vec::new(), |(_, [mean, ..])| {
        (0..mean.len()).map(|k| k as f64 / (mean.len() - 1).max(1) as f64).collect()
    });
    let lines: Vec<[Curve; 1]> = factors
        .iter()
        .map(|(_, [mean, lower, upper])| [Curve { arm, x: &shares, middle: mean, low: lower, high: upper }])
        .collect();
    let ends = factors.iter().flat_map(|(_, [_, lower, upper])| lower.iter().chain(upper)).copied();
    let hold = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    let quantities: Vec<Quantity> = factors
        .iter()
        .zip(&lines)
        .map(|((label, _), line)| Quantity {
            label,
            scale: Scale::Linear,
            // The same axis in every panel, so that slopes compare.
            hold: &hold,
            level: None,
            guides: &[],
            curves: line,
        })
        .collect();
    curves(&Curves {
        title: response,
        x_label: "from the least to the greatest of each factor",
        x_scale: Scale::Linear,
        mark: None,
        spread: Spread::Band,
        note: "predicted mean, band: 80 % interval for one ball",
        quantities: &quantities,
    })
}
