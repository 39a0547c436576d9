//! Particles of a body that are not alike.

use serde::{Deserialize, Serialize};

/// How particles differ, and in what.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum HeterogeneitySpec {
    /// Each for itself: Gamma of mean 1.
    Independent {
        /// What differs.
        of: Property,
        /// Standard deviation over the mean.
        spread: f64,
    },
    /// Neighbours alike: log-normal of mean 1.
    Correlated {
        /// What differs.
        of: Property,
        /// Standard deviation over the mean.
        spread: f64,
        /// Correlation length [m].
        correlation_length: f64,
    },
    /// A shell that differs from the inside.
    Shell {
        /// What differs.
        of: Property,
        /// Factor in the shell.
        factor: f64,
        /// Thickness [m].
        thickness: f64,
    },
}

/// What the factors are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Property {
    /// Mass and rest volume: how much of the body a particle stands for.
    Weight,
    /// Mass alone.
    Mass,
    /// Both Lame parameters.
    Stiffness,
}

impl HeterogeneitySpec {
    /// What differs.
    pub fn of(&self) -> Property {
        match *self {
            Self::Independent { of, .. } | Self::Correlated { of, .. } | Self::Shell { of, .. } => of,
        }
    }
}
