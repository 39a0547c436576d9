//! The report's data from a study's findings.

use crate::claims::{CHECK_BLOCKS, Verdict, smallest_effect};
use crate::evaluate::{Judged, Kind};
use crate::outcome_map::{maps, table};
use crate::record::Outcome;
use crate::report::{
    EffectSize, ReportArm, ReportData, ReportFact, ReportFailure, ReportFigure, ReportOutcome, ReportTable,
    ReportVerdict, html,
};
use crate::results::CaseResult;
use crate::spec::StudySpec;
use crate::spec::scene::{EngineName, PrecisionName};
use crate::statistics::{Interval, OperatingSpeed, summarise};
use crate::store::{METRIC_VERSION, SOLVER_VERSION};
use crate::table::{Cell, Row, Table};
use crate::tables::{self, case_row, groups, usable};

use super::Findings;
use super::charts::{contrast, operating_point};
use super::motion::motion;

/// Where the numbers come from.
#[derive(Clone, Debug)]
pub struct Provenance {
    /// Text of the study file: its digest goes into the report.
    pub study_text: String,
    /// Git revision, where there is one.
    pub revision: Option<String>,
}

/// Endpoints of the summary table, with their headings.
const SUMMARY: [(&str, &str); 6] = [
    ("ln_neff", "A = ln N_eff"),
    ("damage", "D"),
    ("fragments", "N_f"),
    ("dust", "dust"),
    ("d50", "D50 [m]"),
    ("crack", "crack [m]"),
];

/// The page.
///
/// # Errors
/// Frames that cannot be read, and [`crate::report::ReportError`].
pub fn page(
    findings: Findings,
    provenance: &Provenance,
    figures: Vec<ReportFigure>,
) -> anyhow::Result<String> {
    let spec = &findings.archive.study.spec;
    let listed: Vec<CaseResult> = findings.results.iter().filter(|r| !is_mapped(spec, r)).cloned().collect();
    let listed = Findings { results: &listed, ..findings };
    let mut caveats = spec.caveats.clone();
    if !findings.judged.is_empty() {
        caveats.extend(findings.gates.words.iter().cloned());
    }
    caveats.extend(pilot_words(findings));
    let data = ReportData {
        title: spec.name.clone(),
        subtitle: format!("profile {}, {} cases", findings.archive.study.profile, findings.results.len()),
        question: spec.question.split("\n\n").map(str::to_string).collect(),
        caveats,
        arms: arms(listed),
        verdicts: findings.judged.iter().map(|judged| verdict(findings, judged)).collect(),
        smallest_effect: smallest_effect(),
        figures,
        motion: motion(listed)?,
        tables: [
            Some(summary(listed)),
            robustness(findings),
            replicates(findings),
            noise(findings),
            limits(findings),
        ]
        .into_iter()
        .flatten()
        .collect(),
        failures: failures(listed),
        provenance: facts(findings, provenance),
    };
    Ok(html(&data)?)
}

/// What the pilot's rule says, where the study is a pilot.
fn pilot_words(findings: Findings) -> Option<String> {
    let (found, obstacle) = operating_point(findings.results, &findings.archive.study.arms())?;
    Some(match found {
        OperatingSpeed::Found { speed, median_damage } => {
            format!("Operating point: {speed} m/s on the {obstacle}, pooled median of D {median_damage:.3}.")
        }
        OperatingSpeed::NoneUsable { nearest: Some((speed, damage)) } => format!(
            "No operating point: on the {obstacle} the pooled median of D nearest to 0.25 is {damage:.3}, at {speed} m/s, outside [0.05, 0.6]."
        ),
        OperatingSpeed::NoneUsable { nearest: None } => {
            format!("No operating point: no usable case on the {obstacle}.")
        }
    })
}

fn arms(findings: Findings) -> Vec<ReportArm> {
    let mut arms: Vec<ReportArm> = Vec::new();
    for group in groups(findings.results) {
        let first = group[0];
        let built = group.iter().find(|result| result.record.was_built()).unwrap_or(&first);
        let made = &built.record.made;
        let ended = group.iter().filter(|result| usable(result)).count();
        let voids = if made.voids > 0 {
            format!(", {} voids, porosity {:.3}{}", made.voids, made.porosity, selection(&group))
        } else {
            String::new()
        };
        arms.push(ReportArm {
            name: name(findings, first),
            description: format!(
                "{} particles, {:.1} per cell{voids}",
                made.particles, made.particles_per_cell
            ),
            cases: format!("{ended} of {}", group.len()),
        });
    }
    arms
}

/// Below this share of void fields accepted, the fields of an arm are a selection of those that the shape allows (study
/// definition).
const SELECTED: f64 = 0.5;

/// Marks an arm whose void fields were accepted less than half the time.
fn selection(group: &[&CaseResult]) -> String {
    let draws: usize = group.iter().map(|result| result.record.made.void_draws).sum();
    let bodies: usize =
        group.iter().map(|result| result.case.scene.body.iter().filter(|b| b.voids.is_some()).count()).sum();
    let accepted = bodies as f64 / draws.max(1) as f64;
    if accepted < SELECTED {
        format!(", selected ({:.0} % of the fields drawn)", 100.0 * accepted)
    } else {
        String::new()
    }
}

