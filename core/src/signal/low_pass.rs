//! Zero-phase Butterworth low-pass: second-order sections run forward and backward over the signal.

use super::check_same_length;
use crate::error::{Error, Result};
use std::f64::consts::PI;

const SUBJECT: &str = "zero-phase low-pass";

/// Highest order taken; above it the filter rings for longer than it separates better.
const MAX_ORDER: usize = 16;

/// Butterworth low-pass run forward and then backward, so that it has no delay.
///
/// The two runs square the magnitude response: it is 1 at zero frequency, 1/2 at the cut-off and monotonic between and
/// beyond. At both ends the signal is continued by its point reflection about the end sample (odd padding) over
/// 3 (order + 1) samples, and each run starts in the steady state of its first sample; the output is that of scipy's
/// `sosfiltfilt(butter(order, cutoff_hz, fs=rate_hz, output="sos"), x)`.
///
/// References: S. Butterworth, "On the theory of filter amplifiers", Wireless Engineer 7 (1930) 536-541;
/// A. V. Oppenheim and R. W. Schafer, "Discrete-Time Signal Processing", 3rd ed. 2010, sections 6.3 and 7.2 (bilinear
/// transform); F. Gustafsson, "Determining the initial states in forward-backward filtering", IEEE Transactions on
/// Signal Processing 44 (1996) 988-992.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::signal::ZeroPhaseLowPass;
///
/// // 10 Hz in a log of 100 Hz: half the amplitude passes at the cut-off, and a constant as it is.
/// let filter = ZeroPhaseLowPass::new(4, 10.0, 100.0)?;
/// assert!((filter.gain(10.0) - 0.5).abs() < 1e-12);
/// let mut signal = vec![3.0; 50];
/// filter.apply_in_place(&mut signal)?;
/// assert!(signal.iter().all(|value| (value - 3.0).abs() < 1e-9));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroPhaseLowPass {
    order: usize,
    rate_hz: f64,
    /// Prewarped cut-off: tan(pi cutoff_hz / rate_hz).
    warped_cutoff: f64,
    sections: Vec<Section>,
}

/// One second-order section, of unit gain at zero frequency: (b0 + b1/z + b2/z^2) / (1 + a1/z + a2/z^2).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl Section {
    /// A real pole of the analogue prototype: 1 / (s + 1).
    fn first_order(warped_cutoff: f64) -> Self {
        let k = warped_cutoff;
        let b = k / (1.0 + k);
        Self { b: [b, b, 0.0], a: [(k - 1.0) / (k + 1.0), 0.0] }
    }

    /// A conjugate pair of poles of the analogue prototype: 1 / (s^2 + damping s + 1).
    fn second_order(warped_cutoff: f64, damping: f64) -> Self {
        let (k, k2) = (warped_cutoff, warped_cutoff * warped_cutoff);
        let denominator = 1.0 + damping * k + k2;
        let b = k2 / denominator;
        Self { b: [b, 2.0 * b, b], a: [2.0 * (k2 - 1.0) / denominator, (1.0 - damping * k + k2) / denominator] }
    }

    /// State of the transposed direct form II in which an input of ones gives ones.
    fn steady_state(&self) -> [f64; 2] {
        [1.0 - self.b[0], self.b[2] - self.a[1]]
    }

    #[inline(always)]
    fn step(&self, state: &mut [f64; 2], x: f64) -> f64 {
        let y = self.b[0] * x + state[0];
        state[0] = self.b[1] * x - self.a[0] * y + state[1];
        state[1] = self.b[2] * x - self.a[1] * y;
        y
    }
}

impl ZeroPhaseLowPass {
    /// A filter of the given `order` (of one run), cutting off at `cutoff_hz`, for signals sampled at `rate_hz`.
    ///
    /// # Errors
    /// When the order is not within 1 to 16, the rate not a positive number, or the cut-off not between zero and half
    /// the rate.
    pub fn new(order: usize, cutoff_hz: f64, rate_hz: f64) -> Result<Self> {
        let refuse = |problem: String| Err(Error::request(SUBJECT, problem));
        if !(1..=MAX_ORDER).contains(&order) {
            return refuse(format!("the order is {order}; take 1 to {MAX_ORDER}"));
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return refuse(format!("the sample rate is {rate_hz} Hz; give a positive number"));
        }
        if !(cutoff_hz > 0.0 && cutoff_hz < 0.5 * rate_hz) {
            // The mean of many steps is a rate with an error of rounding.
            let rounded = |hz: f64| (1e6 * hz).round() / 1e6;
            return refuse(format!(
                "the cut-off is {cutoff_hz} Hz; at a sample rate of {} Hz it must be above 0 and below {} Hz",
                rounded(rate_hz),
                rounded(0.5 * rate_hz)
            ));
        }
        let warped_cutoff = (PI * cutoff_hz / rate_hz).tan();
        let real_pole = (order % 2 == 1).then(|| Section::first_order(warped_cutoff));
        // The best damped pair first, so that no section's resonance is passed on amplified by the next.
        let pairs = (0..order / 2).rev().map(|k| {
            let damping = 2.0 * (PI * (2 * k + 1) as f64 / (2 * order) as f64).sin();
            Section::second_order(warped_cutoff, damping)
        });
        Ok(Self { order, rate_hz, warped_cutoff, sections: real_pole.into_iter().chain(pairs).collect() })
    }

