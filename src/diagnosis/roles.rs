//! What the parameters of an effect are to a test: columns, shapes, levels, departures that bend, events.

use crate::effects::{Effect, Role, Site};

/// Effects whose departure is a level: absent at zero, smaller the higher it is.
const LEVELS: [&str; 1] = ["torque_saturation"];

/// Effects that come from outside.
const EVENTS: [&str; 1] = ["external_contact"];

/// Effects that low-pass the torque.
const LAGS: [&str; 1] = ["torque_lag"];

/// Sizes of departures of which the torque is not linear, as multiples of the typical one: of times, and of the compliance of
/// gears, which reaches from those of the base to those of a hand.
const TIMES: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
const COMPLIANCES: [f64; 6] = [0.25, 1.0, 4.0, 16.0, 64.0, 250.0];
const COMPLIANCE: &str = "rad/(N m)";

/// Indices of the parameters for which there are columns: amplitudes and departures.
pub fn linear(effect: &dyn Effect) -> Vec<usize> {
    with_role(effect, |role| matches!(role, Role::Amplitude | Role::Departure))
}

/// Indices of the shapes, and of departures that are levels.
pub fn shapes(effect: &dyn Effect) -> Vec<usize> {
    let level = is_level(effect);
    with_role(effect, |role| role == Role::Shape || (level && role == Role::Departure))
}

/// Whether the departure of an effect is a level.
pub fn is_level(effect: &dyn Effect) -> bool {
    LEVELS.contains(&effect.about().name)
}

/// Whether the torque of a departure is not straight in it: times by which signals are moved, and the compliance of gears, on
/// which links swing.
pub fn bends(effect: &dyn Effect, index: usize) -> bool {
    let parameter = &effect.parameters()[index];
    parameter.role == Role::Departure && ["s", COMPLIANCE].contains(&parameter.unit)
}

/// Sizes at which the columns of a departure that bends are taken, without signs.
pub fn sizes(effect: &dyn Effect, index: usize) -> Vec<f64> {
    let parameter = &effect.parameters()[index];
    let multiples = if parameter.unit == COMPLIANCE { COMPLIANCES.as_slice() } else { TIMES.as_slice() };
    multiples.iter().map(|multiple| multiple * parameter.typical.abs()).collect()
}

/// Size below which the torque of a departure that bends is as good as straight in it.
pub fn straight_below(effect: &dyn Effect, index: usize) -> f64 {
    sizes(effect, index)[0]
}

fn with_role(effect: &dyn Effect, wanted: impl Fn(Role) -> bool) -> Vec<usize> {
    let parameters = effect.parameters().iter().enumerate();
    parameters.filter(|(_, parameter)| wanted(parameter.role)).map(|(index, _)| index).collect()
}

/// Whether an effect low-passes the torque, of which its column is the derivative.
pub fn is_lag(effect: &dyn Effect) -> bool {
    LAGS.contains(&effect.about().name)
}

/// Whether the torque of an effect depends on inertias and rotors: others have the same along a motion whatever is found of these.
pub fn acts_upon_arm(effect: &dyn Effect) -> bool {
    let about = effect.about();
    about.site != Site::Joint || about.uses_acceleration
}

/// Whether an effect comes and goes on its own, whatever the motion.
pub fn is_event(effect: &dyn Effect) -> bool {
    EVENTS.contains(&effect.about().name)
}
