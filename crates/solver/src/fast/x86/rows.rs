//! Registers of four channels of each of four nodes.
#![expect(unsafe_code, reason = "vector instructions, see the module above")]

use std::arch::x86_64::*;
use std::ops::{Add, Mul};

use super::super::simd::{CHANNELS, ROW_NODES, Row};

/// A row in `$parts` registers of `$width` numbers, `$width / 4` nodes each.
macro_rules! row {
    ($(#[$doc:meta])* $name:ident, $scalar:ty, $register:ty, $parts:literal, $width:literal,
     $set1:ident, $load:ident, $store:ident, $add:ident, $mul:ident, $div:ident, $fma:ident,
     $repeat:ident, $spread:ident, $above:ident, $sums:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $name([$register; $parts]);

        impl Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(mut self, other: Self) -> Self {
                for k in 0..$parts {
                    self.0[k] = unsafe { $add(self.0[k], other.0[k]) };
                }
                self
            }
        }
        impl Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(mut self, other: Self) -> Self {
                for k in 0..$parts {
                    self.0[k] = unsafe { $mul(self.0[k], other.0[k]) };
                }
                self
            }
        }
        impl Row<$scalar> for $name {
            #[inline(always)]
            fn zero() -> Self {
                Self::splat(0.0)
            }
            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                $name([unsafe { $set1(value) }; $parts])
            }
            #[inline(always)]
            fn repeat(from: &[$scalar]) -> Self {
                assert!(from.len() >= CHANNELS);
                $name([unsafe { $repeat(from.as_ptr()) }; $parts])
            }
            #[inline(always)]
            fn by_node(values: [$scalar; ROW_NODES]) -> Self {
                let mut places = [0.0; ROW_NODES * CHANNELS];
                for k in 0..ROW_NODES * CHANNELS {
                    places[k] = values[k / CHANNELS];
                }
                Self::load(&places)
            }
            #[inline(always)]
            fn load(from: &[$scalar]) -> Self {
                assert!(from.len() >= ROW_NODES * CHANNELS);
                let mut row = Self::zero();
                for k in 0..$parts {
                    row.0[k] = unsafe { $load(from.as_ptr().add(k * $width)) };
                }
                row
            }
            #[inline(always)]
            fn store(self, to: &mut [$scalar]) {
                assert!(to.len() >= ROW_NODES * CHANNELS);
                for k in 0..$parts {
                    unsafe { $store(to.as_mut_ptr().add(k * $width), self.0[k]) }
                }
            }
            #[inline(always)]
            unsafe fn load_at(from: &[$scalar], first: usize) -> Self {
                debug_assert!(from.len() >= first + ROW_NODES * CHANNELS);
                let mut row = Self::zero();
                for k in 0..$parts {
                    row.0[k] = unsafe { $load(from.as_ptr().add(first + k * $width)) };
                }
                row
            }
            #[inline(always)]
            unsafe fn store_at(self, to: &mut [$scalar], first: usize) {
                debug_assert!(to.len() >= first + ROW_NODES * CHANNELS);
                for k in 0..$parts {
                    unsafe { $store(to.as_mut_ptr().add(first + k * $width), self.0[k]) }
                }
            }
            #[inline(always)]
            fn mul_add(mut self, a: Self, b: Self) -> Self {
                for k in 0..$parts {
                    self.0[k] = unsafe { $fma(self.0[k], a.0[k], b.0[k]) };
                }
                self
            }
            #[inline(always)]
            fn over(mut self, other: Self) -> Self {
                for k in 0..$parts {
                    self.0[k] = unsafe { $div(self.0[k], other.0[k]) };
                }
                self
            }
            #[inline(always)]
            fn spread<const MASS: usize>(mut self) -> Self {
                for k in 0..$parts {
                    self.0[k] = unsafe { $spread::<MASS>(self.0[k]) };
                }
                self
            }
            #[inline(always)]
            fn where_above(mut self, gauge: Self, limit: Self) -> Self {
                for k in 0..$parts {
                    self.0[k] = unsafe { $above(self.0[k], gauge.0[k], limit.0[k]) };
                }
                self
            }
            #[inline(always)]
            fn sums_over_nodes(rows: [Self; 4], to: &mut [$scalar]) {
                assert!(to.len() >= 4 * CHANNELS);
                unsafe { $sums(rows, to.as_mut_ptr()) }
            }
        }
    };
}

row!(
    /// 16 `f32` in two registers.
    F32Row256, f32, __m256, 2, 8,
    _mm256_set1_ps, _mm256_loadu_ps, _mm256_storeu_ps, _mm256_add_ps, _mm256_mul_ps, _mm256_div_ps, _mm256_fmadd_ps,
    repeat_ps256, spread_ps256, keep_above_ps256, sums_ps256
);
row!(
    /// 16 `f32` in one register.
    F32Row512, f32, __m512, 1, 16,
    _mm512_set1_ps, _mm512_loadu_ps, _mm512_storeu_ps, _mm512_add_ps, _mm512_mul_ps, _mm512_div_ps, _mm512_fmadd_ps,
    repeat_ps512, spread_ps512, keep_above_ps512, sums_ps512
);
row!(
    /// 16 `f64` in four registers.
    F64Row256, f64, __m256d, 4, 4,
    _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_add_pd, _mm256_mul_pd, _mm256_div_pd, _mm256_fmadd_pd,
    _mm256_loadu_pd, spread_pd256, keep_above_pd256, sums_pd256
);
row!(
    /// 16 `f64` in two registers.
    F64Row512, f64, __m512d, 2, 8,
    _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_add_pd, _mm512_mul_pd, _mm512_div_pd, _mm512_fmadd_pd,
    repeat_pd512, spread_pd512, keep_above_pd512, sums_pd512
);

