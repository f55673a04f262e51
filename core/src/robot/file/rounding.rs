//! Angles that a file prints with few digits: 1.5708 stands for a quarter turn.

use std::f64::consts::{FRAC_PI_2, PI};

/// Printed decimals, and the step of the angles that so few may stand for: of the angles that mean something else, one in a
/// hundred lies as near with two decimals, one in 500 with three, one in 1700 with four.
const STEPS: [(i32, f64); 3] = [(2, PI / 2.0), (3, PI / 4.0), (4, PI / 12.0)];

/// Fewest decimals of an angle that may have been cut off in place of rounded.
const FEWEST_CUT_OFF: i32 = 3;

/// From so many decimals on an angle is taken as printed: what it lacks is below 1e-10 rad.
const ENOUGH: i32 = 10;

/// Widest angle that is asked; beyond two turns it may have another unit.
const WIDEST: f64 = 4.0 * PI;

/// Zeros at the end of a number from which they are not digits of it.
const FILLED: usize = 2;

/// Share of half a printed digit that the parsed number may err beyond it.
const PARSING: f64 = 1e-6;

/// Fewest printed decimals of an angle that may be rounded.
pub(super) const FEWEST: i32 = STEPS[0].0;

/// The multiple of pi/12 that a printed number of at least `fewest` decimals stands for, if it is rounded (or cut off) from
/// one.
pub(super) fn meant(word: &str, fewest: i32) -> Option<f64> {
    let value: f64 = word.parse().ok()?;
    let decimals = decimals(word)?;
    if !(fewest..ENOUGH).contains(&decimals) || value.abs() > WIDEST {
        return None;
    }
    let (_, step) = STEPS.into_iter().rev().find(|(fewest, _)| decimals >= *fewest)?;
    let multiple = (value / step).round();
    // The bits of a quarter turn written out; PI / 12 has been rounded once more.
    let quarters = multiple * step / FRAC_PI_2;
    let exact = if quarters.round() == quarters { quarters * FRAC_PI_2 } else { multiple * step };
    if exact == 0.0 {
        return None;
    }
    let digit = 10f64.powi(-decimals);
    let rounded = (value - exact).abs() <= 0.5 * digit * (1.0 + PARSING);
    let cut_off = decimals >= FEWEST_CUT_OFF && value.abs() < exact.abs() && exact.abs() - value.abs() < digit;
    (rounded || cut_off).then_some(exact)
}

/// Decimals of a printed number, its exponent counted. Two or more zeros at the end are those of a program that prints so many
/// digits of every number (1.570800); one number in a hundred has them by itself.
fn decimals(word: &str) -> Option<i32> {
    let (mantissa, exponent) = match word.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (word, 0),
    };
    let digits = mantissa.split_once('.').map_or("", |(_, digits)| digits);
    let written = digits.trim_end_matches('0').len();
    let digits = if digits.len() - written < FILLED { digits.len() } else { written };
    i32::try_from(digits).ok()?.checked_sub(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_and_cut_off_multiples_are_meant() {
        for (word, expected) in [
            ("1.5708", FRAC_PI_2),
            ("-1.5707", -FRAC_PI_2),
            ("1.571", FRAC_PI_2),
            ("1.57", FRAC_PI_2),
            ("3.14", PI),
            ("3.1416", PI),
            ("3.141", PI),
            ("+3.1415926", PI),
            ("1.5708E+00", FRAC_PI_2),
            ("0.15708e1", FRAC_PI_2),
            ("-0.785", -PI / 4.0),
            ("1.0472", PI / 3.0),
            ("6.2832", 2.0 * PI),
            ("1.570800", FRAC_PI_2),
            ("-3.14159000", -PI),
            ("1.5700", FRAC_PI_2),
        ] {
            let angle = meant(word, FEWEST).unwrap_or_else(|| panic!("{word}"));
            assert!((angle - expected).abs() < 4e-16 * expected.abs(), "{word} {angle}");
        }
        assert_eq!(meant("1.5708", FEWEST), Some(FRAC_PI_2), "the same bits as the number written out");
        assert_eq!(meant("-3.1416", FEWEST), Some(-PI));
    }

    #[test]
    fn other_numbers_stay() {
        let other = [
            "0", "0.0", "1.6", "1.5", "2", "0.6109", "1.5710", "1.5705", "0.79", "1.04", "0.26", "1e-16", "1.047",
            "-2.094", "1.6000", "2.000000", "1.047000",
        ];
        let exact = ["1.5707963267948966", "3.14159265358979", "1.57079632679", "2.6179938779914944"];
        let broken = ["", "x", "nan", "1e999999999999", ".", "1.2.3", "1e-2147483648", "0.5e"];
        for word in other.iter().chain(&exact).chain(&broken) {
            assert_eq!(meant(word, FEWEST), None, "{word}");
        }
    }
}
