//! The fragments of a set of particles and the numbers derived from them.

use super::error::{MetricError, check_masses};
use super::exact_sum::FixedPoint;

/// The connected components of a set of particles, heaviest first.
///
/// Component masses are summed exactly ([`FixedPoint`]), and components are ordered by descending mass, ties
/// by their smallest particle index: apart from which particle carries which label nothing depends on the
/// order of particles.
#[derive(Clone, Debug, PartialEq)]
pub struct FragmentAnalysis {
    labels: Vec<u32>,
    masses: Vec<f64>,
    counts: Vec<usize>,
    total_mass: f64,
}

impl FragmentAnalysis {
    /// The fragments of a partition: particles i and j lie in one fragment where `components[i] ==
    /// components[j]`. The names may be any numbers below the number of particles. `masses` [kg], one per
    /// particle; the total mass is their sum.
    ///
    /// # Errors
    /// Masses that do not fit the particles or are not finite and positive; a name that is no particle
    /// number.
    pub fn of_partition(components: &[u32], masses: &[f64]) -> Result<Self, MetricError> {
        let particles = components.len();
        check_masses(particles, masses)?;
        const NONE: u32 = u32::MAX;
        let scale = FixedPoint::for_masses(masses);
        let mut number_of = vec![NONE; particles];
        let (mut sums, mut counts): (Vec<i128>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut labels = Vec::with_capacity(particles);
        for (index, (&component, &mass)) in components.iter().zip(masses).enumerate() {
            let Some(number) = number_of.get_mut(component as usize) else {
                return Err(MetricError::Parameter {
                    parameter: "name of a component",
                    value: f64::from(components[index]),
                    least: 0.0,
                    greatest: particles as f64 - 1.0,
                });
            };
            if *number == NONE {
                *number = sums.len() as u32;
                sums.push(0);
                counts.push(0);
            }
            sums[*number as usize] += scale.encode(mass);
            counts[*number as usize] += 1;
            labels.push(*number);
        }
        // Numbers were given in order of the smallest particle index, so a stable sort settles ties by it.
        let mut by_mass: Vec<u32> = (0..sums.len() as u32).collect();
        by_mass.sort_by_key(|&number| std::cmp::Reverse(sums[number as usize]));
        let mut rank = vec![0; sums.len()];
        for (position, &number) in by_mass.iter().enumerate() {
            rank[number as usize] = position as u32;
        }
        labels.iter_mut().for_each(|label| *label = rank[*label as usize]);
        Ok(Self {
            labels,
            masses: by_mass.iter().map(|&number| scale.decode(sums[number as usize])).collect(),
            counts: by_mass.iter().map(|&number| counts[number as usize]).collect(),
            total_mass: scale.decode(sums.iter().sum()),
        })
    }

    /// The same fragments, with shares taken of `total_mass` [kg] (the case's own mass M) in place of the
    /// mass of the particles measured, which is less where some were lost.
    ///
    /// # Errors
    /// A total mass that is not finite and positive.
    pub fn relative_to(mut self, total_mass: f64) -> Result<Self, MetricError> {
        if !(total_mass.is_finite() && total_mass > 0.0) {
            let (least, greatest) = (f64::MIN_POSITIVE, f64::MAX);
            return Err(MetricError::Parameter {
                parameter: "total mass [kg]",
                value: total_mass,
                least,
                greatest,
            });
        }
        self.total_mass = total_mass;
        Ok(self)
    }

    /// The fragment of each particle: 0 is the heaviest.
    pub fn labels(&self) -> &[u32] {
        &self.labels
    }

    /// The mass of each fragment [kg], descending.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// The number of particles of each fragment, in the order of [`masses`](Self::masses).
    pub fn particle_counts(&self) -> &[usize] {
        &self.counts
    }

    /// The number of fragments of any mass.
    pub fn components(&self) -> usize {
        self.masses.len()
    }

    /// The mass shares are taken of, M [kg].
    pub fn total_mass(&self) -> f64 {
        self.total_mass
    }

    /// N_f, the number of fragments of at least `least_mass` [kg].
    pub fn count(&self, least_mass: f64) -> usize {
        self.masses.partition_point(|&mass| mass >= least_mass)
    }

    /// The share of M in fragments below `least_mass` [kg]; 0 without particles.
    pub fn dust_share(&self, least_mass: f64) -> f64 {
        let dust = &self.masses[self.count(least_mass)..];
        if dust.is_empty() { 0.0 } else { FixedPoint::sum(dust) / self.total_mass }
    }

    /// The mass shares M_k / M, descending.
    pub fn shares(&self) -> impl Iterator<Item = f64> + '_ {
        self.masses.iter().map(|mass| mass / self.total_mass)
    }

    /// N_eff = 1 / sum_k (M_k/M)^2 over all components: the number of equal fragments with the same chance
    /// that two bits of mass lie in one of them (the inverse Simpson index; Hill, Ecology 54, 1973, order 2).
    /// 0 without particles.
    pub fn effective_number(&self) -> f64 {
        if self.masses.is_empty() { 0.0 } else { 1.0 / self.shares().map(|share| share * share).sum::<f64>() }
    }

    /// A = ln N_eff, the primary endpoint; 0 for one piece, minus infinity without particles.
    pub fn log_effective_number(&self) -> f64 {
        libm::log(self.effective_number())
    }

    /// The same of the fragments of at least `least` [kg] alone; 0 where there are none.
    pub fn log_effective_number_above(&self, least: f64) -> f64 {
        let large = || self.masses.iter().take_while(|&&mass| mass >= least);
        let (sum, squares) = (large().sum::<f64>(), large().map(|mass| mass * mass).sum::<f64>());
        if squares > 0.0 { libm::log(sum * sum / squares) } else { 0.0 }
    }

    /// M_1/M, the share of the heaviest fragment; 0 without particles. The study's D is one minus this.
    pub fn largest_share(&self) -> f64 {
        self.shares().next().unwrap_or(0.0)
    }

    /// The mass-weighted median fragment mass [kg]: the greatest mass m such that fragments of at least m
    /// hold at least half of the mass measured. `None` without particles.
    pub fn median_fragment_mass(&self) -> Option<f64> {
        let half = 0.5 * FixedPoint::sum(&self.masses);
        let mut held = 0.0;
        self.masses.iter().copied().find(|mass| {
            held += mass;
            held >= half
        })
    }

    /// D50 [m]: the diameter of the disc (`D` = 2) or ball (3) of density `density` [kg/m^D] with the mass of
    /// the mass-weighted median fragment: sqrt(4 m / (pi rho)), cbrt(6 m / (pi rho)).
    pub fn median_diameter<const D: usize>(&self, density: f64) -> Option<f64> {
        self.median_fragment_mass().map(|mass| equivalent_diameter::<D>(mass, density))
    }
}

/// The diameter [m] of the disc (`D` = 2) or ball (3) of mass `mass` [kg, in 2D per metre of depth] and
/// density `density` [kg/m^3].
pub fn equivalent_diameter<const D: usize>(mass: f64, density: f64) -> f64 {
    let volume = mass / density;
    match D {
        2 => (4.0 * volume / std::f64::consts::PI).sqrt(),
        _ => libm::cbrt(6.0 * volume / std::f64::consts::PI),
    }
}
