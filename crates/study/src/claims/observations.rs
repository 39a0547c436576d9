use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::limits::CLAMP_SHARE;
use crate::spec::study::Rerun;

/// How a case ended, as far as a claim asks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CaseStatus {
    /// Ran to its end.
    Ok,
    /// Ran to its end with some particles clamped.
    OkWithClamps {
        /// Share of the particles that were ever clamped, in [0, 1].
        clamp_share: f64,
    },
    /// Stopped before its end.
    Stopped,
    /// The gate of the metric at t = 0 failed.
    MetricInvalid,
}

/// One case of one arm: the endpoint and what decides whether it may be used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArmValue {
    /// Block: the seed shared by the paired arms.
    pub block: u64,
    /// Name of the arm.
    pub arm: String,
    /// The endpoint A = ln N_eff; of no meaning (NaN allowed) when the case is lost.
    pub value: f64,
    /// How the case ended.
    pub status: CaseStatus,
    /// Whether M1/M varied by at most 0.01 over the last 2R/v.
    pub settled: bool,
    /// Damage D = 1 - M1/M at the time of measurement.
    pub damage: f64,
    /// Damping integral: (1 - a)/dt integrated over time, a the FLIP share of a step.
    pub damping: f64,
}

impl ArmValue {
    /// Whether the case is lost: stopped, metric-invalid, or more than 0.1 % of its particles clamped.
    pub fn is_lost(&self) -> bool {
        match self.status {
            CaseStatus::Ok => false,
            CaseStatus::OkWithClamps { clamp_share } => clamp_share > CLAMP_SHARE,
            CaseStatus::Stopped | CaseStatus::MetricInvalid => true,
        }
    }
}

/// What the pilot says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OperatingPoint {
    /// A speed (or the wedge) was found at which its median D lies within [0.05, 0.6].
    Found,
    /// It found none.
    NotFound,
    /// There was none.
    NoPilot,
}

/// What the arms that nothing can break say: zero-speed impact and the elastic material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseFloor {
    /// They read as one piece in every block.
    Holds,
    /// One of them does not.
    Broken,
    /// None of them was run.
    NotRun,
}

/// What the calibration by stretch says of a claim's arms at equal counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Calibration {
    /// They seem to fall apart at the same stretch, within 15 %.
    Agrees,
    /// They do not: the flood fill is their primary metric.
    FloodFill,
    /// It could not be made.
    NotMeasured,
}

/// The metric that the endpoint A is measured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Primary {
    /// Friends-of-friends at the study's link.
    FriendsOfFriends,
    /// Flood fill of a density raster.
    FloodFill,
}

impl Calibration {
    /// The primary metric of arms so calibrated.
    pub fn primary(self) -> Primary {
        match self {
            Self::Agrees | Self::NotMeasured => Primary::FriendsOfFriends,
            Self::FloodFill => Primary::FloodFill,
        }
    }
}

impl fmt::Display for Primary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FriendsOfFriends => "friends-of-friends",
            Self::FloodFill => "flood fill",
        })
    }
}

/// What decides whether a claim can be judged: of the study the pilot and the noise floor, of its arms the calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Conditions {
    /// The pilot.
    pub operating_point: OperatingPoint,
    /// The calibration by stretch.
    pub calibration: Calibration,
    /// The arms that nothing can break.
    pub noise_floor: NoiseFloor,
}

impl Conditions {
    /// All conditions met.
    pub const MET: Self = Self {
        operating_point: OperatingPoint::Found,
        calibration: Calibration::Agrees,
        noise_floor: NoiseFloor::Holds,
    };
}

/// A re-measurement that a verdict must withstand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Check {
    /// All particles, not the equal counts N*.
    NoThinning,
    /// Linking length 3 h_max.
    LongLink,
    /// Flood fill of a density raster.
    FloodFill,
    /// Graph of the bonds of t = 0.
    BondGraph,
    /// At t_m - 2R/v.
    EarlierTime,
    /// Run again with half the time step.
    HalfStep,
    /// Run again with the other transfer.
    OtherTransfer,
}

impl Check {
    /// All seven, in the order of the rule.
    pub const ALL: [Self; 7] = [
        Self::NoThinning,
        Self::LongLink,
        Self::FloodFill,
        Self::BondGraph,
        Self::EarlierTime,
        Self::HalfStep,
        Self::OtherTransfer,
    ];
}

impl Check {
    /// Whether it takes runs of its own.
    pub fn is_rerun(self) -> bool {
        matches!(self, Self::HalfStep | Self::OtherTransfer)
    }
}

impl From<Rerun> for Check {
    fn from(by: Rerun) -> Self {
        match by {
            Rerun::HalfStep => Self::HalfStep,
            Rerun::OtherTransfer => Self::OtherTransfer,
        }
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoThinning => "no thinning",
            Self::LongLink => "link 3h",
            Self::FloodFill => "flood fill",
            Self::BondGraph => "bond graph",
            Self::EarlierTime => "earlier time",
            Self::HalfStep => "dt/2",
            Self::OtherTransfer => "other transfer",
        })
    }
}

/// Everything observed that one claim is judged by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observations {
    /// One row per case of the claim's arms; rows of other arms are passed over.
    pub rows: Vec<ArmValue>,
    /// What the pilot and the gates say.
    pub conditions: Conditions,
    /// The same cases re-measured, as far as this was done.
    pub checks: BTreeMap<Check, Vec<ArmValue>>,
}
