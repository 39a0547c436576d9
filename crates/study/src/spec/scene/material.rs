//! What a body is made of.

use serde::{Deserialize, Serialize};

/// A material. The defaults are S13's table 2 as handed on by public codes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum MaterialSpec {
    /// Snow.
    Snow {
        /// Density at rest [kg/m^D].
        #[serde(default = "defaults::density")]
        density: f64,
        /// Young's modulus E [Pa].
        #[serde(default = "defaults::young")]
        young: f64,
        /// Poisson's ratio nu.
        #[serde(default = "defaults::poisson")]
        poisson: f64,
        /// theta_c.
        #[serde(default = "defaults::critical_compression")]
        critical_compression: f64,
        /// theta_s.
        #[serde(default = "defaults::critical_stretch")]
        critical_stretch: f64,
        /// xi.
        #[serde(default = "defaults::hardening")]
        hardening: f64,
        /// Bounds on J_P; a run in which one takes effect is marked. None when left out.
        #[serde(default)]
        plastic_ratio_bounds: Option<[f64; 2]>,
        /// The greatest factor that hardening has on the moduli. None when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        hardening_limit: Option<f64>,
    },
    /// The same elastic law without a yield surface.
    Elastic {
        /// Density at rest [kg/m^D].
        #[serde(default = "defaults::density")]
        density: f64,
        /// Young's modulus E [Pa].
        #[serde(default = "defaults::young")]
        young: f64,
        /// Poisson's ratio nu.
        #[serde(default = "defaults::poisson")]
        poisson: f64,
    },
}

impl Default for MaterialSpec {
    fn default() -> Self {
        MaterialSpec::Snow {
            density: defaults::density(),
            young: defaults::young(),
            poisson: defaults::poisson(),
            critical_compression: defaults::critical_compression(),
            critical_stretch: defaults::critical_stretch(),
            hardening: defaults::hardening(),
            plastic_ratio_bounds: None,
            hardening_limit: None,
        }
    }
}

impl MaterialSpec {
    /// Density at rest [kg/m^D].
    pub fn density(&self) -> f64 {
        match self {
            MaterialSpec::Snow { density, .. } | MaterialSpec::Elastic { density, .. } => *density,
        }
    }
}

/// Defaults of keys that may be left out: S13 table 2 as handed on by public codes.
mod defaults {
    pub fn density() -> f64 {
        400.0
    }
    pub fn young() -> f64 {
        1.4e5
    }
    pub fn poisson() -> f64 {
        0.2
    }
    pub fn critical_compression() -> f64 {
        2.5e-2
    }
    pub fn critical_stretch() -> f64 {
        7.5e-3
    }
    pub fn hardening() -> f64 {
        10.0
    }
}
