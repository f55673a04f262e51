//! Two numbers side by side in plain Rust, for machines without lanes of their own: compilers turn them into SSE2 and the
//! like.

use super::number::Lane;
use super::sin_cos::sin_cos;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Two numbers side by side.
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub(super) struct Pair([f64; 2]);

macro_rules! operator {
    ($name:ident, $method:ident, $symbol:tt) => {
        impl $name for Pair {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Pair([self.0[0] $symbol other.0[0], self.0[1] $symbol other.0[1]])
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Neg for Pair {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Pair([-self.0[0], -self.0[1]])
    }
}

impl AddAssign for Pair {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// Adding and taking off this rounds to a whole number, for sizes below 2^51.
const WHOLE: f64 = 6_755_399_441_055_744.0;

impl Lane for Pair {
    const WIDTH: usize = 2;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Pair([value; 2])
    }

    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        Pair([values[0], values[1]])
    }

    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        values[..2].copy_from_slice(&self.0);
    }

    // SSE2 has no rounding of its own, and one by one it is a library call.
    #[inline(always)]
    fn round(self) -> Self {
        self + Self::splat(WHOLE) - Self::splat(WHOLE)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
}
