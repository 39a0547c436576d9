//! What responds to the factors of a sampled axis.

use crate::figure::FigureError;
use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};
use crate::figure::drawing::Drawing;
use crate::response::sampled_arms;
use crate::template::{Record, records};

use super::{Findings, Titled, drawn};

/// A column of numbers.
type Column = Vec<f64>;

/// What is predicted along one factor.
struct Factor {
    /// Its name and range.
    label: String,
    /// Mean, lower and upper end over the range.
    columns: [Column; 3],
}

impl Factor {
    fn curve<'a>(&'a self, x: &'a [f64]) -> Curve<'a> {
        let [middle, low, high] = &self.columns;
        Curve { arm: &self.label, x, middle, low, high }
    }
}

/// What responds, along all factors.
struct Response {
    label: String,
    factors: Vec<Factor>,
}

/// A chart for every arm of the table `response`: a row of panels for each response, a panel for each factor.
pub(super) fn charts(findings: Findings) -> anyhow::Result<Vec<Titled>> {
    let table = findings.archive.store.root().join("response.csv");
    if !table.exists() {
        return Ok(Vec::new());
    }
    let rows = records(&table)?;
    let mut charts = Vec::new();
    for arm in sampled_arms(&findings.archive.study.spec) {
        let own: Vec<&Record> = rows.iter().filter(|row| row["arm"] == arm).collect();
        let responses: Vec<Response> =
            values(&own, "response").iter().map(|name| response(&own, name)).collect();
        let label = findings.archive.study.label(arm);
        charts.extend(drawn(chart(&responses))?.map(|drawing| Titled {
            name: format!("response-{arm}"),
            title: format!("What fragments respond to: {label}"),
            caption: "Predicted for one ball along each factor, the others in the middle of their ranges, with the 80 % interval for one ball. Grey: along the other factors.".into(),
            alternative: format!("Curves of what responds against each factor, {label}; the numbers are in response.csv."),
            drawing,
        }));
    }
    Ok(charts)
}

fn values<'a>(rows: &[&'a Record], column: &str) -> Vec<&'a str> {
    let mut values: Vec<&str> = Vec::new();
    for row in rows {
        if !values.contains(&row[column].as_str()) {
            values.push(&row[column]);
        }
    }
    values
}

/// Of a logarithm the number itself is shown.
fn response(rows: &[&Record], name: &str) -> Response {
    let own: Vec<&Record> = rows.iter().filter(|row| row["response"] == name).copied().collect();
    let words = name.strip_prefix("ln ").unwrap_or(name);
    let label = match words.split_once('_') {
        Some((letter, index)) => format!("{letter}_{{{index}}}"),
        None => words.to_string(),
    };
    let is_logarithm = words != name;
    let factors = values(&own, "factor").into_iter().map(|name| factor(&own, name, is_logarithm)).collect();
    Response { label, factors }
}

fn factor(rows: &[&Record], name: &str, is_logarithm: bool) -> Factor {
    let own: Vec<&Record> = rows.iter().filter(|row| row["factor"] == name).copied().collect();
    let number = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    let shown = |value: f64| if is_logarithm { libm::exp(value) } else { value };
    let column = |column: &str| own.iter().map(|row| shown(number(&row[column]))).collect();
    let trimmed = |row: Option<&&Record>| {
        let text = row.map_or(String::new(), |row| format!("{:.4}", number(&row["number"])));
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    };
    Factor {
        label: format!("{}: {} to {}", name.replace('_', " "), trimmed(own.first()), trimmed(own.last())),
        columns: ["mean", "lower", "upper"].map(column),
    }
}

fn chart(responses: &[Response]) -> Result<Drawing, FigureError> {
    let points =
        responses.first().and_then(|r| r.factors.first()).map_or(0, |factor| factor.columns[0].len());
    let shares: Column = (0..points).map(|k| k as f64 / (points - 1).max(1) as f64).collect();
    let lines: Vec<Vec<Curve>> = responses
        .iter()
        .map(|response| response.factors.iter().map(|factor| factor.curve(&shares)).collect())
        .collect();
    let quantities: Vec<Quantity> = responses
        .iter()
        .zip(&lines)
        .map(|(Response { label, .. }, curves)| Quantity {
            label,
            scale: Scale::Linear,
            hold: &[],
            level: None,
            guides: &[],
            curves,
        })
        .collect();
    curves(&Curves {
        title: "",
        x_label: "from the least to the greatest",
        x_scale: Scale::Linear,
        mark: None,
        spread: Spread::BandsApart,
        note: "predicted mean, band: 80 % interval for one ball",
        quantities: &quantities,
    })
}
