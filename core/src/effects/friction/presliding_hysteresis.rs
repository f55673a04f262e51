//! Presliding hysteresis: friction that builds up over a small distance after each reversal, as bristles bend before they
//! slip.
//!
//! A Dahl element in parallel to the other friction of the joint. Its bristle deflection z runs from -1 to 1 and follows
//! dz/dt = (v/d)(1 - z sign v), whose solution over a step at constant velocity is
//! z = s + (z0 - s) exp(-|v| dt / d) with s = sign v.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// A Dahl bristle: level z.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, PreslidingHysteresis};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 30 N m that build up over 5 mrad. After a reversal and 5 mrad, 63 % of it is there.
/// let (parameters, mut memory) = ([30.0, 5e-3], [0.0]);
/// let moving = Instant { qd: &[0.1], direction: &[1.0], ..at_rest };
/// PreslidingHysteresis.advance(&parameters, 0, &moving, 0.05, &mut memory);
/// let mut torque = [0.0];
/// PreslidingHysteresis.torque(&parameters, 0, &moving, &memory, &mut torque);
/// assert!((torque[0] / 30.0 - 0.632).abs() < 1e-3);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct PreslidingHysteresis;

static ABOUT: About = About {
    name: "presliding_hysteresis",
    equation: "tau = F z, dz/dt = (v/d) (1 - z sign(v))",
    explanation: "After a reversal the joint first winds up like a stiff spring and only then slips: friction needs a small \
                  distance to build up.",
    reference: "Dahl (1968), A solid friction model, The Aerospace Corporation TOR-0158(3107-18)-1; Canudas de Wit, Olsson, \
                Astrom, Lischinsky (1995), A new model for control of systems with friction, IEEE Transactions on Automatic \
                Control 40(3)",
    rivals: &[
        Rival {
            name: "coulomb_friction",
            how_to_tell: "the same away from reversals; look at the first milliradians after each reversal",
        },
        Rival {
            name: "stribeck_friction",
            how_to_tell: "Stribeck friction is high at low speed, hysteresis is low just after a reversal",
        },
        Rival {
            name: "backlash",
            how_to_tell: "in a gap the link does not follow at all and the load hits the other flank; hysteresis is smooth",
        },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::AfterReversals,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 2] = [
    Parameter {
        name: "level",
        symbol: "F",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 30.0,
    },
    Parameter {
        name: "distance",
        symbol: "d",
        unit: Unit::Position,
        role: Role::Shape,
        lower: 1e-4,
        upper: 0.1,
        typical: 5e-3,
    },
];

impl Effect for PreslidingHysteresis {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn torque(&self, p: &[f64], joint: usize, _: &Instant, memory: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * memory[0];
    }

    fn memory(&self) -> usize {
        1
    }

    fn advance(&self, p: &[f64], joint: usize, x: &Instant, dt: f64, memory: &mut [f64]) {
        let velocity = x.qd[joint];
        if velocity != 0.0 {
            let slipping = velocity.signum();
            memory[0] = slipping + (memory[0] - slipping) * (-velocity.abs() * dt / p[1]).exp();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::at;

    /// Deflection after `dt` seconds at velocity `qd`, from `start`.
    fn after(qd: f64, dt: f64, start: f64) -> f64 {
        let mut memory = [start];
        at(0.0, qd, |x| PreslidingHysteresis.advance(&[20.0, 0.01], 0, x, dt, &mut memory));
        memory[0]
    }

    fn torque(level: f64, deflection: f64) -> f64 {
        at(0.0, 0.5, |x| {
            let mut out = [0.0];
            PreslidingHysteresis.torque(&[level, 0.01], 0, x, &[deflection], &mut out);
            out[0]
        })
    }

    #[test]
    fn by_hand() {
        // 0.2 rad/s for 0.05 s is one presliding distance: 1 - 1/e = 0.632120558829. Then one distance back:
        // -1 + 1.632120558829 / e = -0.399576400894.
        assert!((after(0.2, 0.05, 0.0) - 0.632_120_558_829).abs() < 1e-11);
        assert!((after(-0.2, 0.05, 0.632_120_558_829) + 0.399_576_400_894).abs() < 1e-11);
        assert_eq!(torque(20.0, 0.25), 5.0);
        assert_eq!(torque(0.0, 0.25), 0.0);
    }

    #[test]
    fn standstill_keeps_the_deflection_and_slip_ends_at_one() {
        assert_eq!(after(0.0, 0.05, 0.3), 0.3);
        assert_eq!(after(3.0, 1e3, -1.0), 1.0);
    }

    #[test]
    fn many_steps_are_one() {
        let mut deflection = -0.4;
        for _ in 0..50 {
            deflection = after(0.2, 0.001, deflection);
        }
        assert!((deflection - after(0.2, 0.05, -0.4)).abs() < 1e-12);
    }
}
