//! The claims as a forest plot.

use crate::claims::{Contrast, Verdict, smallest_effect};
use crate::figure::forest::{self, Forest, forest};

use super::{Findings, Titled, drawn};

pub(super) fn claims(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let words: Vec<(String, String)> = findings
        .judged
        .iter()
        .map(|judged| (contrast(findings, &judged.claim.contrast), judged.assessment.verdict.to_string()))
        .collect();
    let rows: Vec<forest::Row> = findings
        .judged
        .iter()
        .zip(&words)
        .map(|(judged, (contrast, verdict))| {
            let evidence = &judged.assessment.evidence;
            let interval = evidence.interval_t.or(evidence.interval_bca);
            forest::Row {
                claim: &judged.claim.id,
                contrast,
                effect: evidence.effect,
                interval: interval.map(|i| [i.lower, i.upper]),
                verdict,
                outcome: match judged.assessment.verdict {
                    Verdict::Supported => forest::Outcome::Supported,
                    Verdict::Refuted(_) => forest::Outcome::Refuted,
                    Verdict::Inconclusive(_) => forest::Outcome::Inconclusive,
                    Verdict::NotRun(_) => forest::Outcome::NotRun,
                },
            }
        })
        .collect();
    let figure = Forest {
        title: "",
        label: "effect on A = ln N_{eff}, positive where PS17 is right",
        delta: smallest_effect(),
        rows: &rows,
        note: "mean over blocks with the simultaneous interval of its family; dashed: the smallest effect of interest, 1.25x",
    };
    Ok(drawn(forest(&figure))?.map(|drawing| Titled {
        name: "claims".into(),
        title: "The claims".into(),
        caption: "Effect of each contrast with its simultaneous interval (studentised; BCa for ranges), and the verdict of the mechanical rule.".into(),
        alternative: "Forest plot of the claims' effects; the numbers are on the cards of the verdicts.".into(),
        drawing,
    }))
}

/// A contrast in a few words.
pub fn contrast(findings: Findings, contrast: &Contrast) -> String {
    let label = |arm: &str| findings.archive.study.label(arm);
    match contrast {
        Contrast::Paired { treated, control } => format!("{} - {}", label(treated), label(control)),
        Contrast::Trend { arms } => format!("- slope on log2 N, {} arms, x log2 6", arms.len()),
        Contrast::Range { arms } => {
            let ends = [arms.first(), arms.last()].map(|arm| arm.map_or(String::new(), |arm| label(arm)));
            format!("range: {}", ends.join(" \u{2026} "))
        }
        Contrast::Weighted { weights } => {
            let term = |(arm, weight): (&String, &f64)| {
                let sign = if *weight < 0.0 { "-" } else { "+" };
                format!("{sign} {}", label(arm))
            };
            let mut terms: Vec<String> = weights.iter().map(term).collect();
            terms.sort();
            terms.join(" ")
        }
    }
}
