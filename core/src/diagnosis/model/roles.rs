//! What the parameters of an effect are to a test: columns, shapes, levels, departures that bend, events.

use crate::effects::{DriveParameter, Effect, Nature, Parameter, Placed, Role, Scope, Search, Site};
use crate::robot::Robot;

/// Indices of the parameters for which there are columns: amplitudes and departures.
pub(crate) fn linear(effect: &dyn Effect) -> Vec<usize> {
    with_role(effect, |role| matches!(role, Role::Amplitude | Role::Departure))
}

/// Indices of the shapes, and of departures that are levels.
pub(crate) fn shapes(effect: &dyn Effect) -> Vec<usize> {
    let level = is_level(effect);
    with_role(effect, |role| role == Role::Shape || (level && role == Role::Departure))
}

/// Whether the departure of an effect is a level.
pub fn is_level(effect: &dyn Effect) -> bool {
    effect.about().nature == Nature::Level
}

/// Whether the torque of a departure is not straight in it: times by which signals are moved, the compliance of gears, on which links
/// swing, and their play.
pub(crate) fn bends(effect: &dyn Effect, index: usize) -> bool {
    matches!(effect.search(index), Search::Shift | Search::Compliance | Search::Gap)
}

/// Whether a departure is the play of a gear: its size decides when the teeth meet. Torque taken at the wrong moment is none of it, so that
/// the size is where the test is largest, and repeated estimates at the last estimate do not lead there.
pub(crate) fn is_gap(effect: &dyn Effect, index: usize) -> bool {
    effect.search(index) == Search::Gap
}

/// Whether the column of a parameter is taken at its estimate: that of a departure, but of levels and plays, whose sizes are looked for.
pub(crate) fn follows_estimate(effect: &dyn Effect, index: usize) -> bool {
    effect.parameters()[index].role == Role::Departure && !is_level(effect) && !is_gap(effect, index)
}

/// A value within the bounds of its parameter.
pub(crate) fn bounded(parameter: &Parameter, value: f64) -> f64 {
    value.clamp(parameter.lower, parameter.upper)
}

/// Prior standard deviations of the factors of an effect's columns; infinite where nothing is known beforehand.
pub(crate) fn prior(placed: &Placed, robot: &Robot) -> Vec<f64> {
    let own = placed.effect.prior(placed.joint, robot);
    own.unwrap_or_else(|| vec![f64::INFINITY; linear(placed.effect).len()])
}

fn with_role(effect: &dyn Effect, wanted: impl Fn(Role) -> bool) -> Vec<usize> {
    let parameters = effect.parameters().iter().enumerate();
    parameters.filter(|(_, parameter)| wanted(parameter.role)).map(|(index, _)| index).collect()
}

/// Whether the torque of an effect depends on inertias and rotors: others have the same along a motion whatever is found of these, more
/// inertia too.
pub(crate) fn acts_upon_arm(effect: &dyn Effect) -> bool {
    let about = effect.about();
    let adds_inertia = effect.is_body() || effect.of_drive() == Some(DriveParameter::Rotor);
    !adds_inertia && (about.site != Site::Joint || about.uses_acceleration)
}

/// Whether the torque of an effect at a joint depends on what changed: the torque of the arm as found on the joints `moved`, the rounding of
/// friction on those `rounded`. What acts upon the arm as a whole depends on any joint.
pub(crate) fn is_outdated(effect: &dyn Effect, joint: usize, moved: &[usize], rounded: &[usize]) -> bool {
    let is_moved = match effect.about().scope {
        Scope::Joint => moved.contains(&joint),
        Scope::Pair => moved.contains(&joint) || moved.contains(&(joint + 1)),
        Scope::Arm => !moved.is_empty(),
    };
    (acts_upon_arm(effect) && is_moved) || (effect.about().dry && rounded.contains(&joint))
}

/// Whether an effect shifts or spreads torque in time.
pub(crate) fn is_shift(effect: &dyn Effect) -> bool {
    matches!(effect.about().nature, Nature::Lag | Nature::Delay)
}

/// Time around the beginning and the end of an event in which its torque is not known, s: it may come at once or build up, and smooth
/// positions do not follow the jerk that it gives the arm.
pub(crate) const ENDS_OF_EVENT_S: f64 = 0.15;

/// Whether an effect comes and goes on its own, whatever the motion.
pub(crate) fn is_event(effect: &dyn Effect) -> bool {
    effect.about().nature == Nature::Event
}
