//! Which set of changes the logs ask for.
//!
//! | question | module |
//! |---|---|
//! | which set of changes is the smallest | `smallest` |
//! | which of those that the logs do not separate | `settle` |

mod settle;
mod smallest;

pub(super) use settle::{are_of_bodies, opposite_zeros, settled};
pub(super) use smallest::{CLEAN, Found, Outcome, search};
