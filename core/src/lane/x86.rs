//! Lanes of AVX2 with FMA and of AVX-512.
//!
//! Every operation is one instruction that the machine must have. The types stay inside `lane`, and only
//! [`Lanes::run`](super::Lanes) names them, in functions compiled for those instructions and called after the machine was
//! asked for them: this is what makes each `unsafe` below sound.

use super::number::Lane;
use super::sin_cos::sin_cos;
use std::arch::x86_64::*;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

const NEAREST: i32 = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;

macro_rules! lane {
    ($(#[$about:meta])* $name:ident, $register:ty, $width:literal, $round:ident, $splat:ident, $load:ident, $store:ident,
     $mul_add:ident, $mul_sub_from:ident, $($trait:ident $method:ident $instruction:ident),+) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy)]
        pub(super) struct $name($register);

        $(impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the machine has the instruction, see the module's words.
                unsafe { $name($instruction(self.0, other.0)) }
            }
        })+

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::splat(-0.0) - self
            }
        }

        impl AddAssign for $name {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl Lane for $name {
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                // SAFETY: the machine has the instruction, see the module's words.
                unsafe { $name($splat(value)) }
            }

            #[inline(always)]
            fn load(values: &[f64]) -> Self {
                let values = &values[..$width];
                // SAFETY: as above, and the slice has as many values as are read.
                unsafe { $name($load(values.as_ptr())) }
            }

            #[inline(always)]
            fn store(self, values: &mut [f64]) {
                let values = &mut values[..$width];
                // SAFETY: as above, and the slice has as many values as are written.
                unsafe { $store(values.as_mut_ptr(), self.0) }
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                // SAFETY: the machine has the instruction, see the module's words.
                unsafe { $name($mul_add(self.0, factor.0, addend.0)) }
            }

            #[inline(always)]
            fn mul_sub_from(self, factor: Self, from: Self) -> Self {
                // SAFETY: the machine has the instruction, see the module's words.
                unsafe { $name($mul_sub_from(self.0, factor.0, from.0)) }
            }

            #[inline(always)]
            fn round(self) -> Self {
                // SAFETY: the machine has the instruction, see the module's words.
                unsafe { $name($round::<NEAREST>(self.0)) }
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                sin_cos(self)
            }
        }
    };
}

lane!(
    /// Four numbers in an AVX2 register.
    Avx2, __m256d, 4, _mm256_round_pd, _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_fmadd_pd,
    _mm256_fnmadd_pd, Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd,
    Div div _mm256_div_pd
);

lane!(
    /// Eight numbers in an AVX-512 register.
    Avx512, __m512d, 8, _mm512_roundscale_pd, _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_fmadd_pd,
    _mm512_fnmadd_pd, Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd,
    Div div _mm512_div_pd
);
