//! Wrong descriptions as hypotheses that are judged together on all logs of an arm: signs, exchanged columns, the direction
//! of gravity, torque without gravity, the scale of torque, zeros of positions.
//!
//! | question | module |
//! |---|---|
//! | what can be wrong, and what it makes of the signals | `change` |
//! | a description with its residuals | `tried` |
//! | residuals under a description | `fitting` |
//! | whether one is clearly better than another | `compare` |
//! | whether a gain is large, and whether the described bodies support it | `known` |
//! | which set of changes is the smallest, which of those that the logs do not separate | `search` |
//! | whether torques are of another scale, and wrong besides | `scales` |
//! | which direction of gravity needs no drive to carry weights | `weights` |
//! | which way friction acts, without a model | `jumps` |
//! | changes that have a size: gravity, scales, zeros | `sizes` |
//! | what the described bodies indicate about the residual | `bodies` |
//! | whether a torque lost its sign on the way | `lost_signs` |
//! | whether the clock is wrong, or positions are in another unit | `motion_units` |
//! | the judgement of all of these | `judgement` |
//! | its content | `verdict` |
//! | whether factors are the gears of the robot's file | `file_gears` |
//! | texts | `findings` |

mod bodies;
mod change;
mod compare;
mod contradiction;
mod file_gears;
mod findings;
mod fitting;
mod judgement;
mod jumps;
mod known;
mod lost_signs;
mod motion_units;
mod scales;
mod search;
mod shares;
mod sizes;
mod tried;
mod verdict;
mod weights;

pub(super) use bodies::at_rest::finding as of_gravity_alone;
pub(super) use bodies::finding as of_another_robot;
pub use change::{Change, Description};
pub(super) use contradiction::contradict;
pub(super) use findings::{findings, of_tilt};
pub use findings::{is_description, words};
pub(super) use judgement::{Judged, is_modelled, judge};
pub(super) use lost_signs::{is_explained_with_signs, without_sign};
pub(super) use motion_units::{
    ClockFactor, are_degrees, are_radians, are_turns, clock_factor, clock_text, gear_ratio, in_si_units, ranges,
    torques_deny_clock, unsure_clock_text,
};
pub use verdict::{Alternative, Shown, Spread, Verdict};

/// Whether a robot has bodies that can exist.
pub(super) fn has_bodies(robot: &crate::robot::Robot) -> bool {
    fitting::Physics::bodies(robot).is_some()
}

#[cfg(test)]
mod tests;
