//! Whether a study's results lie in the ranges it expects.

use crate::results::CaseResult;
use crate::spec::study::{ExpectSpec, ExpectStatistic};
use crate::statistics::{mean, median};
use crate::sweep::Study;
use crate::table::Row;
use crate::tables::{case_row, groups};

/// One expectation and what was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Whether all values lie in the range.
    pub holds: bool,
    /// One line: what was asked, of whom, what was found.
    pub line: String,
}

/// Holds the results against the expectations of the study's profile. One that no case is there for is not met, unless the
/// profile leaves all its arms out.
pub fn check(study: &Study, results: &[CaseResult]) -> Vec<Finding> {
    let run = study.arms();
    let mut findings: Vec<Finding> = results.iter().filter_map(stopped).collect();
    for expect in &study.spec.expect {
        if !expect.profiles.is_empty() && !expect.profiles.contains(&study.profile) {
            continue;
        }
        let asked = |arm: &str| expect.arms.is_empty() || expect.arms.iter().any(|own| own == arm);
        let groups: Vec<_> = groups(results).into_iter().filter(|group| asked(&group[0].case.arm)).collect();
        if groups.is_empty() && run.iter().any(|arm| asked(arm)) {
            let line = format!("`{}` matches no case ({})", expect.metric, expect.why);
            findings.push(Finding { holds: false, line });
        }
        findings.extend(groups.iter().map(|group| hold(expect, group)));
    }
    findings
}

/// A case that stopped is outside every range.
fn stopped(result: &CaseResult) -> Option<Finding> {
    if let crate::record::Outcome::Stopped { message, .. } = &result.record.outcome {
        let line = format!("{} block {}: {message}", result.case.arm, result.case.block);
        return Some(Finding { holds: false, line });
    }
    None
}

fn hold(expect: &ExpectSpec, group: &[&CaseResult]) -> Finding {
    let rows: Vec<Row> = group.iter().map(|result| case_row(result)).collect();
    let values: Vec<Option<f64>> = rows.iter().map(|row| row.value(&expect.metric)).collect();
    let known: Vec<f64> = values.iter().flatten().copied().collect();
    let asked: Vec<Option<f64>> = match expect.statistic {
        ExpectStatistic::Each => values,
        ExpectStatistic::Mean => vec![mean(&known)],
        ExpectStatistic::Median => vec![median(&known)],
    };
    let [least, greatest] = expect.range;
    let inside = |value: &Option<f64>| value.is_some_and(|v| v >= least && v <= greatest);
    let holds = asked.iter().all(inside);
    let shown: Vec<String> =
        asked.iter().map(|v| v.map_or("missing".to_string(), |v| format!("{v:.4}"))).collect();
    let statistic = match expect.statistic {
        ExpectStatistic::Each => "each",
        ExpectStatistic::Mean => "mean",
        ExpectStatistic::Median => "median",
    };
    let point: Vec<String> =
        group[0].case.point().map(|(name, value)| format!(" {name} = {value}")).collect();
    let line = format!(
        "{}{}: {statistic} `{}` in [{least}, {greatest}]: {} ({})",
        group[0].case.arm,
        point.concat(),
        expect.metric,
        shown.join(", "),
        expect.why
    );
    Finding { holds, line }
}
