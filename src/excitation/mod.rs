//! Excitation: the reference motions an arm is driven along so that its dynamic parameters show up in the torques.
//!
//! | file | motion | unknowns per joint |
//! |---|---|---|
//! | [`freudenstein`] | rest-to-rest moves under the Freudenstein 1-3-5 law | via points and durations |
//! | [`fourier`] | finite Fourier series | sine and cosine coefficients |
//! | [`quintic`] | quintic segments through via points | via points, velocities, accelerations, durations |
//! | [`bspline`] | clamped uniform B-spline | control points |
//!
//! Every motion starts and ends at zero position, velocity and acceleration, by construction, as the constraints
//! (17) of the paper behind [`freudenstein`] ask. All are linear in their unknowns once the durations are fixed, so a motion
//! that is too large for an arm can be scaled down to fit.
//!
//! [`limits`] tells whether a motion keeps inside an arm's limits, at all times and not only on samples. [`encoding`]
//! turns a vector in the box [-1, 1]^n into a motion inside given limits, which is what a search over motions works on;
//! [`random_sequence`] does so for the 1-3-5 law and draws motions at random. [`motion_file`] reads and writes motions.
//!
//! Angles in rad, times in s, one entry per joint from the base outwards.

mod batch;
pub mod bspline;
pub mod encoding;
pub mod fourier;
pub mod freudenstein;
mod joined;
pub mod limits;
pub mod motion_file;
pub mod peaks;
mod piecewise;
mod polynomial;
pub mod quintic;
pub mod random_sequence;
mod timing;

use crate::channels::Channels;
use serde::{Deserialize, Serialize};

pub use bspline::Bspline;
pub use encoding::Encoding;
pub use fourier::FourierSeries;
pub use freudenstein::FreudensteinSequence;
pub use limits::JointLimits;
pub use motion_file::MotionFile;
pub use peaks::Peaks;
pub use quintic::QuinticSequence;

/// Something an arm can be asked to follow: position, velocity and acceleration of every joint at every time.
pub trait Reference: Send + Sync {
    /// Number of joints.
    fn joints(&self) -> usize;

    /// Length of the motion, s; it starts at t = 0.
    fn duration_s(&self) -> f64;

    /// Writes position (rad), velocity (rad/s) and acceleration (rad/s^2) at time `t_s` into slices of one entry per
    /// joint. Velocity and acceleration are the exact derivatives of the position. Before 0 and after the duration the
    /// state at that end is held.
    ///
    /// # Panics
    /// When a slice is shorter than the number of joints.
    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]);

    /// What [`Reference::at`] says, to rounding, at times in ascending order: position, velocity and acceleration of all
    /// joints, each `[joint][time]`.
    ///
    /// # Panics
    /// When a table has fewer channels than joints or another number of samples than there are times.
    fn along(&self, times_s: &[f64], [q, qd, qdd]: [&mut Channels; 3]) {
        let mut state = [(); 3].map(|()| vec![0.0; self.joints()]);
        for (sample, &t) in times_s.iter().enumerate() {
            let [position, velocity, acceleration] = &mut state;
            self.at(t, position, velocity, acceleration);
            q.set(sample, position);
            qd.set(sample, velocity);
            qdd.set(sample, acceleration);
        }
    }

    /// Bounds on the motion of `joint` that hold at all times; `None` where only samples can tell.
    fn peaks(&self, joint: usize) -> Option<Peaks> {
        let _ = joint;
        None
    }
}

/// A motion of any of the four parametrisations, as motion files hold it: `kind` names the parametrisation, `data` holds
/// its unknowns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", content = "data", rename_all = "snake_case")]
pub enum Motion {
    /// Rest-to-rest moves under the Freudenstein 1-3-5 law.
    Freudenstein(FreudensteinSequence),
    /// A finite Fourier series.
    Fourier(FourierSeries),
    /// Quintic segments through via points.
    Quintic(QuinticSequence),
    /// A clamped uniform B-spline.
    Bspline(Bspline),
}

impl Motion {
    /// Names of the parametrisations, as `kind` spells them.
    pub const KINDS: [&'static str; 4] = ["freudenstein", "fourier", "quintic", "bspline"];

    /// The parametrisation, as `kind` spells it.
    pub fn kind(&self) -> &'static str {
        match self {
            Motion::Freudenstein(_) => Self::KINDS[0],
            Motion::Fourier(_) => Self::KINDS[1],
            Motion::Quintic(_) => Self::KINDS[2],
            Motion::Bspline(_) => Self::KINDS[3],
        }
    }

    fn reference(&self) -> &dyn Reference {
        match self {
            Motion::Freudenstein(motion) => motion,
            Motion::Fourier(motion) => motion,
            Motion::Quintic(motion) => motion,
            Motion::Bspline(motion) => motion,
        }
    }
}

impl Reference for Motion {
    fn joints(&self) -> usize {
        self.reference().joints()
    }

    fn duration_s(&self) -> f64 {
        self.reference().duration_s()
    }

    fn at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.reference().at(t_s, q, qd, qdd);
    }

    fn along(&self, times_s: &[f64], signals: [&mut Channels; 3]) {
        self.reference().along(times_s, signals);
    }

    fn peaks(&self, joint: usize) -> Option<Peaks> {
        self.reference().peaks(joint)
    }
}

