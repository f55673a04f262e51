//! Exact on polynomials, whatever the edge; the weights of the literature; the same outputs in any order of work.

use super::*;
use proptest::prelude::*;

fn filtered(filter: &SavitzkyGolay, input: &[f64]) -> Vec<f64> {
    let mut output = vec![0.0; input.len()];
    filter.apply(input, &mut output).unwrap();
    output
}

fn assert_close(got: &[f64], want: &[f64], tolerance: f64) {
    assert_eq!(got.len(), want.len());
    for (i, (g, w)) in got.iter().zip(want).enumerate() {
        assert!((g - w).abs() <= tolerance, "at {i}: {g} instead of {w}");
    }
}

#[test]
fn five_point_quadratic_weights_are_those_of_the_1964_tables() {
    let smooth = SavitzkyGolay::new(5, 2, 0, 1.0, Edge::Nearest).unwrap();
    assert_close(&smooth.coefficients(), &[-3.0, 12.0, 17.0, 12.0, -3.0].map(|w| w / 35.0), 1e-15);
    let slope = SavitzkyGolay::new(5, 2, 1, 0.5, Edge::Nearest).unwrap();
    assert_close(&slope.coefficients(), &[-2.0, -1.0, 0.0, 1.0, 2.0].map(|w| w / 5.0), 1e-15);
    let curvature = SavitzkyGolay::new(5, 2, 2, 0.5, Edge::Nearest).unwrap();
    assert_close(&curvature.coefficients(), &[2.0, -1.0, -2.0, -1.0, 2.0].map(|w| w * 4.0 / 7.0), 1e-14);
}

#[test]
fn an_order_one_below_the_window_interpolates() {
    let filter = SavitzkyGolay::new(9, 8, 0, 0.01, Edge::Polynomial).unwrap();
    let input: Vec<f64> = (0..40).map(|t| ((t * 7) % 11) as f64).collect();
    assert_close(&filtered(&filter, &input), &input, 1e-11);
}

#[test]
fn a_window_of_one_sample_changes_nothing() {
    for edge in [Edge::Polynomial, Edge::Nearest, Edge::Mirror, Edge::Constant(7.0)] {
        let filter = SavitzkyGolay::new(1, 0, 0, 0.01, edge).unwrap();
        assert_eq!(filtered(&filter, &[3.0, 1.0, 4.0]), [3.0, 1.0, 4.0]);
    }
}

#[test]
fn each_edge_continues_the_signal_as_named() {
    // A moving mean of five samples over 1 2 4 8 16 32.
    let input = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
    for (edge, first, last) in
        [(Edge::Nearest, 9.0, 120.0), (Edge::Mirror, 13.0, 80.0), (Edge::Constant(10.0), 27.0, 76.0)]
    {
        let filter = SavitzkyGolay::new(5, 0, 0, 1.0, edge).unwrap();
        let output = filtered(&filter, &input);
        assert!((output[0] - first / 5.0).abs() < 1e-14, "{edge:?}: {output:?}");
        assert!((output[5] - last / 5.0).abs() < 1e-14, "{edge:?}: {output:?}");
        assert!((output[2] - 31.0 / 5.0).abs() < 1e-14, "{edge:?}: {output:?}");
    }
}

#[test]
fn a_signal_shorter_than_the_window_is_reflected_to_and_fro() {
    // Mirrored about its ends, 0 1 2 reads ... 2 1 0 1 2 1 0 1 2 ...
    let filter = SavitzkyGolay::new(9, 0, 0, 1.0, Edge::Mirror).unwrap();
    assert_close(&filtered(&filter, &[0.0, 1.0, 2.0]), &[8.0 / 9.0, 9.0 / 9.0, 10.0 / 9.0], 1e-15);
    assert_close(&filtered(&filter, &[5.0]), &[5.0], 1e-14);
}

#[test]
fn the_response_is_what_a_sinusoid_takes_on() {
    let (rate, hz) = (500.0, 17.0);
    for derivative in 0..=3 {
        let filter = SavitzkyGolay::new(21, 4, derivative, 1.0 / rate, Edge::Nearest).unwrap();
        let (re, im) = filter.frequency_response(hz);
        let omega = TAU * hz;
        let input: Vec<f64> = (0..200).map(|t| (omega * t as f64 / rate).cos()).collect();
        let output = filtered(&filter, &input);
        for (t, y) in output.iter().enumerate().take(190).skip(10) {
            let (sin, cos) = (omega * t as f64 / rate).sin_cos();
            let want = re * cos - im * sin;
            assert!((y - want).abs() < 1e-11 * omega.powi(derivative as i32), "derivative {derivative}");
        }
    }
}

#[test]
fn the_response_begins_like_the_ideal_one() {
    let (re, im) = SavitzkyGolay::new(31, 4, 0, 1e-3, Edge::Nearest).unwrap().frequency_response(0.0);
    assert!((re - 1.0).abs() < 1e-14 && im == 0.0);
    let (re, im) = SavitzkyGolay::new(31, 4, 1, 1e-3, Edge::Nearest).unwrap().frequency_response(2.0);
    assert!(re == 0.0 && (im / (TAU * 2.0) - 1.0).abs() < 1e-4);
    let (re, im) = SavitzkyGolay::new(31, 4, 2, 1e-3, Edge::Nearest).unwrap().frequency_response(2.0);
    assert!(im == 0.0 && (re / -(TAU * 2.0).powi(2) - 1.0).abs() < 1e-3);
}

