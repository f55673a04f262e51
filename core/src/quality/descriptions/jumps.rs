//! Jumps of torque at reversals: the sign of friction without any model.
//!
//! On either side of a reversal, at equal speed, a joint has the same place and the same acceleration: gravity and inertia
//! cancel in the difference of the torques, and twice the friction is left. It goes with the motion.

use super::change::Description;
use crate::linear::root_mean_square;
use crate::quality::view::View;

/// Speed on both sides of a reversal, as a share of the joint's root mean square speed.
const SIDES: f64 = 0.1;

/// A reversal that takes longer is a rest, s.
const LONGEST_S: f64 = 2.0;

/// Share of the jumps that go with the motion from which friction is taken to. Where there is no friction half of them do.
const WITH: f64 = 0.6;

/// Reversals from which it is said that a torque jumps against the motion.
const FEWEST: usize = 2;

/// Whether the torque of every channel jumps against the motion of its position channel, more often than with it.
pub(super) fn against_motion(views: &[&View]) -> Vec<bool> {
    of_all(views, |with, all| all >= FEWEST && 2 * with < all)
}

/// Whether the torque of every channel jumps with the motion of its position channel, as logged.
pub(super) fn with_motion(views: &[&View]) -> Vec<bool> {
    of_all(views, |with, all| with > 0 && with as f64 > WITH * all as f64)
}

/// What is said of the jumps with the motion, and all jumps, of every channel in all logs.
fn of_all(views: &[&View], said: impl Fn(usize, usize) -> bool) -> Vec<bool> {
    let dof = views.first().map_or(0, |view| view.dof());
    let of = |joint: usize| {
        let (with, all) = views.iter().map(|view| jumps(view, joint)).fold((0, 0), |(w, n), (a, b)| (w + a, n + b));
        said(with, all)
    };
    (0..dof).map(of).collect()
}

/// Jumps with the motion, and all jumps, of a log.
fn jumps(view: &View, joint: usize) -> (usize, usize) {
    let (qd, tau) = (view.qd.channel(joint), view.tau.channel(joint));
    let side = SIDES * root_mean_square(qd);
    let longest = (LONGEST_S / view.period) as usize;
    let (mut with, mut all) = (0, 0);
    // The last sample at which the joint surely moved.
    let mut last: Option<usize> = None;
    for sample in 0..qd.len() {
        if side == 0.0 || qd[sample].abs() < side {
            continue;
        }
        if let Some(before) = last.filter(|&before| qd[before] * qd[sample] < 0.0 && sample - before <= longest) {
            let jump = (tau[sample] - tau[before]) * qd[sample].signum();
            if jump.is_finite() && jump != 0.0 {
                all += 1;
                with += usize::from(jump > 0.0);
            }
        }
        last = Some(sample);
    }
    (with, all)
}

/// Whether a description turns a jump that goes with the motion against it.
pub(super) fn contradicts(with_motion: &[bool], description: &Description) -> bool {
    (0..description.dof()).any(|joint| {
        let channel = description.torque_of[joint];
        channel == description.position_of[joint]
            && with_motion[channel]
            && description.torque_sign[joint] * description.position_sign[joint] < 0.0
    })
}
