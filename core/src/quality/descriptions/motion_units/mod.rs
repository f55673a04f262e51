//! Units of the motion that show in the torques alone: the clock's second, positions in turns, joints in another unit than the others,
//! positions before the gears, and shares of the joints' ranges.
//!
//! In: one log and the arm. Out: the factor of its clock, whether its positions are in turns, in degrees that look like rad, or in rad where their names
//! say degrees, joints that are in rad where others are not,
//! the ratio of the gears, or what positions are shares of.

mod clock;
mod degrees;
mod gears;
mod mixed;
mod radians;
mod ranges;
mod scaled;
mod turns;

pub(crate) use clock::{ClockFactor, clock_factor, clock_text, torques_deny_clock, unsure_clock_text};
pub(crate) use degrees::are_degrees;
pub(crate) use gears::ratio as gear_ratio;
pub(crate) use mixed::in_si_units;
pub(crate) use radians::are_radians;
pub(crate) use ranges::ranges;
pub(crate) use turns::are_turns;
