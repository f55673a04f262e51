//! What the tests of all parametrisations share.

use super::{JointLimits, Peaks, Reference};

/// Position, velocity and acceleration of all joints at `t`.
pub(super) fn state(reference: &dyn Reference, t: f64) -> [Vec<f64>; 3] {
    let mut out = [(); 3].map(|()| vec![f64::NAN; reference.joints()]);
    let [q, qd, qdd] = &mut out;
    reference.at(t, q, qd, qdd);
    out
}

/// Velocity and acceleration at `t` agree with central differences of position and velocity. The jerk may jump at
/// a via point, so the acceleration is compared to within its own change over the difference step.
pub(super) fn assert_derivatives(reference: &dyn Reference, t: f64) {
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
pub(super) fn assert_zero_ends(reference: &dyn Reference, rounding: f64, joint_state: impl Fn(usize, f64) -> [f64; 3]) {
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
pub(super) fn assert_peaks_tight(reference: &dyn Reference, slack: f64) {
    let samples = 40_000;
    for joint in 0..reference.joints() {
        let claimed = reference.peaks(joint).expect("peaks");
        let mut seen = Peaks::default();
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
pub(super) fn irb1600() -> Vec<JointLimits> {
    let ranges = [(-180.0, 180.0), (-63.0, 110.0), (-235.0, 55.0), (-200.0, 200.0), (-115.0, 115.0), (-400.0, 400.0)];
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
