//! Effects that are to be fitted, as users name them.

use crate::effects::{self, Placed, Scope};
use crate::error::{Error, Result};
use crate::identification::model::Model;
use crate::robot::Robot;

/// An effect to fit together with the arm's parameters: `NAME` or `NAME:JOINT` of the library, which without a joint is on every joint,
/// or a law at a place.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Placed, StribeckFriction};
/// use tauscope::identification::Wanted;
/// use tauscope::robot::{self, InertiaCheck};
///
/// let arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// assert!(Wanted::from("stribeck_friction:joint_2").check(&arm).is_ok());
/// assert!(Wanted::from(Placed::typical(&StribeckFriction, 1)).check(&arm).is_ok());
///
/// let refused = Wanted::from("stribeck_friction:elbow").check(&arm).unwrap_err();
/// assert!(refused.to_string().contains("its joints are joint_1"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Wanted(Named);

#[derive(Debug, Clone)]
enum Named {
    Text(String),
    Law(Placed),
}

impl From<&str> for Wanted {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<&String> for Wanted {
    fn from(text: &String) -> Self {
        text.clone().into()
    }
}

impl From<String> for Wanted {
    fn from(text: String) -> Self {
        Wanted(Named::Text(text))
    }
}

impl From<Placed> for Wanted {
    fn from(placed: Placed) -> Self {
        Wanted(Named::Law(placed))
    }
}

impl Wanted {
    /// Refuses an effect that the library or the robot does not have.
    ///
    /// # Errors
    /// An unknown effect or joint, a joint that is missing or unwanted, and another number of parameters than the law has.
    pub fn check(&self, robot: &Robot) -> Result<()> {
        self.placed(robot, None).map(drop)
    }

    /// The effect on its joints; joints of `model` without an equation are skipped where no joint is named.
    ///
    /// # Errors
    /// Those of [`Wanted::check`], and a joint without an equation that is named.
    pub(crate) fn placed(&self, robot: &Robot, model: Option<&Model>) -> Result<Vec<Placed>> {
        let is_seen = |joint: &usize| model.is_none_or(|model| model.has_equation(*joint));
        let refused = |subject: &str, scope: Scope, joint: usize| {
            let is_joint = matches!(scope, Scope::Joint | Scope::Pair);
            (is_joint && !is_seen(&joint)).then(|| {
                let problem = "the logs have no torque of this joint, or it hardly moves; leave the effect out";
                Error::request(subject, problem)
            })
        };
        let text = match &self.0 {
            Named::Text(text) => text.as_str(),
            Named::Law(placed) => {
                let about = placed.effect.about();
                let (given, wanted) = (placed.parameters.len(), placed.effect.parameters().len());
                if given != wanted {
                    return Err(Error::request(about.name, format!("has {given} parameters; {wanted} are wanted")));
                }
                let last = robot.dof() - usize::from(about.scope == Scope::Pair);
                if placed.joint >= last {
                    let problem = format!("is on joint {}; its joint is one of 0 to {}", placed.joint, last - 1);
                    return Err(Error::request(about.name, problem));
                }
                return refused(about.name, about.scope, placed.joint).map_or_else(|| Ok(vec![placed.clone()]), Err);
            }
        };
        let (name, joint) = text.split_once(':').map_or((text, None), |(name, joint)| (name, Some(joint)));
        let effect = effects::find(name)?;
        let spots = match (effect.about().scope, joint) {
            (Scope::Joint, None) => (0..robot.dof()).filter(is_seen).collect(),
            (Scope::Pair, None) => {
                (0..robot.dof().saturating_sub(1)).filter(|joint| is_seen(joint) && is_seen(&(joint + 1))).collect()
            }
            (scope, _) => {
                let joint = effects::joint(effect, joint, robot).map_err(|problem| Error::request(text, problem))?;
                if let Some(refused) = refused(text, scope, joint) {
                    return Err(refused);
                }
                vec![joint]
            }
        };
        Ok(spots.into_iter().map(|joint| Placed::typical(effect, joint)).collect())
    }

