//! Registers of one number of each of several particles.
#![expect(unsafe_code, reason = "vector instructions, see the module above")]

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::super::simd::{CHANNELS, Lanes};

/// Arithmetic of a register type.
macro_rules! arithmetic {
    ($name:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $zero:ident) => {
        impl Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                $name(unsafe { $add(self.0, other.0) })
            }
        }
        impl Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                $name(unsafe { $sub(self.0, other.0) })
            }
        }
        impl Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                $name(unsafe { $mul(self.0, other.0) })
            }
        }
        impl Div for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                $name(unsafe { $div(self.0, other.0) })
            }
        }
        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                $name(unsafe { $sub($zero(), self.0) })
            }
        }
    };
}

/// What the four register types have under the same names but for a prefix and a suffix.
macro_rules! common_lanes {
    ($scalar:ty, $set1:ident, $load:ident, $store:ident, $fma:ident, $fnma:ident, $sqrt:ident, $max:ident, $min:ident) => {
        #[inline(always)]
        fn splat(value: $scalar) -> Self {
            Self(unsafe { $set1(value) })
        }
        #[inline(always)]
        fn load(from: &[$scalar]) -> Self {
            assert!(from.len() >= Self::COUNT);
            Self(unsafe { $load(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [$scalar]) {
            assert!(to.len() >= Self::COUNT);
            unsafe { $store(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn mul_add(self, a: Self, b: Self) -> Self {
            Self(unsafe { $fma(self.0, a.0, b.0) })
        }
        #[inline(always)]
        fn neg_mul_add(self, a: Self, b: Self) -> Self {
            Self(unsafe { $fnma(self.0, a.0, b.0) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { $sqrt(self.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { $max(self.0, other.0) })
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { $min(self.0, other.0) })
        }
    };
}

/// Eight `f32` in 256 bits.
#[derive(Clone, Copy)]
pub struct F32x8(__m256);
arithmetic!(F32x8, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_div_ps, _mm256_setzero_ps);

impl Lanes<f32> for F32x8 {
    const COUNT: usize = 8;
    type Mask = __m256;
    common_lanes!(
        f32,
        _mm256_set1_ps,
        _mm256_loadu_ps,
        _mm256_storeu_ps,
        _mm256_fmadd_ps,
        _mm256_fnmadd_ps,
        _mm256_sqrt_ps,
        _mm256_max_ps,
        _mm256_min_ps
    );
    #[inline(always)]
    fn floor(self) -> Self {
        F32x8(unsafe { _mm256_floor_ps(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        F32x8(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> __m256 {
        unsafe { _mm256_cmp_ps::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __m256, yes: Self, no: Self) -> Self {
        F32x8(unsafe { _mm256_blendv_ps(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn bits(mask: __m256) -> u32 {
        unsafe { _mm256_movemask_ps(mask) as u32 }
    }
    #[inline(always)]
    fn store_integers(self, to: &mut [i32]) {
        assert!(to.len() >= Self::COUNT);
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_cvtps_epi32(self.0)) }
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        unsafe {
            let exponent = _mm256_add_epi32(_mm256_cvtps_epi32(self.0), _mm256_set1_epi32(127));
            F32x8(_mm256_castsi256_ps(_mm256_slli_epi32::<23>(exponent)))
        }
    }
    #[inline(always)]
    fn load_channels(from: &[f32], stride: usize) -> [Self; CHANNELS] {
        assert!(from.len() >= 7 * stride + CHANNELS);
        unsafe {
            let mut pairs = [_mm256_setzero_ps(); 4];
            for p in 0..4 {
                let first = from.as_ptr().add(p * stride);
                let (near, far) = (_mm_loadu_ps(first), _mm_loadu_ps(first.add(4 * stride)));
                pairs[p] = _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(near), far);
            }
            let [a, b, c, d] = transpose_4x4_ps(pairs);
            [F32x8(a), F32x8(b), F32x8(c), F32x8(d)]
        }
    }
    #[inline(always)]
    fn store_channels(channels: [Self; CHANNELS], to: &mut [f32], stride: usize) {
        assert!(to.len() >= 7 * stride + CHANNELS);
        unsafe {
            let pairs = transpose_4x4_ps([channels[0].0, channels[1].0, channels[2].0, channels[3].0]);
            for p in 0..4 {
                let first = to.as_mut_ptr().add(p * stride);
                _mm_storeu_ps(first, _mm256_castps256_ps128(pairs[p]));
                _mm_storeu_ps(first.add(4 * stride), _mm256_extractf128_ps::<1>(pairs[p]));
            }
        }
    }
}

/// Transposes the 4 by 4 matrix in each half of four registers.
#[inline(always)]
unsafe fn transpose_4x4_ps([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    unsafe {
        let (ab_low, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (cd_low, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
        [
            _mm256_shuffle_ps::<0x44>(ab_low, cd_low),
            _mm256_shuffle_ps::<0xEE>(ab_low, cd_low),
            _mm256_shuffle_ps::<0x44>(ab_high, cd_high),
            _mm256_shuffle_ps::<0xEE>(ab_high, cd_high),
        ]
    }
}

/// Sixteen `f32` in 512 bits.
#[derive(Clone, Copy)]
pub struct F32x16(__m512);
arithmetic!(F32x16, _mm512_add_ps, _mm512_sub_ps, _mm512_mul_ps, _mm512_div_ps, _mm512_setzero_ps);

impl Lanes<f32> for F32x16 {
    const COUNT: usize = 16;
    type Mask = __mmask16;
    common_lanes!(
        f32,
        _mm512_set1_ps,
        _mm512_loadu_ps,
        _mm512_storeu_ps,
        _mm512_fmadd_ps,
        _mm512_fnmadd_ps,
        _mm512_sqrt_ps,
        _mm512_max_ps,
        _mm512_min_ps
    );
    #[inline(always)]
    fn floor(self) -> Self {
        F32x16(unsafe { _mm512_roundscale_ps::<0x09>(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        F32x16(unsafe { _mm512_abs_ps(self.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask16, yes: Self, no: Self) -> Self {
        F32x16(unsafe { _mm512_mask_blend_ps(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn bits(mask: __mmask16) -> u32 {
        u32::from(mask)
    }
    #[inline(always)]
    fn store_integers(self, to: &mut [i32]) {
        assert!(to.len() >= Self::COUNT);
        unsafe { _mm512_storeu_si512(to.as_mut_ptr().cast(), _mm512_cvtps_epi32(self.0)) }
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        unsafe {
            let exponent = _mm512_add_epi32(_mm512_cvtps_epi32(self.0), _mm512_set1_epi32(127));
            F32x16(_mm512_castsi512_ps(_mm512_slli_epi32::<23>(exponent)))
        }
    }
    #[inline(always)]
    fn load_channels(from: &[f32], stride: usize) -> [Self; CHANNELS] {
        assert!(from.len() >= 15 * stride + CHANNELS);
        let low = F32x8::load_channels(from, stride);
        let high = F32x8::load_channels(&from[8 * stride..], stride);
        let mut joined = [F32x16::splat(0.0); CHANNELS];
        for c in 0..CHANNELS {
            joined[c].0 = unsafe { _mm512_insertf32x8::<1>(_mm512_castps256_ps512(low[c].0), high[c].0) };
        }
        joined
    }
    #[inline(always)]
    fn store_channels(channels: [Self; CHANNELS], to: &mut [f32], stride: usize) {
        assert!(to.len() >= 15 * stride + CHANNELS);
        let mut low = [F32x8::splat(0.0); CHANNELS];
        let mut high = [F32x8::splat(0.0); CHANNELS];
        for c in 0..CHANNELS {
            low[c].0 = unsafe { _mm512_castps512_ps256(channels[c].0) };
            high[c].0 = unsafe { _mm512_extractf32x8_ps::<1>(channels[c].0) };
        }
        F32x8::store_channels(low, to, stride);
        F32x8::store_channels(high, &mut to[8 * stride..], stride);
    }
}

/// Four `f64` in 256 bits.
#[derive(Clone, Copy)]
pub struct F64x4(__m256d);
arithmetic!(F64x4, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd, _mm256_setzero_pd);

impl Lanes<f64> for F64x4 {
    const COUNT: usize = 4;
    type Mask = __m256d;
    common_lanes!(
        f64,
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_fmadd_pd,
        _mm256_fnmadd_pd,
        _mm256_sqrt_pd,
        _mm256_max_pd,
        _mm256_min_pd
    );
    #[inline(always)]
    fn floor(self) -> Self {
        F64x4(unsafe { _mm256_floor_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        F64x4(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __m256d, yes: Self, no: Self) -> Self {
        F64x4(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn bits(mask: __m256d) -> u32 {
        unsafe { _mm256_movemask_pd(mask) as u32 }
    }
    #[inline(always)]
    fn store_integers(self, to: &mut [i32]) {
        assert!(to.len() >= Self::COUNT);
        unsafe { _mm_storeu_si128(to.as_mut_ptr().cast(), _mm256_cvtpd_epi32(self.0)) }
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        unsafe {
            let whole = _mm256_cvtepi32_epi64(_mm256_cvtpd_epi32(self.0));
            let exponent = _mm256_add_epi64(whole, _mm256_set1_epi64x(1023));
            F64x4(_mm256_castsi256_pd(_mm256_slli_epi64::<52>(exponent)))
        }
    }
    #[inline(always)]
    fn load_channels(from: &[f64], stride: usize) -> [Self; CHANNELS] {
        assert!(from.len() >= 3 * stride + CHANNELS);
        unsafe {
            let mut quads = [_mm256_setzero_pd(); 4];
            for p in 0..4 {
                quads[p] = _mm256_loadu_pd(from.as_ptr().add(p * stride));
            }
            let [a, b, c, d] = transpose_4x4_pd(quads);
            [F64x4(a), F64x4(b), F64x4(c), F64x4(d)]
        }
    }
    #[inline(always)]
    fn store_channels(channels: [Self; CHANNELS], to: &mut [f64], stride: usize) {
        assert!(to.len() >= 3 * stride + CHANNELS);
        unsafe {
            let quads = transpose_4x4_pd([channels[0].0, channels[1].0, channels[2].0, channels[3].0]);
            for p in 0..4 {
                _mm256_storeu_pd(to.as_mut_ptr().add(p * stride), quads[p]);
            }
        }
    }
}

/// Transposes the 4 by 4 matrix in four registers.
#[inline(always)]
unsafe fn transpose_4x4_pd([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    unsafe {
        let (ab_low, ab_high) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (cd_low, cd_high) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab_low, cd_low),
            _mm256_permute2f128_pd::<0x20>(ab_high, cd_high),
            _mm256_permute2f128_pd::<0x31>(ab_low, cd_low),
            _mm256_permute2f128_pd::<0x31>(ab_high, cd_high),
        ]
    }
}

/// Eight `f64` in 512 bits.
#[derive(Clone, Copy)]
pub struct F64x8(__m512d);
arithmetic!(F64x8, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd, _mm512_setzero_pd);

impl Lanes<f64> for F64x8 {
    const COUNT: usize = 8;
    type Mask = __mmask8;
    common_lanes!(
        f64,
        _mm512_set1_pd,
        _mm512_loadu_pd,
        _mm512_storeu_pd,
        _mm512_fmadd_pd,
        _mm512_fnmadd_pd,
        _mm512_sqrt_pd,
        _mm512_max_pd,
        _mm512_min_pd
    );
    #[inline(always)]
    fn floor(self) -> Self {
        F64x8(unsafe { _mm512_roundscale_pd::<0x09>(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        F64x8(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask8, yes: Self, no: Self) -> Self {
        F64x8(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn bits(mask: __mmask8) -> u32 {
        u32::from(mask)
    }
    #[inline(always)]
    fn store_integers(self, to: &mut [i32]) {
        assert!(to.len() >= Self::COUNT);
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm512_cvtpd_epi32(self.0)) }
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        unsafe {
            let whole = _mm512_cvtepi32_epi64(_mm512_cvtpd_epi32(self.0));
            let exponent = _mm512_add_epi64(whole, _mm512_set1_epi64(1023));
            F64x8(_mm512_castsi512_pd(_mm512_slli_epi64::<52>(exponent)))
        }
    }
    #[inline(always)]
    fn load_channels(from: &[f64], stride: usize) -> [Self; CHANNELS] {
        assert!(from.len() >= 7 * stride + CHANNELS);
        let low = F64x4::load_channels(from, stride);
        let high = F64x4::load_channels(&from[4 * stride..], stride);
        let mut joined = [F64x8::splat(0.0); CHANNELS];
        for c in 0..CHANNELS {
            joined[c].0 = unsafe { _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low[c].0), high[c].0) };
        }
        joined
    }
    #[inline(always)]
    fn store_channels(channels: [Self; CHANNELS], to: &mut [f64], stride: usize) {
        assert!(to.len() >= 7 * stride + CHANNELS);
        let mut low = [F64x4::splat(0.0); CHANNELS];
        let mut high = [F64x4::splat(0.0); CHANNELS];
        for c in 0..CHANNELS {
            low[c].0 = unsafe { _mm512_castpd512_pd256(channels[c].0) };
            high[c].0 = unsafe { _mm512_extractf64x4_pd::<1>(channels[c].0) };
        }
        F64x4::store_channels(low, to, stride);
        F64x4::store_channels(high, &mut to[4 * stride..], stride);
    }
}
