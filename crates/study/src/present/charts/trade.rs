//! Errors against time: what arms trade.

use crate::figure::axis::Scale;
use crate::trade::{Trade, trades};
use crate::verify::chart::{Line, Panel, chart};

use super::{Findings, Titled};

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
    panels
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
        .collect()
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
