//! The scalar type of a run: `f32` or `f64`.

use nalgebra::RealField;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::fast::HasRegisters;

/// A floating point type a run can be computed in.
///
/// The transcendental functions come from `libm`, never from the system's library, so that a run has the same bits
/// on every machine; `sqrt` and the four operations are exact by IEEE 754.
pub trait Real: RealField + Copy + Default + HasRegisters + Serialize + DeserializeOwned {
    /// A node whose mass is below this share of the lightest particle's mass counts as empty (chosen: far above the
    /// denormal numbers, so that momentum / mass keeps its relative precision, far below what a result can show).
    const EMPTY_NODE_SHARE: f64;
    /// Sums of squares between this and its inverse have lost nothing to underflow or overflow (chosen: a power of ten well inside the
    /// range of normal numbers times 1 / epsilon).
    const LEAST_SQUARE: f64;
    /// Terms of (1 + x)^(1/2) - 1 for |x| <= 0.1 to round-off.
    const ROOT_TERMS: usize;
    /// Terms of e^x for |x| <= ln 2 / 2 to round-off.
    const EXPONENTIAL_TERMS: usize;
    /// Sweeps after which Jacobi's iteration for a 3 by 3 matrix has long converged (chosen: it needs 4 or 5).
    const JACOBI_SWEEPS: usize;
    /// The greatest n for which both 2^n and 2^-n are normal.
    const EXPONENT_REACH: f64;
    /// ln 2 as a number of few bits, whose products with exponents are exact, and the rest.
    const LN_2: [Self; 2];

    /// The value nearest to `x`.
    fn of(x: f64) -> Self;
    /// The value as `f64`, without loss.
    fn as_f64(self) -> f64;
    /// e to the power of `self`.
    fn exponential(self) -> Self;
    /// The greatest integer not above `self`, where it is an `i32`; for other values any number.
    fn floor_index(self) -> i32;
    /// The value nearest to the integer `i`.
    fn of_index(i: i32) -> Self;
}

impl Real for f64 {
    const EMPTY_NODE_SHARE: f64 = 1e-30;
    const LEAST_SQUARE: f64 = 1e-280;
    const ROOT_TERMS: usize = 13;
    const EXPONENTIAL_TERMS: usize = 13;
    const JACOBI_SWEEPS: usize = 8;
    const EXPONENT_REACH: f64 = 1022.0;
    const LN_2: [f64; 2] = [f64::from_bits(0x3FE6_2E42_FEE0_0000), f64::from_bits(0x3DEA_39EF_3579_3C76)];

    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn as_f64(self) -> f64 {
        self
    }
    #[inline]
    fn exponential(self) -> Self {
        libm::exp(self)
    }
    #[inline(always)]
    fn floor_index(self) -> i32 {
        // From 2^52 on, f64s are the integers: the sum is rounded to one, and its lowest bits are the integer nearest to `self`.
        // `f64::floor` is a library call on the x86-64 baseline, and a cast takes its time for values that do not fit.
        const INTEGERS: f64 = 6_755_399_441_055_744.0; // 2^52 + 2^51
        let nearest = (self + INTEGERS).to_bits() as i32;
        nearest - i32::from(f64::from(nearest) > self)
    }
    #[inline(always)]
    fn of_index(i: i32) -> Self {
        f64::from(i)
    }
}

impl Real for f32 {
    const EMPTY_NODE_SHARE: f64 = 1e-20;
    const LEAST_SQUARE: f64 = 1e-28;
    const ROOT_TERMS: usize = 6;
    const EXPONENTIAL_TERMS: usize = 7;
    const JACOBI_SWEEPS: usize = 7;
    const EXPONENT_REACH: f64 = 126.0;
    const LN_2: [f32; 2] = [f32::from_bits(0x3F31_7200), f32::from_bits(0x35BF_BE8E)];

    #[inline(always)]
    fn of(x: f64) -> Self {
        x as f32
    }
    #[inline(always)]
    fn as_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn exponential(self) -> Self {
        libm::expf(self)
    }
    #[inline(always)]
    fn floor_index(self) -> i32 {
        f64::from(self).floor_index()
    }
    #[inline(always)]
    fn of_index(i: i32) -> Self {
        i as f32
    }
}
