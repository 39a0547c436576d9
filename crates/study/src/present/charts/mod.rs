//! Charts of endpoints, distributions, curves, energies and claims.

mod claims;
mod curves;
mod endpoints;
mod energies;
mod maps;
mod pilot;
mod response;
mod stretch;
mod swept;
mod trade;

pub use claims::contrast;
pub use pilot::operating_point;

use crate::figure::strips::Summary;
use crate::measure::Metrics;
use crate::response::sampled_arms;
use crate::results::CaseResult;
use crate::statistics::summarise;
use crate::tables::{groups, usable};

use super::{Findings, Titled, drawn};

/// Cases of the arms that are compared: not those of the noise floor or of a check, nor those that only make a
/// picture.
struct Arms<'a> {
    labels: Vec<String>,
    cases: Vec<Vec<&'a CaseResult>>,
}

/// All charts that the study's results allow.
pub fn all(findings: Findings) -> anyhow::Result<Vec<Titled>> {
    let trades = trade::charts(findings)?;
    if !trades.is_empty() {
        return Ok(trades);
    }
    if !sampled_arms(&findings.archive.study.spec).is_empty() {
        return response::charts(findings);
    }
    if !findings.archive.study.spec.map.is_empty() {
        return maps::charts(findings);
    }
    if !findings.archive.study.spec.sweep.is_empty() {
        let pilot = pilot::pilot_chart(findings)?;
        return Ok(if pilot.is_some() { pilot } else { swept::chart(findings)? }.into_iter().collect());
    }
    let arms = Arms::of(findings);
    let charts = [
        claims::claims(findings)?,
        endpoints::endpoints(&arms)?,
        endpoints::distributions(&arms)?,
        curves::links(findings, &arms)?,
        stretch::stretch(findings)?,
        curves::histories(&arms)?,
        energies::energies(findings)?,
        curves::trend(findings)?,
    ];
    Ok(charts.into_iter().flatten().collect())
}

impl<'a> Arms<'a> {
    fn of(findings: Findings<'a>) -> Self {
        let spec = &findings.archive.study.spec;
        let judged = spec.claim.iter().chain(&spec.control).flat_map(|claim| claim.arms());
        let judged: Vec<&str> = judged.collect();
        let mut arms = Arms { labels: Vec::new(), cases: Vec::new() };
        let groups = groups(findings.results);
        let most = groups.iter().map(Vec::len).max().unwrap_or(0);
        for group in groups {
            let id = group[0].case.arm.as_str();
            let floor = spec.noise_floor.iter().any(|arm| arm == id) || spec.under(id).is_some();
            let only_pictured = group.len() == 1 && most > 1 && !judged.contains(&id);
            let cases: Vec<&CaseResult> = group.iter().copied().filter(|result| usable(result)).collect();
            if !floor && !only_pictured && !cases.is_empty() {
                arms.labels.push(findings.archive.study.label(id));
                arms.cases.push(cases);
            }
        }
        arms
    }

    fn names(&self) -> Vec<&str> {
        self.labels.iter().map(String::as_str).collect()
    }

    fn metrics(&self, arm: usize) -> impl Iterator<Item = &'a Metrics> + '_ {
        self.cases[arm].iter().filter_map(|result| result.metrics.as_ref())
    }
}

fn summary(values: &[f64]) -> Option<Summary> {
    let s = summarise(values, 0.95)?;
    let interval = s.interval?;
    Some(Summary { mean: s.mean, low: interval.lower, high: interval.upper })
}
