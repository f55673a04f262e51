//! Savitzky-Golay filter: least-squares polynomial over a sliding window, for the smoothed signal or one derivative.

use super::gram::Gram;
use super::sliding;
use crate::error::{Error, Result};
use crate::lane::Lanes;
use crate::signal::{check_same_length, downsample};
use std::f64::consts::TAU;

const SUBJECT: &str = "Savitzky-Golay filter";

/// Highest order taken: the weights are good to 1e-13 of the greatest one up to here, and motions need far less.
const MAX_ORDER: usize = 12;

/// What stands for the samples that the window misses at both ends of the signal.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::signal::{Edge, SavitzkyGolay};
///
/// // A ramp stays a ramp up to its end where the last polynomial goes on, and bends where the end sample is repeated.
/// let ramp: Vec<f64> = (0..20).map(f64::from).collect();
/// let last = |edge| -> tauscope::error::Result<f64> {
///     let mut smooth = vec![0.0; 20];
///     SavitzkyGolay::new(5, 2, 0, 1.0, edge)?.apply(&ramp, &mut smooth)?;
///     Ok(smooth[19])
/// };
/// assert!((last(Edge::Polynomial)? - 19.0).abs() < 1e-9);
/// assert!((last(Edge::Nearest)? - 19.0).abs() > 0.1);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Edge {
    /// Nothing is made up: the polynomial of the first (last) full window is evaluated up to the end (scipy "interp").
    Polynomial,
    /// The end sample is repeated.
    Nearest,
    /// The signal is reflected about its end sample, which is not repeated.
    Mirror,
    /// The signal is continued with this value. Other than zero it makes the filter affine instead of linear.
    Constant(f64),
}

/// Savitzky-Golay filter for a uniformly sampled signal.
///
/// Each output is the `derivative`-th derivative, at the window's centre, of the polynomial of degree `order` that fits
/// the `window` samples around it best in the least-squares sense. It has no delay, and reproduces every polynomial up
/// to `order` exactly.
///
/// The weights come from the Gram (discrete Legendre) polynomials, so that no ill-conditioned system is solved.
///
/// References: A. Savitzky and M. J. E. Golay, "Smoothing and differentiation of data by simplified least squares
/// procedures", Analytical Chemistry 36 (1964) 1627-1639; P. A. Gorry, "General least-squares smoothing and
/// differentiation by the convolution (Savitzky-Golay) method", Analytical Chemistry 62 (1990) 570-573; R. W. Schafer,
/// "What is a Savitzky-Golay filter?", IEEE Signal Processing Magazine 28 (2011) 111-117.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::signal::{Edge, SavitzkyGolay};
///
/// // Velocity of q = t^2 / 2, sampled at 100 Hz: a polynomial of degree 2 is reproduced exactly, up to the ends.
/// let q: Vec<f64> = (0..50).map(|k| 0.5 * (0.01 * f64::from(k)).powi(2)).collect();
/// let mut qd = vec![0.0; 50];
/// SavitzkyGolay::new(7, 2, 1, 0.01, Edge::Polynomial)?.apply(&q, &mut qd)?;
/// assert!(qd.iter().enumerate().all(|(k, v)| (v - 0.01 * k as f64).abs() < 1e-9));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SavitzkyGolay {
    half: usize,
    derivative: usize,
    sample_period_s: f64,
    edge: Edge,
    /// Weights of the centre sample and of those after it; before the centre they are the same, negated for odd
    /// derivatives.
    weights: Vec<f64>,
    /// Weights of the first `half` outputs over the first full window, one row per output; empty unless the edge is
    /// [`Edge::Polynomial`].
    start_weights: Vec<f64>,
}

impl SavitzkyGolay {
    /// A filter over `window` samples (odd) that are `sample_period_s` seconds apart, with polynomials of degree
    /// `order`; `derivative` 0 smooths, 1 gives the rate in units per second, 2 units per second squared, and so on.
    ///
    /// # Errors
    /// When the window is even or not longer than the order, the order above 12, the derivative above the order, or
    /// the sample period not a positive number.
    pub fn new(window: usize, order: usize, derivative: usize, sample_period_s: f64, edge: Edge) -> Result<Self> {
        let refuse = |problem: String| Err(Error::request(SUBJECT, problem));
        if window.is_multiple_of(2) {
            return refuse(format!("the window is {window} samples; take an odd number, so that it has a centre"));
        }
        if order >= window {
            return refuse(format!(
                "order {order} does not fit a window of {window} samples; take an order below {window} or a longer \
                 window"
            ));
        }
        if order > MAX_ORDER {
            return refuse(format!("order {order} is too high; take at most {MAX_ORDER}"));
        }
        if derivative > order {
            return refuse(format!(
                "derivative {derivative} of a polynomial of order {order} is zero everywhere; take an order of at \
                 least {derivative}"
            ));
        }
        // The order is at most 12, so the cast is exact.
        let per_period = sample_period_s.powi(-(derivative as i32));
        if !(sample_period_s.is_finite() && sample_period_s > 0.0 && per_period.is_normal()) {
            return refuse(format!("the sample period is {sample_period_s} s; give the seconds between two samples"));
        }
        let half = window / 2;
        let gram = Gram::new(half, order);
        let row = |position: f64| gram.weights(position, derivative).into_iter().map(|w| w * per_period);
        let mut weights: Vec<f64> = row(0.0).skip(half).collect();
        if derivative % 2 == 1 {
            weights[0] = 0.0;
        }
        let start_weights = match edge {
            Edge::Polynomial => (0..half).flat_map(|i| row(i as f64 - half as f64)).collect(),
            _ => Vec::new(),
        };
        Ok(Self { half, derivative, sample_period_s, edge, weights, start_weights })
    }

