//! Choices before the search: logs and the arm become a session with rows of the training and of the held-out logs.
//!
//! Cut-offs of the positions' low-pass minimise the innovations of the torque, the low-pass of the torque before logging its residual. The
//! Coulomb smoothing velocity of each joint is the likeliest. Where reference logs follow the same motion, differences of torque at equal
//! states replace torque. The entry point is [`prepare`].

mod coulomb_forms;
mod coulomb_width;
mod differences;
mod feedback;
mod filters;
mod opening;
mod passband;
mod smoothing;

pub(crate) use opening::prepare;
