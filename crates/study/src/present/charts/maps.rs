//! Maps of how cases end.

use crate::figure::outcomes::{Kind, OutcomePanel, Outcomes, Places, inks, outcomes};
use crate::figure::style::Ink;
use crate::outcome_map::{End, OutcomeMap, maps};

use super::{Findings, Titled, drawn};

/// A figure for every map of the study that cases have been run for.
pub(super) fn charts(findings: Findings) -> anyhow::Result<Vec<Titled>> {
    let mut charts = Vec::new();
    for map in maps(findings.archive.study, findings.results) {
        charts.extend(chart(&map)?);
    }
    Ok(charts)
}

fn chart(map: &OutcomeMap) -> anyhow::Result<Option<Titled>> {
    let ends = ends_of(map);
    let words: Vec<String> = ends.iter().map(|end| map.words(end)).collect();
    let kinds: Vec<Kind> =
        ends.iter().zip(&words).map(|(end, words)| Kind { words, ink: ink(end, &ends) }).collect();
    let kind = |end: &Option<End>| end.as_ref().and_then(|end| ends.iter().position(|known| known == end));
    let cells: Vec<Vec<Vec<Option<usize>>>> = map
        .arms
        .iter()
        .map(|arm| arm.rows.iter().map(|row| row.ends.iter().map(kind).collect()).collect())
        .collect();
    let limits: Vec<Vec<Option<f64>>> =
        map.arms.iter().map(|arm| arm.rows.iter().map(|row| row.derived).collect()).collect();
    let panels: Vec<OutcomePanel> = map
        .arms
        .iter()
        .zip(cells.iter().zip(&limits))
        .map(|(arm, (cells, limits))| OutcomePanel { arm: &arm.label, cells, limits })
        .collect();
    let figure = Outcomes {
        title: "",
        x: Places { label: &map.x.label, values: &map.x.numbers },
        y: Places { label: &map.y.label, values: &map.y.numbers },
        kinds: &kinds,
        panels: &panels,
        note: "every cell a case; the limits found and derived, in numbers, are in maps.csv",
    };
    Ok(drawn(outcomes(&figure))?.map(|drawing| Titled {
        name: format!("map-{}", map.spec.id),
        title: map.spec.title.clone(),
        caption: "How every case ended. The dashed line is where the first step is as long as the limit derived for it (docs/stability.md).".into(),
        alternative: format!("Cells coloured by how a case ended, {} against {}, a panel for each arm; the limits are in maps.csv.", map.y.label, map.x.label),
        drawing,
    }))
}

/// All ends that the map has, the better first.
fn ends_of(map: &OutcomeMap) -> Vec<End> {
    let rows = map.arms.iter().flat_map(|arm| &arm.rows);
    let mut ends: Vec<End> = rows.flat_map(|row| row.ends.iter().flatten().cloned()).collect();
    ends.sort();
    ends.dedup();
    ends
}

fn ink(end: &End, ends: &[End]) -> Ink {
    match end {
        End::Sound => inks::SOUND,
        End::Clamped => inks::CLAMPED,
        End::Halved => inks::HALVED,
        End::Unsound => inks::UNSOUND,
        End::Stopped(_) => {
            let mut reasons = ends.iter().filter(|end| matches!(end, End::Stopped(_)));
            let rank = reasons.position(|known| known == end).unwrap_or(0);
            inks::STOPPED[rank.min(inks::STOPPED.len() - 1)]
        }
    }
}
