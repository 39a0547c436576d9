//! Charts of endpoints, distributions, curves, energies and claims.

use crate::claims::{Contrast, Verdict, smallest_effect};
use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};
use crate::figure::energy::{Energy, EnergyCase, energy};
use crate::figure::forest::{self, Forest, forest};
use crate::figure::pilot::{Pilot, PilotArm, pilot};
use crate::figure::sizes::{SizeArm, sizes};
use crate::figure::strips::{Endpoint, Strip, Strips, Summary, strips};
use crate::measure::Metrics;
use crate::results::CaseResult;
use crate::statistics::{OperatingSpeed, SpeedTrial, operating_speed, quantile, summarise};
use crate::tables::{case_row, groups, usable};

use super::{Findings, Titled, drawn};

/// Cases of the arms that are compared: not those of the noise floor, nor those that only make a picture.
struct Arms<'a> {
    labels: Vec<String>,
    cases: Vec<Vec<&'a CaseResult>>,
}

/// All charts that the study's results allow.
pub fn all(findings: Findings) -> anyhow::Result<Vec<Titled>> {
    if !findings.archive.study.spec.sweep.is_empty() {
        return Ok(pilot_chart(findings)?.into_iter().collect());
    }
    let arms = Arms::of(findings);
    let charts = [
        endpoints(&arms)?,
        distributions(&arms)?,
        links(findings, &arms)?,
        histories(&arms)?,
        energies(findings)?,
        trend(findings)?,
        claims(findings)?,
    ];
    Ok(charts.into_iter().flatten().collect())
}

