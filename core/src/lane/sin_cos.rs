//! Sine and cosine of a row of numbers, without branches.
//!
//! The angle is brought to half a turn around zero by a multiple of pi in three parts (Cody and Waite 1980), whose products
//! with whole numbers up to 2^25 are exact; there polynomials to x^17 and x^16 leave less than the rounding. The sign is that of
//! an even or odd multiple, so neither a choice nor a swap is needed.

use super::number::Lane;
use std::f64::consts::FRAC_1_PI;

/// pi in parts of 28 bits each, the last one rounded.
const PI: [f64; 3] = [3.141_592_621_803_283_7, 3.178_650_942_459_171_3e-8, 1.224_646_786_410_718_8e-16];

/// sin x = x p(x^2) within 4e-17; made by tests/reference/sin_cos.py.
const SINE: [f64; 9] = [
    1.0,
    -0.166_666_666_666_666_66,
    0.008_333_333_333_333_316,
    -0.000_198_412_698_412_549_74,
    2.755_731_921_916_323_4e-6,
    -2.505_210_761_699_618_2e-8,
    1.605_897_731_246_408_7e-10,
    -7.643_970_296_798_572e-13,
    2.731_444_766_986_399_5e-15,
];

/// cos x = p(x^2) within 7e-17; from there too.
const COSINE: [f64; 9] = [
    1.0,
    -0.5,
    0.041_666_666_666_666_66,
    -0.001_388_888_888_888_476_7,
    2.480_158_729_891_355e-5,
    -2.755_731_857_336_617_5e-7,
    2.087_668_155_886_739_5e-9,
    -1.146_625_225_971_847_9e-11,
    4.646_435_959_112_480_6e-14,
];

/// Even and odd powers side by side, as either has half as long to wait for itself.
#[inline(always)]
fn polynomial<L: Lane, const N: usize>(coefficients: &[f64; N], x: L, square: L) -> L {
    let mut sums = [L::splat(0.0); 2];
    for power in [N - 1, N - 2] {
        sums[power % 2] = L::splat(coefficients[power]);
    }
    for power in (0..N - 2).rev() {
        sums[power % 2] = sums[power % 2].mul_add(square, L::splat(coefficients[power]));
    }
    sums[1].mul_add(x, sums[0])
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
    let fourth = square * square;
    (sign * rest * polynomial(&SINE, square, fourth), sign * polynomial(&COSINE, square, fourth))
}
