//! A one-joint arm on which laws can be checked by hand.

use super::{Effect, Instant, direction};
use crate::dynamics::Chain;
use crate::robot::{Addresses, Drive, Inertia, Joint, JointKind, Limits, Pose, Robot};
use nalgebra::Vector3;

/// A pendulum: 2 kg at 0.5 m along x, turning about y, with gravity along -z.
pub(super) fn pendulum() -> Robot {
    Robot {
        name: "pendulum".to_owned(),
        source: Default::default(),
        gravity: Vector3::new(0.0, 0.0, -9.81),
        joints: vec![Joint {
            name: "joint_1".to_owned(),
            link: "link_1".to_owned(),
            kind: JointKind::Revolute,
            origin: Pose::identity(),
            axis: Vector3::y(),
            limits: Limits { lower: -3.0, upper: 3.0, velocity: 3.0, effort: 100.0 },
            inertia: Inertia::from_center_of_mass(2.0, Vector3::new(0.5, 0.0, 0.0), nalgebra::Matrix3::zeros()),
            drive: Drive::default(),
        }],
        flange: Pose { rotation: nalgebra::Matrix3::identity(), translation: Vector3::x() },
        tree: None,
        columns: vec!["joint_1".to_owned()],
        actuators: Vec::new(),
        addresses: Addresses::default(),
        held: Vec::new(),
        assumed: Vec::new(),
        guessed: Vec::new(),
        lifted: Vec::new(),
        notes: Vec::new(),
    }
}

/// What `check` makes of the pendulum at position `q` and velocity `qd`, with acceleration 1.5 rad/s2, load 12 N m and
/// t = 2 s.
pub(super) fn at<T>(q: f64, qd: f64, check: impl FnOnce(&Instant) -> T) -> T {
    let robot = pendulum();
    let chain = Chain::new(&robot);
    check(&Instant {
        t: 2.0,
        started: 0.0,
        q: &[q],
        qd: &[qd],
        qdd: &[1.5],
        direction: &[direction(qd, 0.0)],
        load: &[12.0],
        robot: &robot,
        chain: &chain,
        frames: None,
    })
}

/// Torque of an effect without memory on the pendulum at position `q` and velocity `qd` (see [`at`]).
pub(super) fn torque_at(effect: &dyn Effect, p: &[f64], q: f64, qd: f64) -> f64 {
    at(q, qd, |x| {
        let mut out = [0.0];
        effect.torque(p, 0, x, &[], &mut out);
        out[0]
    })
}
