//! The Freudenstein 1-3-5 law, and sequences of rest-to-rest moves under it.
//!
//! A move from theta_0 by h in the time T, with s = (t - t_0) / T and x = 2 pi s:
//!
//! ```text
//! theta   = theta_0 + h s - h / (2 pi) alpha (sin x + sin(3 x) / 54 + sin(5 x) / 1250)        (13)
//! theta'  = h / T     [1 - alpha (cos x + cos(3 x) / 18 + cos(5 x) / 250)]                   (14)
//! theta'' = h / T^2   2 pi alpha (sin x + sin(3 x) / 6 + sin(5 x) / 50)                      (15)
//! ```
//!
//! The numbers are those of J. Ogbemhe, K. Mpofu and M. Mokakabye, Robot dynamic model: freudenstein-based optimal
//! trajectory and parameter identification. Its print differs in three places. (13) lacks the plus sign after theta_0.
//! (14) has h/2 for h/T and closes the bracket of alpha after the first cosine, so that it is not the derivative of
//! (13). alpha is printed as 0.9438, which leaves an end velocity of 1e-5 h/T; here it is exactly
//! 1 / (1 + 1/18 + 1/250) = 1125/1192 = 0.94379..., for which velocity and acceleration are zero at both ends.
//!
//! Peaks. The derivative of (15) is proportional to cos x + cos(3 x) / 2 + cos(5 x) / 10 = 1.6 cos(x)^5. So the
//! acceleration is monotone between its two flat peaks at s = 1/4 and 3/4, of magnitude 2 pi alpha (1 - 1/6 + 1/50) =
//! 240 pi / 149 = 5.0603 h/T^2. The velocity never changes sign and peaks at s = 1/2 with 1 + alpha / alpha = 2 h/T.
//!
//! F. Freudenstein, On the dynamics of high-speed cam profiles, Int. J. Mechanical Sciences 1, 1960; L. Biagiotti and
//! C. Melchiorri, Trajectory Planning for Automatic Machines and Robots, Springer 2008, chapter 2.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::channels::Channels;
use crate::error::{Error, Result};
use crate::excitation::primitives::{Law, Peaks, Reference, fill, fill_along, timing};
use crate::lane::Lane;

/// The factor alpha that makes the velocity at both ends exactly zero; the paper prints 0.9438.
pub(crate) const ALPHA: f64 = 1125.0 / 1192.0;

/// Peak velocity of a move in units of h/T, reached at half time.
pub const PEAK_VELOCITY: f64 = 2.0;

/// Peak acceleration of a move in units of h/T^2, reached at a quarter (and, negative, at three quarters) of the time.
pub const PEAK_ACCELERATION: f64 = 240.0 * PI / 149.0;

/// One rest-to-rest move of one joint under the 1-3-5 law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Position at the start theta_0, rad.
    pub from: f64,
    /// Position at the end theta_f, rad.
    pub to: f64,
    /// Start time t_0, s.
    pub start_s: f64,
    /// Duration T, s.
    pub duration_s: f64,
}

impl Move {
    /// [position rad, velocity rad/s, acceleration rad/s^2] at `t_s`, which lies within the move: (13), (14), (15).
    pub fn at(&self, t_s: f64) -> [f64; 3] {
        Law::at(self, t_s)
    }
}

