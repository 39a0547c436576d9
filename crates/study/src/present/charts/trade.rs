//! Errors against time: what arms trade.

use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};
use crate::template::{Record, records};
use crate::trade::{Trade, trades};
use crate::verify::chart::{Line, Panel, chart};

use super::{Findings, Titled, drawn};

/// A chart for every point of the sweep; none where no arm is compared.
pub(super) fn charts(findings: Findings) -> anyhow::Result<Vec<Titled>> {
    let trades = trades(findings.archive, findings.results)?;
    let compared = trades.iter().filter(|trade| trade.blocks > 0 && trade.error() > 0.0);
    let mut points: Vec<&[(String, Option<f64>)]> = Vec::new();
    compared.clone().for_each(|trade| {
        if !points.contains(&trade.axes.as_slice()) {
            points.push(&trade.axes);
        }
    });
    let names: Vec<String> = points.iter().map(|axes| name_of(findings, axes)).collect();
    let labels: Vec<String> = names.iter().map(|name| format!("{name}: error")).collect();
    let panels: Vec<Panel> = points
        .iter()
        .zip(&labels)
        .map(|(axes, label)| {
            let here: Vec<&Trade> = compared.clone().filter(|trade| trade.axes == *axes).collect();
            let lines = families(&trades).into_iter().map(|family| {
                let own = here.iter().filter(|trade| trade.family == family);
                Line::new(family.clone(), own.map(|trade| (trade.seconds, trade.error())))
            });
            Panel::new(label, Scale::Logarithmic, lines.collect())
        })
        .collect();
    // Each scene on a sheet of its own: their times have nothing in common.
    let of_scenes = panels
        .iter()
        .zip(&names)
        .enumerate()
        .map(|(number, (panel, name))| {
            let note = "every point an arm; means over blocks";
            let drawing = chart("median wall time of a case [s]", Scale::Logarithmic, note, std::slice::from_ref(panel))?;
            Ok(Titled {
                name: if names.len() == 1 { "trade".into() } else { format!("trade-{}", number + 1) },
                title: format!("Error against time: {name}"),
                caption: "The largest of the relative errors of deformation, impulse and plastic loss at the end, beside the reference, against the wall time of a case.".into(),
                alternative: format!("Error of every setting against its wall time, {name}; the numbers are in trade.csv."),
                drawing,
            })
        })
        .collect::<anyhow::Result<Vec<Titled>>>()?;
    Ok(settings(findings)?.into_iter().chain(of_scenes).collect())
}

/// Settings of one family, from the fastest to the slowest.
struct Family {
    name: String,
    seconds: Vec<f64>,
    /// E, its lower and its upper limit in another scene.
    columns: [Vec<f64>; 3],
}

/// E over all scenes against time, where `snowlab tradeoff` has timed settings.
fn settings(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let table = findings.archive.store.root().join("settings.csv");
    if !table.exists() {
        return Ok(None);
    }
    let mut families: Vec<Family> = Vec::new();
    let mut rows = records(&table)?;
    let number = |row: &Record, column: &str| row.get(column).and_then(|text| text.parse::<f64>().ok());
    rows.retain(|row| number(row, "seconds").is_some() && number(row, "error_lower").is_some());
    rows.sort_by(|a, b| number(a, "seconds").partial_cmp(&number(b, "seconds")).expect("times are numbers"));
    for arm in &findings.archive.study.spec.arm {
        let Some(name) = arm.trade.as_ref().map(|trade| &trade.family) else { continue };
        if families.iter().all(|family| family.name != *name) {
            families.push(Family {
                name: name.clone(),
                seconds: Vec::new(),
                columns: [vec![], vec![], vec![]],
            });
        }
    }
    for row in &rows {
        let arm = findings.archive.study.spec.arm.iter().find(|arm| arm.id == row["arm"]);
        let Some(trade) = arm.and_then(|arm| arm.trade.as_ref()) else { continue };
        let family = families.iter_mut().find(|family| family.name == trade.family).expect("it is there");
        family.seconds.extend(number(row, "seconds"));
        for (column, name) in family.columns.iter_mut().zip(["error", "error_lower", "error_upper"]) {
            column.push(number(row, name).unwrap_or(f64::NAN));
        }
    }
    let shown: Vec<Curve> =
        families.iter().filter(|family| !family.seconds.is_empty()).map(Family::curve).collect();
    let quantity = Quantity {
        label: "E in another scene",
        scale: Scale::Logarithmic,
        hold: &[],
        level: None,
        guides: &[],
        curves: &shown,
    };
    let figure = Curves {
        title: "",
        x_label: "time of the first scene on one thread [s]",
        x_scale: Scale::Logarithmic,
        mark: None,
        spread: Spread::Bars,
        note: "every point a setting; bars: 90 % interval for another scene; grey: the other families",
        quantities: &[quantity],
    };
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: "settings".into(),
        title: "What accuracy costs".into(),
        caption: "E, the largest of the relative errors of displacements, impulse and kinetic energy in the first waves, against the time of the first scene: geometric means over scenes, carried to the impact of the first one, with the interval for a scene to come.".into(),
        alternative: "Error of every setting against its time, by family; the numbers are in settings.csv.".into(),
        drawing,
    }))
}

impl Family {
    fn curve(&self) -> Curve<'_> {
        let [middle, low, high] = &self.columns;
        Curve { arm: &self.name, x: &self.seconds, middle, low, high }
    }
}

fn families(trades: &[Trade]) -> Vec<String> {
    let mut families: Vec<String> = Vec::new();
    for trade in trades {
        if !families.contains(&trade.family) {
            families.push(trade.family.clone());
        }
    }
    families
}

/// The words of a point of the sweep.
fn name_of(findings: Findings, axes: &[(String, Option<f64>)]) -> String {
    let spec = &findings.archive.study.spec;
    let word = |(name, number): (&String, f64)| {
        let axis = spec.sweep.iter().find(|axis| axis.name == *name);
        let numbers = axis.and_then(|axis| axis.numbers.as_ref());
        let place = numbers.and_then(|numbers| numbers.iter().position(|n| *n == number));
        let label = axis.and_then(|axis| axis.labels.as_ref()?.get(place?).cloned());
        label.unwrap_or_else(|| format!("{name} = {number}"))
    };
    let point = axes.iter().filter_map(|(name, number)| Some((name, (*number)?)));
    let words: Vec<String> = point.map(word).collect();
    if words.is_empty() { spec.name.clone() } else { words.join(", ") }
}
