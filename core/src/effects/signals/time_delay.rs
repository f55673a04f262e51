//! Time delay: torque is logged later than position, or position later than torque.

use crate::effects::{About, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::Unit;

/// Logged torque at t = tau(t - d), on all joints.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, TimeDelay};
///
/// // A delay of 4 ms in a log of 500 Hz: two samples. The first torque is held before that.
/// let mut logged = [1.0, 2.0, 5.0, 5.0, 3.0, 0.0];
/// TimeDelay.distort_torque(&[0.004], &mut logged, 0.002);
/// assert_eq!(logged, [1.0, 1.0, 1.0, 2.0, 5.0, 5.0]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct TimeDelay;

static ABOUT: About = About {
    name: "time_delay",
    equation: "tau_logged(t) = tau(t - d)",
    explanation: "Torque and position in the log were not taken at the same time; a negative delay means that position is \
                  the later one.",
    reference: "Laakso, Valimaki, Karjalainen and Laine (1996), Splitting the unit delay - tools for fractional delay \
                filter design, IEEE Signal Processing Magazine 13(1)",
    rivals: &[
        Rival {
            name: "torque_lag",
            how_to_tell: "a lag rounds jumps and is of one axis, a delay keeps jumps sharp and is of all axes (overlap .94)",
        },
        Rival {
            name: "load_dependent_friction",
            how_to_tell: "friction changes with the direction of motion at constant speed, a delay with acceleration \
                          (overlap .58)",
        },
        Rival {
            name: "joint_spring",
            how_to_tell: "a spring still acts when the motion is slow; the error of a delay fades with speed (overlap .55)",
        },
        Rival {
            name: "joint_elasticity",
            how_to_tell: "a delay shifts the jumps of friction at reversals too, elasticity does not",
        },
    ],
    site: Site::Sensor,
    scope: Scope::Arm,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Delay,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "delay",
    symbol: "d",
    unit: Unit::Time,
    role: Role::Departure,
    lower: -0.05,
    upper: 0.05,
    typical: 0.004,
}];

impl Effect for TimeDelay {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn is_asked_about(&self) -> bool {
        true
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn search(&self, _: usize) -> Search {
        Search::Shift
    }

    /// By cubic Lagrange interpolation; before its first and after its last sample the torque is held.
    fn distort_torque(&self, p: &[f64], signal: &mut [f64], period: f64) {
        if p[0] == 0.0 {
            return;
        }
        let torque = signal.to_vec();
        for (sample, value) in signal.iter_mut().enumerate() {
            *value = interpolated(&torque, sample as f64 - p[0] / period);
        }
    }
}

/// `signal` at a place counted in samples, from the cubic through the four samples around it; held beyond the ends.
fn interpolated(signal: &[f64], place: f64) -> f64 {
    let last = signal.len() - 1;
    let place = place.clamp(0.0, last as f64);
    let points = signal.len().min(4);
    let start = (place.floor() as usize).saturating_sub(1).min(signal.len() - points);
    let x = place - start as f64;
    (0..points)
        .map(|i| {
            let weight: f64 = (0..points).filter(|&j| j != i).map(|j| (x - j as f64) / (i as f64 - j as f64)).product();
            weight * signal[start + i]
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_by_hand() {
        // tau = t^3 - 2 t^2 + 5 with t in samples, delayed by 1.25 samples.
        let torque = |t: f64| t * t * t - 2.0 * t * t + 5.0;
        let mut signal: Vec<f64> = (0..12).map(|k| torque(f64::from(k))).collect();
        TimeDelay.distort_torque(&[0.0025], &mut signal, 0.002);
        // The first two samples ask for what was before the log: held at tau(0) = 5.
        assert_eq!(signal[..2], [5.0, 5.0]);
        // At sample 5 it is tau(3.75) = 52.734375 - 28.125 + 5 = 29.609375.
        assert!((signal[5] - 29.609375).abs() < 1e-10);
        for (k, value) in signal.iter().enumerate().skip(2) {
            assert!((value - torque(k as f64 - 1.25)).abs() < 1e-10, "{k}");
        }
    }

    #[test]
    fn a_negative_delay_looks_ahead() {
        let mut signal: Vec<f64> = (0..8).map(f64::from).collect();
        TimeDelay.distort_torque(&[-0.003], &mut signal, 0.002);
        for (value, expected) in signal.iter().zip([1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.0, 7.0]) {
            assert!((value - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn whole_samples_are_moved_as_they_are() {
        let mut signal = [3.0, -1.0, 4.0, 1.0, -5.0, 9.0];
        TimeDelay.distort_torque(&[0.5], &mut signal, 0.25);
        assert_eq!(signal, [3.0, 3.0, 3.0, -1.0, 4.0, 1.0]);
    }

    #[test]
    fn absent_it_changes_nothing_and_short_logs_are_no_trouble() {
        let mut signal = [0.1, -0.7, 3.0];
        TimeDelay.distort_torque(&[0.0], &mut signal, 0.002);
        assert_eq!(signal, [0.1, -0.7, 3.0]);
        TimeDelay.distort_torque(&[0.004], &mut [], 0.002);
        let mut single = [2.0];
        TimeDelay.distort_torque(&[0.004], &mut single, 0.002);
        assert_eq!(single, [2.0]);
    }
}