impl<'a> Arms<'a> {
    fn of(findings: Findings<'a>) -> Self {
        let spec = &findings.archive.study.spec;
        let judged = spec.claim.iter().chain(&spec.control).flat_map(|claim| claim.arms());
        let judged: Vec<&str> = judged.collect();
        let mut arms = Arms { labels: Vec::new(), cases: Vec::new() };
        for group in groups(findings.results) {
            let id = group[0].case.arm.as_str();
            let floor = spec.noise_floor.iter().any(|arm| arm == id);
            let only_pictured = group.len() == 1 && !judged.contains(&id);
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

fn endpoints(arms: &Arms) -> anyhow::Result<Option<Titled>> {
    let shown = [
        ("ln_neff", "A = ln N_{eff}"),
        ("damage", "damage D"),
        ("fragments", "fragments N_{f}"),
        ("crack", "crack length [m]"),
    ];
    let values = |endpoint: &str| -> Vec<Vec<f64>> {
        let of =
            |cases: &Vec<&CaseResult>| cases.iter().filter_map(|r| case_row(r).value(endpoint)).collect();
        arms.cases.iter().map(of).collect()
    };
    let columns: Vec<Vec<Vec<f64>>> = shown.iter().map(|(endpoint, _)| values(endpoint)).collect();
    let strips_of: Vec<Vec<Strip>> = columns
        .iter()
        .map(|column| column.iter().map(|values| Strip { values, summary: summary(values) }).collect())
        .collect();
    let panels: Vec<Endpoint> = shown
        .iter()
        .zip(&strips_of)
        .map(|((_, label), strips)| Endpoint { label, scale: Scale::Linear, strips })
        .collect();
    let figure = Strips {
        title: "",
        arms: &arms.names(),
        endpoints: &panels,
        note: "every case a point; mean with its 95 % t interval",
    };
    Ok(drawn(strips(&figure))?.map(|drawing| Titled {
        name: "endpoints".into(),
        title: "Endpoints by arm".into(),
        caption: "Every case as a point, with the mean of the arm and its 95 % t interval.".into(),
        alternative: "Strips of every case's ln N_eff, damage, fragment count and crack length, one for each arm; the numbers are in the summary table.".into(),
        drawing,
    }))
}

fn summary(values: &[f64]) -> Option<Summary> {
    let s = summarise(values, 0.95)?;
    let interval = s.interval?;
    Some(Summary { mean: s.mean, low: interval.lower, high: interval.upper })
}

fn distributions(arms: &Arms) -> anyhow::Result<Option<Titled>> {
    let cases: Vec<Vec<&[f64]>> =
        (0..arms.cases.len()).map(|arm| arms.metrics(arm).map(|m| m.sizes.as_slice()).collect()).collect();
    let shown: Vec<SizeArm> =
        arms.labels.iter().zip(&cases).map(|(label, cases)| SizeArm { arm: label, cases }).collect();
    Ok(drawn(sizes("", &shown))?.map(|drawing| Titled {
        name: "fragment-sizes".into(),
        title: "Fragment sizes".into(),
        caption: "Share of the fragments that weigh at least m, against m over the mass of the ball: mean over cases, band from the 10 % to the 90 % quantile.".into(),
        alternative: "Complementary cumulative distributions of fragment mass, one curve for each arm.".into(),
        drawing,
    }))
}

/// Median and 10 % and 90 % quantiles over cases at each abscissa.
struct Band {
    x: Vec<f64>,
    middle: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Band {
    /// `rows` are cases, each a value at each abscissa; as many abscissae are used as all cases have.
    fn of(x: &[f64], rows: &[Vec<f64>]) -> Self {
        let length = rows.iter().map(Vec::len).min().unwrap_or(0).min(x.len());
        let at = |share: f64| -> Vec<f64> {
            let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<_>>();
            (0..length).map(|k| quantile(&column(k), share).unwrap_or(f64::NAN)).collect()
        };
        Band { x: x[..length].to_vec(), middle: at(0.5), low: at(0.1), high: at(0.9) }
    }

    fn curve<'a>(&'a self, arm: &'a str) -> Curve<'a> {
        Curve { arm, x: &self.x, middle: &self.middle, low: &self.low, high: &self.high }
    }
}

fn bands(arms: &Arms, x: impl Fn(&Metrics) -> Vec<f64>, y: impl Fn(&Metrics) -> Vec<f64>) -> Vec<Band> {
    (0..arms.cases.len())
        .map(|arm| {
            let rows: Vec<Vec<f64>> = arms.metrics(arm).map(&y).collect();
            let axis = arms.metrics(arm).map(&x).min_by_key(Vec::len).unwrap_or_default();
            Band::of(&axis, &rows)
        })
        .collect()
}

fn named<'a>(arms: &'a Arms, bands: &'a [Band]) -> Vec<Curve<'a>> {
    arms.labels.iter().zip(bands).map(|(label, band)| band.curve(label)).collect()
}

fn links(findings: Findings, arms: &Arms) -> anyhow::Result<Option<Titled>> {
    let link = |m: &Metrics| m.link_curve.iter().map(|row| row.0).collect();
    let components = bands(arms, link, |m| m.link_curve.iter().map(|row| row.1 as f64).collect());
    let ln_neff = bands(arms, link, |m| m.link_curve.iter().map(|row| row.3).collect());
    let (components, ln_neff) = (named(arms, &components), named(arms, &ln_neff));
    let quantities = [
        Quantity {
            label: "components N",
            scale: Scale::Logarithmic,
            hold: &[1.0],
            level: None,
            curves: &components,
        },
        Quantity { label: "A = ln N_{eff}", scale: Scale::Linear, hold: &[0.0], level: None, curves: &ln_neff },
    ];
    let figure = Curves {
        title: "",
        x_label: "link / h",
        x_scale: Scale::Linear,
        mark: Some((findings.archive.study.measure.link_ratio, "link used")),
        spread: Spread::Band,
        note: "median over cases, band from the 10 % to the 90 % quantile",
        quantities: &quantities,
    };
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: "link-curves".into(),
        title: "Components against the link".into(),
        caption: "All components, and ln N_eff, at the end of the run for every link from 0.5 h to 4 h. Where the curve is flat, the count does not hang on the ruler.".into(),
        alternative: "Curves of the number of components and of ln N_eff against the link, one for each arm.".into(),
        drawing,
    }))
}

fn histories(arms: &Arms) -> anyhow::Result<Option<Titled>> {
    // Frames before contact differ in number between cases; from contact on they are at the same times.
    let after = |m: &Metrics, pick: fn(&crate::measure::SeriesRow) -> f64| -> Vec<f64> {
        m.series.iter().filter(|row| row.since_contact > 0.0).map(pick).collect()
    };
    let time = |m: &Metrics| after(m, |row| row.since_contact);
    let count = bands(arms, time, |m| after(m, |row| row.fragments.fragments as f64));
    let largest = bands(arms, time, |m| after(m, |row| 1.0 - row.fragments.damage));
    let (count, largest) = (named(arms, &count), named(arms, &largest));
    let quantities = [
        Quantity { label: "fragments N_{f}", scale: Scale::Linear, hold: &[0.0], level: None, curves: &count },
        Quantity {
            label: "largest share M_{1}/M",
            scale: Scale::Linear,
            hold: &[1.0],
            level: None,
            curves: &largest,
        },
    ];
    let figure = Curves {
        title: "",
        x_label: "time since contact [R/v]",
        x_scale: Scale::Linear,
        mark: None,
        spread: Spread::Band,
        note: "median over cases, band from the 10 % to the 90 % quantile",
        quantities: &quantities,
    };
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: "fragments-over-time".into(),
        title: "Fragments over time".into(),
        caption:
            "Number of fragments and share of the largest from first contact to the time of the measurement."
                .into(),
        alternative: "Curves of the fragment count and of the largest share against time, one for each arm."
            .into(),
        drawing,
    }))
}

