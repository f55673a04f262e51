//! Sine and cosine of a row of numbers, without branches.
//!
//! The angle is brought to half a turn around zero by a multiple of pi in three parts (Cody and Waite 1980), whose products
//! with whole numbers up to 2^25 are exact; there the Taylor series to x^22 leave less than the rounding. The sign
//! is that of an even or odd multiple, so neither a choice nor a swap is needed.

use super::Lane;
use std::f64::consts::FRAC_1_PI;

/// pi in parts of 28 bits each, the last one rounded.
const PI: [f64; 3] = [3.141_592_621_803_283_7, 3.178_650_942_459_171_3e-8, 1.224_646_786_410_718_8e-16];

/// Reciprocals of factorials, from that of 1, with alternating signs in pairs: x - x^3/6 and 1 - x^2/2.
const SINE: [f64; 11] = series(1);
const COSINE: [f64; 12] = series(0);

/// Coefficients (-1)^k / (2 k + first)!.
const fn series<const N: usize>(first: usize) -> [f64; N] {
    let mut coefficients = [1.0; N];
    let mut k = 1;
    while k < N {
        let top = 2 * k + first;
        coefficients[k] = -coefficients[k - 1] / (top * (top - 1)) as f64;
        k += 1;
    }
    coefficients
}

#[inline(always)]
fn polynomial<L: Lane, const N: usize>(coefficients: &[f64; N], x: L) -> L {
    let mut value = L::splat(coefficients[N - 1]);
    for &coefficient in coefficients[..N - 1].iter().rev() {
        value = value.mul_add(x, L::splat(coefficient));
    }
    value
}

#[inline(always)]
pub(super) fn sin_cos<L: Lane>(angle: L) -> (L, L) {
    let half_turns = (angle * L::splat(FRAC_1_PI)).round();
    let mut rest = angle;
    for part in PI {
        rest = half_turns.mul_sub_from(L::splat(part), rest);
    }
    // 1 for even, -1 for odd: 1 - 2 (n - 2 round(n / 2))^2, whatever way the half is rounded.
    let odd = (half_turns * L::splat(0.5)).round().mul_sub_from(L::splat(2.0), half_turns);
    let sign = (odd * odd).mul_sub_from(L::splat(2.0), L::splat(1.0));
    let square = rest * rest;
    (sign * rest * polynomial(&SINE, square), sign * polynomial(&COSINE, square))
}