    /// Samples under the window.
    pub fn window(&self) -> usize {
        2 * self.half + 1
    }

    /// Which derivative the filter gives; 0 is the smoothed signal.
    pub fn derivative(&self) -> usize {
        self.derivative
    }

    /// What stands for the samples beyond both ends.
    pub fn edge(&self) -> Edge {
        self.edge
    }

    /// The weights of the window's samples, first to last: `output[t] = sum over i of weights[i] * input[t + i - half]`.
    pub fn coefficients(&self) -> Vec<f64> {
        let sign = self.sign();
        self.weights.iter().skip(1).rev().map(|w| sign * w).chain(self.weights.iter().copied()).collect()
    }

    /// Filters `input` into `output`, both `[time]`.
    ///
    /// # Errors
    /// When the lengths differ, the input is empty, or it is shorter than the window with [`Edge::Polynomial`].
    pub fn apply(&self, input: &[f64], output: &mut [f64]) -> Result<()> {
        self.check(input, output)?;
        let n = input.len();
        if n >= self.window() {
            let inner = &mut output[self.half..n - self.half];
            sliding::interior(Lanes::best(), &self.weights, self.is_odd(), input, inner);
        }
        self.apply_edges(input, output);
        Ok(())
    }

    /// The signal and its first two derivatives in one pass: filters of one window and edge, with derivatives 0, 1 and 2.
    ///
    /// # Errors
    /// As [`SavitzkyGolay::apply`], and when the filters are others.
    pub fn apply_three(filters: [&Self; 3], input: &[f64], output: [&mut [f64]; 3]) -> Result<()> {
        let alike = |(derivative, filter): (usize, &&Self)| {
            filter.derivative == derivative && filter.half == filters[0].half && filter.edge == filters[0].edge
        };
        if !filters.iter().enumerate().all(alike) {
            let problem = "a signal and its derivatives come from one window and edge, with derivatives 0, 1 and 2";
            return Err(Error::request(SUBJECT, problem));
        }
        for (filter, output) in filters.iter().zip(&output) {
            filter.check(input, output)?;
        }
        let (n, half) = (input.len(), filters[0].half);
        let [smooth, rate, second] = output;
        if n >= filters[0].window() {
            let inner = [&mut smooth[half..n - half], &mut rate[half..n - half], &mut second[half..n - half]];
            let weights = filters.map(|filter| filter.weights.as_slice());
            sliding::interior_of_three(Lanes::best(), weights, input, inner);
        }
        for (filter, output) in filters.iter().zip([smooth, rate, second]) {
            filter.apply_edges(input, output);
        }
        Ok(())
    }

    /// Every `step`-th output of [`SavitzkyGolay::apply`], to rounding, without computing the others: samples 0, `step`,
    /// 2 `step`, ...
    ///
    /// # Errors
    /// As [`SavitzkyGolay::apply`]; when `step` is zero.
    pub(crate) fn apply_every(&self, input: &[f64], step: usize) -> Result<Vec<f64>> {
        if step <= 1 {
            let mut output = vec![0.0; input.len()];
            self.apply(input, &mut output)?;
            return downsample(&output, step);
        }
        self.check(input, input)?;
        let mut output = vec![0.0; input.len().div_ceil(step)];
        self.rows(input, 0, step, &mut output);
        Ok(output)
    }

