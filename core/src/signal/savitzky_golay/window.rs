//! The Savitzky-Golay window that suits the noise of positions: long enough to hold it down in the accelerations, short enough not
//! to bend them.

use super::smoother::{Edge, SavitzkyGolay};
use crate::error::{Error, Result};
use crate::signal::noise_floor;

/// Ratio of a window to the next shorter one that is tried; the standard deviation of the noise falls by a fifth from one to the next.
const STEP: f64 = 1.090_507_732_665_257_7;

/// How many windows shorter the one is by which a window is judged, together a factor of 1.4: of order six it bends accelerations
/// eight times less, and its noise is not yet so large that it hides the difference.
const SHORTER: usize = 4;

/// The longest window as a share of the signal: beyond, hardly any sample has a full window.
const LONGEST_SHARE: f64 = 0.125;

/// Outputs of each signal at which windows are compared; more do not change the choice.
const OUTPUTS: usize = 20_000;

/// Share of the largest position that rounding leaves in positions without noise.
const ROUNDING: f64 = 1e-12;

/// The odd window, up to about `longest` samples, with the least mean square error of the second derivative over the `signals`, with
/// polynomials of degree `order`.
///
/// The error of a window W has two parts. The noise is s^2 |w|^2, with the standard deviation s of the white noise on the signal as its
/// spectrum shows it ([`noise_floor`]) and the weights w of the second derivative. The bias is what the output differs by from that
/// of a window 1.4 times shorter, v, beyond what noise explains: mean (y_w - y_v)^2 - s^2 |w - v|^2. What both windows take off is not seen
/// in that, so `longest` must not smooth over a whole start or stop. Signals of different sizes and units count
/// alike: the sum of their errors is minimised, each in units of its least one. Signals that stand are left out.
///
/// References: S. R. Krishnan and C. S. Seelamantula, "On the selection of optimum Savitzky-Golay filters", IEEE Transactions on Signal
/// Processing 61 (2013) 380-391 (unbiased estimate of the error); O. V. Lepskii, "On a problem of adaptive estimation in Gaussian white
/// noise", Theory of Probability and its Applications 35 (1991) 454-466 (bias from a shorter window).
///
/// # Errors
/// If the order is below 2 or too high, no signal moves, or the signals are too short.
pub fn window_by_noise(signals: &[&[f64]], order: usize, longest: usize) -> Result<usize> {
    let shortest = signals.iter().map(|signal| signal.len()).min().unwrap_or(0);
    let windows = candidates(order, longest.min((LONGEST_SHARE * shortest as f64) as usize));
    let [first, .., last] = windows[..] else {
        let problem = format!("{shortest} samples are too few to choose a window for order {order}; take a longer log");
        return Err(Error::request("Savitzky-Golay window", problem));
    };
    let filters: Vec<SavitzkyGolay> = windows
        .iter()
        .map(|&window| SavitzkyGolay::new(window, order, 2, 1.0, Edge::Nearest))
        .collect::<Result<_>>()?;
    let weights: Vec<Vec<f64>> = filters.iter().map(|filter| centred(filter, last)).collect();
    let mut errors = vec![0.0; windows.len()];
    let mut moved = false;
    for signal in signals {
        let noise = noise_floor(signal).max(ROUNDING * signal.iter().fold(0.0f64, |most, x| most.max(x.abs())));
        if !moves(signal, noise) {
            continue;
        }
        moved = true;
        let step = signal.len().div_ceil(OUTPUTS);
        // Samples at which the longest window is full.
        let inside = (last / 2).div_ceil(step)..(signal.len() - last / 2).div_ceil(step);
        let outputs: Vec<Vec<f64>> = filters
            .iter()
            .map(|filter| Ok(filter.apply_every(signal, step)?[inside.clone()].to_vec()))
            .collect::<Result<_>>()?;
        let mut own = vec![0.0; windows.len()];
        for (k, error) in own.iter_mut().enumerate() {
            let variance = noise * noise * squares(weights[k].iter().copied());
            // The shortest windows have none to be judged by, nor a bias that any noise would not hide.
            let bias = k.checked_sub(SHORTER).map_or(0.0, |shorter| {
                let differences = outputs[k].iter().zip(&outputs[shorter]).map(|(a, b)| a - b);
                let apart = weights[k].iter().zip(&weights[shorter]).map(|(a, b)| a - b);
                squares(differences) / inside.len() as f64 - noise * noise * squares(apart)
            });
            *error = variance + bias.max(0.0);
        }
        let least = own.iter().copied().fold(f64::INFINITY, f64::min);
        errors.iter_mut().zip(own).for_each(|(sum, error)| *sum += error / least);
    }
    if !moved {
        return Err(Error::request("Savitzky-Golay window", "no joint moves; take a log of a motion"));
    }
    let best = errors.iter().zip(&windows).min_by(|a, b| a.0.total_cmp(b.0));
    Ok(best.map_or(first, |(_, &window)| window))
}

