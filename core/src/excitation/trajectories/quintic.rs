//! Quintic segments through via points.
//!
//! A quintic is fixed by position, velocity and acceleration at its two ends, so a sequence of them through given via
//! states has continuous acceleration. The state at a via point is free; a velocity and an acceleration of zero there
//! make it a rest.
//!
//! K. M. Lynch and F. C. Park, Modern Robotics, Cambridge University Press 2017, section 9.3; L. Biagiotti and
//! C. Melchiorri, Trajectory Planning for Automatic Machines and Robots, Springer 2008, chapter 2.

use serde::{Deserialize, Serialize};

use crate::channels::Channels;
use crate::error::{Error, Result};
use crate::excitation::primitives::{Peaks, PiecewisePolynomial, Reference, fill, fill_along, timing};

/// The segments of one joint; it starts and ends at rest at zero, so n durations go with n - 1 via points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointSegments {
    /// Duration of each segment, s.
    pub duration_s: Vec<f64>,
    /// Position at each via point, rad.
    pub position: Vec<f64>,
    /// Velocity at each via point, rad/s; all zero when left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub velocity: Vec<f64>,
    /// Acceleration at each via point, rad/s^2; all zero when left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub acceleration: Vec<f64>,
}

impl JointSegments {
    /// [position, velocity, acceleration] at knot `k`, of which the first and the last are at rest at zero.
    fn knot_state(&self, k: usize) -> [f64; 3] {
        let via = |values: &[f64]| k.checked_sub(1).and_then(|k| values.get(k)).copied().unwrap_or(0.0);
        [via(&self.position), via(&self.velocity), via(&self.acceleration)]
    }
}

/// Quintic segments of every joint, each with its own durations, that together last equally long.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::{Motion, MotionFile, Reference};
/// # let file = |data: &str| {
/// #     let head = "schema = \"tauscope.motion/1\"\nrobot = \"bench\"\njoints = [\"pan\"]\nkind = \"quintic\"\n";
/// #     MotionFile::parse("motion.toml", &format!("{head}data = {data}"))
/// # };
///
///
/// // What a file with `kind = "quintic"` holds: through 0.5 rad at 0.3 rad/s after 1 s, and back to rest at zero.
/// let data = "{ duration_s = 3.0, joints = [{ duration_s = [1.0, 2.0], position = [0.5], velocity = [0.3] }] }";
/// let Motion::Quintic(sequence) = file(data)?.motion else { unreachable!() };
/// let (mut q, mut qd, mut qdd) = ([0.0], [0.0], [0.0]);
/// sequence.at(1.0, &mut q, &mut qd, &mut qdd);
/// assert!((q[0] - 0.5).abs() < 1e-12 && (qd[0] - 0.3).abs() < 1e-12);
/// sequence.at(3.0, &mut q, &mut qd, &mut qdd);
/// assert!(q[0].abs() < 1e-12 && qd[0].abs() < 1e-12);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Data", into = "Data")]
pub struct QuinticSequence {
    data: Data,
    curves: Vec<PiecewisePolynomial>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    duration_s: f64,
    joints: Vec<JointSegments>,
}

impl QuinticSequence {
    /// A sequence that lasts `duration_s`, from the segments of every joint.
    ///
    /// # Errors
    /// Names the joint whose durations do not add up to `duration_s`, are not positive, or do not match the via states.
    pub fn new(duration_s: f64, joints: Vec<JointSegments>) -> Result<Self> {
        timing::require_positive("duration_s", duration_s)?;
        if joints.is_empty() {
            return Err(Error::request("joints", "is empty; give the segments of at least one joint"));
        }
        let mut curves = Vec::with_capacity(joints.len());
        for (j, joint) in joints.iter().enumerate() {
            let name = format!("joint {}", j + 1);
            let knots = timing::knots(&name, &joint.duration_s, duration_s)?;
            for (field, values, optional) in [
                ("position", &joint.position, false),
                ("velocity", &joint.velocity, true),
                ("acceleration", &joint.acceleration, true),
            ] {
                let subject = format!("{name}: {field}");
                if !(optional && values.is_empty()) {
                    timing::require_one_fewer(&subject, values.len(), joint.duration_s.len())?;
                }
                timing::require_finite(&subject, values)?;
            }
            let segments = (0..joint.duration_s.len())
                .map(|k| hermite(joint.knot_state(k), joint.knot_state(k + 1), knots[k + 1] - knots[k]))
                .collect();
            curves.push(PiecewisePolynomial { knots, segments });
        }
        Ok(QuinticSequence { data: Data { duration_s, joints }, curves })
    }

    /// The segments of every joint, as given.
    pub(crate) fn joint_segments(&self) -> &[JointSegments] {
        &self.data.joints
    }
}

