//! What the parameters of an effect are to a test: columns, shapes, levels, departures that bend, events.

use crate::effects::{Effect, Role, Site};

/// Effects whose departure is a level: absent at zero, smaller the higher it is.
const LEVELS: [&str; 1] = ["torque_saturation"];

/// Effects that come from outside.
const EVENTS: [&str; 1] = ["external_contact"];

/// Effects that low-pass the torque.
const LAGS: [&str; 1] = ["torque_lag"];

/// Unit of the compliance of gears.
pub const COMPLIANCE: &str = "rad/(N m)";

/// Effects that move all torques in time.
const DELAYS: [&str; 1] = ["time_delay"];

/// Effects that are functions of their joint's speed alone, as different books write them.
const SPEED_LAWS: [&str; 2] = ["stribeck_friction", "nonlinear_viscous_friction"];

/// Friction that comes up over a distance after reversals.
const OF_REVERSALS: [&str; 1] = ["presliding_hysteresis"];

/// Gears with play.
pub const PLAY: &str = "backlash";

/// Effects that look like play between its impacts.
const LIKE_PLAY: [&str; 3] = ["encoder_offset", "encoder_eccentricity", "joint_elasticity"];

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

fn with_role(effect: &dyn Effect, wanted: impl Fn(Role) -> bool) -> Vec<usize> {
    let parameters = effect.parameters().iter().enumerate();
    parameters.filter(|(_, parameter)| wanted(parameter.role)).map(|(index, _)| index).collect()
}

/// Whether an effect low-passes the torque, of which its column is the derivative.
pub fn is_lag(effect: &dyn Effect) -> bool {
    LAGS.contains(&effect.about().name)
}

/// Whether an effect moves the torque of the whole arm in time.
pub fn is_delay(effect: &dyn Effect) -> bool {
    DELAYS.contains(&effect.about().name)
}

/// Whether an effect is friction that depends on its joint's speed alone.
pub fn is_speed_law(effect: &dyn Effect) -> bool {
    SPEED_LAWS.contains(&effect.about().name)
}

/// Whether an effect is friction that shows after reversals alone.
pub fn is_of_reversals(effect: &dyn Effect) -> bool {
    OF_REVERSALS.contains(&effect.about().name)
}

/// Whether play of the same gear looks like an effect, but for its impacts.
pub fn is_like_play(effect: &dyn Effect) -> bool {
    LIKE_PLAY.contains(&effect.about().name)
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