/// Share of the variance of the second derivative over a `window` that the noise of the `signals` makes, of the signal where it is largest:
/// by as much a regression on it is attenuated (errors in variables). Signals that stand are left out.
///
/// # Errors
/// If the window is impossible.
pub(crate) fn noise_share(signals: &[&[f64]], window: usize, order: usize) -> Result<f64> {
    let filter = SavitzkyGolay::new(window, order, 2, 1.0, Edge::Nearest)?;
    let gain = squares(filter.coefficients().into_iter());
    let mut largest = 0.0f64;
    for signal in signals.iter().filter(|signal| signal.len() > window) {
        let noise = noise_floor(signal);
        if moves(signal, noise) {
            let output = filter.apply_every(signal, 1)?;
            let inside = &output[window / 2..output.len() - window / 2];
            let variance = squares(inside.iter().copied()) / inside.len() as f64;
            largest = largest.max(noise * noise * gain / variance.max(f64::MIN_POSITIVE));
        }
    }
    Ok(largest)
}

/// Frequency, Hz, up to which a smoother (derivative 0) passes more than half of an amplitude, for signals sampled at `rate_hz`: the
/// cut-off of the [`crate::signal::ZeroPhaseLowPass`] that it is like. Half the rate where it passes as much of everything.
pub(crate) fn half_gain_hz(smoother: &SavitzkyGolay, rate_hz: f64) -> f64 {
    /// Steps up to half the rate, of which the first crossing is halved until it is exact to rounding.
    const STEPS: usize = 4000;
    const HALVINGS: usize = 60;
    let passes = |hz: f64| smoother.frequency_response(hz).0 > 0.5;
    let at = |step: usize| 0.5 * rate_hz * step as f64 / STEPS as f64;
    let Some(first) = (1..=STEPS).find(|&step| !passes(at(step))) else { return 0.5 * rate_hz };
    let [mut low, mut high] = [at(first - 1), at(first)];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        *(if passes(middle) { &mut low } else { &mut high }) = middle;
    }
    low
}

/// Odd windows from the shortest that smooths to the longest, each some 9 % longer than the one before.
fn candidates(order: usize, longest: usize) -> Vec<usize> {
    let mut windows: Vec<usize> = Vec::new();
    let mut size = (order + 3) as f64;
    while size as usize <= longest {
        let window = size as usize | 1;
        if windows.last() != Some(&window) {
            windows.push(window);
        }
        size *= STEP;
    }
    windows
}

/// The weights of a filter in the middle of `length` samples.
fn centred(filter: &SavitzkyGolay, length: usize) -> Vec<f64> {
    let beyond = vec![0.0; (length - filter.window()) / 2];
    [&beyond[..], &filter.coefficients(), &beyond].concat()
}

/// Whether a signal leaves its mean by more than its noise.
fn moves(signal: &[f64], noise: f64) -> bool {
    /// Variance over that of the noise; that of a signal that stands is one.
    const MOVES: f64 = 2.0;
    let mean = signal.iter().sum::<f64>() / signal.len() as f64;
    squares(signal.iter().map(|x| x - mean)) / signal.len() as f64 > MOVES * noise * noise
}

