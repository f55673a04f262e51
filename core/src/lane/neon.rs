//! Lanes of NEON, which every 64-bit ARM processor has.

use super::number::Lane;
use super::sin_cos::sin_cos;
use std::arch::aarch64::*;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Two numbers in a NEON register.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neon(float64x2_t);

macro_rules! operator {
    ($($name:ident $method:ident $instruction:ident),+) => {
        $(impl $name for Neon {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: NEON is part of the architecture.
                unsafe { Neon($instruction(self.0, other.0)) }
            }
        })+
    };
}

operator!(Add add vaddq_f64, Sub sub vsubq_f64, Mul mul vmulq_f64, Div div vdivq_f64);

impl Neg for Neon {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: NEON is part of the architecture.
        unsafe { Neon(vnegq_f64(self.0)) }
    }
}

impl AddAssign for Neon {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Lane for Neon {
    const WIDTH: usize = 2;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: NEON is part of the architecture.
        unsafe { Neon(vdupq_n_f64(value)) }
    }

    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        let values = &values[..2];
        // SAFETY: NEON is part of the architecture, and the slice has as many values as are read.
        unsafe { Neon(vld1q_f64(values.as_ptr())) }
    }

    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        let values = &mut values[..2];
        // SAFETY: NEON is part of the architecture, and the slice has as many values as are written.
        unsafe { vst1q_f64(values.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // SAFETY: NEON is part of the architecture.
        unsafe { Neon(vfmaq_f64(addend.0, self.0, factor.0)) }
    }

    #[inline(always)]
    fn mul_sub_from(self, factor: Self, from: Self) -> Self {
        // SAFETY: NEON is part of the architecture.
        unsafe { Neon(vfmsq_f64(from.0, self.0, factor.0)) }
    }

    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: NEON is part of the architecture.
        unsafe { Neon(vrndnq_f64(self.0)) }
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
}
