//! Positions that count from another joint: those of a motor behind a parallelogram, or coupled gears.
//!
//! Of palletisers, and of arms whose elbow is driven from the shoulder, some controllers report the angle of the upper arm to the ground, and
//! others that to the lower arm. They differ by the angle of the lower arm, whose axis is parallel.

use crate::quality::view::View;
use crate::robot::{JointKind, Robot};

/// Positions this far beyond a limit leave it, rad (m).
pub(super) const BEYOND: f64 = 0.01;

/// Axes whose directions differ by less than 8 degrees (the cosine) are parallel: axes of a parallelogram are so to within tolerances.
const PARALLEL: f64 = 0.99;

/// What may be tried where the positions of a joint leave its limits, but stay within them with those of a parallel neighbour added or
/// taken off.
pub(super) fn hint(view: &View, robot: &Robot, joint: usize) -> Option<String> {
    let own = view.log.q.channel(joint);
    let limits = robot.joints[joint].limits;
    let fits = |other: usize, sign: f64| {
        let sum: Vec<f64> = own.iter().zip(view.log.q.channel(other)).map(|(q, other)| q + sign * other).collect();
        limits.left_by(&sum) <= BEYOND
    };
    let others = (0..robot.dof()).filter(|&other| is_parallel_neighbour(robot, joint, other));
    let (other, sign) =
        others.flat_map(|other| [(other, 1.0), (other, -1.0)]).find(|&(other, sign)| fits(other, sign))?;
    let (name, does) = (&robot.joints[other].name, if sign > 0.0 { "added" } else { "taken off" });
    Some(format!(
        "; with the position of {name} {does} they stay within them, as where the motor of one joint counts from the other (a parallelogram, coupled \
         gears): [motors] coupling in a dataset then"
    ))
}

/// Whether two joints turn about parallel axes, one carrying the other or both on one body.
fn is_parallel_neighbour(robot: &Robot, joint: usize, other: usize) -> bool {
    let [own, near] = [joint, other].map(|joint| &robot.joints[joint]);
    let [above, beside] = [joint, other].map(|joint| robot.parent(joint));
    let adjoins = joint != other && (above == Some(other) || beside == Some(joint) || above == beside);
    if !adjoins || [own, near].iter().any(|joint| joint.kind != JointKind::Revolute) {
        return false;
    }
    // Axes of neighbours keep their angle in every pose.
    let frames = robot.frames(&vec![0.0; robot.dof()]);
    let [a, b] = [(joint, own), (other, near)].map(|(at, joint)| frames[at].rotation * joint.axis);
    a.dot(&b).abs() > PARALLEL
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::recording::Recording;
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn a_joint_that_counts_from_its_parallel_neighbour_is_told_so() {
        let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let robot = load(urdf, InertiaCheck::Required).unwrap();
        let limits = robot.joints[2].limits;
        // The angle of the upper arm to the ground, near the end of its range, and the lower arm a radian forward.
        let row = |of: fn(f64) -> f64| (0..500).map(|k| of(0.01 * f64::from(k))).collect::<Vec<f64>>();
        let mut q = vec![row(|t| 0.2 * t.sin()); 6];
        q[1] = row(|t| 1.0 + 0.2 * t.sin());
        q[2] = q[1].iter().map(|lower| limits.upper - 0.5 + lower).collect();
        let log = Recording {
            joints: robot.joint_names(),
            time: (0..500).map(|k| 0.01 * f64::from(k)).collect(),
            tau: Channels::from_vectors(&q),
            q: Channels::from_vectors(&q),
            ..Recording::default()
        };
        let view = View::new(&log, Some(&robot)).unwrap();
        let said = hint(&view, &robot, 2).unwrap();
        assert!(said.contains("joint_2 taken off") && said.contains("coupling"), "{said}");
        // Joint 4 turns about the upper arm, and joint 1 about a vertical axis.
        assert!(!is_parallel_neighbour(&robot, 2, 3) && !is_parallel_neighbour(&robot, 1, 0));
    }
}
