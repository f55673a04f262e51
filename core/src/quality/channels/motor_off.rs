//! Torque of a motor that is switched off.

use super::digits::runs;
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::view::View;
use crate::signal::quantum;
use std::ops::Range;

/// A channel that stands still for longer while its joint moves is frozen, s.
pub(super) const FROZEN_S: f64 = 0.1;

/// Path that a joint or its neighbours must go meanwhile, rad or m.
pub(super) const PATH: f64 = 0.02;

/// A torque of few digits rests at zero where it changes its sign. A motor that is switched off, or on again, is more than so many last
/// digits away from zero one sample before or behind, and rests there so many times longer than the torque does elsewhere.
const FALLS: f64 = 5.0;
const LONGER: usize = 3;

/// Samples over which a torque, at so many samples per second, is exactly zero for longer than a torque that changes its sign
/// is, while the position goes on: the motor is off.
pub(super) fn motor_off(q: &[f64], tau: &[f64], rate_hz: f64) -> Vec<Range<usize>> {
    let shortest = ((FROZEN_S * rate_hz) as usize).max(10);
    if tau.iter().all(|torque| *torque == 0.0) {
        return Vec::new();
    }
    let few_digits = quantum(tau);
    let elsewhere = runs(tau).filter(|&(start, _)| tau[start] != 0.0).map(|(_, length)| length).max().unwrap_or(0);
    let falls = |start: usize, end: usize| match few_digits {
        None => true,
        Some(digit) => {
            let sides = [start.checked_sub(1), Some(end)];
            let far =
                sides.into_iter().flatten().filter_map(|at| tau.get(at)).any(|torque| torque.abs() > FALLS * digit);
            far && end - start > LONGER * elsewhere
        }
    };
    let off = runs(tau).filter(|&(start, length)| {
        let end = start + length;
        tau[start] == 0.0 && length >= shortest && path(&q[start..end]) > PATH && falls(start, end)
    });
    off.map(|(start, length)| start..start + length).collect()
}

/// Path that a position goes, rad or m.
pub(super) fn path(signal: &[f64]) -> f64 {
    signal.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum()
}

/// The finding on a motor that is off in a part of the log.
pub(super) fn off(view: &View, joint: usize, tau: &[f64]) -> Option<Finding> {
    let parts = motor_off(view.log.q.channel(joint), tau, 1.0 / view.period);
    let first = parts.first()?;
    let seconds = parts.iter().map(Range::len).sum::<usize>() as f64 * view.period;
    let text = format!("the torque is exactly zero for {seconds:.3} s: the motor is off; these samples are left out");
    let place = format!("{} from {:.4} s", view.place("tau", joint), view.log.time[first.start]);
    Some(Finding::new(Kind::MotorOff, Severity::Note, place, text))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint that moves all the time under a torque in so many steps of its swing, off from sample 300 to `end`.
    fn found(digit: f64, end: usize) -> Vec<Range<usize>> {
        let q: Vec<f64> = (0..2000).map(|k| (0.01 * f64::from(k)).sin()).collect();
        let mut tau: Vec<f64> = (0..2000).map(|k| ((0.02 * f64::from(k)).cos() / digit).round() * digit).collect();
        tau[300..end].fill(0.0);
        motor_off(&q, &tau, 100.0)
    }

    #[test]
    fn a_torque_that_falls_to_zero_is_off_whatever_its_digits() {
        assert!(found(1e-6, 309).is_empty(), "a tenth of a second is ten samples");
        assert_eq!(found(1e-6, 310).first(), Some(&(300..310)));
        // Steps of a fiftieth of the swing: at its extremes the torque rests for 15 samples.
        assert!(found(0.02, 345).is_empty());
        assert_eq!(found(0.02, 346).first(), Some(&(300..346)));
        // Steps of a third: it rests at zero for as long as elsewhere.
        assert!(found(0.33, 300).is_empty());
    }
}
