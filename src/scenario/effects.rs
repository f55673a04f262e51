//! `[[effect]]` tables: effects by name, joint and parameters.

use crate::effects::{self, Effect, Parameter, Placed, did_you_mean, joint};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One effect at work in the plant.
///
/// ```
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::scenario::EffectSpec;
///
/// // [[effect]] of a scenario; parameters that are left out have their typical values.
/// let arm = robot::load("urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let (name, joint) = ("stribeck_friction".to_owned(), Some("joint_2".to_owned()));
/// let spec = EffectSpec { name, joint, parameters: [("rise".to_owned(), 12.0)].into() };
/// let placed = spec.place(&arm).expect("the library has it");
/// assert_eq!((placed.joint, &placed.parameters[..]), (1, &[12.0, 0.15, 2.0][..]));
/// assert!(EffectSpec { joint: None, ..spec }.place(&arm).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EffectSpec {
    /// Name in the library; `tauscope effects` lists them.
    pub name: String,
    /// Name of the joint it acts on (the first of a pair); absent for effects on the arm as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Parameters by name; those left out are at their typical values.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
}

impl EffectSpec {
    /// The effect on its joint of `robot`.
    ///
    /// # Errors
    /// In words, for an unknown name (with the nearest there is), a joint that is missing, unknown or unwanted, and
    /// parameters that are unknown or out of bounds.
    pub fn place(&self, robot: &Robot) -> Result<Placed, String> {
        let effect = effects::find(&self.name).map_err(|e| e.to_string())?;
        let joint = joint(effect, self.joint.as_deref(), robot)?;
        let mut placed = Placed::typical(effect, joint);
        for (name, &value) in &self.parameters {
            let index = index(effect, name)?;
            check(effect, &effect.parameters()[index], value)?;
            placed.parameters[index] = value;
        }
        Ok(placed)
    }
}

fn index(effect: &dyn Effect, name: &str) -> Result<usize, String> {
    effect.parameters().iter().position(|parameter| parameter.name == name).ok_or_else(|| {
        let names: Vec<&str> = effect.parameters().iter().map(|parameter| parameter.name).collect();
        let hint = did_you_mean(name, names.iter().copied());
        format!("`{}` has no parameter `{name}`{hint} It has {}", effect.about().name, names.join(", "))
    })
}

fn check(effect: &dyn Effect, parameter: &Parameter, value: f64) -> Result<(), String> {
    if value.is_finite() && (parameter.lower..=parameter.upper).contains(&value) {
        return Ok(());
    }
    Err(format!(
        "{} of `{}` is {value}, outside {} .. {} {}",
        parameter.name,
        effect.about().name,
        parameter.lower,
        parameter.upper,
        parameter.unit
    ))
}