#[test]
fn wrong_arguments_are_refused() {
    for (window, order, derivative, period, word) in [
        (10, 2, 0, 1.0, "odd"),
        (0, 0, 0, 1.0, "odd"),
        (5, 5, 0, 1.0, "order 5"),
        (31, 13, 0, 1.0, "order 13"),
        (5, 2, 3, 1.0, "derivative 3"),
        (5, 2, 1, 0.0, "sample period"),
        (5, 2, 1, -0.1, "sample period"),
        (5, 2, 0, f64::NAN, "sample period"),
        (5, 2, 2, 1e-200, "sample period"),
    ] {
        let message = SavitzkyGolay::new(window, order, derivative, period, Edge::Mirror).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
    assert!(
        SavitzkyGolay::check_window(99_999, 99_999).is_ok() && SavitzkyGolay::check_window(99_999, 99_998).is_err()
    );
}

#[test]
fn wrong_signals_are_refused() {
    let filter = SavitzkyGolay::new(7, 2, 0, 1.0, Edge::Polynomial).unwrap();
    let message = filter.apply(&[0.0; 6], &mut [0.0; 6]).unwrap_err().to_string();
    assert!(message.contains("6 samples") && message.contains("window of 7"), "{message}");
    let message = filter.apply(&[0.0; 9], &mut [0.0; 8]).unwrap_err().to_string();
    assert!(message.contains("output holds 8"), "{message}");
    let filter = SavitzkyGolay::new(7, 2, 0, 1.0, Edge::Nearest).unwrap();
    assert!(filter.apply(&[], &mut []).unwrap_err().to_string().contains("empty"));
}

proptest! {
    /// With polynomial edges, every derivative of a polynomial up to the order comes out right, ends included.
    #[test]
    fn polynomials_up_to_the_order_are_exact(
        half in 3_usize..40, derivative in 0_usize..=3, coefficients in prop::collection::vec(-1.0..1.0_f64, 4..=6),
        extra in 0_usize..40,
    ) {
        let order = coefficients.len() - 1;
        let n = 2 * half + 1 + extra;
        // Time runs from -1 to 1, so that all powers are of like size.
        let period = 2.0 / (n - 1) as f64;
        let times: Vec<f64> = (0..n).map(|t| t as f64 * period - 1.0).collect();
        let value = |c: &[f64], t: f64| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
        let mut wanted = coefficients.clone();
        for _ in 0..derivative {
            wanted = wanted.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect();
        }
        let input: Vec<f64> = times.iter().map(|&t| value(&coefficients, t)).collect();
        let filter = SavitzkyGolay::new(2 * half + 1, order, derivative, period, Edge::Polynomial).unwrap();
        // Rounding of the input, amplified by differencing over the window.
        let tolerance = 1e-11 * (half as f64 * period).powi(-(derivative as i32)).max(1.0);
        let worst = filtered(&filter, &input)
            .iter()
            .zip(&times)
            .map(|(y, &t)| (y - value(&wanted, t)).abs())
            .fold(0.0, f64::max);
        prop_assert!(worst < tolerance, "off by {worst}, allowed {tolerance}");
    }

    /// Three derivatives in one pass, and thinned outputs, are those of one filter after the other.
    #[test]
    fn together_and_thinned_are_the_same(
        input in prop::collection::vec(-1.0..1.0_f64, 1..150), half in 1_usize..25, step in 1_usize..20,
        edge in prop::sample::select(vec![Edge::Polynomial, Edge::Nearest, Edge::Mirror, Edge::Constant(0.5)]),
    ) {
        let n = input.len();
        let filters = [0, 1, 2].map(|d| SavitzkyGolay::new(2 * half + 1, 2, d, 1.0, edge).unwrap());
        prop_assume!(edge != Edge::Polynomial || n > 2 * half);
        let (mut a, mut b, mut c) = (vec![f64::NAN; n], vec![f64::NAN; n], vec![f64::NAN; n]);
        SavitzkyGolay::apply_three(filters.each_ref(), &input, [&mut a, &mut b, &mut c]).unwrap();
        for (filter, together) in filters.iter().zip([&a, &b, &c]) {
            let alone = filtered(filter, &input);
            prop_assert_eq!(together, &alone);
            let thinned = filter.apply_every(&input, step).unwrap();
            prop_assert_eq!(thinned.len(), n.div_ceil(step));
            for (x, y) in thinned.iter().zip(alone.iter().step_by(step)) {
                prop_assert!((x - y).abs() < 1e-14, "{x} {y}");
            }
        }
    }

    /// The vectorised interior equals the plain sum over the window.
    #[test]
    fn the_interior_is_the_plain_weighted_sum(
        input in prop::collection::vec(-1.0..1.0_f64, 60..140), half in 1_usize..25, odd in any::<bool>(),
    ) {
        let filter = SavitzkyGolay::new(2 * half + 1, 2, odd as usize, 1.0, Edge::Mirror).unwrap();
        let weights = filter.coefficients();
        let output = filtered(&filter, &input);
        for t in half..input.len() - half {
            let plain: f64 = weights.iter().zip(&input[t - half..]).map(|(w, x)| w * x).sum();
            prop_assert!((output[t] - plain).abs() < 1e-14);
        }
    }
}
