//! Link inertia error: one link's inertial parameters are not those of the model.

use super::payload::load;
use super::plausible::{LIMITS_OF_LINK, length, mass, over_limit, spread};
use crate::effects::{About, Derived, Effect, Hidden, Limit, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::{Inertia, Robot, Unit};

/// Ten inertial parameters, about the joint frame, added to a link.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, LinkInertiaError};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // A weight of 1 kg at (0, 0, -1) m on the rod of a pendulum, 2 kg with the centre at -0.5 m.
/// let mut arm = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// LinkInertiaError.alter(&[1.0, 0.0, 0.0, -1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0], 0, &mut arm);
/// let rod = arm.joints[0].inertia;
/// assert_eq!((rod.mass(), rod.first_moment().z), (3.0, -2.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct LinkInertiaError;

static ABOUT: About = About {
    name: "link_inertia_error",
    equation: "tau = Y(q, v, a) (dm, dmx, dmy, dmz, dIxx, dIxy, dIyy, dIxz, dIyz, dIzz) of one link",
    explanation: "A link is heavier, lighter or differently balanced than the data sheet: hoses, covers, added equipment, \
                  or a wrong model.",
    reference: "Gautier and Khalil (1990), Direct calculation of minimum set of inertial parameters of serial robots, \
                IEEE Transactions on Robotics and Automation 6(3)",
    rivals: &[
        Rival { name: "payload", how_to_tell: "on the last link they are the same; look whether a tool is mounted" },
        Rival {
            name: "encoder_offset",
            how_to_tell: "an offset turns mass and moments as one, which a free link error imitates (overlap .85 to .93); \
                          a mark on the joint settles it",
        },
        Rival {
            name: "torque_gain",
            how_to_tell: "a gain scales one joint's friction too and does not act on other joints (overlap .85 to .93)",
        },
    ],
    site: Site::Body,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::Wholly,
};

const fn amplitude(name: &'static str, unit: Unit, typical: f64) -> Parameter {
    Parameter {
        name,
        symbol: name,
        unit,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical,
    }
}

// 10 kg more, at (0.25, -0.1, 0.05) m.
static PARAMETERS: [Parameter; 10] = [
    amplitude("dm", Unit::Mass, 10.0),
    amplitude("dmx", Unit::FirstMoment, 2.5),
    amplitude("dmy", Unit::FirstMoment, -1.0),
    amplitude("dmz", Unit::FirstMoment, 0.5),
    amplitude("dIxx", Unit::MomentOfInertia, 0.3),
    amplitude("dIxy", Unit::MomentOfInertia, 0.25),
    amplitude("dIyy", Unit::MomentOfInertia, 0.8),
    amplitude("dIxz", Unit::MomentOfInertia, -0.125),
    amplitude("dIyz", Unit::MomentOfInertia, 0.05),
    amplitude("dIzz", Unit::MomentOfInertia, 0.9),
];

impl Effect for LinkInertiaError {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn headline(&self) -> &'static [&'static str] {
        &["mass", "first_moment_x"]
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn prior(&self, joint: usize, robot: &Robot) -> Option<Vec<f64>> {
        Some(spread(mass(robot, joint), length(robot, joint)))
    }

    fn limits(&self) -> &'static [Limit] {
        &LIMITS_OF_LINK
    }

    fn over_limit(&self, p: &[f64], joint: usize, robot: &Robot) -> f64 {
        let mut changed = robot.clone();
        self.alter(p, joint, &mut changed);
        over_limit(&changed.joints[joint].inertia, robot, joint)
    }

    fn is_body(&self) -> bool {
        true
    }

    /// On the last link it is what hangs on the flange.
    fn derived(&self, p: &[f64], joint: usize, robot: &Robot) -> Vec<Derived> {
        match p.try_into() {
            Ok(body) if joint + 1 == robot.dof() => load(&Inertia(body), &robot.flange, robot.reach()),
            _ => Vec::new(),
        }
    }

    fn alter(&self, p: &[f64], joint: usize, robot: &mut Robot) {
        if let Ok(error) = p.try_into() {
            let link = &mut robot.joints[joint];
            link.inertia = link.inertia.welded_to(&Inertia(error));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{Chain, inverse_dynamics_at};
    use crate::effects::testing::pendulum;

    #[test]
    fn by_hand() {
        // Horizontal (q = 0), turning about y under gravity along -z: a first moment of 0.5 kg m along x takes
        // -0.5 * 9.81 = -4.905 N m; a moment of inertia of 0.2 kg m2 about y, accelerated by 3 rad/s2, 0.6 N m.
        let mut robot = pendulum();
        let torque = |robot: &Robot| {
            inverse_dynamics_at(&Chain::new(robot), &robot.inertial_parameters(), &[0.0], &[0.0], &[3.0])[0]
        };
        let before = torque(&robot);
        LinkInertiaError.alter(&[1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0], 0, &mut robot);
        assert!((torque(&robot) - before + 4.905 - 0.6).abs() < 1e-12);
    }

    #[test]
    fn a_typical_error_is_a_body_and_none_changes_nothing() {
        let typical = Inertia(std::array::from_fn(|i| PARAMETERS[i].typical));
        assert_eq!(typical.physical_fault(1e-9), None);
        let mut robot = pendulum();
        LinkInertiaError.alter(&[0.0; 10], 0, &mut robot);
        assert_eq!(robot, pendulum());
    }
}
