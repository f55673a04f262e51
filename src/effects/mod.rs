//! Physical effects: each law is written once, in one file, and serves the plant, the identification model, the diagnosis,
//! the report and the catalogue.
//!
//! An effect acts at one or more places: on the robot's bodies ([`Effect::alter`]), as a torque at the joints
//! ([`Effect::torque`]), inside the gear ([`Effect::gear`]), or in the sensors ([`Effect::distort_torque`],
//! [`Effect::distort_position`]). Its parameters play one of four roles ([`Role`]).
//!
//! Sign convention: an effect's torque is what the motor must add because of it. Positions, velocities and accelerations
//! are the motor's, seen at the joint side of the gear.

mod along;
mod backlash;
mod base_tilt;
mod catalogue;
mod coulomb_friction;
mod drives;
mod encoder_eccentricity;
mod encoder_offset;
mod external_contact;
mod friction_asymmetry;
mod friction_warm_up;
mod gear;
mod gravity_balancer;
mod integration_error;
mod joint_coupling;
mod joint_elasticity;
mod joint_spring;
mod link_inertia_error;
mod load_dependent_friction;
mod nonlinear_viscous_friction;
mod payload;
mod position_dependent_friction;
mod presliding_hysteresis;
mod rotor_inertia;
mod stribeck_friction;
#[cfg(test)]
mod testing;
mod time_delay;
mod torque_gain;
mod torque_lag;
mod torque_offset;
mod torque_ripple;
mod torque_saturation;
mod viscous_friction;

pub use along::{Along, contribution, contributions, direction};
pub use backlash::Backlash;
pub use base_tilt::BaseTilt;
pub use catalogue::{LIBRARY, find};
pub use coulomb_friction::CoulombFriction;
pub use drives::drive_friction;
pub use encoder_eccentricity::EncoderEccentricity;
pub use encoder_offset::EncoderOffset;
pub use external_contact::ExternalContact;
pub use friction_asymmetry::FrictionAsymmetry;
pub use friction_warm_up::FrictionWarmUp;
pub use gear::{DAMPING_TIME_S, Gear};
pub use gravity_balancer::GravityBalancer;
pub use integration_error::IntegrationError;
pub use joint_coupling::JointCoupling;
pub use joint_elasticity::JointElasticity;
pub use joint_spring::JointSpring;
pub use link_inertia_error::LinkInertiaError;
pub use load_dependent_friction::LoadDependentFriction;
pub use nonlinear_viscous_friction::NonlinearViscousFriction;
pub use payload::Payload;
pub(crate) use payload::seen_from_parent;
pub use position_dependent_friction::PositionDependentFriction;
pub use presliding_hysteresis::PreslidingHysteresis;
pub use rotor_inertia::RotorInertia;
pub use stribeck_friction::StribeckFriction;
pub use time_delay::TimeDelay;
pub use torque_gain::TorqueGain;
pub use torque_lag::TorqueLag;
pub use torque_offset::TorqueOffset;
pub use torque_ripple::TorqueRipple;
pub use torque_saturation::TorqueSaturation;
pub use viscous_friction::ViscousFriction;

use crate::dynamics::Chain;
use crate::robot::{Pose, Robot};

/// Where an effect can be placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    /// On one joint (or the link it carries).
    Joint,
    /// On a joint and the one after it.
    Pair,
    /// On the arm as a whole.
    Arm,
}

/// Where an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Site {
    /// On masses, inertias or gravity.
    Body,
    /// As torque at the joints.
    Joint,
    /// Between motor and link.
    Gear,
    /// In what is logged.
    Sensor,
    /// In the simulation itself.
    Integrator,
}

/// How a parameter enters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Torque is linear in it; zero means absent.
    Amplitude,
    /// Not linear; zero means absent (a delay, a compliance, an offset of an encoder).
    Departure,
    /// Not linear, and without meaning while all amplitudes are zero (a Stribeck velocity, a time constant).
    Shape,
    /// A constant of the law that fits leave at its default.
    Held,
}

/// One parameter of an effect.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Name in scenarios and results: "rise".
    pub name: &'static str,
    /// Symbol in equations: "Fs - Fc".
    pub symbol: &'static str,
    /// Unit on a revolute joint.
    pub unit: &'static str,
    /// How it enters.
    pub role: Role,
    /// Smallest value that makes sense.
    pub lower: f64,
    /// Largest value that makes sense.
    pub upper: f64,
    /// A typical size on an industrial arm: start of fits, and default where the scenario gives none.
    pub typical: f64,
}

/// Entry of an effect in the catalogue.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct About {
    /// Its name in scenarios, results and tests; also its file's.
    pub name: &'static str,
    /// Its law as a formula.
    pub equation: &'static str,
    /// A sentence a practitioner understands.
    pub explanation: &'static str,
    /// The paper or book the law comes from.
    pub reference: &'static str,
    /// Similar effects, each with how to separate them.
    pub rivals: &'static [Rival],
    /// Where it acts.
    pub site: Site,
    /// Where it can be placed.
    pub scope: Scope,
    /// Whether its torque jumps with the direction of motion at its joint, so that the joint can stick.
    pub dry: bool,
    /// Whether its torque depends on [`Instant::qdd`] or [`Instant::load`].
    pub uses_acceleration: bool,
    /// What sets it apart from most laws when it is looked for in logs.
    pub nature: Nature,
    /// What re-identified inertial parameters hide of it: that shows only against trusted inertias or a reference log.
    pub hidden_by_base_parameters: Hidden,
}

