//! Base tilt: the base does not stand as in the model, so gravity points elsewhere.

use crate::effects::{About, Derived, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::{Robot, Unit};
use nalgebra::Rotation3;

/// Gravity in base coordinates = R' g, with R = Ry(pitch) Rx(roll) the turn of the base.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{BaseTilt, Effect};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // A base that rolls by 0.1 rad: in its axes gravity leaves the vertical by as much, and keeps its size.
/// let mut arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let before = arm.gravity;
/// BaseTilt.alter(&[0.1, 0.0], 0, &mut arm);
/// assert!((arm.gravity.angle(&before) - 0.1).abs() < 1e-9);
/// assert!((arm.gravity.norm() - before.norm()).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct BaseTilt;

static ABOUT: About = About {
    name: "base_tilt",
    equation: "g_base = (Ry(pitch) Rx(roll))' g",
    explanation: "The floor or pedestal is not level, or the arm is mounted at an angle that the model does not have.",
    reference: "Siciliano, Sciavicco, Villani and Oriolo (2009), Robotics: Modelling, Planning and Control, Springer, \
                chapter 7 (gravity in the dynamic model)",
    rivals: &[
        Rival {
            name: "encoder_offset",
            how_to_tell: "a tilt loads joint 1 as well; a tilt about the axis of joint 2 of an upright arm that never turns \
                          joint 1 is the same as its offset",
        },
        Rival { name: "payload", how_to_tell: "a tilt changes with the angle of joint 1, a payload does not" },
        Rival { name: "torque_offset", how_to_tell: "on joint 1 a tilt changes with position, an offset does not" },
    ],
    site: Site::Body,
    scope: Scope::Arm,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

const fn angle(name: &'static str, typical: f64) -> Parameter {
    const HALF_TURN: f64 = std::f64::consts::PI;
    Parameter {
        name,
        symbol: name,
        unit: Unit::Angle,
        role: Role::Departure,
        lower: -HALF_TURN,
        upper: HALF_TURN,
        typical,
    }
}

static PARAMETERS: [Parameter; 2] = [angle("roll", 0.02), angle("pitch", -0.015)];

impl Effect for BaseTilt {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn headline(&self) -> &'static [&'static str] {
        &["tilt"]
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn derived(&self, p: &[f64], _: usize, _: &Robot) -> Vec<Derived> {
        let value = (p[0].cos() * p[1].cos()).acos();
        vec![Derived { name: "tilt", unit: Unit::Angle, value, of_the_first: false }]
    }

    fn alter(&self, p: &[f64], _: usize, robot: &mut Robot) {
        if p.iter().any(|&angle| angle != 0.0) {
            robot.gravity = Rotation3::from_euler_angles(p[0], p[1], 0.0).inverse() * robot.gravity;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{Chain, inverse_dynamics_at};
    use crate::effects::testing::pendulum;
    use nalgebra::Vector3;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

    fn gravity(roll: f64, pitch: f64) -> Vector3<f64> {
        let mut robot = pendulum();
        BaseTilt.alter(&[roll, pitch], 0, &mut robot);
        robot.gravity
    }

    #[test]
    fn by_hand() {
        // Pitched by 30 degrees the base's x axis points down: gravity gains 9.81 sin 30 = 4.905 along it and keeps
        // 9.81 cos 30 = 8.4957092 along -z. Rolled by 30 degrees its y axis points up: -4.905 along it.
        assert!((gravity(0.0, FRAC_PI_6) - Vector3::new(4.905, 0.0, -8.495_709_211_125_34)).norm() < 1e-12);
        assert!((gravity(FRAC_PI_6, 0.0) - Vector3::new(0.0, -4.905, -8.495_709_211_125_34)).norm() < 1e-12);
        // Rolled by 90 degrees and then pitched by 30: the base's axes are x = (cos 30, 0, -sin 30),
        // y = (sin 30, 0, cos 30), z = (0, -1, 0) in the world, with z up there.
        assert!((gravity(FRAC_PI_2, FRAC_PI_6) - Vector3::new(4.905, -8.495_709_211_125_34, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn a_pitch_is_an_offset_of_a_joint_about_y() {
        let torque = |robot: &Robot, q: f64| {
            inverse_dynamics_at(&Chain::new(robot), &robot.inertial_parameters(), &[q], &[0.0], &[0.0])[0]
        };
        let mut tilted = pendulum();
        BaseTilt.alter(&[0.0, 0.3], 0, &mut tilted);
        assert!((torque(&tilted, 0.2) - torque(&pendulum(), 0.5)).abs() < 1e-12);
    }

    #[test]
    fn absent_it_changes_nothing() {
        assert_eq!(gravity(0.0, 0.0), pendulum().gravity);
    }
}
