//! Rotor inertia: the motor's rotor, turning fast behind the gear, beyond what the robot description gives.

use crate::effects::{About, DriveParameter, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::{Robot, Unit};

/// Ia a.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, RotorInertia};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // The rotor adds to the one that the description has: 45 kg m2 at joint 1 of this arm.
/// let mut arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// RotorInertia.alter(&[20.0], 0, &mut arm);
/// assert_eq!(arm.joints[0].drive.armature, 65.0);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct RotorInertia;

static ABOUT: About = About {
    name: "rotor_inertia",
    equation: "tau = Ia a",
    explanation: "The rotor's inertia times the gear ratio squared, which robot descriptions often leave out or give too small.",
    reference: "Khalil, Dombre (2002), Modeling, Identification and Control of Robots, Hermes Penton, chapter 9",
    rivals: &[
        Rival {
            name: "link_inertia_error",
            how_to_tell: "a link's inertia also changes with the pose and loads the joints before it; on the first joint the two \
                          are one",
        },
        Rival { name: "torque_gain", how_to_tell: "a gain scales gravity too: compare slow and fast motions" },
        Rival { name: "joint_coupling", how_to_tell: "coupling loads the other axis of the pair as well" },
    ],
    site: Site::Body,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Baseline,
    hidden_by_base_parameters: Hidden::Wholly,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "inertia",
    symbol: "Ia",
    unit: Unit::Inertia,
    role: Role::Amplitude,
    lower: 0.0,
    upper: f64::INFINITY,
    typical: 20.0,
}];

impl Effect for RotorInertia {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn of_drive(&self) -> Option<DriveParameter> {
        Some(DriveParameter::Rotor)
    }

    fn alter(&self, p: &[f64], joint: usize, robot: &mut Robot) {
        robot.joints[joint].drive.armature += p[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::dynamics::{Chain, Motion};
    use crate::effects::testing::pendulum;
    use crate::effects::{Along, Placed, contribution};

    #[test]
    fn by_hand() {
        // 40 kg m2 at -1.5 rad/s2, whatever position and velocity are.
        let robot = pendulum();
        let chain = Chain::new(&robot);
        let signal = |value: f64| Channels::from_vectors(&[vec![value]]);
        let motion = Motion { q: signal(0.2), qd: signal(0.5), qdd: signal(-1.5) };
        let along = Along::new(&robot, &chain, &[0.0], &motion, 0.0);
        let torque = |inertia: f64| {
            let placed = Placed { effect: &RotorInertia, joint: 0, parameters: vec![inertia] };
            contribution(&[placed], &along).channel(0)[0]
        };
        assert!((torque(40.0) + 60.0).abs() < 1e-12, "{}", torque(40.0));
        assert_eq!(torque(0.0), 0.0);
    }

    #[test]
    fn adds_to_what_is_known() {
        let mut robot = pendulum();
        robot.joints[0].drive.armature = 5.0;
        RotorInertia.alter(&[40.0], 0, &mut robot);
        assert_eq!(robot.joints[0].drive.armature, 45.0);
    }
}