/// What sets a law apart when it is looked for in logs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Nature {
    /// Nothing: it is there throughout, and follows from the motion by its law.
    Lasting,
    /// Every model of an arm has it.
    Baseline,
    /// Friction that depends on its joint's speed alone: books write such curves in many forms.
    OfSpeed,
    /// Friction that shows after reversals alone.
    AfterReversals,
    /// A gear with backlash: its impacts show it.
    Play,
    /// It looks like play of the same gear, but for the impacts.
    LikePlay,
    /// Torque is cut off at a level: absent at zero, and smaller the higher it is.
    Level,
    /// A low-pass of the torque, of which its column is the derivative.
    Lag,
    /// All torques are moved in time.
    Delay,
    /// It comes and goes on its own, whatever the motion.
    Event,
}

/// What base parameters take of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Hidden {
    /// Nothing but by chance.
    No,
    /// A part, as of a sensor's error: a test shows how much remains.
    InPart,
    /// All of it.
    Wholly,
}

/// An effect easily taken for another.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Rival {
    /// The other effect.
    pub name: &'static str,
    /// What separates them.
    pub how_to_tell: &'static str,
}

/// The state of the arm at one instant, as a law sees it. All slices have one entry per joint.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// Time, s.
    pub t: f64,
    /// Positions.
    pub q: &'a [f64],
    /// Velocities.
    pub qd: &'a [f64],
    /// Accelerations.
    pub qdd: &'a [f64],
    /// Direction of motion in -1 ..= 1: the sign of the velocity, or of the imminent motion at standstill.
    pub direction: &'a [f64],
    /// Torque that the gear passes on to the rigid bodies: inverse dynamics without rotor and friction.
    pub load: &'a [f64],
    /// The arm as it is known.
    pub robot: &'a Robot,
    /// Its geometry, for laws that need kinematics or inverse dynamics.
    pub chain: &'a Chain,
    /// Poses of its joint frames and flange ([`Robot::frames`]), where they are known already.
    pub frames: Option<&'a [Pose]>,
}

/// A physical law.
///
/// `p` holds its parameters in the order of [`Effect::parameters`]; `joint` is where it is placed (the first of a pair;
/// zero for the whole arm).
pub trait Effect: Sync {
    /// Its entry in the catalogue.
    fn about(&self) -> &'static About;

    /// Its parameters.
    fn parameters(&self) -> &'static [Parameter];

    /// Changes masses, inertias, rotor or gravity.
    fn alter(&self, p: &[f64], joint: usize, robot: &mut Robot) {
        let _ = (p, joint, robot);
    }

    /// Adds the torque that the motors must deliver because of it to `out`, one entry per joint. `memory` is the law's own state.
    fn torque(&self, p: &[f64], joint: usize, x: &Instant, memory: &[f64], out: &mut [f64]) {
        let _ = (p, joint, x, memory, out);
    }

    /// Whether its torque takes the poses of the joint frames.
    fn uses_frames(&self) -> bool {
        false
    }

    /// Times between which it has torque, s.
    fn acts_between(&self, p: &[f64]) -> [f64; 2] {
        let _ = p;
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    /// Number of values the law remembers from one instant to the next; zero at the start.
    fn memory(&self) -> usize {
        0
    }

    /// Carries the memory over `dt` seconds during which the arm is as `x` on average.
    fn advance(&self, p: &[f64], joint: usize, x: &Instant, dt: f64, memory: &mut [f64]) {
        let _ = (p, joint, x, dt, memory);
    }

    /// The gear between motor and link, where the effect is in the gear.
    fn gear(&self, p: &[f64]) -> Option<Gear> {
        let _ = p;
        None
    }

    /// Changes the logged torque of its joint; `period` is the time between samples, s.
    fn distort_torque(&self, p: &[f64], signal: &mut [f64], period: f64) {
        let _ = (p, signal, period);
    }

    /// Changes the logged position of its joint.
    fn distort_position(&self, p: &[f64], signal: &mut [f64]) {
        let _ = (p, signal);
    }
}

/// An effect at work on a joint, with its parameters.
#[derive(Clone)]
pub struct Placed {
    /// The law.
    pub effect: &'static dyn Effect,
    /// The joint (the first of a pair; zero for the whole arm).
    pub joint: usize,
    /// Its parameters, in the order of [`Effect::parameters`].
    pub parameters: Vec<f64>,
}

impl Placed {
    /// `effect` on `joint` with its typical parameters.
    pub fn typical(effect: &'static dyn Effect, joint: usize) -> Self {
        Placed { effect, joint, parameters: effect.parameters().iter().map(|p| p.typical).collect() }
    }

    /// The same effect with every amplitude and departure at zero: absent.
    pub fn absent(&self) -> Self {
        let parameters = self.effect.parameters().iter().zip(&self.parameters);
        let parameters = parameters
            .map(|(parameter, &value)| match parameter.role {
                Role::Amplitude | Role::Departure => 0.0,
                Role::Shape | Role::Held => value,
            })
            .collect();
        Placed { parameters, ..self.clone() }
    }

    /// Unit of its parameter `index` on the joint of `robot` that it is placed on. What belongs to a body or to the whole arm
    /// has the same unit on every joint.
    pub fn unit(&self, index: usize, robot: &Robot) -> &'static str {
        let unit = self.effect.parameters()[index].unit;
        let about = self.effect.about();
        match about.site == Site::Body || about.scope == Scope::Arm {
            true => unit,
            false => robot.joints[self.joint].kind.unit(unit),
        }
    }

    /// The joints it is placed on; none for the whole arm.
    pub fn joints(&self) -> Vec<usize> {
        match self.effect.about().scope {
            Scope::Joint => vec![self.joint],
            Scope::Pair => vec![self.joint, self.joint + 1],
            Scope::Arm => Vec::new(),
        }
    }
}

impl std::fmt::Debug for Placed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} on {}: {:?}", self.effect.about().name, self.joint, self.parameters)
    }
}
