//! Choices before the search.
//!
//! In: logs and the arm. Out: a session with rows of the training and of the held-out logs. The cut-offs of the positions' low-pass
//! minimise the innovations of the torque. The low-pass of the torque before logging minimises the residual. The Coulomb smoothing
//! velocity of each joint is the likeliest. Where reference logs follow the same motion, differences of torque at equal states replace
//! torque. The entry point is [`Session::knowing`](crate::diagnosis::model::Session::knowing).

mod coulomb_forms;
mod coulomb_width;
mod differences;
mod feedback;
mod filters;
mod opening;
mod passband;
mod smoothing;
