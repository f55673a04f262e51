//! Torque ripple: a torque that repeats n times per turn of the joint, from motor cogging or gear meshing.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::lane::{Kernel, Lane, Lanes};
use crate::robot::Unit;

/// Ac cos(n q) + As sin(n q).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, TorqueRipple};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // Ac = 8 N m, As = 6 N m, 20 periods a turn: an amplitude of 10 N m, whatever the speed.
/// let largest = (0..1000).map(|k| {
///     let mut torque = [0.0];
///     let pose = Instant { q: &[1e-3 * f64::from(k)], ..at_rest };
///     TorqueRipple.torque(&[8.0, 6.0, 20.0], 0, &pose, &[], &mut torque);
///     torque[0]
/// });
/// assert!((largest.fold(0.0, f64::max) - 10.0).abs() < 1e-3);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct TorqueRipple;

static ABOUT: About = About {
    name: "torque_ripple",
    equation: "tau = Ac cos(n q) + As sin(n q)",
    explanation: "The torque swings with every motor turn, magnet pole or gear tooth that passes: a tone whose pitch follows \
                  the speed.",
    reference: "Ferretti, Magnani, Rocco (1998), Modeling, identification, and compensation of pulsating torque in permanent \
                magnet AC motors, IEEE Transactions on Industrial Electronics 45(6)",
    rivals: &[
        Rival {
            name: "joint_elasticity",
            how_to_tell: "a resonance stays at its frequency whatever the speed; ripple stays at its positions",
        },
        Rival {
            name: "encoder_eccentricity",
            how_to_tell: "an eccentric encoder errs once per turn and its torque error grows with acceleration",
        },
        Rival {
            name: "position_dependent_friction",
            how_to_tell: "friction flips with the direction: pass one position both ways",
        },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 3] = [
    Parameter {
        name: "cosine",
        symbol: "Ac",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical: 8.0,
    },
    Parameter {
        name: "sine",
        symbol: "As",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical: 6.0,
    },
    // Below 3 per turn it is gravity's; the fastest are the motor poles behind a gear of a few hundred to one.
    Parameter {
        name: "harmonic",
        symbol: "n",
        unit: Unit::PerTurn,
        role: Role::Shape,
        lower: 3.0,
        upper: 2000.0,
        typical: 20.0,
    },
];

impl Effect for TorqueRipple {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    /// Poles and teeth do not carry an arm.
    fn largest_share(&self) -> Option<f64> {
        Some(0.3)
    }

    fn search(&self, index: usize) -> Search {
        match index {
            2 => Search::PerTurn,
            _ => Search::Bounds,
        }
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += ripple(p, x.q[joint]);
    }

    /// A scan asks for hundreds of orders along every log.
    fn torque_at_positions(&self, p: &[f64], q: &[f64]) -> Option<Vec<f64>> {
        let mut torque = vec![0.0; q.len()];
        let largest = q.iter().fold(0.0f64, |largest, q| largest.max(q.abs()));
        Lanes::best().for_angles_to(p[2] * largest).run(AtPositions { p, q, torque: &mut torque });
        Some(torque)
    }
}

/// The law at one position, or at several side by side.
#[inline(always)]
fn ripple<L: Lane>(p: &[f64], q: L) -> L {
    let (sine, cosine) = (L::splat(p[2]) * q).sin_cos();
    L::splat(p[0]).mul_add(cosine, L::splat(p[1]) * sine)
}

/// The law at many positions.
struct AtPositions<'a> {
    p: &'a [f64],
    q: &'a [f64],
    torque: &'a mut [f64],
}

impl Kernel for AtPositions<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        for (q, torque) in self.q.chunks(L::WIDTH).zip(self.torque.chunks_mut(L::WIDTH)) {
            ripple(self.p, L::load_part(q)).store_part(torque);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // 20 q = pi/6: cosine 0.866025403784, sine 0.5, so 4 * 0.866025403784 + 6 * 0.5; the direction plays no part.
        let q = std::f64::consts::PI / 120.0;
        let torque = torque_at(&TorqueRipple, &[4.0, 6.0, 20.0], q, -0.5);
        assert!((torque - 6.464_101_615_14).abs() < 1e-10, "{torque}");
        assert_eq!(torque, torque_at(&TorqueRipple, &[4.0, 6.0, 20.0], q, 0.5));
        assert_eq!(torque_at(&TorqueRipple, &[0.0, 0.0, 20.0], q, 0.5), 0.0);
    }

    #[test]
    fn many_positions_at_once_are_one_after_the_other() {
        let p = [4.0, -6.0, 33.0];
        let q: Vec<f64> = (0..37).map(|k| 0.17 * f64::from(k) - 2.0).collect();
        let all = TorqueRipple.torque_at_positions(&p, &q).unwrap();
        let each = q.iter().map(|q| torque_at(&TorqueRipple, &p, *q, 0.5));
        assert!(all.iter().zip(each).all(|(all, one)| (all - one).abs() < 1e-13), "{all:?}");
        // Beyond the reach of the lanes' sines.
        let far = TorqueRipple.torque_at_positions(&p, &[1e5]).unwrap();
        assert_eq!(far[0], torque_at(&TorqueRipple, &p, 1e5, 0.5));
    }
}
