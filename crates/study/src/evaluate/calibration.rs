//! The calibration by stretch: do the arms of a claim seem to fall apart at the same uniform stretch, though nothing
//! tore? Where they do not, friends-of-friends would read their placement as damage, and the flood fill is their primary.

use std::collections::BTreeMap;

use super::start::Start;
use super::{BlocksOf, equal_count};
use crate::claims::Calibration;
use crate::metrics::calibration::STRETCH_RANGE;
use crate::metrics::{MetricError, breaking_stretch, stretches_agree};
use crate::results::{Archive, CaseResult};
use crate::spec::study::MeasureSpec;
use crate::statistics::median;
use crate::store::StoreError;

/// The stretch at which a case falls apart; [`OVER`] where it holds at the greatest.
type Breaking = Result<f64, MetricError>;

/// Stands for every stretch beyond those tried: far enough that a median between it and any other lies beyond them too.
const OVER: f64 = 2.0 * STRETCH_RANGE[1];

/// Measures each case at each count once.
pub(super) struct Calibrator<'a> {
    archive: &'a Archive<'a>,
    /// By key, count and h_max (its bits).
    known: BTreeMap<(String, usize, u64), Breaking>,
}

impl<'a> Calibrator<'a> {
    pub fn new(archive: &'a Archive<'a>) -> Self {
        Calibrator { archive, known: BTreeMap::new() }
    }

    /// Compares the arms of a claim by the median over all blocks in which each of them was built, at the count of the
    /// block. What was found comes with it, in words.
    pub fn calibrate(
        &mut self,
        blocks: &BlocksOf,
        measure: &MeasureSpec,
    ) -> Result<(Calibration, String), StoreError> {
        let arms = blocks.values().map(Vec::len).max().unwrap_or(0);
        let whole = |block: &&Vec<&CaseResult>| {
            block.len() == arms && block.iter().all(|result| result.record.was_built())
        };
        let mut stretches: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        let mut counts = Vec::new();
        for block in blocks.values().filter(whole) {
            counts.push(equal_count(block));
            for result in block {
                match self.breaking(result, equal_count(block), measure)? {
                    Ok(stretch) => stretches.entry(&result.case.arm).or_default().push(stretch),
                    Err(error) => {
                        let (arm, block) = (&result.case.arm, result.case.block);
                        return Ok((
                            Calibration::NotMeasured,
                            format!("could not be made of {arm} block {block}: {error}"),
                        ));
                    }
                }
            }
        }
        let (Some(least), Some(most)) = (counts.iter().min(), counts.iter().max()) else {
            return Ok((Calibration::NotMeasured, "no block has all its arms".into()));
        };
        let medians: Vec<(&str, Option<f64>)> = stretches
            .iter()
            .map(|(arm, values)| (*arm, median(values).filter(|stretch| *stretch <= STRETCH_RANGE[1])))
            .collect();
        let agree = stretches_agree(&medians.iter().map(|(_, stretch)| *stretch).collect::<Vec<_>>());
        let calibration = if agree { Calibration::Agrees } else { Calibration::FloodFill };
        let list: Vec<String> = medians
            .iter()
            .map(|(arm, s)| format!("{arm} {}", s.map_or("over 20".into(), |s| format!("{s:.2}"))))
            .collect();
        let particles = if least == most { format!("{least}") } else { format!("{least} to {most}") };
        let word = if agree { "agrees" } else { "does not agree within 15 %" };
        let blocks = counts.len();
        Ok((
            calibration,
            format!("{word} at {particles} particles, medians over {blocks} blocks: {}", list.join(", ")),
        ))
    }

    fn breaking(
        &mut self,
        result: &CaseResult,
        count: usize,
        measure: &MeasureSpec,
    ) -> Result<Breaking, StoreError> {
        let key = (result.key.clone(), count, measure.largest_spacing.to_bits());
        if let Some(known) = self.known.get(&key) {
            return Ok(known.clone());
        }
        let found = match result.case.scene.dimension {
            3 => breaking_in::<3>(self.archive, result, count, measure)?,
            _ => breaking_in::<2>(self.archive, result, count, measure)?,
        };
        self.known.insert(key, found.clone());
        Ok(found)
    }
}

fn breaking_in<const D: usize>(
    archive: &Archive,
    result: &CaseResult,
    count: usize,
    measure: &MeasureSpec,
) -> Result<Breaking, StoreError> {
    let start = Start::<D>::read(archive, result, measure)?;
    Ok(start
        .thinned(result, count)
        .and_then(|(points, masses)| Ok(breaking_stretch(&points, &masses, start.link, 0)?.unwrap_or(OVER))))
}