/// [`Reference::at`] for a motion that is zero at both ends, from the [position, velocity, acceleration] of one joint.
fn fill(
    reference: &impl Reference,
    t_s: f64,
    [q, qd, qdd]: [&mut [f64]; 3],
    joint_state: impl Fn(usize, f64) -> [f64; 3],
) {
    let moving = t_s > 0.0 && t_s < reference.duration_s();
    for joint in 0..reference.joints() {
        let state = if moving { joint_state(joint, t_s) } else { [0.0; 3] };
        [q[joint], qd[joint], qdd[joint]] = state;
    }
}

/// What the tests of all parametrisations share.
#[cfg(test)]
mod testing {
    use super::{JointLimits, Reference};

    /// Position, velocity and acceleration of all joints at `t`.
    pub fn state(reference: &dyn Reference, t: f64) -> [Vec<f64>; 3] {
        let mut out = [(); 3].map(|()| vec![f64::NAN; reference.joints()]);
        let [q, qd, qdd] = &mut out;
        reference.at(t, q, qd, qdd);
        out
    }

    /// Velocity and acceleration at `t` agree with central differences of position and velocity. The jerk may jump at
    /// a via point, so the acceleration is compared to within its own change over the difference step.
    pub fn assert_derivatives(reference: &dyn Reference, t: f64) {
        let step = 1e-5;
        let t = t.clamp(step, reference.duration_s() - step);
        let [_, qd, qdd] = state(reference, t);
        let (before, after) = (state(reference, t - step), state(reference, t + step));
        for j in 0..reference.joints() {
            let change = (after[2][j] - before[2][j]).abs();
            let velocity = (after[0][j] - before[0][j]) / (2.0 * step);
            let acceleration = (after[1][j] - before[1][j]) / (2.0 * step);
            assert!(
                (velocity - qd[j]).abs() <= 1e-7 * (1.0 + qd[j].abs()) + step * change,
                "joint {j} at {t}: velocity {} against {velocity}",
                qd[j]
            );
            assert!(
                (acceleration - qdd[j]).abs() <= 1e-7 * (1.0 + qdd[j].abs()) + change,
                "joint {j} at {t}: acceleration {} against {acceleration}",
                qdd[j]
            );
        }
    }

    /// The law itself, evaluated at both ends, is zero to within `rounding`; the motion is zero there and outside.
    pub fn assert_zero_ends(reference: &dyn Reference, rounding: f64, joint_state: impl Fn(usize, f64) -> [f64; 3]) {
        let end = reference.duration_s();
        for joint in 0..reference.joints() {
            for t in [0.0, end] {
                for value in joint_state(joint, t) {
                    assert!(value.abs() < rounding, "joint {joint} at {t}: {:?}", joint_state(joint, t));
                }
            }
        }
        for t in [-1.0, 0.0, end, end + 1.0] {
            assert!(state(reference, t).concat().iter().all(|v| *v == 0.0), "at {t}");
        }
    }

    /// The claimed peaks bound dense samples and are reached by them to within `slack` (relative).
    pub fn assert_peaks_tight(reference: &dyn Reference, slack: f64) {
        let samples = 40_000;
        for joint in 0..reference.joints() {
            let claimed = reference.peaks(joint).expect("peaks");
            let mut seen = super::Peaks::default();
            for k in 0..=samples {
                let t = reference.duration_s() * f64::from(k) / f64::from(samples);
                let [q, qd, qdd] = state(reference, t);
                seen.include(t, [q[joint], qd[joint], qdd[joint]]);
            }
            for (claim, sample) in [
                (-claimed.lowest.value, -seen.lowest.value),
                (claimed.highest.value, seen.highest.value),
                (claimed.velocity.value.abs(), seen.velocity.value.abs()),
                (claimed.acceleration.value.abs(), seen.acceleration.value.abs()),
            ] {
                let rounding = 1e-12 * (1.0 + claim);
                assert!(sample <= claim + rounding, "joint {joint}: sample {sample} over the bound {claim}");
                let scale = claim.max(claimed.highest.value - claimed.lowest.value);
                assert!(claim - sample <= slack * scale + rounding, "joint {joint}: bound {claim}, reached {sample}");
            }
        }
    }

    /// Limits of the ABB IRB 1600-6/1.2, with the accelerations used for its excitation.
    pub fn irb1600() -> Vec<JointLimits> {
        let ranges =
            [(-180.0, 180.0), (-63.0, 110.0), (-235.0, 55.0), (-200.0, 200.0), (-115.0, 115.0), (-400.0, 400.0)];
        let speeds = [150.0, 160.0, 170.0, 320.0, 400.0, 460.0_f64];
        let accelerations = [10.0, 10.0, 12.0, 35.0, 40.0, 50.0];
        (0..6)
            .map(|j| JointLimits {
                lower: f64::to_radians(ranges[j].0),
                upper: f64::to_radians(ranges[j].1),
                velocity: speeds[j].to_radians(),
                acceleration: accelerations[j],
            })
            .collect()
    }
}