#[inline(always)]
unsafe fn repeat_ps256(from: *const f32) -> __m256 {
    unsafe { _mm256_broadcast_ps(&*from.cast()) }
}
#[inline(always)]
unsafe fn repeat_ps512(from: *const f32) -> __m512 {
    unsafe { _mm512_broadcast_f32x4(_mm_loadu_ps(from)) }
}
#[inline(always)]
unsafe fn repeat_pd512(from: *const f64) -> __m512d {
    unsafe { _mm512_broadcast_f64x4(_mm256_loadu_pd(from)) }
}

#[inline(always)]
unsafe fn spread_ps256<const MASS: usize>(row: __m256) -> __m256 {
    unsafe { if MASS == 2 { _mm256_permute_ps::<0xAA>(row) } else { _mm256_permute_ps::<0xFF>(row) } }
}
#[inline(always)]
unsafe fn spread_ps512<const MASS: usize>(row: __m512) -> __m512 {
    unsafe { if MASS == 2 { _mm512_permute_ps::<0xAA>(row) } else { _mm512_permute_ps::<0xFF>(row) } }
}
#[inline(always)]
unsafe fn spread_pd256<const MASS: usize>(row: __m256d) -> __m256d {
    unsafe { if MASS == 2 { _mm256_permute4x64_pd::<0xAA>(row) } else { _mm256_permute4x64_pd::<0xFF>(row) } }
}
#[inline(always)]
unsafe fn spread_pd512<const MASS: usize>(row: __m512d) -> __m512d {
    unsafe { if MASS == 2 { _mm512_permutex_pd::<0xAA>(row) } else { _mm512_permutex_pd::<0xFF>(row) } }
}

#[inline(always)]
unsafe fn keep_above_ps256(row: __m256, gauge: __m256, limit: __m256) -> __m256 {
    unsafe { _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(gauge, limit), row) }
}
#[inline(always)]
unsafe fn keep_above_ps512(row: __m512, gauge: __m512, limit: __m512) -> __m512 {
    unsafe { _mm512_maskz_mov_ps(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(gauge, limit), row) }
}
#[inline(always)]
unsafe fn keep_above_pd256(row: __m256d, gauge: __m256d, limit: __m256d) -> __m256d {
    unsafe { _mm256_and_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(gauge, limit), row) }
}
#[inline(always)]
unsafe fn keep_above_pd512(row: __m512d, gauge: __m512d, limit: __m512d) -> __m512d {
    unsafe { _mm512_maskz_mov_pd(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(gauge, limit), row) }
}

#[inline(always)]
unsafe fn sums_ps256(rows: [F32Row256; 4], to: *mut f32) {
    unsafe {
        for k in 0..4 {
            let [near, far] = rows[k].0;
            let pairs = _mm256_add_ps(near, far);
            let sum = _mm_add_ps(_mm256_castps256_ps128(pairs), _mm256_extractf128_ps::<1>(pairs));
            _mm_storeu_ps(to.add(k * CHANNELS), sum);
        }
    }
}
#[inline(always)]
unsafe fn sums_ps512([a, b, c, d]: [F32Row512; 4], to: *mut f32) {
    unsafe {
        let ([a], [b], [c], [d]) = (a.0, b.0, c.0, d.0);
        let ab = _mm512_add_ps(_mm512_shuffle_f32x4::<0x44>(a, b), _mm512_shuffle_f32x4::<0xEE>(a, b));
        let cd = _mm512_add_ps(_mm512_shuffle_f32x4::<0x44>(c, d), _mm512_shuffle_f32x4::<0xEE>(c, d));
        let (even, odd) = (_mm512_shuffle_f32x4::<0x88>(ab, cd), _mm512_shuffle_f32x4::<0xDD>(ab, cd));
        _mm512_storeu_ps(to, _mm512_add_ps(even, odd));
    }
}
#[inline(always)]
unsafe fn sums_pd256(rows: [F64Row256; 4], to: *mut f64) {
    unsafe {
        for k in 0..4 {
            let [n0, n1, n2, n3] = rows[k].0;
            let sum = _mm256_add_pd(_mm256_add_pd(n0, n2), _mm256_add_pd(n1, n3));
            _mm256_storeu_pd(to.add(k * CHANNELS), sum);
        }
    }
}
#[inline(always)]
unsafe fn sums_pd512(rows: [F64Row512; 4], to: *mut f64) {
    unsafe {
        for k in 0..4 {
            let [near, far] = rows[k].0;
            let pairs = _mm512_add_pd(near, far);
            let sum = _mm256_add_pd(_mm512_castpd512_pd256(pairs), _mm512_extractf64x4_pd::<1>(pairs));
            _mm256_storeu_pd(to.add(k * CHANNELS), sum);
        }
    }
}