    /// The cut-off, Hz.
    pub fn cutoff_hz(&self) -> f64 {
        self.warped_cutoff.atan() * self.rate_hz / PI
    }

    /// Samples by which the signal is continued at each end; it must be longer than that.
    pub fn padding(&self) -> usize {
        3 * (self.order + 1)
    }

    /// Gain of both runs together at `hz`, between 0 and 1; the phase is zero.
    pub fn gain(&self, hz: f64) -> f64 {
        let warped = (PI * hz / self.rate_hz).tan() / self.warped_cutoff;
        1.0 / (1.0 + warped.powi(2 * self.order as i32))
    }

    /// Filters `input` into `output`, both `[time]`.
    ///
    /// # Errors
    /// When the lengths differ or the signal is not longer than [`Self::padding`].
    pub fn apply(&self, input: &[f64], output: &mut [f64]) -> Result<()> {
        check_same_length(SUBJECT, input, output)?;
        let mut padded = self.padded(input)?;
        self.run_both_ways(&mut padded);
        output.copy_from_slice(&padded[self.padding()..][..input.len()]);
        Ok(())
    }

    /// Filters `signal`, `[time]`, where it stands.
    ///
    /// # Errors
    /// When the signal is not longer than [`Self::padding`].
    pub fn apply_in_place(&self, signal: &mut [f64]) -> Result<()> {
        let mut padded = self.padded(signal)?;
        self.run_both_ways(&mut padded);
        signal.copy_from_slice(&padded[self.padding()..][..signal.len()]);
        Ok(())
    }

    /// `input` continued at both ends by its point reflection about the end sample.
    fn padded(&self, input: &[f64]) -> Result<Vec<f64>> {
        let (n, padding) = (input.len(), self.padding());
        if n <= padding {
            return Err(Error::request(
                SUBJECT,
                format!(
                    "the signal has {n} samples; order {} needs at least {}: take a longer recording or a lower order",
                    self.order,
                    padding + 1
                ),
            ));
        }
        let (first, last) = (input[0], input[n - 1]);
        let before = input[1..=padding].iter().rev().map(|x| 2.0 * first - x);
        let after = input[n - 1 - padding..n - 1].iter().rev().map(|x| 2.0 * last - x);
        Ok(before.chain(input.iter().copied()).chain(after).collect())
    }

    fn run_both_ways(&self, signal: &mut [f64]) {
        self.run(signal.iter_mut());
        self.run(signal.iter_mut().rev());
    }