fn energies(findings: Findings) -> anyhow::Result<Option<Titled>> {
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
            let part =
                |pick: fn(&crate::record::HistoryRow) -> f64| history.iter().map(pick).collect::<Vec<f64>>();
            let parts = vec![
                part(|row| row.kinetic),
                part(|row| row.elastic),
                part(|row| row.plastic_loss),
                part(|row| row.contact_loss),
                part(|row| row.transfer_loss),
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

/// Means of A over the particle numbers of the first trend that is claimed.
fn trend(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let trends = findings.archive.study.spec.claim.iter().filter_map(|claim| match &claim.contrast {
        Contrast::Trend { arms } => Some(arms),
        _ => None,
    });
    let Some(trend) = trends.into_iter().next() else { return Ok(None) };
    let mut points: Vec<(f64, Summary)> = Vec::new();
    for arm in trend {
        let cases = findings.results.iter().filter(|r| r.case.arm == arm.arm && usable(r));
        let values: Vec<f64> = cases.filter_map(|r| Some(r.metrics.as_ref()?.end.ln_neff)).collect();
        points.extend(summary(&values).map(|s| (arm.particles, s)));
    }
    let column = |pick: fn(&(f64, Summary)) -> f64| points.iter().map(pick).collect::<Vec<f64>>();
    let (x, middle, low, high) =
        (column(|p| p.0), column(|p| p.1.mean), column(|p| p.1.low), column(|p| p.1.high));
    let curve = [Curve { arm: "random", x: &x, middle: &middle, low: &low, high: &high }];
    let quantities =
        [Quantity { label: "A = ln N_{eff}", scale: Scale::Linear, hold: &[0.0], level: None, curves: &curve }];
    let figure = Curves {
        title: "",
        x_label: "particles N",
        x_scale: Scale::Logarithmic,
        mark: None,
        spread: Spread::Bars,
        note: "all particles, no thinning; mean with its 95 % t interval",
        quantities: &quantities,
    };
    if points.is_empty() {
        return Ok(None);
    }
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: "particle-number".into(),
        title: "Fragmentation against particle number".into(),
        caption:
            "Random placement at one grid spacing: mean of ln N_eff over blocks with its 95 % t interval."
                .into(),
        alternative: "Mean ln N_eff of random placement against the number of particles, with intervals."
            .into(),
        drawing,
    }))
}

fn claims(findings: Findings) -> anyhow::Result<Option<Titled>> {
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
        alternative: "Forest plot of the claims' effects; the numbers are in the table of verdicts.".into(),
        drawing,
    }))
}

