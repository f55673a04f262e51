//! Finite differences of second order for uniformly sampled signals.
//!
//! Reference: B. Fornberg, "Generation of finite difference formulas on arbitrarily spaced grids", Mathematics of
//! Computation 51 (1988) 699-706, tables 1 and 3.

use super::check_same_length;
use crate::error::{Error, Result};

const SUBJECT: &str = "finite difference";

/// Finite changes of a signal from one sample to the next.
pub(crate) fn changes(signal: &[f64]) -> impl Iterator<Item = f64> {
    signal.windows(2).map(|pair| pair[1] - pair[0]).filter(|change| change.is_finite())
}

/// First derivative of `input`, `[time]`, in its units per second: central differences, one-sided of the same (second)
/// order at both ends. Exact for quadratics; white noise of deviation s comes out as s / (sqrt(2) `sample_period_s`).
///
/// # Errors
/// When the lengths differ, there are fewer than 3 samples, or the sample period is not a positive number.
pub fn first_derivative(input: &[f64], sample_period_s: f64, output: &mut [f64]) -> Result<()> {
    check(input, sample_period_s, output, 3)?;
    let n = input.len();
    let scale = 0.5 / sample_period_s;
    let one_sided = |a: f64, b: f64, c: f64| scale * (-3.0 * a + 4.0 * b - c);
    for (out, w) in output[1..].iter_mut().zip(input.windows(3)) {
        *out = scale * (w[2] - w[0]);
    }
    output[0] = one_sided(input[0], input[1], input[2]);
    output[n - 1] = -one_sided(input[n - 1], input[n - 2], input[n - 3]);
    Ok(())
}

/// Second derivative of `input`, `[time]`, in its units per second squared: central differences, one-sided of the same
/// (second) order at both ends. Exact for cubics.
///
/// # Errors
/// When the lengths differ, there are fewer than 4 samples, or the sample period is not a positive number.
pub fn second_derivative(input: &[f64], sample_period_s: f64, output: &mut [f64]) -> Result<()> {
    check(input, sample_period_s, output, 4)?;
    let n = input.len();
    let scale = 1.0 / (sample_period_s * sample_period_s);
    let one_sided = |a: f64, b: f64, c: f64, d: f64| scale * (2.0 * a - 5.0 * b + 4.0 * c - d);
    for (out, w) in output[1..].iter_mut().zip(input.windows(3)) {
        *out = scale * (w[2] - 2.0 * w[1] + w[0]);
    }
    output[0] = one_sided(input[0], input[1], input[2], input[3]);
    output[n - 1] = one_sided(input[n - 1], input[n - 2], input[n - 3], input[n - 4]);
    Ok(())
}

/// Weights of central differences of eighth order, of the samples 1, 2, 3 and 4 to either side (Fornberg, Mathematics of Computation
/// 51, 1988); the second derivative has one of the sample itself too.
const FIRST: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
const SECOND: [f64; 4] = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];
const SECOND_OF_ITSELF: f64 = -205.0 / 72.0;

/// First and second derivative of `input`, `[time]`, which holds nothing near half the sample rate: central differences of eighth
/// order, exact for polynomials of eighth degree, and of second order in the four samples at either end. They amplify noise near half the
/// sample rate more than [`first_derivative`] and [`second_derivative`], of which the latter takes 3 % off what swings at a tenth of
/// the sample rate.
///
/// # Errors
/// When the lengths differ, there are fewer than 4 samples, or the sample period is not a positive number.
pub(crate) fn smooth_derivatives(
    input: &[f64],
    sample_period_s: f64,
    first: &mut [f64],
    second: &mut [f64],
) -> Result<()> {
    first_derivative(input, sample_period_s, first)?;
    second_derivative(input, sample_period_s, second)?;
    let scale = 1.0 / sample_period_s;
    let inside = first.iter_mut().zip(second).skip(FIRST.len());
    for ((first, second), window) in inside.zip(input.windows(2 * FIRST.len() + 1)) {
        let middle = window[FIRST.len()];
        let (mut slope, mut bend) = (0.0, SECOND_OF_ITSELF * middle);
        for k in 0..FIRST.len() {
            let (before, after) = (window[FIRST.len() - 1 - k], window[FIRST.len() + 1 + k]);
            slope += FIRST[k] * (after - before);
            bend += SECOND[k] * (after + before);
        }
        *first = scale * slope;
        *second = scale * scale * bend;
    }
    Ok(())
}

