//! AVX2 with FMA, and AVX-512.
#![expect(
    unsafe_code,
    reason = "vector instructions: all functions here are inlined into ones compiled for the set, which run only where it was found; \
              loads and stores are within slices whose length has been checked, and need no alignment"
)]

mod lanes;
mod rows;

use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};

use super::simd::InstructionSet;
use lanes::{F32x8, F32x16, F64x4, F64x8};
use rows::{F32Row256, F32Row512, F64Row256, F64Row512};

/// 256 bits.
#[derive(Clone, Copy, Debug)]
pub struct Avx2;
/// 512 bits.
#[derive(Clone, Copy, Debug)]
pub struct Avx512;

macro_rules! registers {
    ($set:ty, $scalar:ty, $lanes:ty, $row:ty) => {
        impl InstructionSet<$scalar> for $set {
            type Lanes = $lanes;
            type Row = $row;

            #[inline(always)]
            fn prefetch(place: *const u8) {
                unsafe { _mm_prefetch::<_MM_HINT_T0>(place.cast()) }
            }
        }
    };
}
registers!(Avx2, f32, F32x8, F32Row256);
registers!(Avx2, f64, F64x4, F64Row256);
registers!(Avx512, f32, F32x16, F32Row512);
registers!(Avx512, f64, F64x8, F64Row512);