/// A contrast in a few words.
pub fn contrast(findings: Findings, contrast: &Contrast) -> String {
    let label = |arm: &str| findings.archive.study.label(arm);
    match contrast {
        Contrast::Paired { treated, control } => format!("{} - {}", label(treated), label(control)),
        Contrast::Trend { arms } => format!("- slope on log2 N, {} arms, x log2 6", arms.len()),
        Contrast::Range { arms } => format!("range of {} arm means", arms.len()),
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

/// Damage against the axis `speed` of a sweep.
fn pilot_chart(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let (speeds, arms, chosen) = speed_trials(findings);
    if speeds.is_empty() {
        return Ok(None);
    }
    let columns: Vec<Vec<&[f64]>> =
        arms.iter().map(|(_, damage)| damage.iter().map(Vec::as_slice).collect()).collect();
    let shown: Vec<PilotArm> =
        arms.iter().zip(&columns).map(|((arm, _), damage)| PilotArm { arm, damage }).collect();
    let figure = Pilot {
        title: "",
        speeds: &speeds,
        arms: &shown,
        target: 0.25,
        accepted: [0.05, 0.6],
        chosen: chosen.and_then(|speed| speeds.iter().position(|s| *s == speed)),
        note: "every case a point; a short line is the median of an arm",
    };
    Ok(drawn(pilot(&figure))?.map(|drawing| Titled {
        name: "pilot".into(),
        title: "Damage against speed".into(),
        caption: "D = 1 - M1/M of every case. The study runs at the speed whose pooled median is nearest to 0.25, if it lies within [0.05, 0.6].".into(),
        alternative: "Damage of every pilot case against impact speed, by arm; the numbers are in the summary table.".into(),
        drawing,
    }))
}

/// Speeds, damages by arm and speed, and the speed that the rule chooses.
type SpeedTrials = (Vec<f64>, Vec<(String, Vec<Vec<f64>>)>, Option<f64>);

fn speed_trials(findings: Findings) -> SpeedTrials {
    let study = findings.archive.study;
    let speed_of =
        |r: &CaseResult| r.case.axes.iter().find(|(name, _)| name == "speed").map(|(_, value)| *value);
    let mut speeds: Vec<f64> = findings.results.iter().filter_map(speed_of).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let damages = |arm: &str, speed: f64| -> Vec<f64> {
        let cases =
            findings.results.iter().filter(|r| r.case.arm == arm && speed_of(r) == Some(speed) && usable(r));
        cases.filter_map(|r| Some(r.metrics.as_ref()?.end.damage)).collect()
    };
    let ids = study.arms();
    let arms = ids
        .iter()
        .map(|id| (study.label(id), speeds.iter().map(|&speed| damages(id, speed)).collect()))
        .collect();
    let chosen = match operating_point(findings.results, &ids) {
        Some((OperatingSpeed::Found { speed, .. }, _)) => Some(speed),
        _ => None,
    };
    (speeds, arms, chosen)
}

/// The operating point by the pilot's rule, obstacle by obstacle: arms of one obstacle share the first part of their
/// id; an obstacle is asked only where those before it, in the order of the file, have no usable speed. The obstacle comes
/// with it.
pub fn operating_point(results: &[CaseResult], arms: &[&str]) -> Option<(OperatingSpeed, String)> {
    let obstacle = |arm: &str| arm.split('-').next().unwrap_or(arm).to_string();
    let mut obstacles: Vec<String> = Vec::new();
    for arm in arms {
        if !obstacles.contains(&obstacle(arm)) {
            obstacles.push(obstacle(arm));
        }
    }
    let mut latest = None;
    for name in obstacles {
        let mut trials: Vec<SpeedTrial> = Vec::new();
        for result in results.iter().filter(|r| obstacle(&r.case.arm) == name && usable(r)) {
            let speed = result.case.axes.iter().find(|(axis, _)| axis == "speed").map(|(_, value)| *value);
            if let (Some(speed), Some(metrics)) = (speed, &result.metrics) {
                match trials.iter_mut().find(|trial| trial.speed == speed) {
                    Some(trial) => trial.damages.push(metrics.end.damage),
                    None => trials.push(SpeedTrial { speed, damages: vec![metrics.end.damage] }),
                }
            }
        }
        if trials.is_empty() {
            continue;
        }
        let found = operating_speed(&trials);
        let usable = matches!(found, OperatingSpeed::Found { .. });
        latest = Some((found, name));
        if usable {
            break;
        }
    }
    latest
}