    /// Outputs `first`, `first + step`, ..., one per place of `output`.
    pub(in crate::signal) fn rows(&self, input: &[f64], first: usize, step: usize, output: &mut [f64]) {
        let (n, rows) = (input.len(), output.len());
        // The rows whose windows lie inside.
        let begin = self.half.saturating_sub(first).div_ceil(step).min(rows);
        let end = n.saturating_sub(self.half + first).div_ceil(step).clamp(begin, rows);
        let inside = if n >= self.window() { begin..end } else { 0..0 };
        if !inside.is_empty() {
            let start = first + begin * step - self.half;
            let output = &mut output[inside.clone()];
            if step == 1 {
                let input = &input[start..][..output.len() + 2 * self.half];
                sliding::interior(Lanes::best(), &self.weights, self.is_odd(), input, output);
            } else {
                sliding::every(Lanes::best(), &self.coefficients(), input, start, step, output);
            }
        }
        for row in (0..rows).filter(|row| !inside.contains(row)) {
            output[row] = self.at_edge(input, first + row * step);
        }
    }

    fn check(&self, input: &[f64], output: &[f64]) -> Result<()> {
        check_same_length(SUBJECT, input, output)?;
        if input.is_empty() {
            return Err(Error::request(SUBJECT, "the signal is empty; give at least one sample"));
        }
        if self.edge == Edge::Polynomial { Self::check_window(self.window(), input.len()) } else { Ok(()) }
    }

    /// Whether a polynomial over the whole of a window can be fitted to a signal of so many samples: asked before a filter is made, whose
    /// weights at the ends are as many as the square of its window.
    ///
    /// # Errors
    /// Where there are fewer samples than the window has.
    pub(crate) fn check_window(window: usize, samples: usize) -> Result<()> {
        if samples >= window {
            return Ok(());
        }
        Err(Error::request(
            SUBJECT,
            format!(
                "the signal has {samples} samples, fewer than the window of {window}; take a longer recording or a \
                 shorter window"
            ),
        ))
    }

    fn apply_edges(&self, input: &[f64], output: &mut [f64]) {
        let n = input.len();
        let start = self.half.min(n);
        let end = (n - start).max(start);
        for t in (0..start).chain(end..n) {
            output[t] = self.at_edge(input, t);
        }
    }

    /// The output at `t` where the window reaches beyond the signal.
    fn at_edge(&self, input: &[f64], t: usize) -> f64 {
        if self.edge != Edge::Polynomial {
            return self.continued_at(input, t);
        }
        let (n, window) = (input.len(), self.window());
        let row = |t: usize| &self.start_weights[t * window..][..window];
        if t < self.half {
            row(t).iter().zip(input).map(|(w, x)| w * x).sum()
        } else {
            self.sign() * row(n - 1 - t).iter().zip(input.iter().rev()).map(|(w, x)| w * x).sum::<f64>()
        }
    }

    /// The response at `hz` as (real, imaginary): a sinusoid of that frequency comes out multiplied by it. Real for
    /// even derivatives and imaginary for odd ones; compare with (j 2 pi hz)^derivative for the ideal.
    pub(crate) fn frequency_response(&self, hz: f64) -> (f64, f64) {
        let step = TAU * hz * self.sample_period_s;
        let after_centre = self.weights.iter().enumerate().skip(1);
        if self.is_odd() {
            (0.0, 2.0 * after_centre.map(|(i, w)| w * (step * i as f64).sin()).sum::<f64>())
        } else {
            (self.weights[0] + 2.0 * after_centre.map(|(i, w)| w * (step * i as f64).cos()).sum::<f64>(), 0.0)
        }
    }

    fn is_odd(&self) -> bool {
        self.derivative % 2 == 1
    }

    /// Reversing time changes the sign of odd derivatives.
    fn sign(&self) -> f64 {
        if self.is_odd() { -1.0 } else { 1.0 }
    }

    /// The output at `t` where the window reaches beyond a signal that is continued.
    fn continued_at(&self, input: &[f64], t: usize) -> f64 {
        let (t, sign) = (t as isize, self.sign());
        self.weights.iter().enumerate().skip(1).fold(self.weights[0] * continued(input, t, self.edge), |sum, (i, w)| {
            let i = i as isize;
            sum + w * (continued(input, t + i, self.edge) + sign * continued(input, t - i, self.edge))
        })
    }
}

/// The sample at `t` of the signal continued beyond its ends. `input` is not empty.
fn continued(input: &[f64], t: isize, edge: Edge) -> f64 {
    let last = input.len() as isize - 1;
    let inside = t.clamp(0, last);
    if inside == t {
        return input[t as usize];
    }
    match edge {
        Edge::Constant(value) => value,
        Edge::Mirror if last > 0 => {
            // A window longer than the signal is reflected to and fro: the period is 2 * last.
            let phase = t.rem_euclid(2 * last);
            input[phase.min(2 * last - phase) as usize]
        }
        Edge::Mirror | Edge::Nearest | Edge::Polynomial => input[inside as usize],
    }
}

#[cfg(test)]
mod tests;
