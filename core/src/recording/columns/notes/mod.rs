//! What must be said of columns whose names were understood.
//!
//! | question | module |
//! |---|---|
//! | whether joints without a torque have a motor current | `spare_currents` |
//! | whether a unit in a name is not known | `unknown_units` |
//! | whether the log also has the motor side of the gears | `motor_side` |

pub(super) mod motor_side;
pub(super) mod spare_currents;
pub(super) mod unknown_units;
