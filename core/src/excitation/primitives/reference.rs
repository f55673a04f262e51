//! What a motion is to those who follow it.

use super::peaks::Peaks;
use crate::channels::Channels;

/// Something an arm can be asked to follow: position, velocity and acceleration of every joint at every time.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::excitation::Reference;
///
/// /// A swing of 0.5 rad at 1 rad/s on one joint.
/// struct Swing;
///
/// impl Reference for Swing {
///     fn joints(&self) -> usize { 1 }
///     fn duration_s(&self) -> f64 { 10.0 }
///     fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
///         (q[0], qd[0], qdd[0]) = (0.5 * t.sin(), 0.5 * t.cos(), -0.5 * t.sin());
///     }
/// }
///
/// let [mut q, mut qd, mut qdd] = [(); 3].map(|()| tauscope::channels::Channels::zeros(1, 2));
/// Swing.along(&[0.0, 1.0], [&mut q, &mut qd, &mut qdd]);
/// assert_eq!(qd.channel(0), [0.5, 0.5 * 1f64.cos()]);
/// ```
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

    /// Bounds on the motion of `joint` that hold at all times; `None` where only samples can show them.
    fn peaks(&self, joint: usize) -> Option<Peaks> {
        let _ = joint;
        None
    }
}

/// [`Reference::at`] for a motion that is zero at both ends, from the [position, velocity, acceleration] of one joint.
pub(crate) fn fill(
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
