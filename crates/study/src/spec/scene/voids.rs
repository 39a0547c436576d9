//! The voids of a body.

use serde::{Deserialize, Serialize};

/// A void field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum VoidSpec {
    /// Irregular circles (spheres).
    Circles(InclusionSpec),
    /// Irregular ellipses (ellipsoids) of the same centres and areas.
    Ellipses(InclusionSpec),
    /// A level cut of a Gaussian random field.
    GaussianField {
        /// Share of the body that is void.
        #[serde(default = "defaults::porosity")]
        porosity: f64,
        /// Correlation length [m].
        correlation_length: f64,
        /// Grid spacing that voids and bridges are judged by [m]; the scene's when left out.
        #[serde(default)]
        judged_at: Option<f64>,
    },
}

/// Parameters of circles and ellipses. Lengths left out follow from the spacing they are judged by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InclusionSpec {
    /// Share of the body that is void.
    #[serde(default = "defaults::porosity")]
    pub porosity: f64,
    /// Mean radius [m]; 3 h when left out.
    #[serde(default)]
    pub mean_radius: Option<f64>,
    /// Standard deviation of the radius over its mean.
    #[serde(default = "defaults::radius_spread")]
    pub radius_spread: f64,
    /// RMS of the outline's relative perturbation.
    #[serde(default = "defaults::irregularity")]
    pub irregularity: f64,
    /// Long over short axis of the ellipses; circles of the same seed leave room for it.
    #[serde(default = "defaults::aspect")]
    pub aspect: f64,
    /// Angle of the long axes [degrees]; random when left out.
    #[serde(default)]
    pub angle: Option<f64>,
    /// Least solid between voids, and between voids and surface [m]; 2 h when left out.
    #[serde(default)]
    pub gap: Option<f64>,
    /// Grid spacing that voids and bridges are judged by [m]; the scene's when left out.
    #[serde(default)]
    pub judged_at: Option<f64>,
}

/// Defaults of keys that may be left out: the study's definition (docs/experiment.md).
mod defaults {
    pub fn porosity() -> f64 {
        0.15
    }
    pub fn radius_spread() -> f64 {
        0.2
    }
    pub fn irregularity() -> f64 {
        0.1
    }
    pub fn aspect() -> f64 {
        2.0
    }
}
