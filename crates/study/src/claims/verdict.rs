use std::fmt;

use serde::Serialize;

use super::limits::{MINIMUM_BLOCKS, SMALLEST_RATIO};
use super::observations::Check;

/// What the mechanical rule says of a claim. "Refuted" reads "not reproduced under these conditions".
/// `Display` gives the phrase that stands in tables; [`Verdict::explanation`] the numbers behind it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Verdict {
    /// Too little was run to judge.
    NotRun(NotRun),
    /// Judged, without an answer.
    Inconclusive(Reason),
    /// The sentence holds.
    Supported,
    /// The sentence does not hold.
    Refuted(Refutation),
}

/// An answer of rules 3 and 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Finding {
    /// The effect lies above 0 and is at least delta.
    Supported,
    /// The effect is smaller than delta.
    Refuted(Refutation),
}

/// In what way a claim is refuted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Refutation {
    /// The effect has the other sign.
    Reversed,
    /// The effect is smaller than the smallest of interest.
    Smaller,
}

/// Why a claim has not been run (rule 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum NotRun {
    /// Fewer than 12 complete blocks.
    TooFewBlocks {
        /// Complete blocks.
        complete: usize,
    },
    /// Over 10 % of the blocks were lost.
    TooManyLost {
        /// Blocks with a lost case.
        lost: usize,
        /// Blocks in which every arm was run.
        run: usize,
    },
}

/// Why a claim has no answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Reason {
    /// Rule 2: nothing breaks where the runs were made.
    Floor(FloorCause),
    /// Rule 2: whether anything should break there is not known.
    NoPilot,
    /// Rule 2: over 20 % of an arm's cases are unsettled.
    NoPlateau {
        /// The arm.
        arm: String,
        /// Share of its cases that are unsettled.
        share: f64,
    },
    /// Rule 2: the metric cannot be trusted.
    Metric(MetricFault),
    /// Rule 2: the arms' mean damping integrals differ by more than 5 %.
    Damping {
        /// Largest over smallest mean.
        ratio: f64,
    },
    /// Rules 3 and 4: the studentised and the BCa interval give different answers.
    MethodsDisagree {
        /// Answer of the studentised interval; `None` for none.
        by_t: Option<Finding>,
        /// Answer of the BCa interval; `None` for none.
        by_bca: Option<Finding>,
    },
    /// Rule 5: the effect is neither clearly present nor clearly smaller than delta.
    Unresolved,
    /// Rule 1: the answer does not hold with the lost cases at their least favourable value.
    LostCases {
        /// What the complete blocks say.
        without: Finding,
        /// Blocks with a lost case.
        lost: usize,
    },
    /// Rule 6: the answer does not withstand the re-measurements.
    Measurement {
        /// What the primary measurement says.
        primary: Finding,
        /// Checks that speak against it.
        against: Vec<Check>,
        /// Checks the rule needs that are missing (or have fewer than 8 complete blocks).
        missing: Vec<Check>,
    },
}

/// Why there is no effect to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum FloorCause {
    /// The pilot found no usable operating point.
    NoOperatingPoint,
    /// Over 75 % of the cases of every arm have D < 0.01.
    Unbroken {
        /// Smallest share of unbroken cases over the arms.
        share: f64,
    },
}

/// Why the metric cannot be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum MetricFault {
    /// The calibration by stretch could not be made.
    NotCalibrated,
    /// An impact at zero speed or an elastic ball reads as more than one piece.
    NoiseFloor,
    /// Neither an impact at zero speed nor an elastic ball was run.
    NoiseFloorNotRun,
}

