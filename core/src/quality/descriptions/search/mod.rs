//! Which set of changes the logs ask for.
//!
//! | question | module |
//! |---|---|
//! | which set of changes is the smallest | `smallest`, `found` |
//! | which of its changes the others make needless | `needed` |
//! | whether a mirror image of reversed axes is the cause | `mirrored` |
//! | which of those that the logs do not separate | `settle` |
//! | whether a zero is that of a convention | `usual_zeros` |

mod found;
mod mirrored;
mod needed;
mod settle;
mod smallest;
mod usual_zeros;

pub(super) use found::Found;
pub(super) use settle::{are_of_bodies, is_beyond_position, opposite_zeros, settled};
pub(super) use smallest::{CLEAN, Outcome, search};
