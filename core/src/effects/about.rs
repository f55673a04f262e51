//! The entry of an effect in the catalogue: what it is, where it acts, its parameters, its rivals.

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

impl Scope {
    /// Places on an arm of so many joints: the joint, the first of a pair, zero for the whole arm.
    pub fn places(self, dof: usize) -> std::ops::Range<usize> {
        match self {
            Scope::Joint => 0..dof,
            Scope::Pair => 0..dof.saturating_sub(1),
            Scope::Arm => 0..1,
        }
    }
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
    /// Whether its torque depends on [`Instant::qdd`](super::Instant::qdd) or [`Instant::load`](super::Instant::load).
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
