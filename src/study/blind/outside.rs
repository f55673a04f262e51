//! Laws that the library does not have, for runs in which no name is right.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Role, Scope, Site};
use crate::robot::Unit;
use std::f64::consts::TAU;

/// All of them.
pub static OUTSIDE: [&dyn Effect; 5] =
    [&PositionDependentDamping, &BeatingHarmonic, &HydraulicDamper, &DriftingGain, &RoughSpot];

const fn about(name: &'static str, equation: &'static str, explanation: &'static str, site: Site) -> About {
    About {
        name,
        equation,
        explanation,
        reference: "none: a law for blind runs",
        rivals: &[],
        site,
        scope: Scope::Joint,
        dry: false,
        uses_acceleration: false,
        nature: Nature::Lasting,
        hidden_by_base_parameters: Hidden::No,
    }
}

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

const fn shape(name: &'static str, unit: Unit, lower: f64, upper: f64, typical: f64) -> Parameter {
    Parameter { name, symbol: name, unit, role: Role::Shape, lower, upper, typical }
}

/// (c cos q + s sin q) v: a bearing whose grease is thicker on one side.
///
/// ```
/// use tauscope::effects::{Effect, Instant};
/// use tauscope::study::blind::outside::PositionDependentDamping;
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // c = 5 N m s/rad at q = 0, where the sine is zero.
/// let moving = Instant { qd: &[2.0], direction: &[1.0], ..at_rest };
/// let mut torque = [0.0];
/// PositionDependentDamping.torque(&[5.0, 8.0], 0, &moving, &[], &mut torque);
/// assert_eq!(torque, [10.0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct PositionDependentDamping;

static DAMPING: About = about(
    "outside_position_damping",
    "tau = (c cos q + s sin q) v",
    "Viscous friction that differs over the turn of the joint.",
    Site::Joint,
);
static DAMPING_PARAMETERS: [Parameter; 2] =
    [amplitude("cosine", Unit::Damping, 5.0), amplitude("sine", Unit::Damping, 8.0)];

impl Effect for PositionDependentDamping {
    fn about(&self) -> &'static About {
        &DAMPING
    }
    fn parameters(&self) -> &'static [Parameter] {
        &DAMPING_PARAMETERS
    }
    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += (p[0] * x.q[joint].cos() + p[1] * x.q[joint].sin()) * x.qd[joint];
    }
}

/// A cos(2 pi t / T) cos(n q): two motor harmonics close to each other.
///
/// ```
/// use tauscope::effects::{Effect, Instant};
/// use tauscope::study::blind::outside::BeatingHarmonic;
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 10 N m at the start, and gone after a quarter of the beat's period of 8 s.
/// for (t, expected) in [(0.0, 10.0), (2.0, 0.0)] {
///     let mut torque = [0.0];
///     BeatingHarmonic.torque(&[10.0, 8.0, 9.0], 0, &Instant { t, ..at_rest }, &[], &mut torque);
///     assert!((torque[0] - expected).abs() < 1e-9);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct BeatingHarmonic;

static BEATING: About = about(
    "outside_beating_harmonic",
    "tau = A cos(2 pi t / T) cos(n q)",
    "A harmonic of the motor that swells and fades in time.",
    Site::Joint,
);
static BEATING_PARAMETERS: [Parameter; 3] = [
    amplitude("amplitude", Unit::Effort, 10.0),
    shape("period", Unit::Time, 1.0, 100.0, 7.0),
    shape("harmonic", Unit::PerTurn, 1.0, 100.0, 9.0),
];

impl Effect for BeatingHarmonic {
    fn about(&self) -> &'static About {
        &BEATING
    }
    fn parameters(&self) -> &'static [Parameter] {
        &BEATING_PARAMETERS
    }
    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * (TAU * x.t / p[1]).cos() * (p[2] * x.q[joint]).cos();
    }
}

/// A damper with an orifice of its own for each direction, whose pressure follows with a lag.
///
/// ```
/// use tauscope::effects::{Effect, Instant};
/// use tauscope::study::blind::outside::HydraulicDamper;
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // Long after the start the pressure is b(v) v |v|, with an orifice of its own for each direction.
/// for (v, expected) in [(2.0, 20.0 * 4.0), (-2.0, -0.3 * 20.0 * 4.0)] {
///     let (moving, mut pressure, mut torque) = (Instant { qd: &[v], ..at_rest }, [0.0], [0.0]);
///     HydraulicDamper.advance(&[20.0, 0.3], 0, &moving, 30.0, &mut pressure);
///     HydraulicDamper.torque(&[20.0, 0.3], 0, &moving, &pressure, &mut torque);
///     assert!((torque[0] - expected).abs() < 1e-6);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct HydraulicDamper;

static HYDRAULIC: About = about(
    "outside_hydraulic_damper",
    "T dp/dt = b(v) v |v| - p; tau = A p; b = 1 forwards, 0.3 backwards",
    "A hydraulic damper: orifices that differ by direction, and oil that gives.",
    Site::Joint,
);
static HYDRAULIC_PARAMETERS: [Parameter; 2] =
    [amplitude("coefficient", Unit::QuadraticDamping, 20.0), shape("lag", Unit::Time, 0.01, 2.0, 0.3)];