/// Coefficients in s = (t - start) / `length` of the quintic between two [position, velocity, acceleration].
fn hermite(start: [f64; 3], end: [f64; 3], length: f64) -> Vec<f64> {
    let scaled =
        |[position, velocity, acceleration]: [f64; 3]| (position, velocity * length, acceleration * length * length);
    let ((p0, v0, a0), (p1, v1, a1)) = (scaled(start), scaled(end));
    let step = p1 - p0;
    vec![
        p0,
        v0,
        0.5 * a0,
        10.0 * step - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
        -15.0 * step + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
        6.0 * step - 3.0 * (v0 + v1) - 0.5 * (a0 - a1),
    ]
}

impl Reference for QuinticSequence {
    fn joints(&self) -> usize {
        self.curves.len()
    }

    fn duration_s(&self) -> f64 {
        self.data.duration_s
    }

    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        fill(self, t_s, [q, qd, qdd], |joint, t| self.curves[joint].at(t));
    }

    fn along(&self, times_s: &[f64], signals: [&mut Channels; 3]) {
        fill_along(self, times_s, signals, |joint, sheet| self.curves[joint].along(sheet));
    }

    /// Exact, from the roots of the derivatives.
    fn peaks(&self, joint: usize) -> Option<Peaks> {
        Some(self.curves[joint].peaks())
    }
}

impl TryFrom<Data> for QuinticSequence {
    type Error = Error;

    fn try_from(data: Data) -> Result<Self> {
        Self::new(data.duration_s, data.joints)
    }
}

impl From<QuinticSequence> for Data {
    fn from(sequence: QuinticSequence) -> Self {
        sequence.data
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::testing::{assert_derivatives, assert_peaks_tight, assert_zero_ends, state};
    use proptest::prelude::*;

    prop_compose! {
        fn any_joint()(segments in 1usize..6)(
            shares in prop::collection::vec(0.3_f64..1.0, segments),
            position in prop::collection::vec(-2.0_f64..2.0, segments - 1),
            velocity in prop::collection::vec(-2.0_f64..2.0, segments - 1),
            acceleration in prop::collection::vec(-5.0_f64..5.0, segments - 1),
        ) -> JointSegments {
            let total: f64 = shares.iter().sum();
            let duration_s = shares.iter().map(|share| 5.0 * share / total).collect();
            JointSegments { duration_s, position, velocity, acceleration }
        }
    }

    proptest! {
        #[test]
        fn velocity_and_acceleration_are_derivatives(
            joints in prop::collection::vec(any_joint(), 1..4),
            t in 0.0_f64..5.0,
        ) {
            assert_derivatives(&QuinticSequence::new(5.0, joints).unwrap(), t);
        }

        #[test]
        fn ends_are_zero_and_via_states_are_met_from_both_sides(
            joints in prop::collection::vec(any_joint(), 1..4),
        ) {
            let sequence = QuinticSequence::new(5.0, joints.clone()).unwrap();
            assert_zero_ends(&sequence, 1e-10, |joint, t| sequence.curves[joint].at(t));
            for (j, joint) in joints.iter().enumerate() {
                for k in 0..joint.position.len() {
                    let expected = [joint.position[k], joint.velocity[k], joint.acceleration[k]];
                    let knot = sequence.curves[j].knots[k + 1];
                    for t in [knot - 1e-13, knot] {
                        for (order, e) in expected.iter().enumerate() {
                            let actual = state(&sequence, t)[order][j];
                            prop_assert!((actual - e).abs() < 1e-9, "{} against {}", actual, e);
                        }
                    }
                }
            }
        }

        #[test]
        fn peaks_are_exact(joints in prop::collection::vec(any_joint(), 1)) {
            assert_peaks_tight(&QuinticSequence::new(5.0, joints).unwrap(), 1e-3);
        }
    }

    #[test]
    fn a_single_rest_to_rest_quintic_has_the_known_peaks() {
        // Out by 1 rad and back, 1 s each: velocity 15/8, acceleration 10/sqrt(3).
        let joint = JointSegments { duration_s: vec![1.0, 1.0], position: vec![1.0], ..Default::default() };
        let peaks = QuinticSequence::new(2.0, vec![joint]).unwrap().peaks(0).unwrap();
        assert!((peaks.velocity.value - 1.875).abs() < 1e-14);
        assert!((peaks.acceleration.value.abs() - 10.0 / 3f64.sqrt()).abs() < 1e-13);
        assert!((peaks.highest.value - 1.0).abs() < 1e-14);
    }

    #[test]
    fn wrong_data_names_joint_and_field() {
        let fine = || JointSegments { duration_s: vec![1.0, 2.0], position: vec![0.3], ..Default::default() };
        let message = |bad: JointSegments| QuinticSequence::new(3.0, vec![fine(), bad]).unwrap_err().to_string();
        for (bad, field) in [
            (JointSegments { position: vec![], ..fine() }, "joint 2: position"),
            (JointSegments { velocity: vec![1.0, 2.0], ..fine() }, "joint 2: velocity"),
            (JointSegments { acceleration: vec![f64::INFINITY], ..fine() }, "joint 2: acceleration"),
            (JointSegments { duration_s: vec![3.1, 2.0], ..fine() }, "joint 2: duration_s"),
        ] {
            let text = message(bad);
            assert!(text.contains(field), "{text}");
        }
    }
}
