//! Friction warm-up: the extra friction of a cold joint, which dies away as the arm works.
//!
//! Housings warm over tens of minutes, which a single recording sees as a slow trend at most; grease that has settled
//! spreads within the first moves. The typical time constant is of the second kind, in sight of one recording.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::Unit;

/// A exp(-t/T) sign(v), t counted from the start of every log, or from an instant `t0` of a clock that runs on from log to log.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, FrictionWarmUp, Instant};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 40 N m when the log starts, falling with a time constant of 5 s.
/// for (t, expected) in [(0.0, 40.0), (5.0, 40.0 / std::f64::consts::E)] {
///     let moving = Instant { t, qd: &[0.5], direction: &[1.0], ..at_rest };
///     let mut torque = [0.0];
///     FrictionWarmUp.torque(&[40.0, 5.0, -1.0], 0, &moving, &[], &mut torque);
///     assert!((torque[0] - expected).abs() < 1e-9);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct FrictionWarmUp;

static ABOUT: About = About {
    name: "friction_warm_up",
    equation: "tau = A exp(-t/T) sign(v)",
    explanation: "Friction is high after a standstill and falls as grease spreads and the gear warms up.",
    reference: "Simoni, Beschi, Legnani, Visioli (2017), Modelling the temperature in joint friction of industrial \
                manipulators, Robotica, doi:10.1017/S0263574717000509",
    rivals: &[
        Rival {
            name: "viscous_friction",
            how_to_tell: "a motion whose speed changes over time mimics a trend: repeat the recording at once, warm-up is gone",
        },
        Rival {
            name: "coulomb_friction",
            how_to_tell: "Coulomb friction is the same in the first and the last second",
        },
        Rival {
            name: "external_contact",
            how_to_tell: "a contact begins and ends at once and need not oppose the motion",
        },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: true,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 3] = [
    Parameter {
        name: "rise",
        symbol: "A",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 40.0,
    },
    Parameter {
        name: "time_constant",
        symbol: "T",
        unit: Unit::Time,
        role: Role::Shape,
        lower: 0.5,
        upper: 1e4,
        typical: 5.0,
    },
    // Negative: the start of every log.
    Parameter {
        name: "since",
        symbol: "t0",
        unit: Unit::Time,
        role: Role::Held,
        lower: -1.0,
        upper: f64::INFINITY,
        typical: -1.0,
    },
];

impl Effect for FrictionWarmUp {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn search(&self, index: usize) -> Search {
        match index {
            1 => Search::TimeConstant,
            2 => Search::ClockStart,
            _ => Search::Bounds,
        }
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let since = if p[2] < 0.0 { x.started } else { p[2] };
        out[joint] += p[0] * (-(x.t - since).max(0.0) / p[1]).exp() * x.direction[joint];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::{at, torque_at};

    #[test]
    fn by_hand() {
        // At t = 2 s with T = 4 s: 20 exp(-0.5) = 20 * 0.606530659713.
        let torque = torque_at(&FrictionWarmUp, &[20.0, 4.0, -1.0], 0.2, -0.5);
        assert!((torque + 12.130_613_194_26).abs() < 1e-10, "{torque}");
        let torque = torque_at(&FrictionWarmUp, &[20.0, 4.0, -1.0], 0.2, 0.5);
        assert!((torque - 12.130_613_194_26).abs() < 1e-10, "{torque}");
        assert_eq!(torque_at(&FrictionWarmUp, &[0.0, 4.0, -1.0], 0.2, 0.5), 0.0);
    }

    /// Recorders stamp by the time of the controller or of the day.
    #[test]
    fn time_counts_from_the_start_of_the_log() {
        at(0.2, 0.5, |x| {
            let at = |since: f64| {
                let mut out = [0.0];
                let now = Instant { t: 3723.0, started: 3721.0, ..*x };
                FrictionWarmUp.torque(&[20.0, 4.0, since], 0, &now, &[], &mut out);
                out[0]
            };
            assert!((at(-1.0) - 12.130_613_194_26).abs() < 1e-10, "{}", at(-1.0));
            // The clock runs on from a log that started 6 s before: 20 exp(-8/4). What is yet to start is at its full height.
            assert!((at(3715.0) - 2.706_705_664_73).abs() < 1e-10 && at(4000.0) == 20.0);
        });
    }
}