impl Law for Move {
    #[inline(always)]
    fn at<L: Lane>(&self, t_s: L) -> [L; 3] {
        let number = |value: f64| L::splat(value);
        let h = self.to - self.from;
        let share = over(t_s - number(self.start_s), self.duration_s);
        let (sin, cos) = (number(TAU) * share).sin_cos();
        // Multiple angles from sin x and cos x: a simulation calls this millions of times.
        let (sin2, cos2) = (sin * sin, cos * cos);
        let fifth = |square: L| number(5.0) - square * (number(20.0) - number(16.0) * square);
        let (sin3, sin5) = (sin * (number(3.0) - number(4.0) * sin2), sin * fifth(sin2));
        let (cos3, cos5) = (cos * (number(4.0) * cos2 - number(3.0)), cos * fifth(cos2));
        let swing = sin + over(sin3, 54.0) + over(sin5, 1250.0);
        let slope = cos + over(cos3, 18.0) + over(cos5, 250.0);
        let bend = sin + over(sin3, 6.0) + over(sin5, 50.0);
        [
            number(self.from) + number(h) * (share - number(ALPHA / TAU) * swing),
            number(h / self.duration_s) * (number(1.0) - number(ALPHA) * slope),
            number(h / (self.duration_s * self.duration_s) * TAU * ALPHA) * bend,
        ]
    }
}

/// A quotient; several side by side as a product, since divisions in lanes would take longer than all else.
#[inline(always)]
fn over<L: Lane>(value: L, divisor: f64) -> L {
    if L::WIDTH == 1 { value / L::splat(divisor) } else { value * L::splat(1.0 / divisor) }
}

/// The moves of one joint; it starts and ends at zero, so n durations go with n - 1 via points between them. Two equal
/// via points in a row are a rest, and so is a zero next to either end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointMoves {
    /// Duration of each move, s.
    pub duration_s: Vec<f64>,
    /// Positions between the moves, rad.
    pub via: Vec<f64>,
}

/// Rest-to-rest moves of every joint, each with its own durations, that together last equally long.
///
/// One move per joint with a common timing is not enough to excite an arm: the joints then move in proportion, and
/// parallel joints cannot be separated.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::{Motion, MotionFile, Reference};
/// # let file = |data: &str| {
/// #     let head = "schema = \"tauscope.motion/1\"\nrobot = \"bench\"\njoints = [\"pan\"]\nkind = \"freudenstein\"\n";
/// #     MotionFile::parse("motion.toml", &format!("{head}data = {data}"))
/// # };
///
///
/// // What a file with `kind = "freudenstein"` holds: to 0.4 rad in 1 s, and back in 2 s.
/// let data = "{ duration_s = 3.0, joints = [{ duration_s = [1.0, 2.0], via = [0.4] }] }";
/// let Motion::Freudenstein(sequence) = file(data)?.motion else { unreachable!() };
///
/// // The velocity peaks at half time of a move, with 2 h/T.
/// let (mut q, mut qd, mut qdd) = ([0.0], [0.0], [0.0]);
/// sequence.at(0.5, &mut q, &mut qd, &mut qdd);
/// assert!((q[0] - 0.2).abs() < 1e-12 && (qd[0] - 0.8).abs() < 1e-12);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Data", into = "Data")]
pub struct FreudensteinSequence {
    data: Data,
    /// Times between the moves, per joint.
    knots: Vec<Vec<f64>>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    duration_s: f64,
    joints: Vec<JointMoves>,
}

impl FreudensteinSequence {
    /// A sequence that lasts `duration_s`, from the moves of every joint.
    ///
    /// # Errors
    /// Names the joint whose durations do not add up to `duration_s`, are not positive, or do not match the via points.
    pub fn new(duration_s: f64, joints: Vec<JointMoves>) -> Result<Self> {
        timing::require_positive("duration_s", duration_s)?;
        if joints.is_empty() {
            return Err(Error::request("joints", "is empty; give the moves of at least one joint"));
        }
        let mut knots = Vec::with_capacity(joints.len());
        for (j, JointMoves { duration_s: durations, via }) in joints.iter().enumerate() {
            let name = format!("joint {}", j + 1);
            knots.push(timing::knots(&name, durations, duration_s)?);
            timing::require_one_fewer(&format!("{name}: via"), via.len(), durations.len())?;
            timing::require_finite(&format!("{name}: via"), via)?;
        }
        Ok(FreudensteinSequence { data: Data { duration_s, joints }, knots })
    }