impl From<Finding> for Verdict {
    fn from(finding: Finding) -> Self {
        match finding {
            Finding::Supported => Self::Supported,
            Finding::Refuted(refutation) => Self::Refuted(refutation),
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Supported => f.write_str("supported"),
            Self::Refuted(Refutation::Reversed) => f.write_str("refuted (reversed)"),
            Self::Refuted(Refutation::Smaller) => write!(f, "refuted (smaller than {SMALLEST_RATIO}x)"),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotRun(NotRun::TooFewBlocks { .. }) => write!(f, "not-run (n < {MINIMUM_BLOCKS})"),
            Self::NotRun(NotRun::TooManyLost { .. }) => f.write_str("not-run (over 10 % lost)"),
            Self::Inconclusive(reason) => write!(f, "inconclusive ({reason})"),
            Self::Supported => write!(f, "{}", Finding::Supported),
            Self::Refuted(refutation) => write!(f, "{}", Finding::Refuted(*refutation)),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Floor(_) => f.write_str("floor"),
            Self::NoPlateau { .. } => f.write_str("no plateau"),
            Self::NoPilot => f.write_str("no pilot"),
            Self::Metric(MetricFault::NotCalibrated) => f.write_str("not calibrated"),
            Self::Metric(MetricFault::NoiseFloor) => f.write_str("metric"),
            Self::Metric(MetricFault::NoiseFloorNotRun) => f.write_str("noise floor not run"),
            Self::Damping { .. } => f.write_str("damping"),
            Self::MethodsDisagree { .. } => f.write_str("t and BCa disagree"),
            Self::Unresolved => f.write_str("not resolved"),
            Self::LostCases { .. } => f.write_str("lost cases"),
            Self::Measurement { against, missing, .. } => {
                write!(f, "measurement: {}", which(against, missing))
            }
        }
    }
}

/// "flood fill, bond graph; missing dt/2".
fn which(against: &[Check], missing: &[Check]) -> String {
    let list = |checks: &[Check]| checks.iter().map(Check::to_string).collect::<Vec<_>>().join(", ");
    match (against.is_empty(), missing.is_empty()) {
        (_, true) => list(against),
        (true, false) => format!("missing {}", list(missing)),
        (false, false) => format!("{}; missing {}", list(against), list(missing)),
    }
}

impl Verdict {
    /// One sentence with the numbers that decided.
    pub fn explanation(&self) -> String {
        match self {
            Self::NotRun(NotRun::TooFewBlocks { complete }) => {
                format!("{complete} complete blocks; a verdict takes {MINIMUM_BLOCKS}")
            }
            Self::NotRun(NotRun::TooManyLost { lost, run }) => {
                format!("{lost} of {run} blocks have a lost case; a verdict takes at most 10 %")
            }
            Self::Inconclusive(reason) => reason.explanation(),
            Self::Supported => format!("the effect lies above 0 and is at least ln {SMALLEST_RATIO}"),
            Self::Refuted(Refutation::Reversed) => "the effect has the other sign".into(),
            Self::Refuted(Refutation::Smaller) => {
                format!("the upper bound of the effect is below ln {SMALLEST_RATIO}")
            }
        }
    }
}

impl Reason {
    fn explanation(&self) -> String {
        let named = |answer: &Option<Finding>| answer.map_or("no answer".into(), |found| found.to_string());
        match self {
            Self::Floor(FloorCause::NoOperatingPoint) => "the pilot found no usable operating point".into(),
            Self::Floor(FloorCause::Unbroken { share }) => {
                format!("in every arm at least {:.0} % of the cases have D < 0.01", 100.0 * share)
            }
            Self::NoPlateau { arm, share } => {
                format!("{:.0} % of the cases of arm `{arm}` are unsettled", 100.0 * share)
            }
            Self::NoPilot => "no pilot has looked for a speed at which the ball breaks".into(),
            Self::Metric(MetricFault::NotCalibrated) => {
                "at which stretch the arms' placements seem to fall apart could not be measured".into()
            }
            Self::Metric(MetricFault::NoiseFloor) => {
                "an impact at zero speed or an elastic ball reads as more than one piece".into()
            }
            Self::Metric(MetricFault::NoiseFloorNotRun) => {
                "no case that nothing can break was run, to show that the metric reads one piece".into()
            }
            Self::Damping { ratio } => {
                format!("mean damping integrals of the arms differ by {:.1} %", 100.0 * (ratio - 1.0))
            }
            Self::MethodsDisagree { by_t, by_bca } => {
                format!("studentised: {}; BCa: {}", named(by_t), named(by_bca))
            }
            Self::Unresolved => {
                format!("the effect is neither shown to be present nor to be below ln {SMALLEST_RATIO}")
            }
            Self::LostCases { without, lost } => {
                format!("{without} without the {lost} lost blocks, but not with them at their worst")
            }
            Self::Measurement { primary, against, missing } => {
                format!("{primary} as measured first, not upheld by: {}", which(against, missing))
            }
        }
    }
}