fn check(input: &[f64], sample_period_s: f64, output: &[f64], fewest: usize) -> Result<()> {
    check_same_length(SUBJECT, input, output)?;
    if input.len() < fewest {
        return Err(Error::request(SUBJECT, format!("the signal has {} samples; give at least {fewest}", input.len())));
    }
    if !(sample_period_s.is_finite() && sample_period_s > 0.0) {
        return Err(Error::request(
            SUBJECT,
            format!("the sample period is {sample_period_s} s; give the seconds between two samples"),
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn hand_computed_differences() {
        let mut output = [0.0; 4];
        first_derivative(&[1.0, 2.0, 4.0, 8.0], 0.5, &mut output).unwrap();
        assert_eq!(output, [1.0, 3.0, 6.0, 10.0]);
        second_derivative(&[1.0, 2.0, 4.0, 8.0], 0.5, &mut output).unwrap();
        assert_eq!(output, [0.0, 4.0, 8.0, 12.0]);
    }

    #[test]
    fn halving_the_period_quarters_the_error_at_the_ends_too() {
        let errors = |n: usize| {
            let period = 1.0 / (n - 1) as f64;
            let times: Vec<f64> = (0..n).map(|t| t as f64 * period).collect();
            let input: Vec<f64> = times.iter().map(|t| (3.0 * t).sin()).collect();
            let (mut first, mut second) = (vec![0.0; n], vec![0.0; n]);
            first_derivative(&input, period, &mut first).unwrap();
            second_derivative(&input, period, &mut second).unwrap();
            let middle = n / 2;
            [0, middle, n - 1].map(|t| {
                let (sin, cos) = (3.0 * times[t]).sin_cos();
                ((first[t] - 3.0 * cos).abs(), (second[t] + 9.0 * sin).abs())
            })
        };
        for (coarse, fine) in errors(201).into_iter().zip(errors(401)) {
            assert!((3.6..4.4).contains(&(coarse.0 / fine.0)), "first: {coarse:?} {fine:?}");
            // The second derivative's error at the start vanishes to this order with the fourth derivative of the sine.
            assert!(coarse.1 / fine.1 > 3.6, "second: {coarse:?} {fine:?}");
        }
    }

    #[test]
    fn wrong_arguments_are_refused() {
        let message = first_derivative(&[1.0, 2.0], 1.0, &mut [0.0; 2]).unwrap_err().to_string();
        assert!(message.contains("at least 3"), "{message}");
        let message = second_derivative(&[1.0; 3], 1.0, &mut [0.0; 3]).unwrap_err().to_string();
        assert!(message.contains("at least 4"), "{message}");
        for period in [0.0, -1.0, f64::NAN] {
            let message = first_derivative(&[1.0; 5], period, &mut [0.0; 5]).unwrap_err().to_string();
            assert!(message.contains("sample period"), "{message}");
        }
        let message = second_derivative(&[1.0; 5], 1.0, &mut [0.0; 4]).unwrap_err().to_string();
        assert!(message.contains("output holds 4"), "{message}");
    }

    #[test]
    fn smooth_derivatives_follow_what_swings_fast() {
        // A fifth of the sample rate, where three samples see an eighth less acceleration; 201 samples, of which four at either end.
        let pulse = std::f64::consts::TAU * 0.2;
        let input: Vec<f64> = (0..201).map(|k| (pulse * f64::from(k)).sin()).collect();
        let (mut first, mut second) = (vec![0.0; 201], vec![0.0; 201]);
        smooth_derivatives(&input, 1.0, &mut first, &mut second).unwrap();
        for k in 4..197 {
            let (sin, cos) = (pulse * k as f64).sin_cos();
            assert!((first[k] - pulse * cos).abs() < 0.01 * pulse, "{} {}", first[k], pulse * cos);
            assert!(
                (second[k] + pulse * pulse * sin).abs() < 0.003 * pulse * pulse,
                "{} {}",
                second[k],
                pulse * pulse * sin
            );
        }
        let mut plain = vec![0.0; 201];
        second_derivative(&input, 1.0, &mut plain).unwrap();
        assert!(plain[51].abs() < 0.88 * second[51].abs());
        assert_eq!((second[3], second[197]), (plain[3], plain[197]));
    }

    proptest! {
        #[test]
        fn smooth_derivatives_of_polynomials_are_exact(c in prop::array::uniform9(-1.0..1.0_f64)) {
            let period = 0.1;
            let polynomial = |t: f64, derivative: i32| -> f64 {
                let term = |(k, c): (usize, &f64)| {
                    let factor: f64 = (0..derivative).map(|d| f64::from(k as i32 - d)).product();
                    if k as i32 >= derivative { c * factor * t.powi(k as i32 - derivative) } else { 0.0 }
                };
                c.iter().enumerate().map(term).sum()
            };
            let times: Vec<f64> = (0..21).map(|k| (f64::from(k) - 10.0) * period).collect();
            let input: Vec<f64> = times.iter().map(|&t| polynomial(t, 0)).collect();
            let (mut first, mut second) = (vec![0.0; 21], vec![0.0; 21]);
            smooth_derivatives(&input, period, &mut first, &mut second).unwrap();
            for k in 4..17 {
                prop_assert!((first[k] - polynomial(times[k], 1)).abs() < 1e-10);
                prop_assert!((second[k] - polynomial(times[k], 2)).abs() < 1e-9);
            }
        }

        #[test]
        fn quadratics_and_cubics_are_exact(c in prop::array::uniform4(-1.0..1.0_f64), n in 4_usize..30) {
            let period = 0.25;
            let times: Vec<f64> = (0..n).map(|t| t as f64 * period).collect();
            let mut output = vec![0.0; n];
            let quadratic: Vec<f64> = times.iter().map(|t| c[0] + t * (c[1] + t * c[2])).collect();
            first_derivative(&quadratic, period, &mut output).unwrap();
            for (y, t) in output.iter().zip(&times) {
                prop_assert!((y - (c[1] + 2.0 * c[2] * t)).abs() < 1e-11);
            }
            let cubic: Vec<f64> = times.iter().map(|t| c[0] + t * (c[1] + t * (c[2] + t * c[3]))).collect();
            second_derivative(&cubic, period, &mut output).unwrap();
            for (y, t) in output.iter().zip(&times) {
                prop_assert!((y - (2.0 * c[2] + 6.0 * c[3] * t)).abs() < 1e-9);
            }
        }
    }
}
