use std::collections::BTreeMap;

use super::claim::ClaimError;
use super::observations::ArmValue;

/// The rows of one claim sorted into blocks; arms in the order of the contrast.
pub(super) struct Blocks<'a> {
    /// Blocks in which every arm has a case that is not lost: one case per arm.
    pub complete: Vec<Vec<&'a ArmValue>>,
    /// Blocks with a lost case and no missing one: the value of each arm, `None` where it was lost.
    pub lost: Vec<Vec<Option<f64>>>,
    /// Number of blocks in which a case has not been run: neither complete nor lost.
    pub incomplete: usize,
}

impl<'a> Blocks<'a> {
    /// Sorts `rows` by block; rows of arms other than `arms` are passed over.
    pub fn of(claim: &str, arms: &[&str], rows: &'a [ArmValue]) -> Result<Self, ClaimError> {
        let mut by_block: BTreeMap<u64, Vec<Option<&ArmValue>>> = BTreeMap::new();
        for row in rows {
            let Some(index) = arms.iter().position(|arm| *arm == row.arm) else { continue };
            check_finite(claim, row)?;
            let cases = by_block.entry(row.block).or_insert_with(|| vec![None; arms.len()]);
            if cases[index].replace(row).is_some() {
                let (claim, block, arm) = (claim.into(), row.block, row.arm.clone());
                return Err(ClaimError::Duplicate { claim, block, arm });
            }
        }
        Ok(Self::sorted(by_block.into_values()))
    }

    fn sorted(blocks: impl Iterator<Item = Vec<Option<&'a ArmValue>>>) -> Self {
        let mut result = Self { complete: Vec::new(), lost: Vec::new(), incomplete: 0 };
        for block in blocks {
            let Some(cases) = block.into_iter().collect::<Option<Vec<_>>>() else {
                result.incomplete += 1;
                continue;
            };
            if cases.iter().any(|case| case.is_lost()) {
                result.lost.push(cases.iter().map(|case| (!case.is_lost()).then_some(case.value)).collect());
            } else {
                result.complete.push(cases);
            }
        }
        result
    }

    /// Values of the complete blocks, one row per block, one value per arm.
    pub fn values(&self) -> Vec<Vec<f64>> {
        self.complete.iter().map(|cases| cases.iter().map(|case| case.value).collect()).collect()
    }

    /// The complete blocks followed by the lost ones, each lost value set to the worst seen: the smallest value
    /// of the claim's cases for an arm of positive weight, the largest for one of negative weight.
    pub fn values_with_lost_at_worst(&self, weights: &[f64]) -> Vec<Vec<f64>> {
        let mut rows = self.values();
        let seen = || rows.iter().flatten().copied().chain(self.lost.iter().flatten().flatten().copied());
        let smallest = seen().fold(f64::INFINITY, f64::min);
        let largest = seen().fold(f64::NEG_INFINITY, f64::max);
        let worst = |weight: f64| if weight > 0.0 { smallest } else { largest };
        let filled = |block: &Vec<Option<f64>>| -> Vec<f64> {
            block.iter().zip(weights).map(|(value, weight)| value.unwrap_or(worst(*weight))).collect()
        };
        rows.extend(self.lost.iter().map(filled));
        rows
    }
}

fn check_finite(claim: &str, row: &ArmValue) -> Result<(), ClaimError> {
    let fields = [("value", row.value), ("damage", row.damage), ("damping", row.damping)];
    match fields.into_iter().find(|(_, value)| !row.is_lost() && !value.is_finite()) {
        None => Ok(()),
        Some((field, value)) => {
            let (claim, block, arm) = (claim.into(), row.block, row.arm.clone());
            Err(ClaimError::NotFinite { claim, block, arm, field, value })
        }
    }
}