    /// The moves of every joint, as given.
    pub(crate) fn joint_moves(&self) -> &[JointMoves] {
        &self.data.joints
    }

    /// The moves of one joint in order of time.
    pub fn moves(&self, joint: usize) -> impl Iterator<Item = Move> {
        (0..self.data.joints[joint].duration_s.len()).map(move |k| self.nth_move(joint, k))
    }

    fn nth_move(&self, joint: usize, k: usize) -> Move {
        let via = &self.data.joints[joint].via;
        let knots = &self.knots[joint];
        Move {
            from: if k == 0 { 0.0 } else { via[k - 1] },
            to: via.get(k).copied().unwrap_or(0.0),
            start_s: knots[k],
            duration_s: knots[k + 1] - knots[k],
        }
    }

    fn joint_state(&self, joint: usize, t_s: f64) -> [f64; 3] {
        self.nth_move(joint, timing::segment(&self.knots[joint], t_s)).at(t_s)
    }
}

impl Reference for FreudensteinSequence {
    fn joints(&self) -> usize {
        self.data.joints.len()
    }

    fn duration_s(&self) -> f64 {
        self.data.duration_s
    }

    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        fill(self, t_s, [q, qd, qdd], |joint, t| self.joint_state(joint, t));
    }

    fn along(&self, times_s: &[f64], signals: [&mut Channels; 3]) {
        fill_along(self, times_s, signals, |joint, sheet| {
            sheet.write_segments(&self.knots[joint], |k| self.nth_move(joint, k));
        });
    }

    /// Exact: positions peak at via points, velocities at half time, accelerations at a quarter of each move.
    fn peaks(&self, joint: usize) -> Option<Peaks> {
        let mut peaks = Peaks::default();
        for leg in self.moves(joint) {
            let (h, length) = (leg.to - leg.from, leg.duration_s);
            peaks.include(leg.start_s + length, [leg.to, 0.0, 0.0]);
            peaks.include(leg.start_s + 0.5 * length, [0.0, PEAK_VELOCITY * h / length, 0.0]);
            peaks.include(leg.start_s + 0.25 * length, [0.0, 0.0, PEAK_ACCELERATION * h / (length * length)]);
        }
        Some(peaks)
    }
}

impl TryFrom<Data> for FreudensteinSequence {
    type Error = Error;

    fn try_from(data: Data) -> Result<Self> {
        Self::new(data.duration_s, data.joints)
    }
}

