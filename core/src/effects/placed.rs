//! An effect on a joint, with its parameters.

use super::about::{Role, Scope};
use super::law::Effect;
use crate::robot::Robot;
use serde::ser::{Serialize, SerializeStruct, Serializer};
use std::collections::BTreeMap;

/// An effect at work on a joint, with its parameters.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Placed, StribeckFriction};
///
/// let placed = Placed::typical(&StribeckFriction, 1);
/// assert_eq!((placed.joints(), &placed.parameters[..]), (vec![1], &[25.0, 0.15, 2.0][..]));
///
/// // Without the rise the effect is not there, whatever its shape.
/// assert_eq!(placed.absent().parameters, [0.0, 0.15, 2.0]);
///
/// let json = serde_json::to_value(&placed).expect("it has a JSON form");
/// assert_eq!((&json["effect"], &json["joint"]), (&"stribeck_friction".into(), &1.into()));
/// assert_eq!(json["parameters"][placed.effect.parameters()[0].name], 25.0);
/// ```
#[derive(Clone)]
pub struct Placed {
    /// The law.
    pub effect: &'static dyn Effect,
    /// The joint (the first of a pair; zero for the whole arm).
    pub joint: usize,
    /// Its parameters, in the order of [`Effect::parameters`].
    pub parameters: Vec<f64>,
}

/// Its name, the index of its joint, and its parameters by name.
impl Serialize for Placed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let names = self.effect.parameters().iter().map(|parameter| parameter.name);
        let parameters: BTreeMap<&str, f64> = names.zip(self.parameters.iter().copied()).collect();
        let mut placed = serializer.serialize_struct("Placed", 3)?;
        placed.serialize_field("effect", self.effect.about().name)?;
        placed.serialize_field("joint", &self.joint)?;
        placed.serialize_field("parameters", &parameters)?;
        placed.end()
    }
}

/// The joint that an effect acts on, by its name: the first of a pair; zero, without a name, for the arm as a whole.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{self, Payload, StribeckFriction};
/// use tauscope::robot::{self, InertiaCheck};
///
/// let arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// assert_eq!(effects::joint(&StribeckFriction, Some("joint_2"), &arm), Ok(1));
/// assert_eq!(effects::joint(&Payload, None, &arm), Ok(0));
/// assert!(effects::joint(&StribeckFriction, None, &arm).is_err_and(|problem| problem.contains("name one of joint_1")));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
///
/// # Errors
/// In words, for a joint that is missing, unknown or unwanted.
pub fn joint(effect: &dyn Effect, name: Option<&str>, robot: &Robot) -> Result<usize, String> {
    let about = effect.about();
    match (about.scope, name) {
        (Scope::Arm, None) => Ok(0),
        (Scope::Arm, Some(name)) => {
            Err(format!("`{}` acts on the arm as a whole; leave out joint `{name}`", about.name))
        }
        (_, None) => Err(format!("`{}` acts on a joint; name one of {}", about.name, robot.joint_names().join(", "))),
        (scope, Some(name)) => {
            let joint = robot.joint_index(name).map_err(|e| e.to_string())?;
            if scope == Scope::Pair && joint + 1 == robot.dof() {
                return Err(format!("`{}` acts on a joint and the one after it; `{name}` is the last", about.name));
            }
            Ok(joint)
        }
    }
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

    /// Index of the parameter by which it grows from nothing: its first amplitude or departure.
    ///
    /// ```
    /// # extern crate tauscope_core as tauscope;
    /// use tauscope::effects::{Placed, StribeckFriction};
    ///
    /// let placed = Placed::typical(&StribeckFriction, 1);
    /// assert_eq!((placed.amount_index(), placed.amount()), (0, 25.0));
    /// ```
    pub fn amount_index(&self) -> usize {
        let is_amount = |role: Role| matches!(role, Role::Amplitude | Role::Departure);
        self.effect.parameters().iter().position(|parameter| is_amount(parameter.role)).unwrap_or(0)
    }

    /// Value of the parameter by which it grows from nothing.
    pub fn amount(&self) -> f64 {
        self.parameters[self.amount_index()]
    }

    /// Unit of its parameter `index` on the joint of `robot` that it is placed on.
    pub fn unit(&self, index: usize, robot: &Robot) -> &'static str {
        robot.joints[self.joint].kind.unit(self.effect.parameters()[index].unit)
    }

    /// The joints it is placed on; none for the whole arm.
    pub fn joints(&self) -> Vec<usize> {
        match self.effect.about().scope {
            Scope::Joint => vec![self.joint],
            Scope::Pair => vec![self.joint, self.joint + 1],
            Scope::Arm => Vec::new(),
        }
    }

    /// The joints, of `dof`, whose sensors it may distort.
    #[doc(hidden)]
    pub fn sensed(&self, dof: usize) -> Vec<usize> {
        if self.effect.about().scope == Scope::Arm { (0..dof).collect() } else { self.joints() }
    }
}

impl PartialEq for Placed {
    fn eq(&self, other: &Self) -> bool {
        let own = |placed: &Placed| (placed.effect.about().name, placed.joint);
        own(self) == own(other) && self.parameters == other.parameters
    }
}

impl std::fmt::Debug for Placed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} on {}: {:?}", self.effect.about().name, self.joint, self.parameters)
    }
}
