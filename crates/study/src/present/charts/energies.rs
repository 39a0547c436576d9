//! Where the energy goes.

use crate::figure::energy::{Energy, EnergyCase, energy};
use crate::record::HistoryRow;
use crate::results::CaseResult;

use super::{Findings, Titled, drawn};

pub(super) fn energies(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let spec = &findings.archive.study.spec;
    let pictured: Vec<&str> =
        spec.arm.iter().filter(|arm| arm.picture.is_some()).map(|arm| arm.id.as_str()).take(4).collect();
    let cases: Vec<&CaseResult> = pictured
        .iter()
        .filter_map(|id| findings.results.iter().find(|r| r.case.arm == *id && r.metrics.is_some()))
        .collect();
    let columns: Vec<(String, Vec<f64>, Vec<Vec<f64>>)> = cases
        .iter()
        .map(|result| {
            let history = &result.record.history;
            let contact = result.record.contact_time.unwrap_or(0.0);
            let time = history.iter().map(|row| (row.time - contact) / result.record.time_unit).collect();
            let part = |pick: fn(&HistoryRow) -> f64| history.iter().map(pick).collect::<Vec<f64>>();
            let parts = vec![
                part(|row| row.kinetic),
                part(|row| row.elastic),
                part(|row| row.plastic_loss),
                // What has not been booked is not drawn.
                part(|row| row.contact_loss.unwrap_or(0.0)),
                part(|row| row.transfer_loss.unwrap_or(0.0)),
            ];
            (findings.archive.study.label(&result.case.arm), time, parts)
        })
        .collect();
    let parts: Vec<Vec<&[f64]>> =
        columns.iter().map(|(_, _, parts)| parts.iter().map(Vec::as_slice).collect()).collect();
    let shown: Vec<EnergyCase> =
        columns.iter().zip(&parts).map(|((arm, time, _), parts)| EnergyCase { arm, time, parts }).collect();
    let figure = Energy {
        title: "",
        x_label: "time since contact [R/v]",
        y_label: "energy [J/m]",
        parts: &["kinetic", "elastic", "lost to plastic flow", "lost in contact", "lost in transfer"],
        cases: &shown,
        note: "first block of each arm; the stack's height is the initial energy but for the time integration's error",
    };
    Ok(drawn(energy(&figure))?.map(|drawing| Titled {
        name: "energy".into(),
        title: "Where the energy goes".into(),
        caption: "Kinetic and elastic energy, and what has been lost to plastic flow, in contact with the floor, and between particles and grid.".into(),
        alternative: "Stacked energies over time for the first block of each pictured arm: most of the kinetic energy goes into plastic flow.".into(),
        drawing,
    }))
}
