//! A claim's contrast measured otherwise, run otherwise, and under other conditions: which findings hang on a choice.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Member, blocks_of, equal_count, primary_value, remeasure};
use crate::claims::{ArmValue, Claim, ScopeReading, direction};
use crate::results::{Archive, CaseResult};

/// What was varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Kind {
    /// Nothing.
    Primary,
    /// How the same frames are measured.
    Measurement,
    /// Step or transfer.
    Numerics,
    /// The scene.
    Condition,
}

impl Kind {
    /// The word in tables.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Primary => "primary",
            Kind::Measurement => "measurement",
            Kind::Numerics => "numerics",
            Kind::Condition => "condition",
        }
    }
}

/// The contrast under one variation.
#[derive(Clone, Debug)]
pub struct Variation {
    /// What was varied.
    pub kind: Kind,
    /// The variation in words.
    pub name: String,
    /// What the contrast is then.
    pub reading: ScopeReading,
}

/// All there are, the primary measurement first.
pub(super) fn variations(
    archive: &Archive,
    results: &[CaseResult],
    claim: &Claim,
    member: &Member,
) -> anyhow::Result<Vec<Variation>> {
    let primary = &member.observations.rows;
    let read = |kind, name: &str, rows: &[ArmValue]| -> anyhow::Result<Variation> {
        Ok(Variation { kind, name: name.into(), reading: direction(claim, primary, rows)? })
    };
    let mut variations = vec![read(Kind::Primary, "as claimed", primary)?];
    for (name, rows) in &member.others {
        variations.push(read(Kind::Measurement, name, rows)?);
    }
    for (check, rows) in &member.observations.checks {
        let kind = if check.is_rerun() { Kind::Numerics } else { Kind::Measurement };
        variations.push(read(kind, &check.to_string(), rows)?);
    }
    let study = &archive.study.spec;
    for condition in study.condition.iter().filter(|condition| condition.check.is_none()) {
        let arm_of = |result: &CaseResult| {
            let under = study.under(&result.case.arm).filter(|under| under.condition == condition.id)?;
            claim.arms().into_iter().find(|arm| *arm == under.arm).map(str::to_string)
        };
        let names: BTreeMap<&str, String> =
            results.iter().filter_map(|result| Some((result.case.arm.as_str(), arm_of(result)?))).collect();
        let blocks = blocks_of(results, |result| names.get(result.case.arm.as_str()).map(String::as_str));
        let mut rows = Vec::new();
        for block in blocks.values() {
            for result in block {
                let measured = remeasure(archive, result, equal_count(block), &member.yardstick)?;
                let arm = names[result.case.arm.as_str()].clone();
                rows.push(ArmValue { arm, ..primary_value(result, measured.as_ref()) });
            }
        }
        // A claim is read under a condition that has all its arms.
        if claim.arms().iter().all(|arm| condition.arms.iter().any(|id| id == arm)) && !rows.is_empty() {
            variations.push(read(Kind::Condition, condition.label(), &rows)?);
        }
    }
    Ok(variations)
}
