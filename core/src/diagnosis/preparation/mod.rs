//! Choices before the search.
//!
//! In: logs and the arm. Out: cut-offs of the positions' low-pass, the low-pass torque went through before logging, and the
//! tanh width of Coulomb friction: whatever predicts held-out rows best. Differences from reference logs of the same motion. The way in is
//! [`Session::knowing`](crate::diagnosis::model::Session::knowing).

mod coulomb_width;
mod differences;
mod filters;
mod opening;
mod passband;
mod smoothing;
