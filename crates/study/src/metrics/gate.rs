//! The gate at t = 0: does the metric see the bodies that were built?

use super::fragments::FragmentAnalysis;
use std::f64::consts::PI;

/// The greatest share of the mass that may be dust before anything has happened.
pub const DUST_LIMIT: f64 = 0.005;
/// m_cut over the mass of the SOLID ball: lighter components are dust, in every arm.
pub const DUST_CUT: f64 = 0.002;
/// Expected number of particles without a neighbour that a random placement may have. Chosen: one case in a
/// hundred.
const EXPECTED_LONERS: f64 = 0.01;

/// What the metric sees at t = 0 against what was built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// The number of bodies the scene has.
    pub intended_bodies: usize,
    /// The number of components of at least the cut.
    pub bodies_seen: usize,
    /// The share of the mass in lighter components.
    pub dust_share: f64,
    /// The cut m_cut [kg].
    pub least_mass: f64,
    /// Whether the metric may be used.
    pub verdict: GateVerdict,
}

/// Whether a metric is fit for a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GateVerdict {
    /// It sees each body as one piece.
    Valid,
    /// `metric-invalid`: it sees another number of bodies than there are.
    WrongNumberOfBodies,
    /// `metric-invalid`: it sees more dust than [`DUST_LIMIT`].
    TooMuchDust,
}

impl Gate {
    /// Judges the fragments of the undeformed particles that will be measured (thinned ones where the arms
    /// are thinned): the components of at least `least_mass` [kg] must be `intended_bodies`, and dust at most
    /// 0.5 % of the mass.
    pub fn judge(undeformed: &FragmentAnalysis, least_mass: f64, intended_bodies: usize) -> Self {
        let bodies_seen = undeformed.count(least_mass);
        let dust_share = undeformed.dust_share(least_mass);
        let verdict = if bodies_seen != intended_bodies {
            GateVerdict::WrongNumberOfBodies
        } else if dust_share > DUST_LIMIT {
            GateVerdict::TooMuchDust
        } else {
            GateVerdict::Valid
        };
        Self { intended_bodies, bodies_seen, dust_share, least_mass, verdict }
    }

    /// Whether the metric may be used.
    pub fn is_valid(&self) -> bool {
        self.verdict == GateVerdict::Valid
    }
}

impl std::fmt::Display for Gate {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { intended_bodies, bodies_seen, dust_share, least_mass, .. } = self;
        let word = if self.is_valid() { "metric valid" } else { "metric-invalid" };
        write!(
            out,
            "{word}: {bodies_seen} components of at least {least_mass:.3e} kg at t = 0 where \
             {intended_bodies} bodies were built, and {:.3} % dust where {} % is allowed",
            100.0 * dust_share,
            100.0 * DUST_LIMIT
        )
    }
}

/// The least particles per cell h^D at which `particles` placed at random hold together at link 2h: the
/// expected number of particles without a neighbour, N e^(-degree), is at most 0.01. In 2D the degree is 4 pi
/// PPC, hence PPC >= ln(100 N) / (4 pi); in 3D it is (32/3) pi PPC. (Isolated vertices are the last obstacle
/// to connectivity: Penrose, Annals of Applied Probability 7(2), 1997.) 0 for fewer than one particle.
pub fn least_random_particles_per_cell<const D: usize>(particles: usize) -> f64 {
    let degree_per_ppc = if D == 2 { 4.0 * PI } else { 32.0 / 3.0 * PI };
    if particles == 0 { 0.0 } else { libm::log(particles as f64 / EXPECTED_LONERS) / degree_per_ppc }
}