/// What a case's arm and point of the sweep are called.
pub(super) fn name(findings: Findings, result: &CaseResult) -> String {
    let point: Vec<String> = result.case.point().map(|(axis, value)| format!(", {axis} {value}")).collect();
    let label = findings.archive.study.label(&result.case.arm);
    let same_label =
        findings.archive.study.spec.arm.iter().filter(|arm| arm.label.as_ref() == Some(&label)).count();
    let label = if same_label > 1 { result.case.arm.clone() } else { label };
    format!("{label}{}", point.concat())
}

fn verdict(findings: Findings, judged: &Judged) -> ReportVerdict {
    let evidence = &judged.assessment.evidence;
    let pair = |kind: &str, interval: Option<Interval>| {
        interval.map(|i| format!("{kind} [{:.3}, {:.3}]", i.lower, i.upper))
    };
    let intervals: Vec<String> =
        [pair("t", evidence.interval_t), pair("BCa", evidence.interval_bca)].into_iter().flatten().collect();
    let checks: Vec<String> = judged.assessment.checks.iter().map(ToString::to_string).collect();
    let measured = format!("measured by {}; calibration by stretch {}", judged.primary, judged.calibration);
    let mut conditions = vec![judged.assessment.explanation.clone(), measured];
    if !checks.is_empty() {
        conditions.push(format!("measured otherwise: {}", checks.join("; ")));
    }
    ReportVerdict {
        claim: judged.claim.id.clone(),
        sentence: judged.claim.sentence.clone(),
        contrast: contrast(findings, &judged.claim.contrast),
        size: evidence
            .effect
            .zip(evidence.interval_t.or(evidence.interval_bca))
            .map(|(effect, interval)| EffectSize { effect, lower: interval.lower, upper: interval.upper }),
        effect: evidence.effect.map_or(String::new(), |d| format!("{d:.3} ({:.2}x)", libm::exp(d))),
        interval: if intervals.is_empty() {
            String::new()
        } else {
            format!("{}; {:.1} %", intervals.join(", "), 100.0 * evidence.confidence)
        },
        verdict: judged.assessment.verdict.to_string(),
        outcome: match judged.assessment.verdict {
            Verdict::Supported => ReportOutcome::Supported,
            Verdict::Refuted(_) => ReportOutcome::Refuted,
            Verdict::Inconclusive(_) => ReportOutcome::Inconclusive,
            Verdict::NotRun(_) => ReportOutcome::NotRun,
        },
        conditions,
    }
}

fn summary(findings: Findings) -> ReportTable {
    let mut columns = vec!["arm".to_string(), "cases".to_string()];
    columns.extend(SUMMARY.iter().map(|(_, heading)| heading.to_string()));
    let rows = groups(findings.results).into_iter().map(|group| {
        let used: Vec<Row> = group.iter().filter(|r| usable(r)).map(|r| case_row(r)).collect();
        let mut cells = vec![name(findings, group[0]), format!("{}", used.len())];
        for (endpoint, _) in SUMMARY {
            let values: Vec<f64> = used.iter().filter_map(|row| row.value(endpoint)).collect();
            cells.push(summarise(&values, 0.95).map_or("-".into(), |s| match s.interval {
                Some(i) => format!("{:.3} [{:.3}, {:.3}]", s.mean, i.lower, i.upper),
                None => format!("{:.3}", s.mean),
            }));
        }
        cells
    });
    ReportTable {
        title: "Summary".into(),
        note: "Mean over the cases that ended well and passed the gate, with its 95 % t interval. All cases are in cases.csv.".into(),
        columns,
        rows: rows.collect(),
    }
}

/// Whether a case is shown by a map of the study, and not one by one.
fn is_mapped(spec: &StudySpec, result: &CaseResult) -> bool {
    spec.map.iter().any(|map| map.arms_of(spec).contains(&result.case.arm.as_str()))
}

/// A row for each claim, a column for each variation: the effect with its 95 % limits, and whether it says the same.
fn robustness(findings: Findings) -> Option<ReportTable> {
    let mut names: Vec<&str> = Vec::new();
    for variation in findings.judged.iter().flat_map(|judged| &judged.variations) {
        if !names.contains(&variation.name.as_str()) {
            names.push(&variation.name);
        }
    }
    let cell = |judged: &Judged, name: &str| {
        let first = judged.variations.first().and_then(|first| first.reading.finding);
        let Some(found) = judged.variations.iter().find(|variation| variation.name == name) else {
            return "-".to_string();
        };
        let reading = &found.reading;
        let (Some(effect), Some(limits)) = (reading.effect, reading.interval) else { return "-".to_string() };
        let sign = match (reading.blocks >= CHECK_BLOCKS, reading.finding == first) {
            _ if found.kind == Kind::Primary => "",
            (false, _) => " ?",
            (true, true) => " =",
            (true, false) => " \u{2260}",
        };
        format!("{effect:.2} [{:.2}, {:.2}]{sign}", limits.lower, limits.upper)
    };
    let row = |judged: &Judged| {
        let cells = names.iter().map(|name| cell(judged, name));
        [judged.claim.id.clone()].into_iter().chain(cells).collect()
    };
    let rows: Vec<Vec<String>> = findings.judged.iter().map(row).collect();
    (!rows.is_empty()).then(|| ReportTable {
        title: "What the findings hang on".into(),
        note: format!(
            "Each claim's effect on ln N_eff with its 95 % limits: as claimed, measured otherwise, run otherwise, and under other conditions. = marks those that rules 3 \
             and 4 read alike, \u{2260} those they read otherwise, ? those with fewer than {CHECK_BLOCKS} blocks."
        ),
        columns: ["claim".to_string()].into_iter().chain(names.iter().map(|name| name.to_string())).collect(),
        rows,
    })
}

