//! The number type of the kernels: one sample, or several side by side.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A number, or a row of numbers that are computed alike. The kernels are written once over this trait.
pub trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + AddAssign
{
    /// Samples side by side.
    const WIDTH: usize;

    /// The same value in every place.
    fn splat(value: f64) -> Self;

    /// The first `WIDTH` values of a slice.
    fn load(values: &[f64]) -> Self;

    /// Writes the first `WIDTH` values of a slice.
    fn store(self, values: &mut [f64]);

    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
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
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
}

/// A vector of three lanes.
pub(super) type Vec3<L> = [L; 3];

#[inline(always)]
pub(super) fn add<L: Lane>(a: Vec3<L>, b: Vec3<L>) -> Vec3<L> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn scale<L: Lane>(a: Vec3<L>, s: L) -> Vec3<L> {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline(always)]
pub(super) fn dot<L: Lane>(a: Vec3<L>, b: Vec3<L>) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross<L: Lane>(a: Vec3<L>, b: Vec3<L>) -> Vec3<L> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A 3x3 matrix of lanes, row by row.
pub(super) type Mat3<L> = [Vec3<L>; 3];

#[inline(always)]
pub(super) fn times<L: Lane>(m: &Mat3<L>, v: Vec3<L>) -> Vec3<L> {
    [dot(m[0], v), dot(m[1], v), dot(m[2], v)]
}

#[inline(always)]
pub(super) fn transpose_times<L: Lane>(m: &Mat3<L>, v: Vec3<L>) -> Vec3<L> {
    [
        m[0][0] * v[0] + m[1][0] * v[1] + m[2][0] * v[2],
        m[0][1] * v[0] + m[1][1] * v[1] + m[2][1] * v[2],
        m[0][2] * v[0] + m[1][2] * v[1] + m[2][2] * v[2],
    ]
}

#[inline(always)]
pub(super) fn splat3<L: Lane>(v: &[f64; 3]) -> Vec3<L> {
    [L::splat(v[0]), L::splat(v[1]), L::splat(v[2])]
}
