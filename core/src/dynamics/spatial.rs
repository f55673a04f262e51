//! Vectors and matrices of lanes.

use crate::lane::Lane;

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
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

#[inline(always)]
pub(super) fn cross<L: Lane>(a: Vec3<L>, b: Vec3<L>) -> Vec3<L> {
    [a[2].mul_sub_from(b[1], a[1] * b[2]), a[0].mul_sub_from(b[2], a[2] * b[0]), a[1].mul_sub_from(b[0], a[0] * b[1])]
}

/// a + b x c.
#[inline(always)]
pub(super) fn add_cross<L: Lane>(a: Vec3<L>, b: Vec3<L>, c: Vec3<L>) -> Vec3<L> {
    [
        b[2].mul_sub_from(c[1], b[1].mul_add(c[2], a[0])),
        b[0].mul_sub_from(c[2], b[2].mul_add(c[0], a[1])),
        b[1].mul_sub_from(c[0], b[0].mul_add(c[1], a[2])),
    ]
}

/// A 3x3 matrix of lanes, row by row.
pub(super) type Mat3<L> = [Vec3<L>; 3];

#[inline(always)]
pub(super) fn times<L: Lane>(m: &Mat3<L>, v: Vec3<L>) -> Vec3<L> {
    [dot(m[0], v), dot(m[1], v), dot(m[2], v)]
}

#[inline(always)]
pub(super) fn transpose_times<L: Lane>(m: &Mat3<L>, v: Vec3<L>) -> Vec3<L> {
    let column = |c: usize| [m[0][c], m[1][c], m[2][c]];
    [dot(column(0), v), dot(column(1), v), dot(column(2), v)]
}

#[inline(always)]
pub(super) fn splat3<L: Lane>(v: &[f64; 3]) -> Vec3<L> {
    [L::splat(v[0]), L::splat(v[1]), L::splat(v[2])]
}

#[inline(always)]
pub(super) fn transposed<L: Lane>(m: Mat3<L>) -> Mat3<L> {
    [[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]]
}
