//! Frames and the end of the run.

use serde::{Deserialize, Serialize};

/// When frames are kept and when the run ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputSpec {
    /// What `frame_interval` and `end` count in.
    #[serde(default)]
    pub time_unit: TimeUnit,
    /// Time between frames.
    pub frame_interval: f64,
    /// End of the run.
    pub end: f64,
    /// What `end` counts from.
    #[serde(default)]
    pub end_from: EndFrom,
}

/// What times of the output count in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeUnit {
    /// Seconds.
    #[default]
    Second,
    /// R / v of the first body: half its largest extent over its speed.
    Crossing,
}

/// What the end of the run counts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EndFrom {
    /// The start.
    #[default]
    Start,
    /// The first step in which an obstacle changes a velocity.
    Contact,
}
