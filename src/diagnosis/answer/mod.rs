//! The whole way from logs to the answer.
//!
//! In: the arm, logs and options. Out: a [`Diagnosis`]: verdict, findings with what derives from them, gap closed on held-out
//! rows, what could not have been found, and the extended model run again in the simulator.

mod accounted;
mod conclusion;
mod derived;
mod diagnosis;
mod equations;
mod extended;
mod first_look;
mod gap;
mod inertias;
mod residual_structure;
mod resimulation;
mod traces;

pub use conclusion::{Conclusion, Resimulation, conclude, diagnose};
pub use derived::Derived;
pub use diagnosis::{Diagnosis, predicts_worse};
pub use equations::{Observed, observed};
pub use extended::torque;
pub use first_look::first_look;
pub use gap::Share;
pub use inertias::Gain;
pub use residual_structure::ResidualStructure;
