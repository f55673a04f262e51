//! Torque lag: the logged torque follows the real one as through a first-order filter.

use crate::effects::{About, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::Unit;

/// T d(logged)/dt + logged = tau.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, TorqueLag};
///
/// // Behind a ramp of 300 N m/s the log of a drive with T = 5 ms stays back by 1.5 N m.
/// let torque: Vec<f64> = (0..200).map(|k| 300.0 * 1e-3 * f64::from(k)).collect();
/// let mut logged = torque.clone();
/// TorqueLag.distort_torque(&[0.005], &mut logged, 1e-3);
/// assert!((torque[199] - logged[199] - 1.5).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct TorqueLag;

static ABOUT: About = About {
    name: "torque_lag",
    equation: "T d(tau_logged)/dt + tau_logged = tau",
    explanation: "The drive filters its current signal before logging it, so quick changes of torque appear late and \
                  rounded.",
    reference: "Siciliano, Sciavicco, Villani and Oriolo (2009), Robotics: Modelling, Planning and Control, Springer, \
                chapter 5 (drives with a first-order current loop)",
    rivals: &[
        Rival {
            name: "time_delay",
            how_to_tell: "a delay shifts all axes alike and keeps jumps sharp, a lag rounds them; below the cut-off of the \
                          lag they are hardly separable (overlap .94): excite faster",
        },
        Rival {
            name: "joint_elasticity",
            how_to_tell: "elasticity leaves friction where it is; a lag rounds its jumps at reversals as well",
        },
    ],
    site: Site::Sensor,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lag,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "time",
    symbol: "T",
    unit: Unit::Time,
    role: Role::Departure,
    lower: 0.0,
    upper: 0.5,
    typical: 0.005,
}];

impl Effect for TorqueLag {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn search(&self, _: usize) -> Search {
        Search::Shift
    }

    /// Exact for torque that is linear between samples; before the first sample the torque was steady.
    fn distort_torque(&self, p: &[f64], signal: &mut [f64], period: f64) {
        let (time, Some(&first)) = (p[0], signal.first()) else { return };
        if time == 0.0 {
            return;
        }
        let decay = (-period / time).exp();
        let (mut before, mut lagged) = (first, first);
        for value in signal {
            // On a ramp the output settles to the input less time * slope.
            let behind = time * (*value - before) / period;
            lagged = *value - behind + decay * (lagged - before + behind);
            before = *value;
            *value = lagged;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_by_hand() {
        // Input 1000 t, T = 10 ms, every 2 ms: output 1000 t - 10 (1 - exp(-t / T)).
        let mut torque: Vec<f64> = (0..50).map(|k| 2.0 * f64::from(k)).collect();
        TorqueLag.distort_torque(&[0.01], &mut torque, 0.002);
        // t = 2 ms: 2 - 10 (1 - exp(-0.2)) = 2 - 10 * 0.181269246922018 = 0.18730753077982.
        assert!((torque[1] - 0.18730753077982).abs() < 1e-12);
        // t = 10 ms: 10 - 10 (1 - exp(-1)) = 10 exp(-1) = 3.67879441171442.
        assert!((torque[5] - 3.67879441171442).abs() < 1e-12);
    }

    #[test]
    fn a_step_is_reached_after_the_fact() {
        // A step within one sample; after it the distance shrinks by exp(-0.2) = 0.818730753077982 a sample.
        let mut torque = [vec![0.0; 3], vec![100.0; 40]].concat();
        TorqueLag.distort_torque(&[0.01], &mut torque, 0.002);
        assert_eq!(torque[..3], [0.0; 3]);
        // During the step: 100 - 100 * 5 (1 - exp(-0.2)) = 9.365376538991.
        assert!((torque[3] - 9.365376538991).abs() < 1e-9, "{}", torque[3]);
        for pair in torque[3..].windows(2) {
            assert!(((100.0 - pair[1]) / (100.0 - pair[0]) - 0.818730753077982).abs() < 1e-9);
        }
    }

    #[test]
    fn absent_it_changes_nothing_and_steady_torque_stays() {
        let mut torque = [0.1, -0.7, 3.0];
        TorqueLag.distort_torque(&[0.0], &mut torque, 0.002);
        assert_eq!(torque, [0.1, -0.7, 3.0]);
        let mut steady = [42.0; 5];
        TorqueLag.distort_torque(&[0.3], &mut steady, 0.002);
        assert_eq!(steady, [42.0; 5]);
        TorqueLag.distort_torque(&[0.3], &mut [], 0.002);
    }

    #[test]
    fn a_vanishing_lag_vanishes() {
        let mut torque = [0.1, -0.7, 3.0];
        TorqueLag.distort_torque(&[1e-12], &mut torque, 0.002);
        for (value, expected) in torque.iter().zip([0.1, -0.7, 3.0]) {
            assert!((value - expected).abs() < 1e-8);
        }
    }
}
