//! Words in the names of columns besides the quantities, and what they mean.

use super::quantity::{QUANTITIES, TORQUE};
use super::words::words;

/// Words for the current of a motor, which stands in for its torque.
pub(super) const CURRENT: [&str; 19] = [
    "current",
    "currents",
    "motor_current",
    "motor_currents",
    "current_motor",
    "axis_current",
    "drive_current",
    "effort_current",
    "control_output",
    "amps",
    "cur",
    "curr",
    "i",
    "macur",
    "strom",
    "motorstrom",
    "courant",
    "corriente",
    "corrente",
];

/// Short units, and words that are no units of SI's kind, that stand behind a name without brackets; those of three letters or more do, too.
pub(super) const UNIT_WORDS: [&str; 7] = ["mm", "um", "nm", "ma", "rps", "pct", "percent"];

/// Words around a quantity that mean it was measured; nothing depends on them.
pub(super) const MEASURED: [&str; 20] = [
    "actual",
    "act",
    "applied",
    "measured",
    "meas",
    "msr",
    "present",
    "ist",
    "out",
    "output",
    "real",
    "sensor",
    "sensed",
    "feedback",
    "raw",
    "true",
    "est",
    "estimated",
    "value",
    "fb",
];

/// Words that mean percent of a rated value.
pub(super) const PERCENT: [&str; 2] = ["pct", "percent"];

/// The present value, in names as `joint1 current torque`: between a joint and a quantity, or before one of these.
pub(super) const PRESENT: [&str; 4] = ["actual", "measured", "current", "present"];
pub(super) const OF_PRESENT: [&str; 11] = [
    "position",
    "positions",
    "pos",
    "angle",
    "angles",
    "velocity",
    "velocities",
    "speed",
    "torque",
    "torques",
    "effort",
];

/// Words that mean a place, before a quantity; behind it they begin a joint's name. `link` and `load` are the joint's side of the gear.
pub(super) const OF_JOINT: [&str; 9] = ["joint", "joints", "jnt", "robot", "arm", "mtr", "link", "links", "load"];

/// Words of the motor's side of the gear.
const OF_MOTORS: [&str; 5] = ["motor", "motors", "rotor", "drive", "drives"];

/// Words that mean that a controller wanted or computed a value: a torque of this kind is taken where none was measured.
pub(super) const OF_CONTROLLER: [&str; 12] = [
    "target",
    "desired",
    "des",
    "ref",
    "reference",
    "cmd",
    "command",
    "commanded",
    "computed",
    "goal",
    "setpoint",
    "disturbance",
];

/// Words that mean that a value is that of another thing, and not of a joint, or a function of its angle.
pub(super) const OF_OTHERS: [&str; 13] = [
    "error",
    "err",
    "tcp",
    "cartesian",
    "temperature",
    "temperatures",
    "temp",
    "voltage",
    "action",
    "cos",
    "cosine",
    "sin",
    "sine",
];

/// Words of what acts from outside on the arm.
pub(super) const EXTERNAL: [&str; 4] = ["ext", "external", "contact", "disturbance"];

/// What a controller wanted, in names with a number at their end, as `tau_J_d_0` of a Panda.
pub(super) const WANTED: &str = "d";

/// The same of names with a number at their end: wanted, or computed as `tau_ext_hat_filtered_0`.
pub(super) const WANTED_NUMBERED: [&str; 4] = [WANTED, "ext", "hat", "filtered"];

/// Words of those parts of a path that name a message or a group and no joint, as `joint_states` and `measured_joint_state`.
pub(super) const OF_GROUPS: [&str; 16] = [
    "joint",
    "joints",
    "robot",
    "state",
    "states",
    "dynamic",
    "field",
    "msg",
    "message",
    "data",
    "observation",
    "obs",
    "measured",
    "actual",
    "feedback",
    "header",
];

/// The quantity that words joined by `_` stand for, and whether it is a current.
pub(super) fn lookup(joined: &str) -> Option<(usize, bool)> {
    if CURRENT.contains(&joined) {
        return Some((TORQUE, true));
    }
    (0..QUANTITIES.len()).find(|&k| QUANTITIES[k].words.contains(&joined)).map(|k| (k, false))
}

/// Whether a word says that a value was measured.
pub(super) fn is_measured(word: &str) -> bool {
    MEASURED.contains(&word)
}

/// Whether a word may stand in the name of a value that was measured at a joint.
pub(super) fn is_of_joint(word: &str) -> bool {
    ![&OF_CONTROLLER[..], &OF_OTHERS, &WANTED_NUMBERED].iter().any(|others| others.contains(&word))
}

/// Whether a word of a name means the motor's side of the gear.
pub(crate) fn is_of_motor(name: &str) -> bool {
    words(name).iter().any(|word| OF_MOTORS.contains(&word.as_str()))
}

/// Whether no word of a name says that its value was not measured at a joint.
pub(crate) fn is_measured_at_joint(name: &str) -> bool {
    words(name).iter().all(|word| is_of_joint(word))
}

/// Whether a name is that of a torque of contact, as controllers estimate it: what is left of the measured one without that of the arm.
pub(crate) fn is_external_torque(name: &str) -> bool {
    let words = words(name);
    let is_torque = |word: &String| lookup(word) == Some((TORQUE, false));
    words.iter().any(|word| EXTERNAL.contains(&word.as_str())) && words.iter().any(is_torque)
}
