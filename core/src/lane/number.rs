//! The trait over which the kernels are written.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Samples in the widest lanes there are.
pub(crate) const WIDEST: usize = 8;

/// A number, or a row of numbers that are computed alike. The kernels are written once over this trait.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dynamics::Lane;
///
/// // Torque of gravity on a pendulum, written once for one sample and for several side by side.
/// fn torque<L: Lane>(q: L) -> L {
///     let (sine, _) = q.sin_cos();
///     L::splat(9.81) * sine
/// }
/// assert!((torque(std::f64::consts::FRAC_PI_2) - 9.81).abs() < 1e-12);
/// assert_eq!(<f64 as Lane>::WIDTH, 1);
/// ```
pub trait Lane:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// Samples side by side.
    const WIDTH: usize;

    /// The same value in every place.
    fn splat(value: f64) -> Self;

    /// The first `WIDTH` values of a slice.
    fn load(values: &[f64]) -> Self;

    /// Writes the first `WIDTH` values of a slice.
    fn store(self, values: &mut [f64]);

    /// self * factor + addend, rounded once where the machine can.
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // f64::mul_add would be a library call on machines without the instruction.
        self * factor + addend
    }

    /// from - self * factor, rounded once where the machine can.
    #[inline(always)]
    fn mul_sub_from(self, factor: Self, from: Self) -> Self {
        from - self * factor
    }

    /// The nearest whole numbers.
    fn round(self) -> Self;

    /// Sine and cosine, to 1e-15 for angles up to 1e6 rad.
    fn sin_cos(self) -> (Self, Self);

    /// The sum of the numbers, in their order.
    #[inline(always)]
    fn sum(self) -> f64 {
        let mut parts = [0.0; WIDEST];
        self.store(&mut parts);
        parts.iter().sum()
    }

    /// Up to `WIDTH` values of a slice, the places behind its end zero.
    #[inline(always)]
    fn load_part(values: &[f64]) -> Self {
        if values.len() >= Self::WIDTH {
            return Self::load(values);
        }
        let mut padded = [0.0; WIDEST];
        padded[..values.len()].copy_from_slice(values);
        Self::load(&padded)
    }

    /// Writes as many values as the slice takes, up to `WIDTH`.
    #[inline(always)]
    fn store_part(self, values: &mut [f64]) {
        if values.len() >= Self::WIDTH {
            return self.store(values);
        }
        let mut padded = [0.0; WIDEST];
        self.store(&mut padded);
        values.copy_from_slice(&padded[..values.len()]);
    }
}

impl Lane for f64 {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        values[0]
    }

    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        values[0] = self;
    }

    #[inline(always)]
    fn round(self) -> Self {
        f64::round_ties_even(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
}