impl Effect for HydraulicDamper {
    fn about(&self) -> &'static About {
        &HYDRAULIC
    }
    fn parameters(&self) -> &'static [Parameter] {
        &HYDRAULIC_PARAMETERS
    }
    fn torque(&self, p: &[f64], joint: usize, _: &Instant, memory: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * memory[0];
    }
    fn memory(&self) -> usize {
        1
    }
    fn advance(&self, p: &[f64], joint: usize, x: &Instant, dt: f64, memory: &mut [f64]) {
        let v = x.qd[joint];
        let aim = if v > 0.0 { v * v } else { -0.3 * v * v };
        memory[0] += (aim - memory[0]) * (1.0 - (-dt / p[1]).exp());
    }
}

/// The torque sensor's gain swings in time.
///
/// ```
/// use tauscope::effects::Effect;
/// use tauscope::study::blind::outside::DriftingGain;
///
/// // e = 0.1, a period of 8 s: the gain is right at 0 s, and 10 % too large at 2 s.
/// let mut logged = [100.0, 100.0, 100.0];
/// DriftingGain.distort_torque(&[0.1, 8.0], &mut logged, 1.0);
/// assert!((logged[0] - 100.0).abs() < 1e-9 && (logged[2] - 110.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct DriftingGain;

static DRIFTING: About = about(
    "outside_drifting_gain",
    "tau_log = (1 + e sin(2 pi t / T)) tau",
    "A torque sensor whose gain goes with the temperature of its amplifier.",
    Site::Sensor,
);
static DRIFTING_PARAMETERS: [Parameter; 2] = [
    Parameter {
        name: "error",
        symbol: "e",
        unit: Unit::One,
        role: Role::Departure,
        lower: -0.5,
        upper: 0.5,
        typical: 0.02,
    },
    shape("period", Unit::Time, 1.0, 100.0, 9.0),
];

impl Effect for DriftingGain {
    fn about(&self) -> &'static About {
        &DRIFTING
    }
    fn parameters(&self) -> &'static [Parameter] {
        &DRIFTING_PARAMETERS
    }
    fn distort_torque(&self, p: &[f64], signal: &mut [f64], period: f64) {
        for (sample, value) in signal.iter_mut().enumerate() {
            *value *= 1.0 + p[0] * (TAU * sample as f64 * period / p[1]).sin();
        }
    }
}

/// Friction at one place of the turn: a dented race, a damaged tooth.
///
/// ```
/// use tauscope::effects::{Effect, Instant};
/// use tauscope::study::blind::outside::RoughSpot;
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 20 N m at 0.15 rad, next to nothing three widths away.
/// for (q, expected) in [(0.15, 20.0), (0.45, 0.0)] {
///     let moving = Instant { q: &[q], qd: &[1.0], direction: &[1.0], ..at_rest };
///     let mut torque = [0.0];
///     RoughSpot.torque(&[20.0, 0.15, 0.1], 0, &moving, &[], &mut torque);
///     assert!((torque[0] - expected).abs() < 0.01);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct RoughSpot;

static ROUGH: About = About {
    dry: true,
    ..about(
        "outside_rough_spot",
        "tau = A exp(-((q - q0) / w)^2) sign(v)",
        "Friction at one place of the turn: a dented race or a damaged tooth.",
        Site::Joint,
    )
};
static ROUGH_PARAMETERS: [Parameter; 3] = [
    Parameter {
        name: "rise",
        symbol: "A",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 20.0,
    },
    shape("place", Unit::Position, -3.0, 3.0, 0.15),
    shape("width", Unit::Position, 0.01, 1.0, 0.1),
];

impl Effect for RoughSpot {
    fn about(&self) -> &'static About {
        &ROUGH
    }
    fn parameters(&self) -> &'static [Parameter] {
        &ROUGH_PARAMETERS
    }
    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let away = (x.q[joint] - p[1]) / p[2];
        out[joint] += p[0] * (-away * away).exp() * x.direction[joint];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_has_a_size() {
        for effect in OUTSIDE {
            assert!(effect.parameters().iter().any(|parameter| parameter.role != Role::Shape));
        }
    }

    #[test]
    fn the_damper_lags_and_settles() {
        let law = HydraulicDamper;
        let mut memory = [0.0];
        let robot = crate::robot::load(
            concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf"),
            crate::robot::InertiaCheck::Required,
        )
        .unwrap();
        let (chain, zeros) = (crate::dynamics::Chain::new(&robot), [0.0; 6]);
        let qd = [2.0; 6];
        let x = Instant {
            t: 0.0,
            started: 0.0,
            q: &zeros,
            qd: &qd,
            qdd: &zeros,
            direction: &zeros,
            load: &zeros,
            robot: &robot,
            chain: &chain,
            frames: None,
        };
        law.advance(&[1.0, 0.5], 0, &x, 0.5, &mut memory);
        assert!((memory[0] - 4.0 * (1.0 - (-1.0f64).exp())).abs() < 1e-12, "{memory:?}");
        law.advance(&[1.0, 0.5], 0, &x, 50.0, &mut memory);
        assert!((memory[0] - 4.0).abs() < 1e-12);
    }
}