/// The calculation of power, with this study as the pilot of one to come.
fn replicates(findings: Findings) -> Option<ReportTable> {
    plain(
        "Power",
        "What the spread between these blocks says of a study to come: the blocks it needs to see a ratio of 1.5 with a power of 80 % in a family of five, held \
         within 24 to 48, and the ratio that it then detects.",
        &tables::replicates(findings.judged),
    )
}

/// The control `density-noise`.
fn noise(findings: Findings) -> Option<ReportTable> {
    let note = "Does noise on a lattice do what random placement does? q = (A_noisy - A_lattice) / (A_random - A_lattice) with its 95 % limits.";
    plain("Density noise", note, &tables::density_noise(findings.noise))
}

/// The limits that the maps show.
fn limits(findings: Findings) -> Option<ReportTable> {
    let note = "At each place of a map's vertical axis: how far along the horizontal one cases are sound, from where one is not, and where the first step is as long as the limit derived for it.";
    plain("Limits found and derived", note, &table(&maps(findings.archive.study, findings.results)))
}

/// A table as it is written; `None` where it is empty.
fn plain(title: &str, note: &str, table: &Table) -> Option<ReportTable> {
    let shown = |cell: &Cell| match cell {
        Cell::Text(text) => text.clone(),
        Cell::Number(number) if (0.01..1e4).contains(&number.abs()) => format!("{number:.3}"),
        Cell::Number(number) => format!("{number:.3e}"),
        Cell::Count(count) => count.to_string(),
        _ => "-".into(),
    };
    let columns: Vec<String> = table.columns().iter().map(|column| column.name.clone()).collect();
    (!columns.is_empty()).then(|| ReportTable {
        title: title.into(),
        note: note.into(),
        columns,
        rows: table.rows.iter().map(|row| row.entries().map(|(_, cell)| shown(cell)).collect()).collect(),
    })
}

fn failures(findings: Findings) -> Vec<ReportFailure> {
    let failed = |result: &CaseResult| {
        let clamped = matches!(result.record.outcome, Outcome::OkWithClamps).then(|| {
            format!(
                "J_P of {} particles met a bound, {} times",
                result.record.clamped_particles, result.record.clamps
            )
        });
        let reason = result.failure().or(clamped)?;
        let case = format!("{}, block {}", name(findings, result), result.case.block);
        Some(ReportFailure { case, status: result.record.outcome.in_words(), reason })
    };
    findings.results.iter().filter_map(failed).collect()
}

fn facts(findings: Findings, provenance: &Provenance) -> Vec<ReportFact> {
    let fact = |name: &str, value: String| ReportFact { name: name.into(), value };
    let blocks = findings.results.iter().map(|r| r.case.block);
    let (first, last) = (blocks.clone().min().unwrap_or(0), blocks.max().unwrap_or(0));
    let steps: u64 = findings.results.iter().map(|r| r.record.particle_steps).sum();
    vec![
        fact("study file, BLAKE3", blake3::hash(provenance.study_text.as_bytes()).to_hex()[..32].to_string()),
        fact("git revision", provenance.revision.clone().unwrap_or_else(|| "not in a checkout".into())),
        fact("snowlab", env!("CARGO_PKG_VERSION").into()),
        fact("solver version", SOLVER_VERSION.to_string()),
        fact("metric version", METRIC_VERSION.to_string()),
        fact("seeds", format!("{first} to {last}")),
        fact("work", format!("{:.2e} particle-steps", steps as f64)),
        fact("engine, precision", engines(findings.results)),
    ]
}

/// Engines and precisions of the cases, as their scenes name them.
fn engines(results: &[CaseResult]) -> String {
    let named = results.iter().map(|result| {
        let numerics = &result.case.scene.numerics;
        let engine = match numerics.engine {
            EngineName::Fast => "fast",
            EngineName::Reference => "reference",
        };
        let precision = match numerics.precision {
            PrecisionName::F32 => "f32",
            PrecisionName::F64 => "f64",
        };
        format!("{engine}, {precision}")
    });
    let all: std::collections::BTreeSet<String> = named.collect();
    all.into_iter().collect::<Vec<_>>().join("; ")
}