    /// One run through all sections, starting in the steady state of the first sample.
    fn run<'a>(&self, samples: impl Iterator<Item = &'a mut f64>) {
        let mut samples = samples.peekable();
        let first = samples.peek().map_or(0.0, |x| **x);
        let mut states: Vec<[f64; 2]> =
            self.sections.iter().map(|section| section.steady_state().map(|state| state * first)).collect();
        for sample in samples {
            *sample = self.sections.iter().zip(&mut states).fold(*sample, |x, (section, state)| section.step(state, x));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn filtered(filter: &ZeroPhaseLowPass, input: &[f64]) -> Vec<f64> {
        let mut output = vec![0.0; input.len()];
        filter.apply(input, &mut output).unwrap();
        output
    }

    #[test]
    fn second_order_at_a_quarter_of_the_rate_is_the_textbook_section() {
        // Warped cut-off tan(pi/4) = 1: b = [1, 2, 1] / (2 + sqrt 2), a1 = 0, a2 = (2 - sqrt 2) / (2 + sqrt 2).
        let filter = ZeroPhaseLowPass::new(2, 250.0, 1000.0).unwrap();
        let root = 2.0_f64.sqrt();
        let [section] = filter.sections[..] else { panic!("one section expected") };
        for (got, want) in section.b.into_iter().zip([1.0, 2.0, 1.0]) {
            assert!((got - want / (2.0 + root)).abs() < 1e-15);
        }
        assert!(section.a[0].abs() < 1e-15);
        assert!((section.a[1] - (2.0 - root) / (2.0 + root)).abs() < 1e-15);
    }

    #[test]
    fn an_impulse_comes_out_symmetric() {
        let filter = ZeroPhaseLowPass::new(3, 40.0, 500.0).unwrap();
        let mut impulse = vec![0.0; 401];
        impulse[200] = 1.0;
        let output = filtered(&filter, &impulse);
        for lag in 1..=200 {
            assert!((output[200 - lag] - output[200 + lag]).abs() < 1e-14, "lag {lag}");
        }
        assert!(output[200] > 0.1);
    }

    #[test]
    fn a_sinusoid_keeps_its_phase_and_takes_the_stated_gain() {
        let (rate, hz) = (1000.0, 20.0);
        for (order, cutoff) in [(1, 30.0), (2, 20.0), (4, 25.0), (5, 15.0)] {
            let filter = ZeroPhaseLowPass::new(order, cutoff, rate).unwrap();
            let input: Vec<f64> = (0..4000).map(|t| (std::f64::consts::TAU * hz * t as f64 / rate).sin()).collect();
            let output = filtered(&filter, &input);
            for t in 1500..2500 {
                assert!((output[t] - filter.gain(hz) * input[t]).abs() < 1e-10, "order {order}, sample {t}");
            }
        }
    }

    #[test]
    fn the_gain_is_one_at_rest_and_one_half_at_the_cutoff() {
        let filter = ZeroPhaseLowPass::new(4, 30.0, 1000.0).unwrap();
        assert_eq!(filter.gain(0.0), 1.0);
        assert!((filter.gain(30.0) - 0.5).abs() < 1e-15);
        assert!(filter.gain(120.0) < 1e-4);
    }

    #[test]
    fn in_place_and_out_of_place_agree() {
        let filter = ZeroPhaseLowPass::new(3, 10.0, 100.0).unwrap();
        let mut signal: Vec<f64> = (0..60).map(|t| ((t * t) % 17) as f64).collect();
        let output = filtered(&filter, &signal);
        filter.apply_in_place(&mut signal).unwrap();
        assert_eq!(signal, output);
    }

    #[test]
    fn a_signal_no_longer_than_the_padding_is_refused() {
        let filter = ZeroPhaseLowPass::new(3, 10.0, 100.0).unwrap();
        assert_eq!(filter.padding(), 12);
        let message = filter.apply_in_place(&mut [0.0; 12]).unwrap_err().to_string();
        assert!(message.contains("12 samples") && message.contains("at least 13"), "{message}");
        filter.apply_in_place(&mut [0.0; 13]).unwrap();
    }

    #[test]
    fn wrong_arguments_are_refused() {
        for (order, cutoff, rate, word) in [
            (0, 10.0, 100.0, "order"),
            (17, 10.0, 100.0, "order"),
            (2, 0.0, 100.0, "cut-off"),
            (2, 50.0, 100.0, "cut-off"),
            (2, f64::NAN, 100.0, "cut-off"),
            (2, 10.0, 0.0, "rate"),
            (2, 10.0, f64::INFINITY, "rate"),
        ] {
            let message = ZeroPhaseLowPass::new(order, cutoff, rate).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }

    proptest! {
        #[test]
        fn straight_lines_pass_unchanged(
            order in 1_usize..=6, relative_cutoff in 0.02..0.45_f64, offset in -10.0..10.0_f64, slope in -1.0..1.0_f64,
        ) {
            // Odd padding continues a line as a line, and a zero-phase filter of unit gain at zero keeps it.
            let filter = ZeroPhaseLowPass::new(order, relative_cutoff, 1.0).unwrap();
            let constant = vec![offset; 200];
            for (y, x) in filtered(&filter, &constant).iter().zip(&constant) {
                prop_assert!((y - x).abs() < 1e-10 * (1.0 + x.abs()));
            }
            let line: Vec<f64> = (0..2000).map(|t| offset + slope * t as f64).collect();
            let output = filtered(&filter, &line);
            for t in 900..1100 {
                prop_assert!((output[t] - line[t]).abs() < 1e-9 * (1.0 + line[t].abs()));
            }
        }
    }
}
