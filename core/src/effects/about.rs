//! The entry of an effect in the catalogue: what it is, where it acts, its parameters, its rivals.

use crate::robot::Unit;

/// Where an effect can be placed.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{self, Scope};
///
/// // Coupling is between a joint and the next one: on six joints there are five places for it.
/// let scope = effects::find("joint_coupling")?.about().scope;
/// assert_eq!(scope, Scope::Pair);
/// assert_eq!(scope.places(6), 0..5);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{LIBRARY, Site};
///
/// // Effects that no change of the arm brings about, only one of what is logged.
/// let sensors = LIBRARY.iter().filter(|effect| effect.about().site == Site::Sensor);
/// let names: Vec<&str> = sensors.map(|effect| effect.about().name).collect();
/// assert!(names.contains(&"torque_gain") && names.contains(&"encoder_offset"));
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{self, Role};
///
/// // tau = (Fs - Fc) exp(-(|v|/vs)^delta) sign(v): linear in the rise; vs is searched; delta is one of two forms.
/// let law = effects::find("stribeck_friction")?;
/// let roles: Vec<Role> = law.parameters().iter().map(|parameter| parameter.role).collect();
/// assert_eq!(roles, [Role::Amplitude, Role::Shape, Role::Held]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects;
///
/// let parameter = &effects::find("backlash")?.parameters()[0];
/// assert_eq!((parameter.name, parameter.symbol, parameter.unit.name()), ("half_gap", "b", "rad"));
/// assert!((parameter.lower..=parameter.upper).contains(&parameter.typical));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Name in scenarios and results: "rise".
    pub name: &'static str,
    /// Symbol in equations: "Fs - Fc".
    pub symbol: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// How it enters.
    pub role: Role,
    /// Smallest value that makes sense.
    pub lower: f64,
    /// Largest value that makes sense.
    pub upper: f64,
    /// A typical size on an industrial arm: start of fits, and default where the scenario gives none.
    pub typical: f64,
}

impl Parameter {
    /// Whether it is an amplitude that has one sign only, and `value` has the other.
    pub(crate) fn has_wrong_sign(&self, value: f64) -> bool {
        let is_below = self.lower == 0.0 && value < 0.0;
        let is_above = self.upper == 0.0 && value > 0.0;
        self.role == Role::Amplitude && (is_below || is_above)
    }
}

/// Entry of an effect in the catalogue.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{self, Scope, Site};
///
/// let about = effects::find("coulomb_friction")?.about();
/// assert_eq!(about.equation, "tau = Fc sign(v); |tau| <= Fc at standstill");
/// assert_eq!((about.site, about.scope, about.dry), (Site::Joint, Scope::Joint, true));
///
/// // A misspelt name gets a hint.
/// let refused = effects::find("colomb_friction").err().expect("there is none");
/// assert!(refused.to_string().contains("did you mean `coulomb_friction`?"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
    /// Whether its torque jumps with the direction of motion at its joint, so that the joint can stick. No other law may ask for
    /// [`Instant::direction`](super::Instant::direction).
    pub dry: bool,
    /// Whether its torque depends on [`Instant::qdd`](super::Instant::qdd) or [`Instant::load`](super::Instant::load); no other law
    /// may ask for the load.
    pub uses_acceleration: bool,
    /// What sets it apart from most laws when it is looked for in logs.
    pub nature: Nature,
    /// What re-identified inertial parameters hide of it: that shows only against trusted inertias or a reference log.
    pub hidden_by_base_parameters: Hidden,
}

/// What sets a law apart when it is looked for in logs.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{LIBRARY, Nature};
///
/// // What every model of an arm has, and what comes and goes on its own.
/// let of = |nature| LIBRARY.iter().filter(move |law| law.about().nature == nature).map(|law| law.about().name);
/// assert!(of(Nature::Baseline).eq(["coulomb_friction", "rotor_inertia", "viscous_friction"]));
/// assert!(of(Nature::Event).eq(["external_contact"]));
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{self, Hidden};
///
/// // Identified inertias take up a payload altogether: it shows only against trusted inertias or a reference log.
/// assert_eq!(effects::find("payload")?.about().hidden_by_base_parameters, Hidden::Wholly);
/// assert_eq!(effects::find("backlash")?.about().hidden_by_base_parameters, Hidden::No);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects;
///
/// // What is easily taken for backlash, and what separates the two.
/// let rival = effects::find("backlash")?.about().rivals[0];
/// assert_eq!(rival.name, "joint_elasticity");
/// assert!(rival.how_to_tell.starts_with("elasticity moves the link in proportion to the load"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Rival {
    /// The other effect.
    pub name: &'static str,
    /// What separates them.
    pub how_to_tell: &'static str,
}
