//! Sums of masses that do not depend on the order of the particles.

/// Significant bits kept of the largest mass. Chosen: a mass 2^22 times below the largest is still summed
/// exactly (53 + 22), and 2^51 of the largest fit the 127 bits of the sum.
const BITS: i32 = 75;

/// Fixed-point numbers whose unit is a power of two set by the largest mass. Integer sums are associative, so
/// a fragment's mass has the same bits however its particles are ordered.
#[derive(Clone, Copy, Debug)]
pub struct FixedPoint {
    exponent: i32,
}

impl FixedPoint {
    /// The scale for these masses [kg], finite and not negative.
    pub fn for_masses(masses: &[f64]) -> Self {
        let largest = masses.iter().copied().fold(0.0, f64::max);
        let exponent = if largest > 0.0 { BITS - libm::ilogb(largest) } else { 0 };
        Self { exponent }
    }

    /// The mass in units of the scale, rounded.
    #[inline]
    pub fn encode(&self, mass: f64) -> i128 {
        libm::scalbn(mass, self.exponent) as i128
    }

    /// The mass [kg] of a sum, rounded once.
    pub fn decode(&self, sum: i128) -> f64 {
        libm::scalbn(sum as f64, -self.exponent)
    }

    /// The sum of these masses [kg].
    pub fn sum(masses: &[f64]) -> f64 {
        let scale = Self::for_masses(masses);
        scale.decode(masses.iter().map(|&mass| scale.encode(mass)).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_does_not_depend_on_the_order() {
        let masses: Vec<f64> = (1..2000).map(|i| 1.0 / i as f64).collect();
        let backwards: Vec<f64> = masses.iter().rev().copied().collect();
        assert_eq!(FixedPoint::sum(&masses).to_bits(), FixedPoint::sum(&backwards).to_bits());
        let plain: f64 = masses.iter().sum();
        assert!((FixedPoint::sum(&masses) - plain).abs() < 1e-12);
    }

    #[test]
    fn the_ends_of_the_range_are_summed() {
        assert_eq!(FixedPoint::sum(&[]), 0.0);
        assert_eq!(FixedPoint::sum(&[5e-324, 5e-324]), 1e-323);
        assert_eq!(FixedPoint::sum(&[1e307, 1e307, 1.0]), 2e307);
    }
}