    /// Whether an effect is here because it was asked for on all joints.
    fn is_on_all(&self, placed: &Placed) -> bool {
        let about = placed.effect.about();
        about.scope == Scope::Joint && matches!(&self.0, Named::Text(text) if text == about.name)
    }
}

/// All that is wanted, on its joints.
///
/// # Errors
/// Those of [`Wanted::check`], and a joint without an equation that is named.
pub(super) fn placed(wanted: &[Wanted], robot: &Robot, model: &Model) -> Result<Vec<Placed>> {
    let each = wanted.iter().map(|one| one.placed(robot, Some(model))).collect::<Result<Vec<_>>>()?;
    Ok(each.concat())
}

/// The effects that the logs separate on a joint by itself, of those that they do not separate together, with a note on the others, which
/// were asked for on no joint by name. None where that changes nothing.
pub(super) fn separable(
    wanted: &[Wanted],
    placed: Vec<Placed>,
    robot: &Robot,
    alone: impl Fn(&Placed) -> bool,
) -> Option<(Vec<Placed>, String)> {
    let on_all = |placed: &Placed| wanted.iter().any(|wanted| wanted.is_on_all(placed));
    let (kept, left): (Vec<Placed>, Vec<Placed>) = placed.into_iter().partition(|own| !on_all(own) || alone(own));
    if left.is_empty() || kept.is_empty() {
        return None;
    }
    let name = |own: &Placed| format!("{} of {}", own.effect.about().name, robot.joints[own.joint].name);
    let names = left.iter().map(name).collect::<Vec<_>>().join(", ");
    Some((kept, format!("{names}: left out, since the logs do not separate it from the arm's parameters")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{JointCoupling, StribeckFriction};
    use crate::robot::{self, InertiaCheck};

    fn irb() -> Robot {
        robot::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required).unwrap()
    }

    #[test]
    fn joints_on_which_an_effect_is_not_separable_are_left_out_unless_they_were_named() {
        let robot = irb();
        let wanted = |text: &str| vec![Wanted::from(text)];
        let all = || wanted("torque_offset")[0].placed(&robot, None).unwrap();
        let (kept, note) = separable(&wanted("torque_offset"), all(), &robot, |placed| placed.joint != 2).unwrap();
        assert_eq!(kept.iter().map(|placed| placed.joint).collect::<Vec<_>>(), [0, 1, 3, 4, 5]);
        assert!(note.starts_with(&format!("torque_offset of {}: left out", robot.joints[2].name)), "{note}");
        // Nothing is left, nothing is left out, or the joint was asked for.
        assert!(separable(&wanted("torque_offset"), all(), &robot, |_| false).is_none());
        assert!(separable(&wanted("torque_offset"), all(), &robot, |_| true).is_none());
        let named = wanted(&format!("torque_offset:{}", robot.joints[2].name));
        let placed = named[0].placed(&robot, None).unwrap();
        assert!(separable(&named, placed, &robot, |_| false).is_none());
    }

    #[test]
    fn effects_that_do_not_fit_the_robot_or_the_logs_are_refused() {
        let robot = irb();
        let unseen = Model::with_equations(&robot, &[true, true, false, true, true, true]);
        let refused = |wanted: Wanted| placed(&[wanted], &robot, &unseen).unwrap_err().to_string();
        let law = |joint: usize, parameters: usize| {
            Wanted::from(Placed { effect: &StribeckFriction, joint, parameters: vec![0.1; parameters] })
        };
        for (wanted, expected) in [
            ("stribeck_fricton".into(), "did you mean `stribeck_friction`?"),
            ("torque_offset:elbow".into(), "its joints are joint_1"),
            ("torque_offset:joint_3".into(), "torque_offset:joint_3: the logs have no torque of this joint"),
            (law(2, 3), "stribeck_friction: the logs have no torque of this joint"),
            (law(6, 3), "stribeck_friction: is on joint 6; its joint is one of 0 to 5"),
            (law(0, 1), "stribeck_friction: has 1 parameters; 3 are wanted"),
            (Placed::typical(&JointCoupling, 5).into(), "joint_coupling: is on joint 5; its joint is one of 0 to 4"),
        ] {
            let message = refused(wanted);
            assert!(message.contains(expected), "{message}");
        }
        // On every joint with an equation where none is named.
        let all = placed(&["torque_offset".into()], &robot, &unseen).unwrap();
        assert_eq!(all.iter().map(|placed| placed.joint).collect::<Vec<_>>(), [0, 1, 3, 4, 5]);
    }
}