impl From<FreudensteinSequence> for Data {
    fn from(sequence: FreudensteinSequence) -> Self {
        sequence.data
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::testing::{assert_derivatives, assert_peaks_tight, assert_zero_ends};
    use proptest::prelude::*;

    fn close(actual: [f64; 3], expected: [f64; 3]) {
        for (a, e) in actual.iter().zip(expected) {
            assert!((a - e).abs() < 1e-12, "{actual:?} against {expected:?}");
        }
    }

    #[test]
    fn law_matches_hand_computed_values() {
        // theta_0 = 0.5, h = 3, t_0 = 1, T = 2. At s = 1/4: sin x = 1, sin 3x = -1, sin 5x = 1, all cosines 0;
        // at s = 1/2 all sines are 0 and all cosines -1.
        let leg = Move { from: 0.5, to: 3.5, start_s: 1.0, duration_s: 2.0 };
        let bracket = 1.0 - 1.0 / 54.0 + 1.0 / 1250.0; // 0.982281481...
        let quarter = 0.5 + 3.0 * (0.25 - 0.943_791_946_308_725 * bracket / TAU);
        close(leg.at(1.5), [quarter, 1.5, 3.0 / 4.0 * 5.060_283_468_869_465]);
        close(leg.at(2.0), [2.0, 3.0, 0.0]);
        close(leg.at(1.0), [0.5, 0.0, 0.0]);
        close(leg.at(3.0), [3.5, 0.0, 0.0]);
    }

    #[test]
    fn alpha_is_the_printed_one_to_its_digits() {
        assert!((ALPHA - 1.0 / (1.0 + 1.0 / 18.0 + 1.0 / 250.0)).abs() < 1e-15);
        assert!((ALPHA - 0.9438).abs() < 1e-5);
    }

    #[test]
    fn peak_factors_are_reached_and_never_passed() {
        let leg = Move { from: 0.0, to: 1.0, start_s: 0.0, duration_s: 1.0 };
        let (mut velocity, mut acceleration) = (0.0_f64, 0.0_f64);
        for k in 0..=100_000 {
            let [position, v, a] = leg.at(f64::from(k) / 100_000.0);
            assert!((-1e-15..=1.0 + 1e-15).contains(&position) && v > -1e-15);
            velocity = velocity.max(v);
            acceleration = acceleration.max(a.abs());
        }
        assert!((velocity - PEAK_VELOCITY).abs() < 1e-12);
        assert!((acceleration - PEAK_ACCELERATION).abs() < 1e-12);
    }

    #[test]
    fn wrong_data_names_joint_and_field() {
        let fine = || JointMoves { duration_s: vec![1.0, 2.0], via: vec![0.3] };
        let message = |bad: JointMoves| FreudensteinSequence::new(3.0, vec![fine(), bad]).unwrap_err().to_string();
        let few = message(JointMoves { via: vec![], ..fine() });
        assert!(few.contains("joint 2") && few.contains("via"), "{few}");
        assert!(message(JointMoves { via: vec![f64::NAN], ..fine() }).contains("finite"));
        assert!(message(JointMoves { duration_s: vec![1.0, 1.0], ..fine() }).contains("add up to 2"));
        assert!(FreudensteinSequence::new(3.0, vec![]).is_err());
        assert!(FreudensteinSequence::new(f64::INFINITY, vec![fine()]).is_err());
    }

    prop_compose! {
        fn any_joint()(moves in 1usize..6)(
            shares in prop::collection::vec(0.2_f64..1.0, moves),
            via in prop::collection::vec(-3.0_f64..3.0, moves - 1),
        ) -> JointMoves {
            let total: f64 = shares.iter().sum();
            JointMoves { duration_s: shares.iter().map(|share| 5.0 * share / total).collect(), via }
        }
    }

    proptest! {
        #[test]
        fn velocity_and_acceleration_are_derivatives(
            joints in prop::collection::vec(any_joint(), 1..4),
            t in 0.0_f64..5.0,
        ) {
            assert_derivatives(&FreudensteinSequence::new(5.0, joints).unwrap(), t);
        }

        #[test]
        fn ends_and_via_points_are_met_at_rest(joints in prop::collection::vec(any_joint(), 1..4)) {
            let sequence = FreudensteinSequence::new(5.0, joints).unwrap();
            assert_zero_ends(&sequence, 1e-12, |joint, t| sequence.joint_state(joint, t));
            for joint in 0..sequence.joints() {
                let legs: Vec<Move> = sequence.moves(joint).collect();
                for (leg, next) in legs.iter().zip(&legs[1..]) {
                    let scale = 1.0 / (leg.duration_s * leg.duration_s);
                    for (before, after) in leg.at(next.start_s).iter().zip(next.at(next.start_s)) {
                        prop_assert!((before - after).abs() < 1e-12 * (1.0 + scale));
                    }
                }
            }
        }
    }

    #[test]
    fn peaks_are_exact() {
        let joints = vec![
            JointMoves { duration_s: vec![1.0, 0.5, 2.5], via: vec![0.4, -0.7] },
            JointMoves { duration_s: vec![1.5, 1.0, 1.5], via: vec![0.9, 0.9] },
        ];
        assert_peaks_tight(&FreudensteinSequence::new(4.0, joints).unwrap(), 1e-6);
    }
}