fn squares(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|x| x * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    const RATE: f64 = 500.0;
    const LONGEST: usize = 1000;
    /// A quarter of a second, two periods of the fastest swing: no window takes it off whole.
    const QUARTER: usize = 125;

    fn swing(hz: f64, noise: f64, seed: u64) -> Vec<f64> {
        let mut source = random::stream(seed, "window", 0);
        let mut draw = || -> f64 { StandardNormal.sample(&mut source) };
        (0..8000).map(|k| (TAU * hz * f64::from(k) / RATE).sin() + noise * draw()).collect()
    }

    /// Root mean square error of the second derivative of a swing, per sample squared.
    fn error(hz: f64, signal: &[f64], window: usize) -> f64 {
        let filter = SavitzkyGolay::new(window, 6, 2, 1.0, Edge::Nearest).unwrap();
        let mut out = vec![0.0; signal.len()];
        filter.apply(signal, &mut out).unwrap();
        let pulse = TAU * hz / RATE;
        let inner = 1000..7000;
        let sum = squares(inner.clone().map(|k| out[k] + pulse * pulse * (pulse * k as f64).sin()));
        (sum / inner.len() as f64).sqrt()
    }

    #[test]
    fn no_other_window_would_be_much_better() {
        for (hz, noise) in [(0.5, 1e-5), (2.0, 1e-5), (2.0, 1e-3), (8.0, 1e-4), (8.0, 1e-2)] {
            let signal = swing(hz, noise, 3);
            let chosen = window_by_noise(&[&signal], 6, QUARTER).unwrap();
            let best =
                candidates(6, QUARTER).into_iter().map(|window| error(hz, &signal, window)).fold(f64::MAX, f64::min);
            let own = error(hz, &signal, chosen);
            assert!(own < 1.3 * best, "{hz} Hz, noise {noise}: window {chosen} {own:e}, best {best:e}");
        }
    }

    #[test]
    fn more_noise_takes_a_longer_window_and_a_faster_motion_a_shorter_one() {
        let chosen = |hz: f64, noise: f64| window_by_noise(&[&swing(hz, noise, 5)], 6, LONGEST).unwrap();
        assert!(chosen(2.0, 1e-3) > chosen(2.0, 1e-5));
        assert!(chosen(8.0, 1e-5) < chosen(2.0, 1e-5));
        assert!(chosen(2.0, 0.0) <= chosen(2.0, 1e-7));
    }

    #[test]
    fn half_gain_by_hand() {
        // The mean of three samples passes (1 + 2 cos x) / 3, half of it at cos x = 1/4; a window of one sample passes all.
        let mean = SavitzkyGolay::new(3, 0, 0, 0.01, Edge::Nearest).unwrap();
        assert!((half_gain_hz(&mean, 100.0) - 0.25f64.acos() * 100.0 / TAU).abs() < 1e-10);
        assert_eq!(half_gain_hz(&SavitzkyGolay::new(1, 0, 0, 0.01, Edge::Nearest).unwrap(), 100.0), 50.0);
    }

    #[test]
    fn a_joint_that_stands_has_no_say_and_units_do_not_count() {
        let (moving, standing) = (swing(2.0, 1e-4, 1), swing(0.0, 1e-4, 2));
        let alone = window_by_noise(&[&moving], 6, LONGEST).unwrap();
        assert_eq!(window_by_noise(&[&moving, &standing], 6, LONGEST).unwrap(), alone);
        let degrees: Vec<f64> = moving.iter().map(|x| x.to_degrees()).collect();
        assert_eq!(window_by_noise(&[&degrees], 6, LONGEST).unwrap(), alone);
        assert!(window_by_noise(&[&standing], 6, LONGEST).unwrap_err().to_string().contains("no joint moves"));
        assert!(window_by_noise(&[&moving], 6, 21).unwrap() <= 21);
        assert!(window_by_noise(&[&moving[..40]], 6, LONGEST).unwrap_err().to_string().contains("too few"));
    }

    #[test]
    fn noise_attenuates_by_its_share_of_the_second_derivative() {
        // White noise of the second derivative: its variance over the window is that of the difference to the swing without noise.
        let (noise, window) = (2e-3, 31);
        let [with, without] = [noise, 0.0].map(|noise| swing(2.0, noise, 8));
        let filter = SavitzkyGolay::new(window, 6, 2, 1.0, Edge::Nearest).unwrap();
        let [a, b] = [&with, &without].map(|signal| filter.apply_every(signal, 1).unwrap()[50..7950].to_vec());
        let of_noise = squares(a.iter().zip(&b).map(|(a, b)| a - b)) / squares(a.iter().copied());
        let share = noise_share(&[&with], window, 6).unwrap();
        assert!((share / of_noise - 1.0).abs() < 0.1, "{share} instead of {of_noise}");
        // What stands has noise only.
        let standing = swing(0.0, noise, 9);
        assert_eq!(noise_share(&[&standing], window, 6).unwrap(), 0.0);
    }
}
