//! Four numbers side by side: as an array for any CPU, as a register for CPUs with AVX2.

use crate::kernel::MAX_SUPPORT;
use crate::real::Real;

/// Four numbers on which the operations act place by place.
pub trait Lanes<T>: Copy {
    /// The same number four times.
    fn splat(value: T) -> Self;
    /// From four numbers in registers.
    fn of(values: [T; MAX_SUPPORT]) -> Self;
    /// From memory.
    fn load(from: &[T; MAX_SUPPORT]) -> Self;
    /// To memory.
    fn store(self, to: &mut [T; MAX_SUPPORT]);
    /// Sum.
    fn plus(self, other: Self) -> Self;
    /// Product.
    fn times(self, other: Self) -> Self;
    /// (x0 + x2) + (x1 + x3).
    fn sum(self) -> T;

    /// self + a b, rounded twice.
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self.plus(a.times(b))
    }
}

/// Four numbers in an array.
#[derive(Clone, Copy, Debug)]
pub struct Array<T>([T; MAX_SUPPORT]);

impl<T: Real> Lanes<T> for Array<T> {
    #[inline(always)]
    fn splat(value: T) -> Self {
        Array([value; MAX_SUPPORT])
    }
    #[inline(always)]
    fn of(values: [T; MAX_SUPPORT]) -> Self {
        Array(values)
    }
    #[inline(always)]
    fn load(from: &[T; MAX_SUPPORT]) -> Self {
        Array(*from)
    }
    #[inline(always)]
    fn store(self, to: &mut [T; MAX_SUPPORT]) {
        *to = self.0;
    }
    #[inline(always)]
    fn plus(self, Array([a, b, c, d]): Self) -> Self {
        Array([self.0[0] + a, self.0[1] + b, self.0[2] + c, self.0[3] + d])
    }
    #[inline(always)]
    fn times(self, Array([a, b, c, d]): Self) -> Self {
        Array([self.0[0] * a, self.0[1] * b, self.0[2] * c, self.0[3] * d])
    }
    #[inline(always)]
    fn sum(self) -> T {
        (self.0[0] + self.0[2]) + (self.0[1] + self.0[3])
    }
}

/// A scalar with four lanes of its own in a register of AVX2, where there is such a thing.
pub trait HasWide: Sized {
    /// Those lanes. To be used in functions compiled for AVX2 alone.
    type Wide: Lanes<Self>;
}

#[cfg(not(target_arch = "x86_64"))]
impl<T: Real> HasWide for T {
    type Wide = Array<T>;
}

#[cfg(target_arch = "x86_64")]
#[expect(
    unsafe_code,
    reason = "vector instructions; the types are used only in functions compiled for AVX2, which run only where AVX2 was found"
)]
mod x86 {
    use std::arch::x86_64::{
        __m128, __m256d, _mm_add_pd, _mm_add_ps, _mm_add_sd, _mm_add_ss, _mm_cvtsd_f64, _mm_cvtss_f32,
        _mm_loadu_ps, _mm_movehl_ps, _mm_mul_ps, _mm_set1_ps, _mm_setr_ps, _mm_shuffle_ps, _mm_storeu_ps,
        _mm_unpackhi_pd, _mm256_add_pd, _mm256_castpd256_pd128, _mm256_extractf128_pd, _mm256_loadu_pd,
        _mm256_mul_pd, _mm256_set1_pd, _mm256_setr_pd, _mm256_storeu_pd,
    };

    use super::{HasWide, Lanes, MAX_SUPPORT};

    /// Four `f64`.
    #[derive(Clone, Copy)]
    pub struct Double(__m256d);

    impl HasWide for f64 {
        type Wide = Double;
    }

    // SAFETY of all below: AVX is part of AVX2; loads and stores go through references to four numbers and need no alignment.
    impl Lanes<f64> for Double {
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Double(unsafe { _mm256_set1_pd(value) })
        }
        #[inline(always)]
        fn of([a, b, c, d]: [f64; MAX_SUPPORT]) -> Self {
            Double(unsafe { _mm256_setr_pd(a, b, c, d) })
        }
        #[inline(always)]
        fn load(from: &[f64; MAX_SUPPORT]) -> Self {
            Double(unsafe { _mm256_loadu_pd(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f64; MAX_SUPPORT]) {
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn plus(self, other: Self) -> Self {
            Double(unsafe { _mm256_add_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn times(self, other: Self) -> Self {
            Double(unsafe { _mm256_mul_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn sum(self) -> f64 {
            unsafe {
                let pairs = _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
                _mm_cvtsd_f64(_mm_add_sd(pairs, _mm_unpackhi_pd(pairs, pairs)))
            }
        }
    }

    /// Four `f32`.
    #[derive(Clone, Copy)]
    pub struct Single(__m128);

    impl HasWide for f32 {
        type Wide = Single;
    }

    impl Lanes<f32> for Single {
        #[inline(always)]
        fn splat(value: f32) -> Self {
            Single(unsafe { _mm_set1_ps(value) })
        }
        #[inline(always)]
        fn of([a, b, c, d]: [f32; MAX_SUPPORT]) -> Self {
            Single(unsafe { _mm_setr_ps(a, b, c, d) })
        }
        #[inline(always)]
        fn load(from: &[f32; MAX_SUPPORT]) -> Self {
            Single(unsafe { _mm_loadu_ps(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f32; MAX_SUPPORT]) {
            unsafe { _mm_storeu_ps(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn plus(self, other: Self) -> Self {
            Single(unsafe { _mm_add_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn times(self, other: Self) -> Self {
            Single(unsafe { _mm_mul_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn sum(self) -> f32 {
            unsafe {
                let pairs = _mm_add_ps(self.0, _mm_movehl_ps(self.0, self.0));
                _mm_cvtss_f32(_mm_add_ss(pairs, _mm_shuffle_ps::<1>(pairs, pairs)))
            }
        }
    }
}
